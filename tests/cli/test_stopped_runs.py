"""What a run that the scenario's until stops says of its applications."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests import ROOT
from tests.helpers.here import prima

DOCUMENTS = ROOT / "documents"


@pytest.mark.parametrize(
    ("until", "doing"),
    [
        ("1s", 'guide is in the middle of "Come on, let\'s go."'),
        ("6s", 'follow is asking "What\'s the matter with you?"'),
    ],
)
def test_a_run_that_is_stopped_says_what_was_going_on(
    tmp_path: Path, until: str, doing: str
) -> None:
    source = (DOCUMENTS / "scenarios" / "touched-on-the-way.xml").read_text(encoding="utf-8")
    path = tmp_path / "stopped.xml"
    source = source.replace("../", f"{DOCUMENTS}/")
    path.write_text(
        source.replace("<scenario ", f'<scenario until="{until}" ', 1), encoding="utf-8"
    )
    done = prima("run", path, "-o", tmp_path / "s.jsonl")
    assert f"The run was stopped at {until[:-1]} s, the scenario's until: " in done.stderr
    assert doing in done.stderr and done.returncode == 0


@pytest.mark.parametrize(
    ("answers", "told"),
    [
        ('<answer to="Tea">juice</answer>', ', and does not take the answer "juice".'),
        ('<answer to="Tea" times="1">juice</answer><answer to="Tea">tea</answer>', "."),
    ],
)
def test_a_question_that_does_not_take_an_answer_is_reported(
    tmp_path: Path, answers: str, told: str
) -> None:
    (tmp_path / "ask.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="ask"><form id="f">'
        '<field name="drink"><prompt>Tea or coffee?</prompt><option>tea</option>'
        '<noinput count="9"><exit/></noinput><filled><clear/></filled></field></form></prima>'
    )
    (tmp_path / "s.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" until="20s"'
        f' world="{DOCUMENTS}/worlds/museum.xml" robot="{DOCUMENTS}/robots/papero.xml">'
        f'<robot at="entrance"/><application src="ask.xml"/>{answers}</scenario>'
    )
    done = prima("run", tmp_path / "s.xml")
    stopped = 'The run was stopped at 20 s, the scenario\'s until: ask is asking "Tea or coffee?"'
    assert f"{stopped}{told}\n" in done.stderr


def test_an_answer_that_another_question_did_not_take_is_not_reported(tmp_path: Path) -> None:
    (tmp_path / "ask.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="ask"><form id="f">'
        '<field name="drink"><prompt>Tea or coffee?</prompt><option>tea</option>'
        '<nomatch><assign name="drink" expr="0"/></nomatch></field>\n'
        '<field name="food"><prompt>Cake or pie?</prompt><option>pie</option></field>'
        "</form></prima>"
    )
    (tmp_path / "s.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" until="20s"'
        f' world="{DOCUMENTS}/worlds/museum.xml" robot="{DOCUMENTS}/robots/papero.xml">'
        '<robot at="entrance"/><application src="ask.xml"/><answer to="Tea">juice</answer></scenario>'
    )
    done = prima("run", tmp_path / "s.xml")
    assert done.stderr.endswith('ask is asking "Cake or pie?".\n')
