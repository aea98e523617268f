"""The building blocks of all pages: escaped text and data, styles and scripts with their hashes."""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Iterable
from html import escape
from importlib.resources import files
from typing import Any

from prima.errors.visible import visible
from prima.messages import Json
from prima.transcript import colours


def text(what: str) -> str:
    """Text that cannot be taken for markup."""
    return escape(visible(what))


def described(pairs: Iterable[tuple[str, str]]) -> str:
    """The content of a list of descriptions: names and texts."""
    return "".join(f"<div><dt>{text(a)}</dt><dd>{text(b)}</dd></div>" for a, b in pairs)


def json_text(data: Json | dict[str, Any]) -> str:
    """JSON that is safe in a script element: nothing in it ends or opens one."""
    made = json.dumps(_seen(data), ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    for letter in "<>&\u2028\u2029":
        made = made.replace(letter, f"\\u{ord(letter):04x}")
    return made


def _seen(data: Any) -> Any:
    """Data in which every text may be shown."""
    if isinstance(data, str):
        return visible(data, "\n")
    if isinstance(data, dict):
        return {visible(key): _seen(value) for key, value in data.items()}
    return [_seen(one) for one in data] if isinstance(data, list | tuple) else data


def part(room: str, name: str) -> str:
    """A file of a package."""
    return (files(room) / name).read_text(encoding="utf-8")


def style_of(room: str, name: str) -> str:
    """A page's style: the one shared by all pages, then its own, with the colours filled in."""
    style = part("prima.report", "base.css") + part(room, name)
    for name, dark in (("light", False), ("dark", True)):
        made = "".join(
            f"--fill{index}: {colours.fill(index, dark)}; --line{index}: {colours.stroke(index, dark)}; "
            for index in range(len(colours.PALETTE))
        )
        style = style.replace(f"/* applications: {name} */", made.strip())
    classes = "".join(
        f".fill{n} {{ fill: var(--fill{n}); stroke: var(--line{n}); }} .line{n} {{ stroke: var(--line{n}); }}"
        f" .app.app{n} {{ border-color: var(--line{n}); }}\n"
        for n in range(len(colours.PALETTE))
    )
    return style.replace("/* applications */", classes.strip())


def policy_of(style: str, script: str) -> str:
    """The content security policy of a page with only this style and this script."""
    return (
        "default-src 'none'; base-uri 'none'; form-action 'none';"
        f" style-src '{_hash(style)}'; script-src '{_hash(script)}'"
    )


def _hash(content: str) -> str:
    """A source of the page itself, as named in a content security policy."""
    return "sha256-" + base64.b64encode(hashlib.sha256(content.encode()).digest()).decode()
