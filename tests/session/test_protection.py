"""Protection of applications from each other: which is the FA, and which messages reach whom."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.errors import DocumentError, Problem

DEMO = api.documents_folder()


def app(name: str, body: str, kind: str = "ea") -> str:
    """An application in PRIMA's own language."""
    head = f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{kind}" id="{name}">'
    return f"{head}{body}</prima>"


def staged(folder: Path, content: str, attributes: str = "", **documents: str) -> Path:
    """A scenario in an empty room; applications stand in it by their names."""
    for name, text in documents.items():
        (folder / f"{name}.xml").write_text(text)
    robot = (DEMO / "robots" / "papero.xml").read_text()
    allows = '<allows command="face-human-and-speak" argument="volume"/></robot>'
    (folder / "robot.xml").write_text(robot.replace("</robot>", allows))
    path = folder / "scenario.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"'
        f' world="{DEMO}/worlds/room.xml" robot="robot.xml" {attributes}>'
        f'<robot at="middle"/><person x="1" y="0"/>{content}</scenario>'
    )
    return path


def problems_of(path: Path) -> list[Problem]:
    """What loading a scenario finds, whether or not it can be run."""
    try:
        return api.load_scenario(path).problems
    except DocumentError as error:
        return error.problems


def whats(transcript: api.Transcript) -> list[str]:
    return [row.what for row in transcript.rows()]


# Of which kind an application is ------------------------------------------------------

LOUD = app(
    "loud",
    '<form id="f"><block><face-human-and-speak>Here.<param name="volume" value="loud"/>'
    "</face-human-and-speak><exit/></block></form>",
    "fa",
)
"""An application that says of itself that it is the robot's own."""


@pytest.mark.parametrize(
    ("said", "kind", "told"),
    [
        ("", "ea", "but this scenario does not: it runs as an EA."),
        ('kind="ea"', "ea", "but this scenario says EA: it runs as an EA."),
        ('kind="fa"', "fa", ""),
    ],
)
def test_no_document_makes_itself_an_fa(tmp_path: Path, said: str, kind: str, told: str) -> None:
    path = staged(tmp_path, f'<application src="loud.xml" {said}/>', loud=LOUD)
    loaded = api.load_scenario(path)
    assert [one.code for one in loaded.problems if told in one.message] == ["other-kind"] * bool(
        told
    )
    records = api.rehearse(loaded).records
    assert [one["data"]["kind"] for one in records if one["phase"] == "load" and "data" in one] == [
        kind
    ]
    refused = [one["rule"] for one in records if one["phase"] == "fail"]
    assert refused == (["E3"] if kind == "ea" else [])


def test_a_kind_that_is_none_is_told_once(tmp_path: Path) -> None:
    loud = LOUD.replace('kind="fa"', 'kind="EA"')
    path = staged(tmp_path, '<application src="loud.xml"/>', loud=loud)
    found = [one for one in problems_of(path) if "kind" in one.message or one.code == "other-kind"]
    assert [(one.code, one.remedy) for one in found] == [("bad-value", 'Did you mean "ea"?')]
    path = staged(tmp_path, '<application src="loud.xml" kind="robot"/>', loud=LOUD)
    found = [one for one in problems_of(path) if "kind" in one.message or one.code == "other-kind"]
    assert [(one.code, one.remedy) for one in found] == [("bad-value", "Write ea or fa.")]


def test_a_document_is_an_fa_where_the_scenario_says_so(tmp_path: Path) -> None:
    calm = app("calm", '<form id="f"><block><speak>Here.</speak><exit/></block></form>')
    path = staged(tmp_path, '<application src="calm.xml" kind="fa"/>', calm=calm)
    loaded = api.load_scenario(path)
    assert "says that it is an EA, but this scenario says FA" in loaded.problems[0].message
    assert loaded.cast.documents[0].kind == "fa"
    # Whoever else runs the same document runs it as that says.
    assert api.load(tmp_path / "calm.xml").kind == "ea"


def test_what_a_place_offers_is_an_ea(tmp_path: Path) -> None:
    world = (DEMO / "worlds" / "room.xml").read_text()
    offer = '<area id="shop" application="loud.xml" x1="-1" y1="-1" x2="1" y2="1"/></world>'
    path = staged(tmp_path, "", 'entrances="open"', loud=LOUD)
    (tmp_path / "world.xml").write_text(world.replace("</world>", offer))
    path.write_text(path.read_text().replace(f"{DEMO}/worlds/room.xml", "world.xml"))
    loaded = api.load_scenario(path)
    assert "but a place offers EAs: it runs as an EA" in loaded.problems[0].message
    assert "Only an FA may give" in " ".join(whats(api.rehearse(loaded)))


# What reaches whom --------------------------------------------------------------------

HEARS = app("hears", '<form id="f"><on event="message"><speak>For me?</speak></on></form>')


def test_a_message_to_an_application_reaches_it_alone(tmp_path: Path) -> None:
    guide = app("guide", '<form id="f"><on event="message"><speak>Thanks.</speak></on></form>')
    both = '<application src="hears.xml"/><application src="guide.xml"/>'
    arrives = '<when at="1s"><message from="Kidode" to="guide">Hi.</message></when>'
    path = staged(tmp_path, both + arrives, hears=HEARS, guide=guide)
    made = api.rehearse(path)
    assert whats(made)[2:] == ["a message from Kidode arrives", '"Thanks."']
    assert made.rows()[2].app == "guide"
    assert api.replay(made, path).dumps() == made.dumps()
    path = staged(tmp_path, both + arrives.replace(' to="guide"', ""))
    assert sorted(whats(api.rehearse(path))[3:]) == ['"For me?"', '"Thanks."']


@pytest.mark.parametrize(
    "content",
    [
        '<when at="1s"><message to="giude">Hi.</message></when>',
        '<service name="server" application="giude"/>',
    ],
)
def test_an_application_that_is_not_there_is_refused(tmp_path: Path, content: str) -> None:
    guide = app("guide", '<form id="f"><on event="message"><exit/></on></form>')
    path = staged(tmp_path, f'<application src="guide.xml"/>{content}', guide=guide)
    told = [one for one in api.validate([path]) if one.code == "no-such-name"]
    assert [one.remedy for one in told] == ['Did you mean "guide"?']
    assert told[0].severity == "error"


ASKS = """<form id="f"><block><send to="server"/></block>
<on event="reply.server"><log>it says <value expr="event.data.n"/></log></on>
<on event="error.service"><log><value expr="event.data.message"/></log></on></form>"""


def services(*owners: str) -> str:
    """Services of one name, each with what it says."""
    made = ""
    for owner in owners:
        whose = f' application="{owner}"' if owner else ""
        made += f'<service name="server"{whose}><reply after="1s"><data name="n" value="{owner or "all"}"/>'
        made += "</reply></service>"
    return made


@pytest.mark.parametrize(
    ("owners", "one", "two"),
    [
        (("",), "log: it says all", "log: it says all"),
        (("one",), "log: it says one", 'log: the service "server" is another application\'s'),
        (("two", "one"), "log: it says one", "log: it says two"),
        (("", "two"), "log: it says all", "log: it says two"),
    ],
)
def test_a_service_answers_the_application_that_it_belongs_to(
    tmp_path: Path, owners: tuple[str, ...], one: str, two: str
) -> None:
    both = '<application src="one.xml"/><application src="two.xml"/>'
    path = staged(tmp_path, both + services(*owners), one=app("one", ASKS), two=app("two", ASKS))
    said = {row.app: row.what for row in api.rehearse(path).rows() if row.what.startswith("log:")}
    assert said == {"one": one, "two": two}
    told = [problem for problem in problems_of(path) if problem.code == "no-such-name"]
    assert [problem.message for problem in told] == [
        'The scenario has the service "server" for one alone.'
    ] * ("another" in two)


def test_two_services_of_one_name_for_one_application_are_refused(tmp_path: Path) -> None:
    content = '<application src="one.xml"/>' + services("one", "one")
    path = staged(tmp_path, content, one=app("one", ASKS))
    assert 'Two services have the name "server" for the application "one".' in str(
        problems_of(path)
    )


FETCHES = """<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"><form><block>
<data name="d" src="{}"/><log>it is there</log></block>
<catch event="error.badfetch"><log><value expr="_message"/></log></catch></form></vxml>"""


@pytest.mark.parametrize("uri", ["service:server", "https://e.example/x"])
def test_a_fetch_reaches_only_services_of_its_application(tmp_path: Path, uri: str) -> None:
    for name in ("one", "two"):
        (tmp_path / f"{name}.vxml").write_text(FETCHES.format(uri))
    both = '<application src="one.vxml"/><application src="two.vxml"/>'
    served = services("one").replace(" application", ' uri="https://e.example/" application')
    made = api.rehearse(staged(tmp_path, both + served))
    said = {row.app: row.what for row in made.rows() if row.what.startswith("log:")}
    assert said["one"] == "log: it is there" and "it is there" not in said["two"]


QUESTION = """<form id="f"><field name="a"><prompt>Shall I?</prompt><option>yes</option>
<nomatch><speak>Pardon?</speak><exit/></nomatch><noinput><exit/></noinput></field></form>"""
LISTENS = """<link event="heard"><grammar>buy it</grammar></link><form id="f">
<on event="heard"><log>caught</log></on></form>"""


@pytest.mark.parametrize(("kind", "caught"), [("ea", False), ("fa", True)])
def test_an_answer_is_not_offered_to_the_link_of_another_ea(
    tmp_path: Path, kind: str, caught: bool
) -> None:
    both = f'<application src="asks.xml"/><application src="listens.xml" kind="{kind}"/>'
    documents = {"asks": app("asks", QUESTION), "listens": app("listens", LISTENS, kind)}
    path = staged(tmp_path, both + '<answer to="Shall I">Buy it.</answer>', **documents)
    said = whats(api.rehearse(path))
    assert ("log: caught" in said) == caught and ('"Pardon?"' in said) == (not caught)


def test_the_asking_applications_own_link_takes_what_its_question_does_not(tmp_path: Path) -> None:
    asks = app("asks", LISTENS.partition("<form")[0] + QUESTION.replace("</form>", (
        '<on event="heard"><log>caught</log></on></form>')))  # fmt: skip
    content = '<application src="asks.xml"/><answer to="Shall I" times="1">Buy it.</answer>'
    assert "log: caught" in whats(api.rehearse(staged(tmp_path, content, asks=asks)))


def test_while_no_question_listens_everybodys_links_do(tmp_path: Path) -> None:
    content = '<application src="listens.xml"/><when at="1s"><say>Buy it.</say></when>'
    path = staged(tmp_path, content, listens=app("listens", LISTENS))
    assert "log: caught" in whats(api.rehearse(path))


# How long one of them may keep the speaker ----------------------------------------------

PAUSE = '<break time="50s"/>' * 5


@pytest.mark.parametrize(
    "said",
    [
        "<speak>{}</speak>".format("x" * 50_000),
        f"<speak>One.{PAUSE * 3}Two.</speak>",
        f"<face-human-and-speak>One.{PAUSE * 3}Two.</face-human-and-speak>",
    ],
)
def test_an_utterance_that_is_too_long_is_an_error_of_validation(tmp_path: Path, said: str) -> None:
    path = tmp_path / "a.xml"
    path.write_text(app("a", f'<form id="f"><block>{said}<exit/></block></form>'))
    assert [one.code for one in api.validate([path])] == ["too-long"]


@pytest.mark.parametrize(
    ("body", "taken"),
    [
        (f"<speak>{PAUSE}{PAUSE}<value expr=\"'x'.repeat(5000)\"/></speak>", False),
        (f"<speak>{PAUSE}<value expr=\"'x'.repeat(5000)\"/></speak>", True),
    ],
)
def test_an_utterance_that_turns_out_too_long_is_refused(
    tmp_path: Path, body: str, taken: bool
) -> None:
    handler = '<on event="error.semantic"><log>too long</log><exit/></on>'
    long = app("long", f'<form id="f"><block>{body}<exit/></block>{handler}</form>')
    made = api.rehearse(staged(tmp_path, '<application src="long.xml"/>', long=long))
    assert ("log: too long" in whats(made)) == (not taken)
    refused = [one["rule"] for one in made.records if one["phase"] == "fail"]
    assert refused == ([] if taken else ["E3"])


@pytest.mark.parametrize(("time", "taken"), [("36000s", False), ("90s", True)])
def test_a_question_of_voicexml_that_waits_too_long_is_refused(
    tmp_path: Path, time: str, taken: bool
) -> None:
    (tmp_path / "asks.vxml").write_text(
        '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"><form><field name="a" type="boolean">'
        f'<prompt timeout="{time}">Well?</prompt><noinput><exit/></noinput></field>'
        '<catch event="error.semantic"><log>too long</log><exit/></catch></form></vxml>'
    )
    made = api.rehearse(staged(tmp_path, '<application src="asks.vxml"/>'))
    assert ("log: too long" in whats(made)) == (not taken)
    assert made.records[-1]["time"] < 120
