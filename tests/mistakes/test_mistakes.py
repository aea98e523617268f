"""Mistakes as newcomers make them, and the examples of every code: one message, in its place."""

from __future__ import annotations

import ast
import json
import tomllib
from importlib import import_module
from pathlib import Path
from string import Formatter
from typing import Any

import pytest

from prima import api
from prima.checks.codes import diagnoses
from prima.errors import Diagnosis, Fix, Problem, UsageError
from prima.errors.rendering import TOKEN
from prima.handbook.examples import FOLDER, Example, beside, data, examples, shown
from prima.loading.files import GivenFiles, in_place_of_files
from tests import ROOT
from tests.helpers.here import prima
from tests.helpers.validating import mended

MISTAKES = Path(__file__).parent
EXPECTED: dict[str, dict[str, str]] = tomllib.loads(
    (MISTAKES / "expected.toml").read_text(encoding="utf-8")
)


def problems_of(path: Path) -> list[Problem]:
    return [one for one in api.validate([path]) if one.severity != "note"]


@pytest.mark.parametrize("name", EXPECTED)
def test_a_mistake_is_told_once_in_its_place_with_a_remedy(name: str) -> None:
    expected = EXPECTED[name]
    found = problems_of(MISTAKES / name)
    assert len(found) == 1, found
    place, (_, code, message, remedy) = found[0].place, found[0].sentence
    assert f"{place.line}:{place.column} {code}" == expected["at"]
    assert Path(place.file) == MISTAKES / expected.get("in", name)
    line = Path(place.file).read_text(encoding="utf-8").split("\n")[place.line - 1]
    token = TOKEN.match(line, place.column - 1)
    assert (token[0] if token else "") == expected["under"]
    assert remedy and expected["says"] in f"{message} {remedy}"


@pytest.mark.parametrize("code", diagnoses())
def test_the_problem_of_an_example_has_a_remedy_of_its_own(code: str) -> None:
    for path in (FOLDER / code).glob("wrong.*"):
        for problem in problems_of(path):
            assert problem.remedy and problem.remedy not in problem.message, problem


def test_every_mistake_is_expected() -> None:
    files = {path.name for path in MISTAKES.iterdir() if path.suffix in (".xml", ".vxml")}
    assert files == set(EXPECTED) and len(files) >= 50


def test_what_mistakes_name_beside_them_is_right() -> None:
    for path in (MISTAKES / "beside").iterdir():
        assert problems_of(path) == [], path.name


# The examples of the codes ----------------------------------------------------------


@pytest.mark.parametrize("code", diagnoses())
def test_the_wrong_example_of_a_code_has_that_problem_alone(code: str) -> None:
    wrong, right = examples(code)
    *others, last = [problem.code for problem in wrong.problems]
    assert last == code and (not others or code == "more-problems")
    assert right.problems == []
    place = wrong.problems[0].place
    assert _lines(wrong, place.file)[place.line - 1].strip()


@pytest.mark.parametrize("code", diagnoses())
def test_a_code_is_explained_with_its_place(code: str) -> None:
    text = shown(code)
    wrong = examples(code)[0]
    assert text.startswith(diagnoses()[code].meaning)
    assert f"[{code}]\n" in text and "^" in text
    assert "\nRight" in text and "Traceback" not in text
    assert data(code)["problems"][0]["line"] == wrong.problems[0].place.line


def _lines(example: Example, name: str) -> list[str]:
    path = FOLDER / name
    text = example.text if name == example.name else path.read_text(encoding="utf-8")
    return text.split("\n")


def test_every_folder_of_examples_is_a_code() -> None:
    folders = {path.name for path in FOLDER.iterdir() if path.is_dir()} - {"__pycache__"}
    assert folders == set(diagnoses())


def test_documents_beside_examples_are_right() -> None:
    for path in FOLDER.glob("*.xml"):
        assert problems_of(path) == [], path.name
    assert set(beside("mode")) == {"keys.grxml", "towns.gram"}


NOTERS = {"Problem", "problem", "unsupported", "of", "_error"}
"""What the package calls to tell a problem; its code is one of the first arguments."""


def test_no_code_is_emitted_that_is_not_explained() -> None:
    found: dict[str, str] = {}
    for path in (ROOT / "prima").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.Call):
                continue
            called = getattr(node.func, "attr", getattr(node.func, "id", ""))
            if called in NOTERS:
                place = {"Problem": 2, "unsupported": 2}.get(called, 1)
                given: Any = node.args[place] if len(node.args) > max(place, 2) else None
                if isinstance(given, ast.Constant) and isinstance(given.value, str):
                    found[given.value] = f"{path.name}:{node.lineno}"
    assert len(found) > 30
    assert {code: place for code, place in found.items() if code not in diagnoses()} == {}


# prima explain ------------------------------------------------------------------------


def test_explain_lists_all_codes() -> None:
    listed = prima("explain", cwd=ROOT)
    assert listed.returncode == 0 and listed.stderr == ""
    lines = listed.stdout.partition("Codes of problems:\n")[2].splitlines()
    assert [line.split()[0] for line in lines] == [*diagnoses()]
    assert all(len(line) <= 100 for line in lines)
    told = json.loads(prima("explain", "--format", "json", cwd=ROOT).stdout)
    codes = {one["code"]: one["explanation"] for one in told if one["kind"] == "problem"}
    assert codes == {code: one.meaning for code, one in diagnoses().items()}


def test_explain_shows_the_wrong_example_the_message_and_the_right_one() -> None:
    told = prima("explain", "misplaced-element", cwd=ROOT)
    assert told.returncode == 0
    assert "wrong.xml:3:5: error: <speak> is not allowed in <form>. Put it into a <block>." in (
        told.stdout
    )
    assert "    3 |     <speak>Hello.</speak>\n      |     ^~~~~~\n" in told.stdout
    as_json = json.loads(prima("explain", "too-deep", "--format", "json", cwd=ROOT).stdout)
    assert as_json["problems"][0]["code"] == "too-deep"
    assert as_json["right"]["text"].startswith("<prima ")


def test_explain_guesses_a_misspelt_code() -> None:
    told = prima("explain", "no-anser", cwd=ROOT)
    assert told.returncode == 2 and told.stdout == ""
    assert 'There is no rule, code or file "no-anser". Did you mean "no-answer"?' in told.stderr
    with pytest.raises(UsageError, match="prima explain lists them"):
        examples("zzz")


# What no file here can show -------------------------------------------------------------


def written(folder: Path, name: str, text: str) -> list[Problem]:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return problems_of(path)


def application(content: str) -> str:
    return (
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="tour">'
        f'<form id="start">{content}</form></prima>'
    )


def test_a_name_that_no_variable_may_have_is_never_suggested(tmp_path: Path) -> None:
    content = (
        '<var name="my drink"/><block><log expr="drink"/>'
        "<script>n = my_drink</script><exit/></block>"
    )
    found = written(tmp_path, "tour.xml", application(content))
    assert "bad-value" in [one.code for one in found]
    assert [one.remedy for one in found if "Did you mean" in one.remedy] == []
    field = (
        '<field name="my drink"><option>tea</option><noinput><exit/></noinput></field>'
        '<filled namelist="my_drink"><exit/></filled>'
    )
    found = written(tmp_path, "tour.xml", application(field))
    assert "no-such-item" in [one.code for one in found]
    assert [one.remedy for one in found if "my drink" in one.remedy] == []


@pytest.mark.parametrize(
    ("code", "message"),
    [
        ("nosuch (1)", 'There is no function "nosuch".'),
        ("nosuch.of(1)", 'The variable "nosuch" is not declared.'),
        ("setTimeout(1)", 'There is no function "setTimeout".'),
    ],
)
def test_what_is_called_is_a_function(tmp_path: Path, code: str, message: str) -> None:
    content = f'<block><log expr="{code}"/><exit/></block>'
    (found,) = written(tmp_path, "tour.xml", application(content))
    assert found.message == message
    assert ("<var" in found.remedy) == message.startswith("The variable")


def scenario(content: str, attributes: str = "") -> str:
    beside = (MISTAKES / "beside").as_posix()
    return (
        f'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit" {attributes}'
        f' world="{beside}/room.xml" robot="{beside}/robot.xml"><robot at="door"/>'
        f'<application src="{beside}/ask.xml"/>{content}</scenario>'
    )


@pytest.mark.parametrize(
    "content",
    [
        '<expect event="touch"/>',
        '<never event="error"/>',
        '<never event="error.service.desk"/>',
        '<expect says="Tea" on="touch.head"/>',
        '<expect ends="ask" reason="unloaded"/>',
        '<never ends="ask" reason="error.semantic"/>',
        '<never ends="ask" reason="error"/>',
        '<never ends="ask" reason="error.unit.timeout"/>',
        '<in-order><expect event="human.found"/></in-order>',
        '<when at="10s"><say>Tea.</say></when>',
        '<when at="1s"><event name="noinput"/></when><expect event="noinput"/>',
        '<expect state="start" at="10s"/>',
        '<expect state="start" at="end"/>',
        '<person x="4" y="3"/>',
        '<person x="4" y="3"/><when at="1s"><walk x="2" y="9"/></when>',
    ],
)
def test_what_is_right_in_a_scenario_is_not_told(tmp_path: Path, content: str) -> None:
    assert written(tmp_path, "visit.xml", scenario(content, 'until="10s"')) == []


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ('<in-order><expect event="mesage"/></in-order>', 'Did you mean "message"?'),
        ('<expect event="noinput"/>', "Name what its handler says or does."),
        ('<when on="nomatch"><say>Tea.</say></when>', "Name what its handler says or does."),
        ('<expect event="error.unsupported.photo"/>', "Name what its handler says or does."),
        ('<never event="interrupted.speak"/>', "Name what its handler says or does."),
        ('<expect event="end.speak"/>', 'Write finishes="speak".'),
        ('<expect event="end.q-and-a"/>', 'Write finishes="q-and-a".'),
        ('<expect event="error.badfetch.http"/>', "Name what its handler says or does."),
        ('<when on="end.speak"><say>Tea.</say></when>', 'Write done="speak".'),
        ('<expect ends="ask" reason="end"/>', "Write exit, unloaded or the name of an error."),
        ('<expect ends="ask" reason="exits"/>', 'Did you mean "exit"?'),
        ('<when at="8s" after="3s"><say>Tea.</say></when>', "or a later until."),
        ('<person x="2" y="9"/>', "They are between -1 and 3."),
    ],
)
def test_what_is_wrong_deeper_in_a_scenario_is_told(
    tmp_path: Path, content: str, says: str
) -> None:
    (found,) = written(tmp_path, "visit.xml", scenario(content, 'until="10s"'))
    assert found.severity == "warning" and says in found.remedy


def staged(folder: Path, robot: str, content: str) -> list[Problem]:
    """The problems of a scenario whose FA asks a robot for something."""
    (folder / "app.xml").write_text(application(f"<block>{content}<exit/></block>"), "utf-8")
    beside = (MISTAKES / "beside").as_posix()
    text = (
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit"'
        f' world="{beside}/museum.xml" robot="{beside}/{robot}.xml"><robot at="door"/>'
        '<application src="app.xml"/></scenario>'
    )
    return written(folder, "visit.xml", text)


PICTURE = '<command type="take-a-picture">{}</command>'
BOW = '<command type="gesture">{}</command>'


@pytest.mark.parametrize(
    ("robot", "content"),
    [
        ("camera", PICTURE.format('<param name="zoom" value="2"/>')),
        ("camera", PICTURE.format('<param name="zoom" expr="1 + 1"/>')),
        ("robot", BOW.format('<param name="name" value="bow"/>')),
        ("robot", '<command type="speak">Hello.</command>'),
    ],
)
def test_what_a_command_of_the_profile_is_given_is_enough(
    tmp_path: Path, robot: str, content: str
) -> None:
    assert staged(tmp_path, robot, content) == []


@pytest.mark.parametrize(
    ("robot", "content", "code"),
    [
        ("camera", PICTURE.format(""), "missing-attribute"),
        ("robot", BOW.format(""), "missing-attribute"),
        ("camera", PICTURE.format('<param name="zoom" value="2"/>Smile!'), "stray-text"),
        (
            "robot",
            '<command type="turn"><param name="angle" value="9"/>Hi.</command>',
            "stray-text",
        ),
    ],
)
def test_what_a_command_of_the_profile_lacks_is_told(
    tmp_path: Path, robot: str, content: str, code: str
) -> None:
    (found,) = staged(tmp_path, robot, content)
    assert found.code == code and found.severity == "error" and found.remedy


@pytest.mark.parametrize("name", ["speek", "Speak"])
def test_a_closing_tag_that_is_misspelt_is_told_as_that(tmp_path: Path, name: str) -> None:
    text = application(f"<block><speak>Hi.</{name}><exit/></block>")
    (found,) = written(tmp_path, "tour.xml", text)
    assert found.code == "not-xml" and f"write </speak> instead of </{name}>" in found.remedy
    (fix,) = found.fixes
    assert problems_after(tmp_path / "tour.xml", fix) == []


def test_a_closing_tag_of_another_element_is_kept(tmp_path: Path) -> None:
    text = application("<block><speake>Hi.<speak></speake></block>")
    (found,) = written(tmp_path, "tour.xml", text)
    (fix,) = found.fixes
    assert fix.edits[0].text == "</speak>" and fix.edits[0].span[:2] == fix.edits[0].span[2:]


@pytest.mark.parametrize(
    "content",
    [
        "<if><exit/></if>",
        '<foreach item="x"><exit/></foreach>',
        '<foreach array="[1]"><exit/></foreach>',
        '<assign name="n"/>',
        "<throw/>",
        "<speak>It is <value/>.</speak>",
        "<pause/>",
        "<set-position-and-direction x='1' y='0'/>",
        '</block><on fresh-for="2s"><exit/></on><block>',
        '<exit/></block></form><form><block><goto next="#start"/>',
    ],
)
def test_an_attribute_that_is_added_has_a_right_value(tmp_path: Path, content: str) -> None:
    text = application(f'<var name="n"/><block>{content}<exit/></block>')
    (found,) = (one for one in written(tmp_path, "tour.xml", text) if one.severity == "error")
    (fix,) = found.fixes
    assert [
        one for one in problems_after(tmp_path / "tour.xml", fix) if one.severity == "error"
    ] == []


@pytest.mark.parametrize("content", ["<topological-move/>", '<assign expr="1"/>'])
def test_no_name_is_made_up_of_what_is_elsewhere(tmp_path: Path, content: str) -> None:
    text = application(f"<block>{content}<exit/></block>")
    found = {one.code: one.fixes for one in written(tmp_path, "tour.xml", text)}
    assert found["missing-attribute"] == ()


@pytest.mark.parametrize(
    ("content", "remedy"),
    [
        ("<speak>a <speak>b</speak></speak>", "Close the first <speak> before this one."),
        ("<speak>a <exit/></speak>", "Put it into an <on>."),
    ],
)
def test_what_is_inside_of_an_utterance_is_put_where_it_belongs(
    tmp_path: Path, content: str, remedy: str
) -> None:
    found = written(tmp_path, "tour.xml", application(f"<block>{content}<exit/></block>"))
    assert [(one.code, one.remedy) for one in found] == [("misplaced-element", remedy)]


@pytest.mark.parametrize("tag", ["<else>", '<elseif cond="1>2"\n>'])
def test_an_element_that_holds_nothing_ends_by_itself(tmp_path: Path, tag: str) -> None:
    text = application(
        f'<block><if cond="1 > 2"><exit/>{tag}<speak>No.</speak></if><exit/></block>'
    )
    (found,) = written(tmp_path, "tour.xml", text)
    assert found.code == "not-xml" and found.remedy.endswith("end its own tag with />.")
    (fix,) = found.fixes
    assert problems_after(tmp_path / "tour.xml", fix) == []


def test_a_device_of_ones_own_is_no_mistake_beside_the_one_it_is_called_like(
    tmp_path: Path,
) -> None:
    robot = (
        '<robot xmlns="urn:prima:robot:1" version="1.0" id="robot">'
        '<device name="neck"/><device name="necks"/><adds command="nod-twice" devices="necks"/></robot>'
    )
    assert written(tmp_path, "robot.xml", robot) == []


def test_two_applications_of_one_id_are_named_by_their_options(tmp_path: Path) -> None:
    ask = MISTAKES / "beside" / "ask.xml"
    other = tmp_path / "other.xml"
    other.write_bytes(ask.read_bytes())
    twice = prima("run", "--ea", str(ask), "--ea", str(ask), cwd=ROOT)
    assert twice.returncode == 2 and twice.stdout == ""
    assert f"--ea {ask} is given twice." in twice.stderr
    both = prima("run", "--fa", str(ask), "--ea", str(other), cwd=ROOT)
    assert both.returncode == 2 and "stage.xml" not in both.stderr
    assert f'--fa {ask} and --ea {other} have the same id, "ask".' in both.stderr


# Diagnoses ----------------------------------------------------------------------------


def declared() -> dict[str, dict[str, Diagnosis]]:
    """The diagnoses that each module of the package names, by module."""
    found: dict[str, dict[str, Diagnosis]] = {}
    for path in (ROOT / "prima").rglob("*.py"):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
        text = path.read_text(encoding="utf-8")
        if "import Diagnosis" in text or "prima.errors.diagnoses" in text:
            known = vars(import_module(name)).items()
            found[name] = {key: one for key, one in known if isinstance(one, Diagnosis)}
    return found


def fields(template: str) -> set[str]:
    return {name for _, name, _, _ in Formatter().parse(template) if name is not None}


def test_a_diagnosis_gets_all_the_parameters_of_its_sentences() -> None:
    found = 0
    for name, known in declared().items():
        path = Path(import_module(name).__file__ or "")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)):
                continue
            holder = node.func.value
            if node.func.attr == "at" and isinstance(holder, ast.Name) and holder.id in known:
                given = {one.arg for one in node.keywords}
                one = known[holder.id]
                needed = fields(one.message) | fields(one.remedy)
                assert one.message, f"{name}:{node.lineno}: {holder.id} says nothing"
                assert given >= needed, f"{name}:{node.lineno}: {needed - given}"
                found += 1
    assert found > 60


def test_diagnoses_have_titles_of_their_own() -> None:
    titles = [one.title for one in diagnoses().values()]
    assert len(set(titles)) == len(titles)
    for code, one in diagnoses().items():
        assert one.meaning.endswith(".") and not one.title.endswith("."), code
        assert one.title[:1].isupper() and len(one.title) <= 40, code


WRONG = [
    *(path for path in FOLDER.rglob("wrong.*") if path.suffix in (".xml", ".vxml")),
    *(path for path in MISTAKES.iterdir() if path.suffix in (".xml", ".vxml")),
]


def problems_after(path: Path, fix: Fix) -> list[Problem]:
    """The problems of a document after a fix."""
    text = mended(path.read_text(encoding="utf-8"), fix)
    with in_place_of_files(GivenFiles({path.resolve(): text.encode()})):
        return problems_of(path)


HIDING = ("unknown-attribute",)
"""Codes behind which a value may be wrong that is only looked at when they are mended."""


@pytest.mark.parametrize("path", WRONG, ids=lambda path: f"{path.parent.name}-{path.name}")
def test_a_fix_takes_its_problem_away(path: Path) -> None:
    before = problems_of(path)
    for problem in before:
        if Path(problem.place.file).resolve() != path.resolve():
            continue
        assert problem.fixes or "Did you mean" not in problem.remedy, problem
        for fix in problem.fixes:
            left = problems_after(path, fix)
            assert problem.sentence not in {one.sentence for one in left}, fix
            new = {one.code for one in left} - {one.code for one in before}
            if problem.code not in HIDING:
                assert not new & {"not-xml", "bad-value"}, fix
