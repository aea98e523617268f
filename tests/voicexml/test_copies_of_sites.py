"""Copies of VoiceXML documents in a folder that run as if they were fetched from a server."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import urljoin

import pytest
from click.testing import CliRunner

from prima import api, loading
from prima.cli import cli
from prima.errors import UsageError
from tests.helpers.here import prima
from tests.helpers.voice import HEAD, vxml

SHOP = """<var name="shop" expr="'the shop'"/>
<catch event="error.badfetch"><log expr="_message"/><exit/></catch>"""
ASKING = """<form><field name="f"><prompt>Tea?</prompt>
<grammar src="https://example.org/app/grammars/a%20b.grxml"/>
<filled><goto next="/app/voice/next.vxml#b"/></filled></field></form>"""
DRINKS = """<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en"
 root="r"><rule id="r">tea</rule></grammar>"""
NEXT = """<form id="a"><block>No.</block></form>
<form id="b"><block><log expr="shop"/><goto next="{}"/></block></form>"""
LEAF = HEAD.replace("<vxml ", '<vxml application="../root.vxml" ')


def copied(tmp_path: Path, leads: str) -> Path:
    """A copy of a site, beside a document that is not of it."""
    made = {
        "site/root.vxml": vxml(SHOP),
        "site/voice/main.vxml": vxml(ASKING, LEAF),
        "site/voice/next.vxml": vxml(NEXT.format(leads), LEAF),
        "site/voice/there.vxml": vxml("<form><block><log>there</log></block></form>"),
        "site/grammars/a b.grxml": DRINKS,
        "outside.vxml": vxml("<form><block><log>outside</log></block></form>"),
    }
    for name, text in made.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path / "site"


def served(tmp_path: Path, attributes: str, more: str = "") -> Path:
    """A scenario that runs the copy."""
    demo = loading.documents_folder()
    path = tmp_path / "s.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"'
        f' world="{demo / "worlds" / "room.xml"}" robot="{demo / "robots" / "papero.xml"}">'
        f'<robot at="middle"/><person x="1" y="0"/>'
        f'<application src="site/voice/main.vxml" {attributes}/>'
        f'<answer to="Tea?">Tea.</answer>{more}</scenario>',
        encoding="utf-8",
    )
    return path


def logged(transcript: api.Transcript) -> list[str]:
    assert transcript.failures == []
    return [one["message"] for one in transcript.records if one["phase"] == "log"]


SITE = "https://example.org/app/voice/"
URI = 'uri="https://example.org/app/voice/main.vxml" folder="site"'


@pytest.mark.parametrize(
    "leads",
    ["there.vxml", "/app/voice/there.vxml", "https://example.org/app/voice/there.vxml?a=b"],
)
def test_a_copy_behaves_as_if_it_was_fetched(tmp_path: Path, leads: str) -> None:
    site = copied(tmp_path, leads)
    assert logged(api.rehearse(served(tmp_path, URI))) == ["the shop", "there"]
    maps = [f"https://example.org/app/={site}/"]
    staged = api.stage([], [str(site / "voice" / "main.vxml")], ["tea"], maps=maps)
    assert logged(api.rehearse(staged)) == ["the shop", "there"]


def test_a_copy_is_validated_as_if_it_was_fetched(tmp_path: Path) -> None:
    site = copied(tmp_path, "/app/voice/there.vxml")
    main = site / "voice" / "main.vxml"
    main.write_text(main.read_text().replace("../root.vxml", "/app/root.vxml"))
    codes = [one.code for one in api.validate([main])]
    assert codes == ["no-such-file"] * len(codes) != []
    maps = [f"https://example.org/app/={site}/"]
    assert api.validate([main], maps) == []
    (site / "voice" / "there.vxml").unlink()
    (missing,) = api.validate([main], maps)
    assert missing.code == "no-such-file" and missing.place.file.endswith("next.vxml")
    with pytest.raises(UsageError, match="no VoiceXML application is in the folder"):
        api.validate([tmp_path / "outside.vxml"], maps)


def test_the_command_line_maps_what_it_validates(tmp_path: Path) -> None:
    site = copied(tmp_path, "/app/voice/there.vxml")
    served_at = f"--map=https://example.org/app/={site}"
    done = CliRunner().invoke(cli, ["validate", "--strict", str(site), served_at])
    assert (done.exit_code, done.stdout) == (0, ""), done.output
    assert CliRunner().invoke(cli, ["validate", "--strict", str(site)]).exit_code == 1


LEADING_OUT = {
    "../../outside.vxml": "example.org/outside.vxml: ",
    "https://example.org/app/%2e%2e/outside.vxml": "outside.vxml: the folder has no such file; ",
    "https://example.org/app/../outside.vxml": "outside.vxml: the folder has no such file; ",
    "https://example.org/app/link.vxml": "link.vxml: the folder has no such file; ",
    "nowhere.vxml": "https://example.org/app/voice/nowhere.vxml: the folder has no such file; ",
    "https://example.org/application/x.vxml": "application/x.vxml: ",
}


@pytest.mark.parametrize("leads", LEADING_OUT)
def test_no_name_leads_out_of_a_copy_and_none_to_the_network(
    tmp_path: Path, leads: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("socket.socket", None)
    site = copied(tmp_path, leads)
    (site / "link.vxml").symlink_to(tmp_path / "outside.vxml")
    shop, why = logged(api.rehearse(served(tmp_path, URI)))
    told = 'the run does not allow the host: add "--allow-host example.org"'
    assert shop == "the shop" and why.startswith("next.vxml:2:39: ")
    assert why.endswith(f"{LEADING_OUT[leads]}{told}")


@pytest.mark.parametrize(
    ("leads", "event"),
    [
        ("nowhere.vxml", "error.badfetch.http.404"),
        ("../../outside.vxml", "error.badfetch"),
        ("https://example.com/app/nowhere.vxml", "error.badfetch"),
    ],
)
def test_what_a_copy_lacks_is_not_found_there(tmp_path: Path, leads: str, event: str) -> None:
    site = copied(tmp_path, leads)
    told = SHOP.replace("_message", "_event")
    (site / "root.vxml").write_text(vxml(told), encoding="utf-8")
    assert logged(api.rehearse(served(tmp_path, URI))) == ["the shop", event]


@pytest.mark.parametrize("leads", ["order.cgi", "/app/order:new"])
def test_a_service_answers_what_a_copy_lacks(tmp_path: Path, leads: str) -> None:
    copied(tmp_path, leads)
    (tmp_path / "answer.vxml").write_text(
        vxml("<form><block><log>ordered</log></block></form>"), encoding="utf-8"
    )
    more = (
        f'<service name="shop" uri="{urljoin(SITE, leads)}"><reply after="1s"'
        ' src="answer.vxml"/></service>'
    )
    assert logged(api.rehearse(served(tmp_path, URI, more))) == ["the shop", "ordered"]


def test_validation_looks_into_a_copy_as_a_run_does(tmp_path: Path) -> None:
    copied(tmp_path, "there.vxml")
    assert loading.validate([served(tmp_path, URI)]) == []
    wrong = tmp_path / "site" / "voice" / "there.vxml"
    wrong.write_text(vxml("<form><block><goto next='/app/gone.vxml'/><nothing/></block></form>"))
    found = loading.validate([served(tmp_path, URI)])
    assert [(str(one.place), one.code) for one in found] == [
        (f"{wrong}:1:96", "no-such-file"),
        (f"{wrong}:1:113", "unknown-element"),
    ]
    service = '<service name="s" uri="https://example.org/app/gone"/>'
    found = loading.validate([served(tmp_path, URI, service)])
    assert [one.code for one in found] == ["unknown-element"]


def test_grammars_of_a_copy_name_each_other_by_their_uris(tmp_path: Path) -> None:
    site = copied(tmp_path, "there.vxml")
    drinks = (site / "grammars" / "a b.grxml").read_text()
    (site / "grammars" / "tea.grxml").write_text(drinks.replace('id="r"', 'id="r" scope="public"'))
    (site / "grammars" / "a b.grxml").write_text(
        drinks.replace(">tea<", '><ruleref uri="/app/grammars/tea.grxml#r"/><')
    )
    assert loading.validate([served(tmp_path, URI)]) == []
    assert logged(api.rehearse(served(tmp_path, URI))) == ["the shop", "there"]


def test_without_a_folder_the_document_s_own_is_served(tmp_path: Path) -> None:
    copied(tmp_path, "there.vxml")
    (tmp_path / "site" / "voice" / "main.vxml").write_text(
        vxml('<form><block><goto next="https://a.example/there.vxml"/></block></form>')
    )
    path = served(tmp_path, 'uri="https://a.example/start"')
    assert logged(api.rehearse(path)) == ["there"]


@pytest.mark.parametrize(
    ("attributes", "code", "message"),
    [
        ('uri="app/main.vxml"', "bad-value", '"app/main.vxml" is not the URI of a document.'),
        ('uri="https://e.example/a?b"', "bad-value", "is not the URI of a document."),
        ('uri="https://e.example/x.vxml" folder="site"', "bad-value", "does not end as the"),
        (
            'uri="https://e.example/a%2Fvoice/main.vxml" folder="site"',
            "bad-value",
            "does not end as the",
        ),
        ('uri="https://e.example/main.vxml" folder="other"', "bad-value", "is not in the folder"),
        ('folder="site"', "missing-attribute", 'A folder is served at a "uri".'),
    ],
)
def test_a_wrong_place_of_a_copy_is_an_error(
    tmp_path: Path, attributes: str, code: str, message: str
) -> None:
    copied(tmp_path, "there.vxml")
    found = loading.validate([served(tmp_path, attributes)])
    [problem] = [one for one in found if one.severity == "error"]
    assert (problem.severity, problem.code) == ("error", code)
    assert message in problem.message


def test_an_application_of_prima_s_language_is_served_nowhere(tmp_path: Path) -> None:
    copied(tmp_path, "there.vxml")
    demo = loading.documents_folder() / "fa" / "follow.xml"
    path = served(tmp_path, f'uri="https://e.example/x"/><application src="{demo}" {URI[:46]}')
    errors = [one for one in loading.validate([path]) if one.severity == "error"]
    assert [one.code for one in errors] == ["unknown-attribute"]


@pytest.mark.parametrize(("given", "problems"), [("follow", 0), ("pal", 1)])
def test_an_application_of_prima_s_language_has_its_own_id(
    tmp_path: Path, given: str, problems: int
) -> None:
    copied(tmp_path, "there.vxml")
    demo = loading.documents_folder() / "fa" / "follow.xml"
    path = served(tmp_path, f'/><application src="{demo}" id="{given}"')
    found = [one for one in loading.validate([path]) if one.code == "unknown-attribute"]
    assert [one.severity for one in found] == ["warning"] * problems
    assert all('has the id "follow"' in one.message for one in found)


@pytest.mark.parametrize("text", ["site", "=site", "https://e.example/app/=", "ftp://x/=site"])
def test_a_mapping_that_is_none_is_wrong_usage(tmp_path: Path, text: str) -> None:
    site = copied(tmp_path, "there.vxml")
    with pytest.raises(UsageError, match="maps no URI to a folder"):
        api.stage([], [str(site / "voice" / "main.vxml")], [], maps=[text])


def test_a_mapping_of_no_application_is_wrong_usage(tmp_path: Path) -> None:
    site = copied(tmp_path, "there.vxml")
    with pytest.raises(UsageError, match="no VoiceXML application is in the folder"):
        api.stage(
            [], [str(site / "voice" / "main.vxml")], [], maps=["https://e.example/=elsewhere"]
        )


def test_an_application_in_our_language_beside_the_copy_is_not_served(tmp_path: Path) -> None:
    site = copied(tmp_path, "/app/voice/there.vxml")
    fa = site / "follow.xml"
    fa.write_text((loading.documents_folder() / "fa" / "follow.xml").read_text())
    maps = [f"https://example.org/app/={site}/"]
    staged = api.stage([fa], [str(site / "voice" / "main.vxml")], ["tea"], maps=maps)
    assert logged(api.rehearse(staged)) == ["the shop", "there"]
    with pytest.raises(UsageError, match="no VoiceXML application is in the folder"):
        api.stage([fa], [], maps=maps)


@pytest.mark.parametrize("uri", ["https://e.example/app/", "https://e.example/x", "http://e/x=1/"])
def test_a_run_of_a_mapped_site_is_replayed_from_any_folder(uri: str, tmp_path: Path) -> None:
    voice, out = tmp_path / "site" / "voice", tmp_path / "out"
    voice.mkdir(parents=True)
    out.mkdir()
    root = f"{uri.rstrip('/')}/root.vxml"
    prompt = '<form><block><prompt><value expr="greeting"/></prompt></block></form>'
    text = vxml(prompt).replace("<vxml", f'<vxml application="{root}"', 1)
    (voice / "main.vxml").write_text(text)
    (voice.parent / "root.vxml").write_text(vxml("""<var name="greeting" expr="'Hello.'"/>"""))
    robot = loading.documents_folder() / "robots" / "simulated.xml"
    words = ["live", "--robot", str(robot), "--speed", "1000"]
    words += ["--ea", "site/voice/main.vxml", "--map", f"{uri}=site", "-o", "out/visit.jsonl"]
    done = prima(*words, cwd=tmp_path)
    assert (done.returncode, '"Hello."' in done.stdout) == (0, True), done.stderr
    done = prima("replay", "visit.jsonl", cwd=out)
    assert (done.returncode, done.stderr) == (0, "the same, byte for byte\n")
