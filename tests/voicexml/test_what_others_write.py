"""What documents of other platforms have: capitals, spaces, lists, names of the DOM."""

from __future__ import annotations

from pathlib import Path
from time import process_time

import pytest

from prima import api
from prima.errors import Problem
from prima.voicexml.reading import read_page
from tests.helpers.dialogs import block, codes, leaf, run, said
from tests.helpers.here import prima
from tests.helpers.voice import HEAD, vxml


def warnings(text: str) -> list[Problem]:
    """What validation says of a document besides errors."""
    return read_page("a.vxml", "a.vxml", vxml(text).encode()).warnings()


DOCUMENTS = api.documents_folder().resolve()


@pytest.mark.parametrize(
    "content", ['<goto next="#b" method="GET"/>', '<prompt method="POST">x</prompt>']
)
def test_a_method_where_none_is_known_is_an_unknown_attribute(content: str) -> None:
    assert codes(block(content) + '<form id="b"/>') == ["unknown-attribute"]


@pytest.mark.parametrize("code", ["1, 2", "'one', 'two'", "(1, 2), 3"])
def test_a_list_of_expressions_has_the_value_of_the_last(code: str) -> None:
    last = code.split(", ")[-1].strip("'")
    call = run(block(f'<prompt><value expr="{code}"/></prompt><log expr="{code}"/><exit/>'))
    assert (call.said(), call.logs()) == ([last], [last])


def test_the_classes_of_the_dom_are_known() -> None:
    assert codes(block('<log expr="Node.TEXT_NODE + (1 instanceof DOMException)"/>')) == []


def test_what_a_script_gives_to_a_scope_is_declared() -> None:
    assert codes("<script>application.z = 5;</script>" + block('<log expr="z"/>')) == []


def test_spaces_around_words_mean_nothing() -> None:
    text = """<form><field name="f" modal=" true ">
      <grammar mode=" voice " version="1.0" root="r"><rule id="r">go</rule></grammar>
      <prompt count=" 1 " bargein=" true " timeout=" 2s ">Well?</prompt>
      <filled><goto next=" #b "/></filled></field></form>
      <form id="b"><block><log>there</log><exit/></block></form>"""
    assert codes(text) == []
    call = run(vxml(text), "go")
    assert call.logs() == ["there"]


def test_spaces_around_names_and_uris_mean_nothing() -> None:
    text = leaf(
        """<form><var name=" x " expr="n + 1"/><block><goto next="#b"/></block></form>
        <form id=" b "><transfer name=" t " dest=" tel:+1-555 " type="bridge"/>
        <block><log expr="t + n"/></block></form>""",
        root=" root.vxml ",
    )
    assert run(text, root=vxml('<var name="n" expr="1"/>')).logs() == ["noanswer1"]


@pytest.mark.parametrize("around", ["{}", "<prompt>{}</prompt>"])
def test_spaces_around_the_item_of_a_foreach_mean_nothing(around: str) -> None:
    each = '<foreach item=" i " array="[1]"><value expr="i"/></foreach>'
    assert said(around.format(each)) == ["1"]


def test_spaces_around_a_base_and_music_mean_nothing() -> None:
    head = HEAD.replace(">", ' xml:base=" sub/ ">')
    play = '<transfer dest="tel:+1-555" type="bridge" transferaudio=" s/ring.wav "/>'
    music = vxml(f"<form>{play}</form>")
    call = run(vxml(block('<goto next="b.vxml"/>'), head), **{"sub/b.vxml": music})
    assert call.said() == ["[ring.wav]"]


def test_a_call_with_music_can_be_ended_by_the_caller(tmp_path: Path) -> None:
    (tmp_path / "a.vxml").write_text(
        vxml(
            """<form><transfer name="t" type="bridge" dest="tel:+1-555" transferaudio="ring.wav">
            <grammar version="1.0" root="r"><rule id="r">stop</rule></grammar>
            <filled><log expr="t"/><exit/></filled></transfer></form>"""
        )
    )
    (tmp_path / "s.xml").write_text(
        f"""<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" until="60s"
          world="{DOCUMENTS}/worlds/room.xml" robot="{DOCUMENTS}/robots/papero.xml">
        <person x="1" y="0"/><application src="a.vxml"/><transfer to="tel:" after="4s" lasts="50s"/>
        <when at="30s"><say>stop</say></when></scenario>"""
    )
    done = prima("run", "s.xml", cwd=tmp_path)
    assert "log: near_end_disconnect" in done.stdout, done.stdout + done.stderr


CONTOURS = ("", "high", "(0%)", "(0%+20Hz)", "(0,+20Hz)", "(0%,loud)", "(0%,+20Hz", "0%,+20Hz")


@pytest.mark.parametrize(
    ("content", "wrong"),
    [
        ('<prosody pitch="foo" volume="101" range="?">a</prosody>', ["pitch", "range", "volume"]),
        ('<prosody pitch="+5%" volume="+6dB" range="120Hz">a</prosody>', []),
        ('<prosody pitch="-2st" volume="100" range="x-low">a</prosody>', []),
        ('<prosody contour="(0%,+20Hz) ( 10% , high )(.5%,120Hz)">a</prosody>', []),
        *((f'<prosody contour="{one}">a</prosody>', ["contour"]) for one in CONTOURS),
        ('<phoneme ph="x" alphabet="ipa">a</phoneme>', []),
        ('<phoneme ph="x" alphabet="x-sampa">a</phoneme>', []),
        ('<phoneme ph="x">a</phoneme>', []),
        ('<phoneme ph="x" alphabet="IPA">a</phoneme>', ["alphabet"]),
        ('<phoneme ph="x" alphabet="sampa">a</phoneme>', ["alphabet"]),
        ('<voice age="x" variant="0">a</voice>', ["age", "variant"]),
        ('<voice age="0" variant="1" gender="female">a</voice>', []),
        ('<prosody pitch=" high " range=" +5% " volume=" loud ">a</prosody>', []),
        ('<voice age=" 0 " variant=" 1 "><phoneme ph="x" alphabet=" ipa ">a</phoneme></voice>', []),
        ("<voice>a</voice>", ["<voice>"]),
        ("<prosody>a</prosody>", ["<prosody>"]),
        ('<voice xml:lang="en">a</voice>', []),
    ],
)
def test_speech_that_no_voice_can_make_is_told(content: str, wrong: list[str]) -> None:
    """SSML 1.0, 3.1.9, 3.2.1 and 3.2.4: it is said all the same."""
    text = block(f"<prompt>{content}</prompt>")
    told = [one.message.split()[0] for one in warnings(text)]
    assert told == wrong
    assert run(text).said() == ["a"]


@pytest.mark.parametrize(
    "wrong",
    [
        "contour='({}x)'",
        "pitch='{}x'",
        "range='+{}x'",
        "volume='+{}x'",
        "pitch='١Hz'",
        "volume='١'",
        "volume='+١'",
    ],
)
def test_a_number_that_is_none_is_told_however_long_it_is(wrong: str) -> None:
    began = process_time()
    (one,) = warnings(block(f"<prompt><prosody {wrong.format('1' * 20_000)}>a</prosody></prompt>"))
    assert one.code == "bad-value" and process_time() - began < 2, "10 ms on a quiet machine"


def test_identifiers_and_ages_that_are_none_are_told() -> None:
    text = '<form id="a b"><block><goto next="#c" maxage="-1" maxstale="x"/></block></form><menu id="1c"/>'
    told = [one.message for one in warnings(text) if "no dialog" not in one.message]
    assert [one.partition(" is")[0] for one in told] == [
        'id "a b"',
        'maxage "-1"',
        'maxstale "x"',
        'id "1c"',
    ]
