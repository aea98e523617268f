"""The names that ECMAScript code declares, reads and gives values to, by its scopes.

Code is not run: what ``with`` and ``eval`` do cannot be told (:attr:`Names.opaque`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache

from prima.script.globals import GLOBALS, HANDLED
from prima.script.parse import Code, Node, parse_expression, parse_script

LONG_CODE = 500
"""Characters of code beyond which what is found in it is not kept, but of the last."""
DEEPEST = 200
"""Scopes inside each other; what is deeper counts as the same scope."""
SCOPES = frozenset(["application", "document", "dialog"])
"""Objects whose members are variables of that name (VoiceXML 2.0, 5.1.2)."""


@dataclass(slots=True)
class Use:
    """A variable's name in code."""

    name: str
    start: int
    """Its offset in the code."""
    holder: str = ""
    """The scope it is a member of: ``document`` in ``document.x``; empty where none is written."""
    declares: bool = False
    """Whether it is declared there; a scope's member is by being given a value."""
    parted: bool = False
    """Whether it is a scope's member whose own member is asked for: of undefined that is an error."""


@dataclass(slots=True)
class Names:
    """The names in a piece of code that mean anything outside of it, or at its top."""

    declared: set[str] = field(default_factory=set)
    """What is declared at the top, outside of functions and blocks."""
    read: dict[str, int] = field(default_factory=dict)
    """What is read and not declared in the code, with the first offset; ``typeof x`` reads nothing."""
    written: set[str] = field(default_factory=set)
    """What is given a value and not declared in the code: a new global variable."""
    changed: set[str] = field(default_factory=set)
    """What is given a value by its old one, and not declared in the code: ``x++``, ``x += 1``."""
    now: dict[str, int] = field(default_factory=dict)
    """What of that is read outside of functions, unless the code asks for its type as well."""
    uses: list[Use] = field(default_factory=list)
    """Where names of all these kinds stand, in the order of the text."""
    opaque: bool = False
    """Whether there is more to it than can be told: ``eval``, or code too long to be parsed."""

    @property
    def free(self) -> Mapping[str, int]:
        """What is read, not declared in the code, and not the engine's or the language's."""
        return {name: start for name, start in self.read.items() if name not in GLOBALS}

    @property
    def handled(self) -> dict[str, int]:
        """Variables of an event's handler that are read, and where first."""
        return {name: start for name, start in self.read.items() if name in HANDLED}


def expression_names(code: str) -> Names:
    """The names in an expression."""
    return _last(code, False) if len(code) > LONG_CODE else _kept(code, False)


def script_names(code: str) -> Names:
    """The names in a script."""
    return _last(code, True) if len(code) > LONG_CODE else _kept(code, True)


@lru_cache(maxsize=10_000)
def _kept(code: str, script: bool) -> Names:
    return _names(code, script)


@lru_cache(maxsize=2)
def _last(code: str, script: bool) -> Names:
    return _names(code, script)


def bound_names(code: Code, target: Node) -> list[str]:
    """The names that a declaration or a pattern declares, in the order of the text."""
    walk = _Walk(code)
    if target.type.endswith("_declaration"):
        walk.declaration(target, walk.top)
    else:
        walk.bind(target, walk.top)
    found = sorted((start, name) for start, name, how, _ in walk.found if how == "declare")
    return [name for _, name in found]


def _names(code: str, script: bool) -> Names:
    parsed = (parse_script if script else parse_expression)(code)
    return Names(opaque=True) if parsed is None else _Walk(parsed).names()


class _Scope:
    """The names that a function or block declares."""

    __slots__ = ("depth", "function", "hides", "names", "outer")

    def __init__(
        self, outer: _Scope | None, *, function: bool = False, hides: bool = False
    ) -> None:
        self.outer = outer
        self.depth: int = outer.depth + 1 if outer else 0
        self.names: set[str] = set()
        self.function: _Scope = self if function or outer is None else outer.function
        """Where ``var`` declares."""
        self.hides = hides
        """Whether any name may be declared in it: ``with``."""

    def inner(self, *, function: bool = False, hides: bool = False) -> _Scope:
        """A new scope in it."""
        return self if self.depth >= DEEPEST else _Scope(self, function=function, hides=hides)

    def home(self, name: str) -> _Scope | None:
        """The scope that declares a name."""
        scope: _Scope | None = self
        while scope is not None and name not in scope.names and not scope.hides:
            scope = scope.outer
        return scope


FUNCTIONS = frozenset(
    [
        *("function_expression", "generator_function", "arrow_function", "method_definition"),
        *("function_declaration", "generator_function_declaration"),
    ]
)
BLOCKS = frozenset(["statement_block", "for_statement", "switch_body", "class_static_block"])
PATTERNS = frozenset(["array_pattern", "object_pattern", "rest_pattern"])
DEFAULTS = frozenset(["assignment_pattern", "object_assignment_pattern"])
TARGETS = frozenset(["identifier", "shorthand_property_identifier_pattern"])


class _Walk:
    """Goes through a tree once; what is found is looked up in the scopes at the end."""

    def __init__(self, code: Code) -> None:
        self.code = code
        self.top = _Scope(None, function=True)
        self.waiting: list[tuple[Node, _Scope]] = [(code.root, self.top)]
        self.found: list[tuple[int, str, str, _Scope]] = []
        """Offset, name, how (``read``, ``write``, ``change``, ``ask``, ``declare`` or a holder), scope."""
        self.opaque = False
        self.given: set[int] = set()
        """Offsets of scopes' members that are given values."""
        self.parted: set[int] = set()
        """Offsets of scopes' members whose own members are asked for."""

    def names(self) -> Names:
        """All names of the code."""
        while self.waiting:
            node, scope = self.waiting.pop()
            visit = VISITS.get(node.type)
            if visit is not None:
                visit(self, node, scope)
            else:
                self.all(node, scope)
        made = Names(set(self.top.names), opaque=self.opaque)
        for start, name, how, scope in sorted(self.found, key=lambda one: one[0]):
            self._add(made, start, name, how, scope)
        for _, name, how, _ in self.found:
            if how == "ask":
                made.now.pop(name, None)
        return made

    def _add(self, made: Names, start: int, name: str, how: str, scope: _Scope) -> None:
        if how in SCOPES:
            given, parted = start in self.given, start in self.parted
            made.uses.append(Use(name, start, how, given, parted))
            return
        home = scope.home(name)
        if home is not None and home is not self.top:
            return
        if how != "change":  # it is read there, too
            made.uses.append(Use(name, start, declares=how == "declare"))
        if home is None and how == "read":
            made.read.setdefault(name, start)
            if scope.function is self.top:
                made.now.setdefault(name, start)
        elif home is None and how in ("write", "change"):
            (made.written if how == "write" else made.changed).add(name)

    def tell(self, node: Node, how: str, scope: _Scope) -> None:
        """A name stands there."""
        self.found.append((self.code.start(node), self.code.of(node), how, scope))

    def push(self, node: Node | None, scope: _Scope) -> None:
        """Go through a node in a scope."""
        if node is not None:
            self.waiting.append((node, scope))

    def all(self, node: Node, scope: _Scope) -> None:
        """Go through all that a node holds."""
        self.waiting += [(one, scope) for one in node.named_children]

    # What declares, or opens a scope ----------------------------------------------------------

    def name(self, node: Node, scope: _Scope) -> None:
        """A variable is read."""
        self.tell(node, "read", scope)

    def nothing(self, _node: Node, _scope: _Scope) -> None:
        """Nothing in it is a variable."""

    def block(self, node: Node, scope: _Scope) -> None:
        """A block has a scope of its own."""
        self.all(node, scope.inner())

    def function(self, node: Node, scope: _Scope) -> None:
        """A function's name is declared around it, or in it where it is an expression."""
        inner = scope.inner(function=True)
        name = node.child_by_field_name("name")
        if node.type.endswith("_declaration"):
            self.bind(name, scope)
        elif node.type == "method_definition":
            self.push(name, scope)
        elif name is not None:
            inner.names.add(self.code.of(name))
        for part in ("parameter", "parameters"):
            self.bind(node.child_by_field_name(part), inner)
        self.push(node.child_by_field_name("body"), inner)

    def class_(self, node: Node, scope: _Scope) -> None:
        """A class is declared around it, or in it where it is an expression."""
        name, inner = node.child_by_field_name("name"), scope.inner()
        if name is not None:
            self.bind(name, scope if node.type == "class_declaration" else inner)
        self.waiting += [(one, inner) for one in node.named_children if one != name]

    def declaration(self, node: Node, scope: _Scope) -> None:
        """``var`` declares in the function, ``let`` and ``const`` in the block."""
        home = scope.function if node.type == "variable_declaration" else scope
        for one in node.named_children:
            if one.type != "variable_declarator":
                self.push(one, scope)
                continue
            self.bind(one.child_by_field_name("name"), home)
            self.push(one.child_by_field_name("value"), scope)

    def loop(self, node: Node, scope: _Scope) -> None:
        """``for (x in y)`` and ``for (x of y)``."""
        inner = scope.inner()
        kind = node.child_by_field_name("kind")
        left = node.child_by_field_name("left")
        if kind is None:
            self.assign(left, inner)
        else:
            self.bind(left, scope.function if kind.type == "var" else inner)
        self.push(node.child_by_field_name("right"), inner)
        self.push(node.child_by_field_name("body"), inner)

    def caught(self, node: Node, scope: _Scope) -> None:
        """What is caught is known in its block."""
        inner = scope.inner()
        self.bind(node.child_by_field_name("parameter"), inner)
        self.push(node.child_by_field_name("body"), inner)

    def with_(self, node: Node, scope: _Scope) -> None:
        """Names in its body may be members of its object."""
        self.push(node.child_by_field_name("object"), scope)
        self.push(node.child_by_field_name("body"), scope.inner(hides=True))

    # What reads or gives values ---------------------------------------------------------------

    def assignment(self, node: Node, scope: _Scope) -> None:
        """``x = 1`` gives ``x`` a value; ``x += 1`` reads it first."""
        left = node.child_by_field_name("left")
        if node.type == "augmented_assignment_expression":
            self.change(left, scope)
        else:
            self.assign(left, scope)
        self.push(node.child_by_field_name("right"), scope)

    def update(self, node: Node, scope: _Scope) -> None:
        """``x++`` reads ``x`` and gives it a value."""
        self.change(node.child_by_field_name("argument"), scope)

    def change(self, target: Node | None, scope: _Scope) -> None:
        """A target is read and given a value."""
        self.push(target, scope)
        if target is not None and target.type == "identifier":
            self.tell(target, "change", scope)
        elif target is not None and (found := self.of_scope(target)) is not None:
            self.given.add(self.code.start(found[1]))

    def unary(self, node: Node, scope: _Scope) -> None:
        """``typeof x`` may be asked of what nothing declares."""
        operator = node.child_by_field_name("operator")
        argument = node.child_by_field_name("argument")
        while argument is not None and argument.type == "parenthesized_expression":
            argument = argument.named_children[0] if argument.named_children else None
        asks = operator is not None and operator.type == "typeof"
        if asks and argument is not None and argument.type == "identifier":
            self.tell(argument, "ask", scope)
        else:
            self.all(node, scope)

    def call(self, node: Node, scope: _Scope) -> None:
        """``eval`` may declare and read anything."""
        function = node.child_by_field_name("function")
        if function is not None and self.code.of(function) == "eval":
            self.opaque = True
        self.all(node, scope)

    def member(self, node: Node, scope: _Scope) -> None:
        """A member's name is a variable's where the object is a scope."""
        holder = node.child_by_field_name("object")
        self.push(holder, scope)
        if (found := self.of_scope(node)) is not None:
            self.tell(found[1], found[0], scope)
        whole = node.child_by_field_name("optional_chain") is None
        if whole and holder is not None and (found := self.of_scope(holder)) is not None:
            self.parted.add(self.code.start(found[1]))

    def of_scope(self, node: Node) -> tuple[str, Node] | None:
        """The scope and the member's name in ``document.x``; None for anything else."""
        holder = node.child_by_field_name("object")
        part = node.child_by_field_name("property")
        if holder is None or part is None or part.type != "property_identifier":
            return None
        name = self.code.of(holder) if holder.type == "identifier" else ""
        return (name, part) if name in SCOPES else None

    def bind(self, target: Node | None, home: _Scope) -> None:
        """Declare the names of a target: a name, a pattern or a list of parameters."""

        def declare(node: Node) -> None:
            home.names.add(self.code.of(node))
            self.tell(node, "declare", home)

        self._target(target, declare, home)

    def assign(self, target: Node | None, scope: _Scope) -> None:
        """The names of a target are given values."""
        self._target(target, lambda node: self.tell(node, "write", scope), scope)

    def _target(self, target: Node | None, put: Callable[[Node], None], scope: _Scope) -> None:
        waiting = [] if target is None else [target]
        while waiting:
            node = waiting.pop()
            if node.type in TARGETS:
                put(node)
            elif node.type in DEFAULTS:
                left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
                waiting += [] if left is None else [left]
                self.push(right, scope)
            elif node.type == "pair_pattern":
                value = node.child_by_field_name("value")
                waiting += [] if value is None else [value]
                self.push(node.child_by_field_name("key"), scope)
            elif node.type in PATTERNS or node.type in (
                "formal_parameters",
                "parenthesized_expression",
            ):
                waiting += node.named_children
            else:
                self.push(node, scope)
                if (found := self.of_scope(node)) is not None:
                    self.given.add(self.code.start(found[1]))


VISITS: Mapping[str, Callable[[_Walk, Node, _Scope], None]] = {
    "identifier": _Walk.name,
    "shorthand_property_identifier": _Walk.name,
    "shorthand_property_identifier_pattern": _Walk.name,
    "property_identifier": _Walk.nothing,
    "private_property_identifier": _Walk.nothing,
    "statement_identifier": _Walk.nothing,
    "comment": _Walk.nothing,
    "html_comment": _Walk.nothing,
    **dict.fromkeys(FUNCTIONS, _Walk.function),
    **dict.fromkeys(BLOCKS, _Walk.block),
    "class_declaration": _Walk.class_,
    "class": _Walk.class_,
    "variable_declaration": _Walk.declaration,
    "lexical_declaration": _Walk.declaration,
    "for_in_statement": _Walk.loop,
    "catch_clause": _Walk.caught,
    "with_statement": _Walk.with_,
    "assignment_expression": _Walk.assignment,
    "augmented_assignment_expression": _Walk.assignment,
    "update_expression": _Walk.update,
    "unary_expression": _Walk.unary,
    "call_expression": _Walk.call,
    "member_expression": _Walk.member,
}
"""What is done at a node of each type; all that a node holds is gone through at any other."""
