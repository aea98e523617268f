"""The root element of a file, found without parsing it."""

from __future__ import annotations

from time import perf_counter

import pytest

from prima.markup.sniff import root_of


@pytest.mark.parametrize(
    ("text", "root"),
    [
        ("<a/>", "<a/>"),
        (" \n\t<a>", "<a>"),
        ('<?xml version="1.0"?><!-- <b> --> <?do <c> ?>\n<a>', "<a>"),
        ("<!DOCTYPE a><a>", "<a>"),
        ('<!DOCTYPE a PUBLIC ">" "x[y]"> <a>', "<a>"),
        ('<!DOCTYPE a [<!ENTITY b "<c>">] ><a>', "<a>"),
        ("#ABNF 1.0;", "#ABNF 1.0;"),
        ("<!-- no end", "<!-- no end"),
        ("<!--> <a>", "<!--> <a>"),
        ("<?> <a>", "<?> <a>"),
        ("<!DOCTYPE a", "<!DOCTYPE a"),
        ("", ""),
        ("  ", ""),
    ],
)
def test_a_root_element_begins_after_the_prolog(text: str, root: str) -> None:
    for data in (text.encode(), b"\xef\xbb\xbf" + text.encode(), text.encode("utf-16")):
        assert root_of(data) == root.encode()


@pytest.mark.parametrize("piece", [" ", "<!---->", "<??>", "<!DOCTYPE a>", "<!DOCTYPE '", "<!--"])
def test_a_long_prolog_takes_its_time_once(piece: str) -> None:
    data = piece.encode() * (2_000_000 // len(piece)) + b"<a>"
    began = perf_counter()
    root_of(data)
    assert perf_counter() - began < 20  # a time that grows with its square would be hours
