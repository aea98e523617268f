"""Runs scripts as code of their scope, whose variables are their top-level declarations.

A script and ``<var>`` declare variables in one space (VoiceXML 2.0, 5.1), which all later code
reads and writes. Here, code can only run inside a function, whose declarations are local. So a
top-level ``var`` or ``class`` is run as an assignment to an existing variable of the scope, and a
top-level ``function`` under another name, from which the scope gets it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from prima.script.names import bound_names
from prima.script.parse import Code, Node, parse_script, spliced
from prima.script.walk import FUNCTIONS

HIDDEN = "$_"
"""Appended to the name of a top-level function."""
DECLARED_FUNCTIONS = ("function_declaration", "generator_function_declaration")
CLASSES = ("class_declaration", "class")
CALLS = ("call_expression", "new_expression")
WORDS = ("var", "let", "const", "function", "class")


@dataclass(slots=True)
class Hoisted:
    """A script without declarations of its scope."""

    code: str
    variables: list[str] = field(default_factory=list)
    """Names of ``var`` and ``function`` that must exist before it runs."""
    functions: list[str] = field(default_factory=list)
    """Those that the scope gets first, from their names with :data:`HIDDEN`."""
    others: list[str] = field(default_factory=list)
    """Other declarations, to be copied to the scope after it has run."""
    shifts: list[tuple[int, int, int]] = field(default_factory=list)
    """Lines, the columns in them after which the text is shifted to the right, and how far."""

    def column(self, line: int, column: int) -> int:
        """The column in the script as it is written."""
        for at, start, width in self.shifts:
            column -= width if at == line and start < column else 0
        return column


def hoisted(code: str) -> Hoisted | None:
    """Move a script's declarations out of it; None if its text cannot be analysed."""
    if not any(word in code for word in WORDS):
        return Hoisted(code)
    parsed = parse_script(code)
    if parsed is None or not parsed.sound:
        return None
    return _Hoister(parsed).hoist()


class _Hoister:
    """Finds declarations outside of functions."""

    def __init__(self, code: Code) -> None:
        self.code = code
        self.script = Hoisted(code.text)
        self.edits: list[tuple[int, int, str]] = []
        """Edits: start, end and new text."""
        nodes = list(code.walk())
        sharing = FUNCTIONS.union(CLASSES, CALLS)
        self.shares = any(node.type in sharing for node in nodes)
        """Whether functions may see its declarations: its own, or earlier ones that it calls."""
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
            return None  # a name has two meanings
        script.code = spliced(self.code.text, sorted(self.edits))
        return script

    def _outside(self) -> Iterator[Node]:
        """The nodes outside of functions and classes, in the order of the text."""
        waiting = [self.code.root]
        while waiting:
            node = waiting.pop()
            yield node
            if node.type not in FUNCTIONS and node.type not in CLASSES:
                waiting += reversed(node.named_children)

    def _declaration(self, node: Node) -> None:
        """Handle a declaration; variables of ``var`` always belong to the scope.

        Top-level ``let`` and ``const`` do if functions may share them; otherwise they stay local,
        which is faster, and are copied to the scope at the end.
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
        # A pattern would be a block at the beginning of a statement, or continue the line before.
        pattern = first is not None and first.type != "identifier"
        self._move(node.children[0], names, "0," if pattern else "")
        last = node.children[-1]
        if last.type != ";" or last.is_missing:
            end = self.code.end(node)
            self.edits.append((end, end, ";"))  # the next line might continue it now

    def _loop(self, node: Node) -> None:
        """``for (var x in y)``."""
        kind, left = node.child_by_field_name("kind"), node.child_by_field_name("left")
        if kind is not None and kind.type == "var" and left is not None:
            self._move(kind, bound_names(self.code, left))

    def _move(self, word: Node, names: list[str], instead: str = "") -> None:
        """Turn declarations into assignments, which begin with something instead of the word."""
        start, end = self.code.start(word), self.code.end(word)
        self.edits.append((start, end, instead.ljust(end - start)))
        self.script.variables += names

    def _named(self, node: Node) -> None:
        """Handle the declaration of a function or class."""
        name = node.child_by_field_name("name")
        if name is None:
            return
        top, text = node.parent == self.code.root, self.code.name(name)
        if top and node.type in DECLARED_FUNCTIONS:
            self._insert(self.code.end(name), HIDDEN)
            self.script.functions.append(text)
        elif top:  # a class, which becomes the value of a variable
            self._insert(self.code.start(node), f"{text}=")
            self._insert(self.code.end(node), ";")
            self.script.variables.append(text)
        elif node.type in DECLARED_FUNCTIONS:
            self.script.others.append(text)

    def _insert(self, offset: int, text: str) -> None:
        """Insert text that shifts what follows in its line."""
        before = self.code.text[:offset]
        line, column = before.count("\n") + 1, offset - before.rfind("\n") - 1
        self.edits.append((offset, offset, text))
        self.script.shifts.append((line, column, len(text)))


def in_turn(codes: list[str]) -> list[str]:
    """Scripts for one function, each of which declares its functions when its turn comes.

    As ECMAScript hoists declarations, earlier ones would see them, and their variables of the same
    names would count for later ones.
    """
    if len(codes) < 2:
        return codes
    made = {code: _assigned(code) if "function" in code else code for code in codes}
    return [made[code] for code in codes]


def _assigned(code: str) -> str:
    """A script that begins with its top-level functions, assigned to variables."""
    parsed = parse_script(code)
    if parsed is None or not parsed.sound:
        return code
    found = {
        parsed.start(node): (parsed.end(node), parsed.name(name))
        for node in parsed.root.children
        if node.type in DECLARED_FUNCTIONS and (name := node.child_by_field_name("name"))
    }
    first = "".join(f"var {name} = {code[start:end]};" for start, (end, name) in found.items())
    return first + spliced(code, ((start, end, ";") for start, (end, _) in found.items()))
