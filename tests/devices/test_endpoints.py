"""What a document of services may not say, and what a language model is sent."""

from __future__ import annotations

import pytest

from prima.devices.endpoints import Endpoint, Grammars, Unfit, filled_by_grammar, read_services
from prima.errors import DocumentError
from prima.grammar import Grammar, load
from prima.messages import Json

SERVICE = '<service name="a" url="http://x/" {}</service>'
MODEL = '<language-model name="a" url="http://x/" model="m"><prompt>It is {{it}}.</prompt>{}'
NO_PROMPT = '<language-model name="a" url="http://x/" model="m">'
FALLBACK = '<fallback grammar="g.grxml" of="it"/>'
HEADERS = '<header name="A" value="x"/><header name="a" value="x"/>'


def no_grammar(name: str) -> Grammar:
    raise LookupError("cannot be read: no such file")


def services(inside: str, grammars: Grammars = no_grammar) -> list[Endpoint]:
    text = f'<services xmlns="urn:prima:services:1" version="1.0">\n{inside}\n</services>'
    return read_services("s.xml", text.encode(), grammars)


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ('key="">', "key is not the name of an environment variable."),
        ('><header name="A" variable=""/>', "variable is not the name of an environment variable."),
        ('><header name="A" value="&#10;"/>', "only printable ASCII characters."),
        ('key="K"><header name="authorization" value="x"/>', "The key is sent as this header"),
        (f">{HEADERS}", '"a" is there twice.'),
        ('><slot name="s"/><slot name="s"/>', '"s" is there twice.'),
        ('><slot name="s" choices=" | "/>', "There is nothing to choose."),
        ('most="10000001">', "is out of range: from 1 to 10000000."),
        ('><slot name="s" kind="number" choices="1|2"/>', "Only texts have choices."),
        ('><header name="a b" value="x"/>', '"a b" is not the name of a header.'),
        ('><header name="Host" value="x"/>', "Host follows from the request and cannot be set."),
        ('><header name="A"/>', "<header> needs exactly one of value, variable."),
        ('><header name="A" value="x" variable="X"/>', "needs exactly one of value, variable."),
    ],
)
def test_what_would_be_ignored_is_told(more: str, told: str) -> None:
    with pytest.raises(DocumentError) as error:
        services(SERVICE.format(more))
    (problem,) = error.value.problems
    assert told in problem.message and problem.place.line == 2 and problem.remedy


@pytest.mark.parametrize(
    ("service", "told"),
    [
        ('<service name="a" url="http://[x/"/>', '"http://[x/" is not an address.'),
        (f"{NO_PROMPT}<slot name='s'/></language-model>", "<language-model> needs a <prompt>."),
        (MODEL.format("</language-model>"), "<language-model> needs a <slot>."),
        (
            MODEL.format(f"<slot name='s'/>{FALLBACK}{FALLBACK}</language-model>"),
            "<language-model> has one <fallback>.",
        ),
    ],
)
def test_what_a_service_lacks_or_has_twice_is_told(service: str, told: str) -> None:
    with pytest.raises(DocumentError) as error:
        services(service, lambda _: load("digits"))
    (problem,) = error.value.problems
    assert problem.message == told and problem.place.line == 2 and problem.remedy


def test_what_is_wrong_with_a_fallback_is_told_with_its_document() -> None:
    with pytest.raises(DocumentError, match=r"g\.grxml:1:1: .*SRGS"):
        services(
            MODEL.format(f"<slot name='s'/>{FALLBACK}</language-model>"),
            lambda name: load(b"<words/>", base=name),
        )


@pytest.mark.parametrize(
    ("slots", "said", "filled"),
    [
        ('<slot name="s"/><slot name="t" required="false"/>', "one two", {"s": "12"}),
        ('<slot name="s" choices="1 | 2"/>', "one two", None),
        ('<slot name="s"/><slot name="t"/>', "one two", None),
        ('<slot name="s"/>', "nothing", None),
    ],
)
def test_a_grammar_of_one_value_fills_the_first_slot_if_it_fits(
    slots: str, said: str, filled: dict[str, Json] | None
) -> None:
    (model,) = services(
        MODEL.format(f"{slots}{FALLBACK}</language-model>"), lambda _: load("digits")
    )
    wanted = None if filled is None else {**filled, "fallback": True}
    assert filled_by_grammar(model, {"it": said}) == wanted


def test_a_model_is_told_what_a_slot_is_for_and_secrets_are_named() -> None:
    more = '<slot name="s" doc="The mood."/><header name="X-Key" variable="KEY"/></language-model>'
    (model,) = services(MODEL.format(more))
    assert model.slots[0].schema() == {"type": "string", "description": "The mood."}
    assert (model.headers, model.variables) == ({}, {"X-Key": ("", "KEY")})


@pytest.mark.parametrize("answer", [[], "happy", None, 1.5])
def test_a_model_has_to_answer_an_object_even_if_it_need_not_fill_a_slot(answer: Json) -> None:
    (model,) = services(MODEL.format('<slot name="s" required="false"/></language-model>'))
    assert model.reply({}) == {}
    with pytest.raises(Unfit, match="the answer is not a JSON object"):
        model.reply(answer)


def test_a_model_is_asked_for_slots_by_their_names() -> None:
    with pytest.raises(DocumentError, match="for the slot by its name"):
        services(MODEL.format('<slot name="s" field="a.0"/></language-model>'))


def test_a_grammar_that_is_not_there_is_told_once() -> None:
    fallback = '<slot name="s"/><fallback grammar="g.grxml" of="it"/></language-model>'
    with pytest.raises(DocumentError, match=r'"g\.grxml" cannot be read: no such'):
        services(MODEL.format(fallback))


@pytest.mark.parametrize(
    ("value", "written"),
    [(True, "true"), (2.0, "2"), (None, "undefined"), ({"a": ["b"]}, '{"a": ["b"]}')],
)
def test_values_are_written_in_prompts_as_applications_have_them(value: Json, written: str) -> None:
    (model,) = services(MODEL.format('<slot name="s"/></language-model>'))
    assert model.chat({"it": value})["messages"] == [
        {"role": "user", "content": f"It is {written}."}
    ]
