"""What a document of services may not say, and what a language model is sent."""

from __future__ import annotations

import pytest

from prima.devices.endpoints import Endpoint, read_services
from prima.errors import DocumentError
from prima.grammar import Grammar
from prima.messages import Json

SERVICE = '<service name="a" url="http://x/" {}</service>'
MODEL = '<language-model name="a" url="http://x/" model="m"><prompt>It is {{it}}.</prompt>{}'
HEADERS = '<header name="A" value="x"/><header name="a" value="x"/>'


def no_grammar(name: str) -> Grammar:
    raise LookupError("cannot be read: no such file")


def services(inside: str) -> list[Endpoint]:
    text = f'<services xmlns="urn:prima:services:1" version="1.0">\n{inside}\n</services>'
    return read_services("s.xml", text.encode(), no_grammar)


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
    ],
)
def test_what_would_be_ignored_is_told(more: str, told: str) -> None:
    with pytest.raises(DocumentError) as error:
        services(SERVICE.format(more))
    (problem,) = error.value.problems
    assert told in problem.message and problem.place.line == 2 and problem.remedy


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
