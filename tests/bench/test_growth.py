"""Work on a document grows in proportion to its size; calls are counted, not time."""

from __future__ import annotations

import gc
import sys
from collections import Counter
from collections.abc import Callable
from cProfile import Profile
from functools import partial
from pathlib import Path

import pytest

from bench.large import FAMILIES, Family
from prima import loading
from prima.certificate import certificates
from prima.checks.ignores import Ignores
from prima.errors import Place, Problem, did_you_mean, few_guesses, in_order
from prima.errors.guesses import MANY_WORDS
from prima.interpreter import reader
from prima.lsp import naming
from prima.lsp.complete import complete
from prima.lsp.hover import hover
from prima.lsp.outline import outline
from prima.lsp.problems import check, spot
from prima.lsp.text import Lines
from prima.lsp.workspace import Workspace
from prima.markup.collecting import OBJECTS, seldom_collected
from prima.markup.tree import Source
from prima.script import names
from prima.script.compile import compiled
from tests import ROOT

SMALL, LARGE = 8_000, 32_000
MOST = 1.4
"""As many times more calls than the size has grown: guesses and what is looked up once count, too."""
TIMES = 200


def calls(work: Callable[[], object]) -> int:
    """How many functions, of Python or not, are called meanwhile."""
    profile = Profile()
    profile.runcall(work)
    return sum(one.callcount for one in profile.getstats())


def grown(family: Family, folder: Path, work: Callable[[Path], object]) -> float:
    """How many times more calls a document needs, by how many times longer it is."""
    counts = []
    for size in (1_000, SMALL, LARGE):
        path = folder / f"of-{size}{family.suffix}"
        path.write_text(family.text(size), encoding="utf-8")
        counts.append(calls(partial(work, path)))
    _, small, large = counts
    return large / small / (LARGE / SMALL)


@pytest.fixture(autouse=True)
def nothing_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """What other tests have compiled would make a small document's share of the work smaller."""
    monkeypatch.setattr("prima.script.compile._Cache.expressions", {})
    names._kept.cache_clear()


@pytest.mark.parametrize("name", FAMILIES)
def test_validation_grows_with_the_size_of_a_document(name: str, tmp_path: Path) -> None:
    assert grown(FAMILIES[name], tmp_path, lambda path: loading.validate([path])) < MOST


@pytest.mark.parametrize("name", ["forms that ask", "subdialogs", "handlers", "let", "areas"])
def test_an_editors_questions_grow_with_the_size_of_a_document(name: str, tmp_path: Path) -> None:
    def ask(path: Path) -> None:
        workspace, text = Workspace(), path.read_text(encoding="utf-8")
        workspace.folders = [path.parent]
        workspace.put(path.as_uri(), text)
        page = workspace.open[path].page
        for problem in [one for some in check(workspace, path).values() for one in some]:
            spot(page.lines, problem)
            for span, _ in (edit for fix in problem.fixes for edit in fix.edits):
                page.lines.offsets(span)
        for offset in (text.find('"', len(text) // 2) + 1, text.find("<", len(text) // 2) + 2):
            hover(workspace, path, offset)
            complete(workspace, path, offset)
            naming.references(workspace, path, offset)
            naming.rename(workspace, path, offset, "other")
        outline(page)

    assert grown(FAMILIES[name], tmp_path, ask) < MOST


ASKING = (
    "VoiceXML dialogs with gotos",
    "VoiceXML menus",
    "VoiceXML external grammars",
    "VoiceXML branches",
    "VoiceXML enumerates",
)


@pytest.mark.parametrize("name", ["forms with gotos", "subdialogs", *ASKING])
def test_a_certificate_grows_with_the_size_of_a_document(name: str, tmp_path: Path) -> None:
    fa = str(ROOT / "documents" / "fa" / "follow.xml")
    assert grown(FAMILIES[name], tmp_path, lambda path: certificates([fa], [str(path)])) < MOST


def test_each_question_looks_at_each_handler_a_few_times(tmp_path: Path) -> None:
    head = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="large" xml:lang="en">'
    fa, path, counts = str(ROOT / "documents" / "fa" / "follow.xml"), tmp_path / "ea.xml", []
    for number in (10, 40, 160):
        handlers = "".join(f'<noinput count="{one + 1}"/>' for one in range(number))
        fields = "".join(f'<field name="q{one}" type="boolean"/>' for one in range(number))
        path.write_text(f'{head}{handlers}<form id="f">{fields}</form></prima>')
        counts.append(calls(lambda: certificates([fa], [str(path)])))
    assert counts[2] / counts[1] < 4**2 * MOST


def test_a_certificate_of_two_large_documents_grows_with_their_size(tmp_path: Path) -> None:
    def both(path: Path) -> object:
        ea = path.with_name("ea.xml")
        ea.write_text(path.read_text(encoding="utf-8").replace('"large"', '"other"'))
        path.write_text(path.read_text(encoding="utf-8").replace('kind="ea"', 'kind="fa"'))
        return certificates([str(path)], [str(ea)])

    family = FAMILIES["forms in a ring beside handlers that go on"]
    assert grown(family, tmp_path, both) < MOST


def test_the_collector_looks_less_often_while_a_document_is_read(tmp_path: Path) -> None:
    before, seen = gc.get_threshold(), []
    path = tmp_path / "a.xml"
    path.write_text(FAMILIES["declared names"].text(1_000), encoding="utf-8")
    with seldom_collected():
        loading.validate([path])
        seen.append(gc.get_threshold()[0])
    assert seen == [OBJECTS] and gc.get_threshold() == before
    gc.disable()
    try:
        loading.validate([path])
        assert not gc.isenabled() and gc.get_threshold() == before
    finally:
        gc.enable()


def test_an_expression_is_compiled_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: Counter[str] = Counter()

    def counted(code: str) -> object:
        asked[code] += 1
        return compiled(code)

    monkeypatch.setattr("prima.interpreter.checks.code.compiled", counted)
    monkeypatch.setattr("prima.voicexml.checks.later.compiled", counted)
    for name in ("undeclared names in expressions", "VoiceXML undeclared names"):
        path = tmp_path / f"a{FAMILIES[name].suffix}"
        path.write_text(FAMILIES[name].text(SMALL), encoding="utf-8")
        asked.clear()
        loading.validate([path])
        assert len(asked) > 100 and asked.most_common(1)[0][1] == 1


def test_problems_nearly_in_order_are_hardly_compared() -> None:
    compared = 0

    class Text(str):
        def __lt__(self, other: str) -> bool:
            nonlocal compared
            compared += 1
            return super().__lt__(other)

    texts = [Text(f"{index:04}") for index in range(1_000)]
    problems = [Problem(Place("a.xml"), "error", "empty", "Empty.", text) for text in texts]
    problems = [one._replace(remedy=text) for one, text in zip(problems, texts, strict=True)]
    assert in_order([*problems, *problems[:10]]) == problems
    assert compared < 2 * len(problems)


def test_a_document_is_few_objects(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Python looks through all of them whenever they have grown by a quarter."""
    monkeypatch.setattr(reader, "MOST_KEPT", 0)
    family = FAMILIES["forms with gotos"]
    counts = []
    for size in (LARGE, SMALL, LARGE):
        text = family.text(size)
        gc.collect()
        before = len(gc.get_objects())
        document, _ = reader.read_document(str(tmp_path / f"{size}.xml"), text.encode())
        gc.collect()
        counts.append((len(gc.get_objects()) - before, len(document.forms)))
        del document
    _, (few, some), (many, more) = counts  # the first one also frees what other tests have left
    most = 10.5 if sys.version_info < (3, 14) else 14.5  # which also looks through plain dicts
    assert (many - few) / (more - some) < most  # three elements, with what they hold and mean


def test_dialogs_without_handlers_and_units_are_not_sketched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    family = FAMILIES["VoiceXML dialogs with gotos"]
    path = tmp_path / "a.vxml"
    path.write_text(family.text(SMALL), encoding="utf-8")
    monkeypatch.setattr("prima.voicexml.sketched.Sketch", None)
    assert loading.validate([path]) == []


def test_only_so_many_words_are_compared_for_one_document() -> None:
    looked = 0

    def words(number: int) -> list[str]:
        return [f"word{index}" for index in range(number)]

    def many() -> object:
        nonlocal looked
        for looked in range(10**6):
            yield f"word{looked}"

    assert did_you_mean("wordy", many()) == "" and looked <= MANY_WORDS + 1  # type: ignore[arg-type]
    with few_guesses():
        told = [did_you_mean(f"wrd{index}", words(MANY_WORDS)) for index in range(TIMES)]
    assert told[0] and not told[-1] and sum(map(bool, told)) >= 100
    assert did_you_mean("wrd1", words(MANY_WORDS))


def test_a_text_is_read_once_for_the_places_in_it() -> None:
    text = f"<a b='{'x&amp;' * 500}'/>"
    source = Source("a.xml", text)
    first = calls(lambda: source.inside(0, "b", 999))
    assert calls(lambda: [source.inside(0, "b", at) for at in range(1_000)]) < 20 * first
    assert source.inside(0, "b", 0) == Place("a.xml", 1, 7)
    assert source.inside(0, "b", 999) == Place("a.xml", 1, 7 + 499 * 6 + 1)


def test_the_columns_of_a_long_line_are_counted_once() -> None:
    lines = Lines("\U0001f600a" * 5_000)
    first = calls(lambda: lines.position(9_999))
    assert calls(lambda: [lines.position(at) for at in range(10_000)]) < 10 * first
    assert [lines.position(at)[1] for at in (0, 1, 2, 3, 9_999)] == [0, 2, 3, 5, 14_999]


def test_ignores_are_found_by_their_places(tmp_path: Path) -> None:
    comments = "<!-- prima-ignore: empty because --> " * 3
    body = f"<a>{comments}<b>\n<c/></b>\n<d/></a>".replace("<d/>", f"\n{comments}<d/>")
    path = tmp_path / "a.xml"
    path.write_text(body, encoding="utf-8")
    ignores = Ignores(lambda _: body.encode())
    places = [(1, body.index("<b>") + 1), (2, 1), (3, 1), (4, body.splitlines()[3].index("<d") + 1)]
    problems = [Problem(Place(str(path), *at), "warning", "empty", "Empty.") for at in places]
    assert [one.place.line for one in ignores.left(problems)] == [3]
    ignores.check(str(path))
    assert ignores.problems() == []
