"""What users say is left out of a redacted journal, wherever it comes back."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.errors import UsageError
from prima.grammar import load
from prima.grammar.answers import Answers
from prima.live.chosen import Chosen
from prima.live.prepared import prepared
from prima.live.redaction import Redactor
from prima.live.visit import LiveSettings, begin
from prima.messages import Record

SCENARIOS = Path(__file__).parents[2] / "documents" / "scenarios"


def test_what_users_say_in_their_own_words_is_left_out_wherever_it_comes_back() -> None:
    takes = [Answers({"a cake": "cake"}), Answers(type="text")]
    redactor = Redactor(lambda: takes)
    said = "My name is Ada."

    def heard(text: str) -> Record:
        return {"time": 1, "phase": "event", "actor": "user", "event": "speech", "text": text}

    redactor([{"time": 0, "phase": "run", "data": {}}])
    value = {"outcome": "filled", "utterance": said, "value": said}
    free = [
        heard(said),
        {"time": 1, "phase": "end", "text": "Who are you?", "data": value},
        {"time": 1, "phase": "send", "data": {"to": "diary", "params": {"text": [said, 3]}}},
        {"time": 1, "phase": "request", "text": "Well, MY  NAME IS ADA. Is that so?"},
        {"time": 1, "phase": "log", "message": f"heard: {said}"},
        {"time": 1, "phase": "request", "words": said, "extra": {"emotion": [said]}},
    ]
    made = redactor(free)
    assert "ada" not in str(made).lower()
    assert [one.get("text") for one in made[:4:3]] == [
        "[redacted]",
        "Well, [redacted]. Is that so?",
    ]
    kept = {"time": 2, "phase": "end", "text": "A cake?", "data": {"value": "cake"}}
    assert redactor([heard("a cake"), kept])[1] == kept, "a grammar has made this"
    takes.clear()
    redactor([])
    says = {"time": 3, "phase": "request", "text": "So it is. Nobody asks me now."}
    assert redactor([heard("it"), says])[1] == says
    assert "Nobody" not in str(redactor([heard("Nobody asks me"), says]))


def test_words_are_left_out_of_errors_and_names_and_so_are_alternatives_and_late_ones() -> None:
    garbage = load("#ABNF 1.0 UTF-8;\nlanguage en;\nroot $r;\n$r = I am $GARBAGE;\n")
    takes = [Answers({"yes": True}), Answers(grammars=[garbage])]
    redactor = Redactor(lambda: takes)
    redactor([])

    def left(text: str, more: Record, **event: object) -> str:
        heard = {"phase": "event", "event": "speech", "text": text, **event}
        return str(redactor([heard, {"time": 1, "app": "it", **more}]))

    ends = 'error.semantic: visit.xml:3:1: "Zorblatt Quux" is not a name'
    said = left("Zorblatt Quux", {"phase": "unload", "outcome": ends})
    assert 'error.semantic: visit.xml:3:1: "[redacted]" is not' in said
    send = {"phase": "send", "data": {"to": "diary", "params": {"seen": {"Zorblatt Quux": 1}}}}
    assert "{'to': 'diary', 'params': {'seen': {'[redacted]': 1}}}" in left("yes", send)
    others = {"alternatives": [{"text": "Boston harbour", "confidence": 0.4}]}
    log = {"phase": "log", "message": "or Boston harbour?"}
    assert "'or [redacted]?'" in left("Austin arbor", log, data=others)
    log = {"phase": "log", "message": "heard: I am Ermintrude"}
    assert "'heard: [redacted]'" in left("I am Ermintrude", log), "GARBAGE takes free words"
    log = {"phase": "log", "message": "too late: Ada."}
    assert "'too late: [redacted].'" in left("Ada", log, rule="X10")
    move = {"phase": "request", "args": {"to": "hall"}, "cues": [{"at": 1, "sound": "hall"}]}
    made = left("hall", move, rule="X10")
    assert "{'to': '[redacted]'}" in made and "[{'at': 1, 'sound': '[redacted]'}]" in made
    answered = {"phase": "end", "rule": "X8", "data": {"value": "Ben"}}
    assert "{'value': '[redacted]'}" in left("Ben", answered)


def test_words_are_left_out_of_the_names_of_errors_and_answers() -> None:
    redactor = Redactor(lambda: [Answers(type="text")])
    redactor([])
    said = {"phase": "event", "event": "speech", "text": "Zorblatt"}
    failed = {"phase": "event", "event": "error.service.Zorblatt"}
    answered = {"phase": "event", "event": "reply.Zorblatt"}
    ends = {"phase": "unload", "outcome": "my.Zorblatt: visit.xml:3:1"}
    made = redactor([said, failed, answered, ends])
    assert [one["event"] for one in made[1:3]] == ["error.service.[redacted]", "reply.[redacted]"]
    assert made[3]["outcome"] == "my.[redacted]: visit.xml:3:1"
    kept = [{"phase": "event", "event": "touch.head"}, {"phase": "unload", "outcome": "exit"}]
    for word in ("head", "exit"):
        assert redactor([{**said, "text": word}, *kept])[1:] == kept, "no words of users"


@pytest.mark.parametrize(
    ("said", "sent", "left"),
    [
        (
            "I am Zoë Quux",
            "https://a.org/?q=I%20am%20Zo%C3%AB%20Quux&n=1",
            "https://a.org/?q={}&n=1",
        ),
        ("Zoë", "q=Zo%c3%ab", "q={}"),
        ("Zoe", "Mrs%20Zoe%2C%20please", "Mrs {}, please"),
        ("Zoe", "100%25%20wool", "100%25%20wool"),
        ("Zoe", "50 % of %zz", "50 % of %zz"),
        ("हिन्दी", "नमस्ते हिन्दी!", "नमस्ते {}!"),
        ("Jose\u0301", "Hi Jose\u0301, hi", "Hi {}, hi"),
    ],
)
def test_words_in_a_uri_and_their_marks_are_left_out(said: str, sent: str, left: str) -> None:
    redactor = Redactor(lambda: [Answers(type="text")])
    redactor([])
    event = {"phase": "event", "event": "speech", "text": said}
    send = {"phase": "send", "data": {"to": "diary", "params": {"q": sent}}}
    assert redactor([event, send])[1]["data"]["params"]["q"] == left.format("[redacted]")


def test_what_an_application_says_of_its_end_has_no_words_in_a_redacted_run(tmp_path: Path) -> None:
    (tmp_path / "ea.xml").write_text(
        """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="ea" xml:lang="en">
  <form id="a"><field name="who" type="text"><prompt>Who?</prompt>
    <filled><throw event-expr="'error.' + who"/></filled><noinput><exit/></noinput></field></form>
</prima>"""
    )
    scenario = tmp_path / "visit.xml"
    scenario.write_text(
        f"""<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit"
    world="{SCENARIOS.parent}/worlds/room.xml" robot="{SCENARIOS.parent}/robots/papero.xml">
  <robot at="middle"/><person x="1" y="0"/><application src="ea.xml"/>
  <answer to="Who?">Zorblatt Quux</answer>
</scenario>"""
    )
    made = api.run_live(scenario, speed=1000, redact=True)
    assert len(made.failures) == 1 and "[redacted]" in made.failures[0]
    assert "Zorblatt" not in str(made.records) + str(made.failures)


def test_a_scenario_with_free_answers_has_none_of_them_in_a_redacted_journal(
    tmp_path: Path,
) -> None:
    journal = tmp_path / "visit.jsonl"
    scenario = "documents/scenarios/follow-during-navigation.xml"
    visit = begin(Chosen(scenario=scenario), LiveSettings(speed=1000, redact=True), str(journal))
    visit.run(lambda _: None, lambda _: None)
    assert "I see" not in journal.read_text()
    with pytest.raises(UsageError, match="is for a new journal"):
        prepared(Chosen(), LiveSettings(redact=True), None, str(journal))
