"""Scripts as code of their scope: what they declare at the top are its variables.

A script and ``<var>`` declare variables of one space (VoiceXML 2.0, 5.1), which whatever is
evaluated later reads and writes. Code can only be run inside of a function here, and what a
function declares is its own. So a ``var`` at the top is run as an assignment to a variable that
the scope has already, and a ``function`` there under another name, from which the scope gets it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from prima.names import DECLARES, HEADED, PAIRS, Reader

HIDDEN = "$_"
"""What is added to the name of a function at the top."""
CONTINUES = frozenset("([`+-/*.")
"""How a line may begin that goes on with an expression of the line before."""
ENDS = frozenset(["", ";", "}"])
STATEMENTS = HEADED | {"switch", "catch"}
"""What has a head in brackets, and a block behind it."""
BLOCKS = frozenset(["{", ")", "else", ":"])
"""Behind what a function may be declared in a block."""
CLOSING = frozenset(PAIRS.values())


@dataclass(slots=True)
class Hoisted:
    """A script that declares nothing of its scope by itself."""

    code: str
    variables: list[str] = field(default_factory=list)
    """Names that are to be there before it runs: of ``var`` and ``function``."""
    functions: list[str] = field(default_factory=list)
    """Those of them that are given to the scope first, from their name with :data:`HIDDEN`."""
    others: list[str] = field(default_factory=list)
    """What it declares in other ways, to be given to the scope when it has run."""
    shifts: list[tuple[int, int]] = field(default_factory=list)
    """Lines, and the columns in them behind which its text stands further right than written."""

    def column(self, line: int, column: int) -> int:
        """Where that place stands in the script as it is written."""
        for at, start in self.shifts:
            column -= len(HIDDEN) if at == line and start < column else 0
        return column


def hoisted(code: str) -> Hoisted | None:
    """Take a script's declarations out of it; None where its text cannot be seen through."""
    return _Hoister(code).hoist() if DECLARES.search(code) else Hoisted(code)


class _Hoister(Reader):
    """Finds what is declared outside of functions."""

    def __init__(self, code: str) -> None:
        super().__init__(code)
        self.script = Hoisted(code)
        self.edits: list[tuple[int, int, str]] = []
        """From where to where which text is put."""
        self.shares = not {"function", "=>", "class"}.isdisjoint(self.texts)
        self.depth = 0
        """In how many brackets the piece stands that is looked at."""

    def hoist(self) -> Hoisted | None:
        """See :func:`hoisted`."""
        script, index = self.script, 0
        brackets = sum(text in PAIRS or text in CLOSING for text in self.texts)
        if len(self.ends) != brackets:
            return None
        while index < len(self.tokens):
            text = self.texts[index]
            self.depth += (text in PAIRS) - (text in CLOSING)
            if text in ("var", "let", "const") and self._text(index - 1) != ".":
                self._declared(index)
            elif text in ("function", "class") and self._is_keyword(index):
                self._named(index)
            index = self._next(index)
        script.variables = [*dict.fromkeys([*script.variables, *script.functions])]
        script.others = [*dict.fromkeys(script.others)]
        hidden = {f"{name}{HIDDEN}" for name in script.functions}
        if not hidden.isdisjoint(self.texts) or not {*script.variables}.isdisjoint(script.others):
            return None  # a name stands for two things
        pieces, at = [], 0
        for start, end, text in sorted(self.edits):
            pieces += [self.code[at:start], text]
            at = end
        script.code = "".join([*pieces, self.code[at:]])
        return script

    def _declared(self, index: int) -> None:
        """Variables are declared; those of ``var`` belong to the scope whatever they stand in.

        At the top ``let`` and ``const`` do where functions may share them; a function's own
        variables are quicker, and they are given to the scope at the end.
        """
        kind, names = self.texts[index], sorted(self._declaration(index + 1))
        ours = kind == "var" or self.depth == 0
        moves = kind == "var" or (ours and self.shares)
        if moves and names and self._text(index + 1) not in PAIRS:
            start = self.tokens[index].start
            self.edits += [(start, start + len(kind), " " * len(kind)), *self._closed(index + 1)]
            self.script.variables += names
        elif ours:
            self.script.others += names

    def _named(self, index: int) -> None:
        """A function or a class begins, which is declared if it has a name and is no operand."""
        at = index + 1 + (self._text(index + 1) == "*")
        name = self._text(at)
        if not self._is_name(name):
            return
        before = self._text(index - 1 - (self._text(index - 1) == "async"))
        headed = before == ")" and self._text(self.ends.get(index - 1, 0) - 1) in HEADED
        alone = before in ENDS or (self._begins_line(index) and not headed)
        function = self.texts[index] == "function"
        if alone and function and self.depth == 0:
            end = self.tokens[at].start + len(name)
            self.edits.append((end, end, HIDDEN))
            self.script.functions.append(name)
            self.script.shifts.append(self._place(end))
        elif (alone and self.depth == 0) or (function and (alone or before in BLOCKS)):
            self.script.others.append(name)

    def _next(self, index: int) -> int:
        """Where to look next: behind the body of a function that begins here."""
        text = self.texts[index]
        if text in ("function", "class") and self._is_keyword(index):
            at = self._function_end(index) if text == "function" else self._class_body(index)
            return max(at, index) + 1
        if text == "=>" and self._text(index + 1) == "{":
            return self.ends.get(index + 1, index) + 1
        if self._is_method(index) and self._may_be_method(index):
            return self.ends.get(self.ends[index + 1] + 1, index) + 1
        return index + 1

    def _class_body(self, index: int) -> int:
        """Where the body of a class ends."""
        at = index + 1
        while at < len(self.tokens) and self.texts[at] != "{":
            at = self.ends.get(at, at) + 1
        return self.ends.get(at, index)

    def _may_be_method(self, index: int) -> bool:
        """Whether what stands before ``( ... ) {`` is a method's name, not the head of a statement."""
        text = self.texts[index]
        if text == "function" or text in PAIRS or text in (")", "}"):
            return False
        return text not in STATEMENTS or self._text(index - 1) == ","

    def _closed(self, index: int) -> list[tuple[int, int, str]]:
        """What ends declarators without a value where the next line would go on with them."""
        made = []
        at, name = index, True
        while at < len(self.tokens) and self.texts[at] not in (";", ")", "}", "]"):
            after = self._text(at + 1)
            if name and after[:1] in CONTINUES and self.tokens[at + 1].fresh:
                end = self.tokens[at].start + len(self.texts[at])
                made.append((end, end, ";"))
                break
            if at > index and self._next_statement(at):
                break
            at = self.ends.get(at, at) + 1
            name = self._text(at - 1) == ","
        return made

    def _place(self, offset: int) -> tuple[int, int]:
        line = self.code.count("\n", 0, offset)
        return line + 1, offset - self.code.rfind("\n", 0, offset) - 1
