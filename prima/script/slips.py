"""Slips in code: names meant as texts or as values of other languages, signs of other languages."""

from __future__ import annotations

import re

from prima.errors import Hint, Span, replaced
from prima.markup.hints import half

ELSEWHERE = {
    **dict.fromkeys(("True", "TRUE"), "true"),
    **dict.fromkeys(("False", "FALSE"), "false"),
    **dict.fromkeys(("None", "Null", "NULL", "nil"), "null"),
}
"""Values as other languages write them, with those of ECMAScript."""


def value_elsewhere(name: str, *spans: Span) -> Hint:
    """ECMAScript's value for a name by which another language writes it; nothing for others."""
    right = ELSEWHERE.get(name, "")
    return replaced(f"Write {right}.", right, *spans) if right else Hint()


def is_bare(code: str, name: str, start: int) -> bool:
    """Whether a name is all of some code, or compared, and may have been meant as a text."""
    if name in ELSEWHERE:
        return False
    return code.strip() == name or code[:start].rstrip().endswith(("==", "!="))


def or_text(hint: Hint, name: str) -> Hint:
    """The same hint, and how to write a name as a text."""
    return hint._replace(text=f"{hint.text} For the text itself write '{name}'.".lstrip())


STRINGS = re.compile(r"""(["'])(?:\\[\s\S]|(?!\1)[^\\])*(?:\1|(\\?\Z))""")
"""Strings, the last of which may lack its end; no character is read twice."""
MISTAKES = (
    (r"\A[^`]*\$\{", "Write the expression alone, without ${{ and }}."),
    (r"=\s+=", "Write == without a space."),
    (r"<>", "Write != for &lt;&gt;."),
    (r"\b(?:is not|IS NOT|ne|NE)\b", "Write != for {0}."),
    (r"\b(?:eq|EQ|is|IS|equals)\b", "Write == for {0}."),
    (r"\b(?:and|AND)\b", "Write &amp;&amp; for {0}."),
    (r"\b(?:or|OR)\b", "Write || for {0}."),
    (r"\b(?:not|NOT)\b", "Write ! for {0}."),
)
"""Common mistakes, with remedies."""
REMEDIES = (
    (r'its "(\W+)" is not closed', "Close the {0}."),
    (r'its "(\W+)" closes nothing', "Remove the {0}."),
    ("ends too early", "Complete it, or remove its last sign."),
    (r"identifier '(\w+)'", "Write an operator before {0}, or put a text into quotes."),
    ("end of string", "Write the text's quote also at its end."),
    ("end of comment", "Write */ at the end of the comment."),
    ("number literal", "A name does not begin with a digit."),
    ("Unexpected number", "Write an operator before the number; an element of a list is list[0]."),
    ("field name", "Write a name after the dot."),
    ("expecting ';'", "Write a ; between two statements of one line."),
    ("variable name expected", "Write a name after the keyword."),
    ("function name expected", "Give the function a name."),
    ("missing initializer", "Give it a value, or write let."),
    (r"nexpected token .*?'(.+)'", "Write what belongs before the {0}, or remove it."),
)
"""What to do about the engine's own messages."""
STATEMENT = re.compile(r"\s*(?:const|for|if|let|return|var|while)\b")
"""How code begins that is no expression."""
WORDS = re.compile(r"\s*(\w+(?:[ .,!?-]+\w+)*[.,!?]*)\s*", re.ASCII)
"""Words alone, most likely a text without its quotes."""
TARGET = re.compile(r"\s*#[\w.-]{1,60}\s*")
"""A target without the quotes of a text."""
LONGEST_TEXT = 60
"""Characters of code above which it is not guessed to be a text."""
QUOTES = re.compile("[“”„‟‘’‚‛]")
"""Typographic quotes."""


def code_remedy(code: str, error: object, *, statements: bool = False, text: bool = True) -> str:
    """The remedy for code that does not compile.

    Args:
        code: The code.
        error: What is wrong with it.
        statements: Whether it may hold statements, as a script does.
        text: Whether it may have been meant as a text.
    """
    bare = STRINGS.sub(lambda found: "" if found[2] is None else found[1], code)
    if QUOTES.search(bare):
        return "This is a typographic quote: write '."
    if wide := _of_full_width(bare):
        return f"Write it in characters of half width: {wide}."
    remedy = "" if statements else _as_expression(bare)
    remedy = remedy or _of_table(MISTAKES, bare) or _of_table(REMEDIES, str(error))
    words = WORDS.fullmatch(code) if text and len(code) <= LONGEST_TEXT else None
    return or_text(Hint(remedy), words[1]).text if words else remedy


def _of_table(table: tuple[tuple[str, str], ...], text: str) -> str:
    """The remedy whose pattern is in a text, or nothing; ``{0}`` is the pattern's last group."""
    for pattern, remedy in table:
        if found := re.search(pattern, text):
            return remedy.format(found[found.lastindex or 0])
    return ""


def _as_expression(bare: str) -> str:
    """The remedy for statements in place of an expression, whose complete strings are left out."""
    if STATEMENT.match(bare):
        return "Write an expression; statements belong in a <script>."
    if bare.rstrip().endswith(";"):
        return "Write the expression without the semicolon."
    if bare.lstrip().startswith("{"):
        return "Write the expression alone, without { and }."
    if TARGET.fullmatch(bare):
        return f"A target is a text, with quotes of its own: '{bare.strip()}'."
    if "'" in bare and not bare.startswith("'"):
        return "Write \\' for a ' inside a text."
    return ""


def _of_full_width(code: str) -> str:
    """The first few full-width characters of code, as they should be."""
    if code.isascii():
        return ""
    wide = [half(one) for one in code if not one.isascii()]
    return " ".join([one for one in wide if one.isascii() and one.strip()][:5])
