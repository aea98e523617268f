"""Slips by which a document is not well-formed XML: each has a remedy that mends it."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api

RIGHT = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a">\n'
    '  <form id="f"><block><speak>Hi.</speak><exit/></block></form>\n'
    "</prima>\n"
)
DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>'


def problems(folder: Path, text: str) -> list[str]:
    path = folder / "a.xml"
    path.write_text(text, encoding="utf-8")
    return [f"{one.message} {one.remedy}" for one in api.validate([path])]


@pytest.mark.parametrize(
    ("old", "new", "remedy"),
    [
        ('<form id="f">', '< form id="f">', "Write <form without the space."),
        ("<block>", "< block>", "Write <block without the space."),
        ("<exit/>", "< exit />", "Write <exit without the space."),
        ("</form>", "< /form>", "Write </form without the space."),
        ("</form>", "</ form>", "A closing tag holds its name alone: </name>."),
        ("</form>", '</form id="f">', "A closing tag holds its name alone: </name>."),
        ("Hi.", "a < b", "Write &lt; for a < that begins no tag."),
        ("Hi.", "a < form b", "Write &lt; for a < that begins no tag."),
        ("Hi.", "a <? b", "or remove the <? and what follows it."),
        ("<exit/>", "<exit:/>", "Remove the colon:"),
        (DECLARATION, "<?xml version=1.0?>", f"is written wrongly. Write {DECLARATION}."),
        (DECLARATION, "<?xml version=“1.0”?>", f"is written wrongly. Write {DECLARATION}."),
        (DECLARATION, '<?xml version="1.0"encoding="UTF-8"?>', f"Write {DECLARATION}."),
        (DECLARATION, '<?xml version="1.0" encoding="UTF-8">', DECLARATION),
        (DECLARATION, '<?XML version="1.0"?>', DECLARATION),
    ],
)
def test_a_slip_of_xml_has_a_remedy(tmp_path: Path, old: str, new: str, remedy: str) -> None:
    found = problems(tmp_path, RIGHT.replace(old, new, 1))
    assert len(found) == 1 and remedy in found[0], found


@pytest.mark.parametrize(
    "first",
    [
        "<?xml version='1.0' ?>",
        '<?xml\n version = "1.0"\n standalone="yes"?>',
        '<?xml version="1.1" encoding="utf-8" standalone="no" ?>',
        '<?xml-stylesheet href="a.css"?>',
        '<!-- a --><?xml-stylesheet href="a.css"?>',
    ],
)
def test_what_may_come_first_is_accepted(tmp_path: Path, first: str) -> None:
    assert problems(tmp_path, RIGHT.replace(DECLARATION, first)) == []
