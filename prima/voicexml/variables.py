"""Variables that a VoiceXML document uses and nothing declares: error.semantic when reached.

In case of doubt, a name is taken for declared. Executable content has a scope of its own, in
that of its dialog (5.1.2); a declaration of a dialog or a document counts from its place on in
what is evaluated in document order, and everywhere in all else.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from prima.errors import Problem, Span, suggestion
from prima.errors.diagnoses.names import NO_MEMBER, UNDECLARED_VARIABLE
from prima.markup.spans import Declarations
from prima.markup.tree import Node
from prima.script.known import Known, NameScope
from prima.script.names import Names, Use, expression_names, script_names, whole_scopes
from prima.script.slips import or_text, value_elsewhere
from prima.script.walk import OBJECTS
from prima.voicexml.checks import NAMING, is_code
from prima.voicexml.document import Page
from prima.voicexml.elements import HANDLERS, INPUTS, ITEMS
from prima.voicexml.reads import FILES, Read, reads, scope_members

ALWAYS = frozenset(
    [
        *("session", "application", "document", "dialog", "lastresult$"),
        *("_event", "_message", "_prompt", "_dtmf", "connection", "telephone", "event"),
        *("Node", "DOMException"),
    ]
)
"""The platform's variables (5.1.2, 5.1.4, 5.1.5, 5.2.2, 2.2.4; 2.1, D)."""
DIALOGS = ("form", "menu")
SETUP = ("var", "script", "data")
CONTAINERS = frozenset([*HANDLERS, "block", "filled", "prompt"])
"""Elements whose content has a scope of its own, unless they are in such content themselves."""
Text = Callable[[Page, Node], str | None]
"""Gives the text of a script in a file, if it can be read."""


class Unknown(Exception):
    """A script that cannot be read may declare anything."""


def check_variables(page: Page, root: Page | None, text: Text, is_root: bool) -> list[Problem]:
    """Warnings of variables that nothing declares in a document and its application root.

    Args:
        page: the document.
        root: its application root, if it has one.
        text: gives the text of a script in a file.
        is_root: whether it is the root of others, whose dialogs inherit its handlers and links.
    """
    if page.application and root is None:
        return []
    try:
        return list(_Look(page, root, text).problems(is_root))
    except Unknown:
        return []


@dataclass(slots=True)
class Level:
    """One scope: its elements in document order, and the names that they declare."""

    nodes: list[Node] = field(default_factory=list)
    inner: list[Node] = field(default_factory=list)
    """Those whose content has a scope of its own."""
    names: NameScope = field(default_factory=NameScope)
    by_node: dict[int, set[str]] = field(default_factory=dict)
    ordered: bool = False
    """Whether all of it is evaluated in document order."""


class _Look:
    """Looks through one document."""

    def __init__(self, page: Page, root: Page | None, text: Text) -> None:
        self.page, self.root, self.text = page, root, text
        self.own = self.level(page, self.outside(page))
        self.shared = [self.own.names]
        if root is not None:
            self.shared.append(self.level(root, self.outside(root)).names)
        self.dialogs = {id(one): self.level(page, [one]) for one in page.dialogs.values()}
        self.mentioned: set[tuple[str, str]] = set()
        """Members of scopes that some code assigns or tests, which may therefore exist.

        A scope used as a whole appears with an empty name: any member may be meant.
        """
        self.asked: set[str] = set()
        """Variables whose type some code tests, which may be missing."""
        self.look_for_tests()

    @staticmethod
    def outside(page: Page) -> list[Node]:
        """The elements outside of a document's dialogs."""
        return [node for node in page.root.nodes if node.tag not in DIALOGS]

    # What is declared -------------------------------------------------------------------------

    def level(self, page: Page, tops: Iterable[Node], ordered: bool = False) -> Level:
        """The scope of elements, without nested ones that have their own.

        Raises:
            Unknown: a script cannot be read.
        """
        made = Level(ordered=ordered)
        waiting = [*tops][::-1]
        while waiting:
            node = waiting.pop()
            made.nodes.append(node)
            if found := self.declared(page, node):
                made.by_node[node.index] = found
                made.names |= found
            if node.tag in CONTAINERS and not ordered:
                made.inner.append(node)
            else:
                waiting += reversed(node.nodes)
        made.names |= self.shadows(made)
        return made

    def declared(self, page: Page, node: Node) -> set[str]:
        """The names that an element declares."""
        if node.key == "script":
            names = self.script(page, node)
            given = {use.name for use in names.uses if use.holder and use.declares}
            return names.declared | names.written | given
        name = node.get(NAMING.get(node.key, ""))
        return {name} if name else set()

    @staticmethod
    def shadows(level: Level) -> set[str]:
        """Shadow variables of the items that a user or a form's grammar fills (3.1.6)."""
        filled = INPUTS - {"subdialog"}
        if any(node.key == "grammar" for top in level.nodes[:1] for node in top.nodes):
            filled = INPUTS
        return {f"{node.get('name')}$" for node in level.nodes if node.key in filled}

    def script(self, page: Page, node: Node) -> Names:
        """The names in a script, which may be in a file.

        Raises:
            Unknown: it cannot be read.
        """
        elsewhere = not node.attributes.keys().isdisjoint(FILES)
        code = self.text(page, node) if elsewhere else node.own_text
        if code is None:
            raise Unknown
        found = script_names(code)
        if found.opaque:
            raise Unknown
        return found

    def look_for_tests(self) -> None:
        """Look for what the code of the document and its root assigns or tests."""
        for page in filter(None, (self.page, self.root)):
            for node in page.root.walk():
                codes = [one for name, one in node.attributes.items() if is_code(node, name)]
                found = list(map(expression_names, codes))
                found += [self.script(page, node)] if node.key == "script" else []
                for names in found:
                    self.mentioned.update(_mentions(names.uses))
                    self.asked |= names.asked

    # What is used -----------------------------------------------------------------------------

    def problems(self, is_root: bool) -> Iterator[Problem]:
        """Warnings of all names used and not declared."""
        everywhere = NameScope(name for one in self.dialogs.values() for name in one.names)
        application = {"application": self.shared[-1]}
        outer = Known(*self.shared[1:])
        setup = [node for node in self.own.nodes if node.tag in SETUP]
        yield from self.check(setup, self.own, outer, application)
        if self.dialogs and not is_root:  # else other documents' dialogs inherit the rest
            others = [node for node in self.own.nodes if node.tag not in SETUP]
            known = Known(*self.shared, everywhere)
            yield from self.check(others, Level(), known, application)
            yield from self.contents(self.own, known, application)
        for dialog in self.dialogs.values():
            members = {**application, "document": self.own.names, "dialog": dialog.names}
            yield from self.check(dialog.nodes, dialog, Known(*self.shared), members)
            yield from self.contents(dialog, Known(*self.shared, dialog.names), members)

    def contents(
        self, level: Level, outer: Known, members: Mapping[str, NameScope]
    ) -> Iterator[Problem]:
        """Check the executable content in a scope."""
        for node in level.inner:
            inner = self.level(self.page, node.nodes, ordered=True)
            yield from self.check(inner.nodes, inner, outer, members)

    @cached_property
    def _declarations(self) -> Declarations:
        return Declarations(self.page.root)

    def _undeclared(self, read: Read, known: Known) -> Problem:
        place = read.place
        span = Span.of(place, read.name)
        hint = value_elsewhere(read.name, span) or suggestion(read.name, known.written(), span)
        declare = f'Declare it: <var name="{read.name}"/>.'
        hint = hint or self._declarations.hint(declare, read.name, read.node)
        hint = or_text(hint, read.name) if read.bare else hint
        return NOT_DECLARED.at(place, hint, name=read.name)

    def check(
        self, nodes: Iterable[Node], level: Level, outer: Known, members: Mapping[str, NameScope]
    ) -> Iterator[Problem]:
        """Check that what elements use is declared before them in their scope, or around it."""
        seen: set[str] = set()
        for node in nodes:
            seen |= _with_it(node, level)
            for read in reads(node):
                if read.name in ALWAYS or read.name in outer or read.name in seen:
                    continue
                if read.name in self.asked:
                    continue
                if read.name not in level.names:
                    yield self._undeclared(read, Known(level.names, *outer.scopes))
                elif read.at_once and (level.ordered or _in_order(read)):
                    yield DECLARED_AFTER.at(read.place, name=read.name)
            yield from self.members(node, members)
            seen |= level.by_node.get(node.index, set())

    def members(self, node: Node, known: Mapping[str, NameScope]) -> Iterator[Problem]:
        """Warn of members of scopes that must exist and do not."""
        for read in scope_members(node):
            holder, _, name = read.name.partition(".")
            scope = known.get(holder)
            if scope is None or name in scope or name in ALWAYS:
                continue
            if self.mentioned.isdisjoint([(holder, ""), *((one, name) for one in OBJECTS)]):
                yield _no_member(read, holder, name, scope)


def _mentions(uses: list[Use]) -> Iterator[tuple[str, str]]:
    """The members of scopes that some code assigns or tests, and scopes used as a whole."""
    yield from ((scope, "") for scope in whole_scopes(uses))
    members = (use for use in uses if use.holder)
    yield from ((use.holder, use.name) for use in members if use.declares or not use.parted)


def _with_it(node: Node, level: Level) -> set[str]:
    """The names that may be there before all of an element has been evaluated."""
    if node.key == "script":
        return level.by_node.get(node.index, set())
    if node.tag == "foreach" and level.ordered:  # its end precedes its beginning again
        return set().union(*(level.by_node.get(one.index, ()) for one in node.walk()))
    return set()


def _in_order(read: Read) -> bool:
    """Whether code of a document or dialog is evaluated where it is written, and not later."""
    return read.node.tag in SETUP or (read.node.tag in ITEMS and read.attribute == "expr")


NOT_DECLARED = UNDECLARED_VARIABLE.says(
    'The variable "{name}" is not declared: this will be error.semantic.', severity="warning"
)
DECLARED_AFTER = UNDECLARED_VARIABLE.says(
    'The variable "{name}" is declared after this: this will be error.semantic.',
    "Declare it before.",
    "warning",
)


def _no_member(read: Read, holder: str, name: str, scope: NameScope) -> Problem:
    at = read.place._replace(column=read.place.column + len(holder) + 1)
    hint = suggestion(name, scope.written, Span.of(at, name))
    return NO_MEMBER.at(read.place, hint, scope=holder, name=name)
