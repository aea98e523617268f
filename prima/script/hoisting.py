"""Scripts as code of their scope: what they declare at the top are its variables.

A script and ``<var>`` declare variables of one space (VoiceXML 2.0, 5.1), which whatever is
evaluated later reads and writes. Code can only be run inside of a function here, and what a
function declares is its own. So a ``var`` at the top is run as an assignment to a variable that
the scope has already, and a ``function`` there under another name, from which the scope gets it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from prima.script.names import bound_names
from prima.script.parse import Code, Node, parse_script
from prima.script.walk import FUNCTIONS

HIDDEN = "$_"
"""What is added to the name of a function at the top."""
DECLARED_FUNCTIONS = ("function_declaration", "generator_function_declaration")
CLASSES = ("class_declaration", "class")
WORDS = ("var", "let", "const", "function", "class")


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
    """Lines, and the columns in them behind which the text is shifted to the right."""

    def column(self, line: int, column: int) -> int:
        """The column in the script as it is written."""
        for at, start in self.shifts:
            column -= len(HIDDEN) if at == line and start < column else 0
        return column


def hoisted(code: str) -> Hoisted | None:
    """Take a script's declarations out of it; None where its text cannot be seen through."""
    if not any(word in code for word in WORDS):
        return Hoisted(code)
    parsed = parse_script(code)
    if parsed is None or not parsed.sound:
        return None
    return _Hoister(parsed).hoist()


class _Hoister:
    """Finds what is declared outside of functions."""

    def __init__(self, code: Code) -> None:
        self.code = code
        self.script = Hoisted(code.text)
        self.edits: list[tuple[int, int, str]] = []
        """From where to where which text is put."""
        nodes = list(code.walk())
        self.shares = any(node.type in FUNCTIONS or node.type in CLASSES for node in nodes)
        self.names = {code.of(node) for node in nodes if node.type == "identifier"}

    def hoist(self) -> Hoisted | None:
        """See :func:`hoisted`."""
        script = self.script
        for node in self._outside():
            if node.type == "for_in_statement":
                self._loop(node)
            elif node.type in ("variable_declaration", "lexical_declaration"):
                self._declaration(node)
            elif node.type in DECLARED_FUNCTIONS or node.type == "class_declaration":
                self._named(node)
        script.variables = [*dict.fromkeys([*script.variables, *script.functions])]
        script.others = [*dict.fromkeys(script.others)]
        hidden = {f"{name}{HIDDEN}" for name in script.functions}
        if not (hidden.isdisjoint(self.names) and {*script.variables}.isdisjoint(script.others)):
            return None  # a name means two things
        script.code = self._edited()
        return script

    def _outside(self) -> Iterator[Node]:
        """The nodes that are in no function and no class, in the order of the text."""
        waiting = [self.code.root]
        while waiting:
            node = waiting.pop()
            yield node
            if node.type not in FUNCTIONS and node.type not in CLASSES:
                waiting += reversed(node.named_children)

    def _edited(self) -> str:
        pieces, at, text = [], 0, self.code.text
        for start, end, put in sorted(self.edits):
            pieces += [text[at:start], put]
            at = end
        return "".join([*pieces, text[at:]])

    def _declaration(self, node: Node) -> None:
        """Variables are declared; those of ``var`` belong to the scope wherever they are.

        At the top ``let`` and ``const`` do where functions may share them; a function's own
        variables are quicker, and they are given to the scope at the end.
        """
        declarators = (one for one in node.named_children if one.type == "variable_declarator")
        first = next(declarators).child_by_field_name("name")
        names = bound_names(self.code, node)
        if node.type == "lexical_declaration":
            if node.parent != self.code.root:
                return
            if not self.shares:
                self.script.others += names
                return
        last = node.children[-1]
        open_ended = last.type != ";" or last.is_missing
        if self._move(node.children[0], first, names) and open_ended:
            end = self.code.end(node)
            self.edits.append((end, end, ";"))  # the next line might go on with it now

    def _loop(self, node: Node) -> None:
        """``for (var x in y)``."""
        kind, left = node.child_by_field_name("kind"), node.child_by_field_name("left")
        if kind is not None and kind.type == "var" and left is not None:
            self._move(kind, left, bound_names(self.code, left))

    def _move(self, word: Node, first: Node | None, names: list[str]) -> bool:
        """Make assignments of declarations, unless they begin with a pattern."""
        moves = first is not None and first.type == "identifier"
        if moves:
            start, end = self.code.start(word), self.code.end(word)
            self.edits.append((start, end, " " * (end - start)))
        (self.script.variables if moves else self.script.others).extend(names)
        return moves

    def _named(self, node: Node) -> None:
        """A function or class is declared."""
        name = node.child_by_field_name("name")
        if name is None:
            return
        top, text = node.parent == self.code.root, self.code.name(name)
        if top and node.type in DECLARED_FUNCTIONS:
            end = self.code.end(name)
            self.edits.append((end, end, HIDDEN))
            self.script.functions.append(text)
            self.script.shifts.append(self._place(end))
        elif top or node.type in DECLARED_FUNCTIONS:
            self.script.others.append(text)

    def _place(self, offset: int) -> tuple[int, int]:
        before = self.code.text[:offset]
        return before.count("\n") + 1, offset - before.rfind("\n") - 1
