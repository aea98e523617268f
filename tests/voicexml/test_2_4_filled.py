"""The filled element: VoiceXML 2.0, 2.4."""

from __future__ import annotations

import pytest

from tests.helpers.dialogs import CITIES, Case, Cases

case = Cases()

case(
    "a form's filled runs when all input items are filled",
    "2.4",
    f"""<form><field name="a">{CITIES}</field><field name="b">{CITIES}</field>
    <filled><log expr="a + b"/></filled></form>""",
    "kyoto",
    "nara",
    logs=["KyotoNara"],
)
case(
    "with mode any it runs for each",
    "2.4",
    f"""<form><field name="a">{CITIES}</field><field name="b">{CITIES}</field>
    <filled mode="any"><log expr="a + (b || '')"/></filled></form>""",
    "kyoto",
    "nara",
    logs=["Kyoto", "KyotoNara"],
)
case(
    "a namelist says which items count",
    "2.4",
    f"""<form><field name="a">{CITIES}</field><field name="b">{CITIES}</field>
    <field name="c">{CITIES}</field>
    <filled namelist="a b"><log>all</log></filled>
    <filled mode="any" namelist="a c"><log>any</log></filled></form>""",
    "kyoto",
    "nara",
    "nara",
    logs=["any", "all", "any"],
)
case(
    "a filled of items that were filled before does not run again",
    "2.4",
    f"""<form><field name="a">{CITIES}</field><filled namelist="a"><log>a</log></filled>
    <field name="b">{CITIES}</field></form>""",
    "kyoto",
    "nara",
    logs=["a"],
)
case(
    "filled elements run in document order",
    "2.4",
    f"""<form><filled mode="any"><log>form</log></filled><field name="a">{CITIES}
    <filled><log>one</log></filled><filled><log>two</log></filled></field></form>""",
    "kyoto",
    logs=["form", "one", "two"],
)
case(
    "a filled that clears its field has it asked again",
    "2.4",
    f"""<form><field name="a"><prompt>Where?</prompt>{CITIES}<filled>
    <if cond="a == 'Nara'">No.<clear namelist="a"/></if></filled></field></form>""",
    "nara",
    "kyoto",
    said=["Where?", "No.", "Where?"],
    ended="exit",
)
case(
    "a filled does not run once one before has cleared its item",
    "C",
    f"""<form><field name="a">{CITIES}<filled><log>one</log>
    <if cond="a == 'Nara'"><clear namelist="a"/></if></filled><filled><log>two</log></filled></field>
    <filled mode="any" namelist="a"><log>any</log></filled></form>""",
    "nara",
    "kyoto",
    logs=["one", "one", "two", "any"],
)
case(
    "an item with a first value counts as filled for the others",
    "2.4",
    f"""<form><field name="a" expr="'x'">{CITIES}</field><field name="b">{CITIES}</field>
    <filled><log expr="a + b"/></filled></form>""",
    "nara",
    logs=["xNara"],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()
