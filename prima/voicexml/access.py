"""Who may read data: the ``access-control`` instructions of a document (VoiceXML 2.1, 5)."""

from __future__ import annotations

import re
from typing import Any
from urllib.parse import urlsplit

from prima.voicexml.document import Page
from prima.voicexml.dom import INSTRUCTION

RULES = re.compile(r"""\b(allow|deny)\s*=\s*("[^"]*"|'[^']*')""")
FOLDER = "localhost"
"""The host of documents in a folder that is not mapped to a URI."""


def host_of_page(page: Page) -> str:
    """The host that a document was fetched from, in small letters."""
    uri = page.site.whole(page.uri) if page.site is not None else page.uri
    return (urlsplit(uri).hostname or FOLDER).lower()


def may_read(data: list[dict[str, Any]], host: str) -> bool:
    """Whether documents of a host may read data, given as its nodes.

    Without an instruction every host may. With one, the longest name that matches the host decides;
    between equal ones ``deny`` wins. A host that no name matches may not.
    """
    rule = (INSTRUCTION, "access-control")
    said = [one["value"] for one in data if (one["type"], one.get("name")) == rule]
    rules = [
        (len(name.lstrip("*.")), verdict)
        for text in said
        for verdict, names in RULES.findall(text)
        for name in names[1:-1].lower().split()
        if _fits(name, host)
    ]
    return not said or max(rules, default=(0, "deny"))[1] == "allow"


def _fits(name: str, host: str) -> bool:
    if name.startswith("*."):
        return host.endswith(name[1:])
    return name in ("*", host)
