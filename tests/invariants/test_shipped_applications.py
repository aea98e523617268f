"""Shipped applications in pairs and threes, with physics and whatever may happen around them."""

from __future__ import annotations

import tempfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

from hypothesis import given, settings
from hypothesis import strategies as st

from prima import api
from prima.invariants import callers, check
from tests import ROOT

DOCUMENTS = ROOT / "documents"
ROBOT = DOCUMENTS / "robots" / "papero-plus.xml"
APPLICATIONS = {
    path.stem: path
    for folder in ("fa", "ea", "rules", "tutorial")
    for path in sorted((DOCUMENTS / folder).iterdir())
    if path.suffix == ".vxml" or b"<prima" in path.read_bytes()
}
PLACES = {"office": "entrance", "museum": "entrance", "library": "entrance", "home": "hall"}
USERS = ("", "patient", "hasty", "silent", "chatty")
SAID = ("Yes.", "No.", "Never mind.", "Stop.", "follow me", "coffee", "history", "please dance")
DEVICES = ("speaker", "locomotion", "neck", "human-detection", "speech-recognition")
TRIGGERS = ("speak", "topological-move", "q-and-a", "tracking-human", "face-human", "gesture")


def element(tag: str, **attributes: object) -> str:
    given = "".join(f" {name}={quoteattr(str(value))}" for name, value in attributes.items())
    return f"<{tag}{given}/>"


def of(*values: object) -> st.SearchStrategy[object]:
    return st.sampled_from(values)


HAPPENINGS = st.one_of(
    st.builds(lambda it: element("touch", sensor=it), of("head", "back")),
    st.builds(lambda it: f"<say>{it}</say>", of(*SAID)),
    st.builds(lambda x, y: element("walk", x=x, y=y), st.integers(-2, 8), st.integers(-3, 3)),
    of(*map(element, ("follow", "stay", "leave", "emergency"))),
    st.builds(lambda it: element("release", resume=it), of("true", "false")),
    st.builds(lambda it: element("event", name=it), of("corner.kidode", "button", "message.mail")),
    st.builds(lambda it: element("sensor", name="light", value=it), of(0, 20, 100)),
    st.builds(
        lambda it, so: element("fail", device=it, hangs=so), of(*DEVICES), of("true", "false")
    ),
    st.builds(lambda it: element("repair", device=it), of(*DEVICES)),
)


@st.composite
def whens(draw: st.DrawFn, names: list[str]) -> str:
    """Something that happens, perhaps that an application goes, and perhaps comes again."""
    time, tag = draw(st.integers(0, 40_000)), draw(of("at", "doing", "done"))
    when: dict[str, object] = {"at": f"{time}ms"}
    if tag != "at":
        when = {str(tag): draw(of(*TRIGGERS)), "after": "200ms"}
    what = draw(HAPPENINGS)
    if draw(st.integers(0, 9)) == 0:
        name = draw(st.sampled_from(names))
        what = element("unload", application=name)
        if draw(st.booleans()):
            what += '<wait for="3s"/>' + element("load", application=name)
    head = element("when", **when).removesuffix("/>")
    return f"{head}>{what}</when>"


@st.composite
def scenarios(draw: st.DrawFn) -> str:
    names = draw(st.lists(st.sampled_from([*APPLICATIONS]), min_size=1, max_size=3, unique=True))
    kinds = {name: APPLICATIONS[name] for name in names}
    world = draw(st.sampled_from([*PLACES]))
    extensions = draw(st.sets(st.integers(1, 10), max_size=6))
    policy = draw(of("prima", "prima", "prima", "fifo", "fair"))
    if policy == "prima":
        policy += "".join(f"+x{number}" for number in sorted(extensions))
    user = draw(st.sampled_from(USERS))
    mind = {"user": DOCUMENTS / "users" / f"{user}.xml"} if user else {}
    inside = [
        element("robot", at=PLACES[world]),
        element("person", x=0.9, y=0.5, **mind),
        *(
            element("application", src=path, kind="fa" if path.parent.name == "fa" else "ea")
            for path in kinds.values()
        ),
        *draw(st.lists(whens(names), max_size=8)),
    ]
    head = element(
        "scenario", xmlns="urn:prima:scenario:1", version="1.0", id="s", policy=policy,
        until="90s", world=DOCUMENTS / "worlds" / f"{world}.xml", robot=ROBOT,
    )  # fmt: skip
    return f"{head.removesuffix('/>')}>{''.join(inside)}</scenario>"


@given(scenarios())
@settings(max_examples=100)
def test_whatever_happens_the_rules_hold(text: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "s.xml")
        path.write_text(text, encoding="utf-8")
        loaded = api.load_scenario(path)
        made = api.rehearse(loaded)
    assert made.defects == []
    cast = loaded.cast
    assert check(made.records, cast.scenario.policy, calling=callers(cast.documents)) == []
