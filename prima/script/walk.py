"""The names in a syntax tree of ECMAScript, and their scopes."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from prima.script.parse import Code, Node

DEEPEST = 200
"""Maximum nesting of scopes; deeper ones count as the same scope."""
OBJECTS = frozenset(["application", "document", "dialog"])
"""Objects whose members are variables (VoiceXML 2.0, 5.1.2)."""


class CodeScope:
    """The names that a function or block declares."""

    __slots__ = ("depth", "function", "hides", "names", "outer")

    def __init__(
        self, outer: CodeScope | None, *, function: bool = False, hides: bool = False
    ) -> None:
        self.outer = outer
        self.depth: int = outer.depth + 1 if outer else 0
        self.names: set[str] = set()
        self.function: CodeScope = self if function or outer is None else outer.function
        """The scope for ``var``."""
        self.hides = hides
        """Whether any name may be declared in it: ``with``."""

    def inner(self, *, function: bool = False, hides: bool = False) -> CodeScope:
        """A new scope in it."""
        return self if self.depth >= DEEPEST else CodeScope(self, function=function, hides=hides)

    def home(self, name: str, written: bool = False) -> CodeScope | None:
        """The scope that declares a name; ``with`` declares no name that may be a new variable."""
        scope: CodeScope | None = self
        while scope is not None and name not in scope.names and (written or not scope.hides):
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


class Walk:
    """Walks a tree once; names found are resolved in the scopes at the end.

    Args:
        code: the code whose tree it is.
    """

    def __init__(self, code: Code) -> None:
        self.code = code
        self.top = CodeScope(None, function=True)
        self.waiting: list[tuple[Node, CodeScope]] = [(code.root, self.top)]
        self.found: list[tuple[int, str, str, CodeScope]] = []
        """Offset, name, how (``read``, ``write``, ``change``, ``ask``, ``declare`` or a holder), scope."""
        self.opaque = False
        self.given: set[int] = set()
        """Offsets of scopes' members that are assigned."""
        self.parted: set[int] = set()
        """Offsets of scopes' members whose own members are read."""
        self.called: set[int] = set()
        """Offsets of names that are called."""
        self.short: set[int] = set()
        """Offsets of names that are also a property's: ``{x}``."""
        self.parts: dict[int, tuple[int, str]] = {}
        """By the offset of a name, the offset and name of its member that is used, not called."""
        self._methods: set[int] = set()
        """The identities of members that are called."""

    def go(self) -> Walk:
        """Walk the tree."""
        while self.waiting:
            node, scope = self.waiting.pop()
            VISITS.get(node.type, Walk.all)(self, node, scope)
        return self

    def tell(self, node: Node, how: str, scope: CodeScope) -> None:
        """Note a name."""
        start = self.code.start(node)
        self.found.append((start, self.code.name(node), how, scope))
        if node.type.startswith("shorthand_"):
            self.short.add(start)

    def push(self, node: Node | None, scope: CodeScope) -> None:
        """Visit a node in a scope."""
        if node is not None:
            self.waiting.append((node, scope))

    def all(self, node: Node, scope: CodeScope) -> None:
        """Visit all children of a node."""
        self.waiting += [(one, scope) for one in node.named_children]

    # Declarations and scopes ------------------------------------------------------------------

    def name(self, node: Node, scope: CodeScope) -> None:
        """A variable is read."""
        self.tell(node, "read", scope)

    def nothing(self, _node: Node, _scope: CodeScope) -> None:
        """Nothing in it is a variable."""

    def block(self, node: Node, scope: CodeScope) -> None:
        """A block has a scope of its own."""
        self.all(node, scope.inner())

    def function(self, node: Node, scope: CodeScope) -> None:
        """A function's name is declared around it, or in it where it is an expression."""
        inner = scope.inner(function=True)
        name = node.child_by_field_name("name")
        if node.type.endswith("_declaration"):
            self.bind(name, scope)
        elif node.type == "method_definition":
            self.push(name, scope)
        elif name is not None:
            inner.names.add(self.code.name(name))
        for part in ("parameter", "parameters"):
            self.bind(node.child_by_field_name(part), inner)
        self.push(node.child_by_field_name("body"), inner)

    def class_(self, node: Node, scope: CodeScope) -> None:
        """A class is declared around it, or in it where it is an expression."""
        name, inner = node.child_by_field_name("name"), scope.inner()
        if name is not None:
            self.bind(name, scope if node.type == "class_declaration" else inner)
        self.waiting += [(one, inner) for one in node.named_children if one != name]

    def declaration(self, node: Node, scope: CodeScope) -> None:
        """``var`` declares in the function, ``let`` and ``const`` in the block."""
        home = scope.function if node.type == "variable_declaration" else scope
        for one in node.named_children:
            if one.type != "variable_declarator":
                self.push(one, scope)
                continue
            self.bind(one.child_by_field_name("name"), home)
            self.push(one.child_by_field_name("value"), scope)

    def loop(self, node: Node, scope: CodeScope) -> None:
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

    def caught(self, node: Node, scope: CodeScope) -> None:
        """The caught exception is visible in its block."""
        inner = scope.inner()
        self.bind(node.child_by_field_name("parameter"), inner)
        self.push(node.child_by_field_name("body"), inner)

    def with_(self, node: Node, scope: CodeScope) -> None:
        """Names in its body may be members of its object."""
        self.push(node.child_by_field_name("object"), scope)
        self.push(node.child_by_field_name("body"), scope.inner(hides=True))

    # Reading and assigning --------------------------------------------------------------------

    def assignment(self, node: Node, scope: CodeScope) -> None:
        """``x = 1`` assigns ``x``; ``x += 1`` reads it first."""
        left = node.child_by_field_name("left")
        if node.type == "augmented_assignment_expression":
            self.change(left, scope)
        else:
            self.assign(left, scope)
        self.push(node.child_by_field_name("right"), scope)

    def update(self, node: Node, scope: CodeScope) -> None:
        """``x++`` reads and assigns ``x``."""
        self.change(node.child_by_field_name("argument"), scope)

    def change(self, target: Node | None, scope: CodeScope) -> None:
        """A target is read and assigned."""
        self.push(target, scope)
        if target is not None and target.type == "identifier":
            self.tell(target, "change", scope)
        elif target is not None and (found := self.of_scope(target)) is not None:
            self.given.add(self.code.start(found[1]))

    def unary(self, node: Node, scope: CodeScope) -> None:
        """``typeof x`` is allowed for an undeclared name."""
        operator = node.child_by_field_name("operator")
        argument = node.child_by_field_name("argument")
        while argument is not None and argument.type == "parenthesized_expression":
            argument = argument.named_children[0] if argument.named_children else None
        asks = operator is not None and operator.type == "typeof"
        if asks and argument is not None and argument.type == "identifier":
            self.tell(argument, "ask", scope)
        else:
            self.all(node, scope)

    def call(self, node: Node, scope: CodeScope) -> None:
        """``eval`` may declare and read anything."""
        function = node.child_by_field_name("function")
        if function is not None and function.type == "identifier":
            self.called.add(self.code.start(function))
            self.opaque = self.opaque or self.code.of(function) == "eval"
        elif function is not None:
            self._methods.add(function.id)
        self.all(node, scope)

    def member(self, node: Node, scope: CodeScope) -> None:
        """A member's name is a variable's if the object is a scope."""
        holder = node.child_by_field_name("object")
        self.push(holder, scope)
        if (found := self.of_scope(node)) is not None:
            self.tell(found[1], found[0], scope)
        part = node.child_by_field_name("property")
        named = holder is not None and holder.type == "identifier"
        if named and part is not None and node.id not in self._methods:
            self.parts[self.code.start(node)] = self.code.start(part), self.code.of(part)
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
        return (name, part) if name in OBJECTS else None

    def bind(self, target: Node | None, home: CodeScope) -> None:
        """Declare the names of a target: a name, a pattern or a list of parameters."""

        def declare(node: Node) -> None:
            home.names.add(self.code.name(node))
            self.tell(node, "declare", home)

        self._target(target, declare, home)

    def assign(self, target: Node | None, scope: CodeScope) -> None:
        """The names of a target are assigned."""
        self._target(target, lambda node: self.tell(node, "write", scope), scope)

    def _target(self, target: Node | None, put: Callable[[Node], None], scope: CodeScope) -> None:
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
                self.member_given(node, scope)

    def member_given(self, node: Node, scope: CodeScope) -> None:
        """A member is assigned: a member of a scope, or of a script's ``this``, is a variable."""
        holder, part = node.child_by_field_name("object"), node.child_by_field_name("property")
        own = holder is not None and holder.type == "this" and scope.function is self.top
        if (found := self.of_scope(node)) is not None:
            self.given.add(self.code.start(found[1]))
        elif own and part is not None and part.type == "property_identifier":
            self.tell(part, "write", scope)


VISITS: Mapping[str, Callable[[Walk, Node, CodeScope], None]] = {
    "identifier": Walk.name,
    "shorthand_property_identifier": Walk.name,
    "shorthand_property_identifier_pattern": Walk.name,
    "property_identifier": Walk.nothing,
    "private_property_identifier": Walk.nothing,
    "statement_identifier": Walk.nothing,
    "comment": Walk.nothing,
    "html_comment": Walk.nothing,
    **dict.fromkeys(FUNCTIONS, Walk.function),
    **dict.fromkeys(BLOCKS, Walk.block),
    "class_declaration": Walk.class_,
    "class": Walk.class_,
    "variable_declaration": Walk.declaration,
    "lexical_declaration": Walk.declaration,
    "for_in_statement": Walk.loop,
    "catch_clause": Walk.caught,
    "with_statement": Walk.with_,
    "assignment_expression": Walk.assignment,
    "augmented_assignment_expression": Walk.assignment,
    "update_expression": Walk.update,
    "unary_expression": Walk.unary,
    "call_expression": Walk.call,
    "member_expression": Walk.member,
}
"""The visitor of each type of node; of any other type, all children are visited."""
