"""The Form Interpretation Algorithm as VoiceXML's appendix C has it, without devices and limits.

PRIMA's own language differs where :attr:`Run.voice` is asked for: a form without items left waits
for events, items' ``filled`` come before their form's, and prompts are left out for one item alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from tests.helpers.fia.documents import FIRST, ROOT, El, Value

MOST_STEPS = 150
ITEMS = ("field", "block", "initial", "subdialog")
ASKED_AGAIN = ("noinput", "nomatch", "help")
OUTSIDE = ("touch.head", "message")
"""Events that come from outside, while the application listens or waits."""


class Waits(Exception):
    """The user says no more, or the form waits for events."""


class Exits(Exception):
    """The application ends."""


class TooLong(Exception):
    """The document loops for long, as the limits do not let it."""


class Thrown(Exception):
    """An event; ``at`` is the item or dialog in whose scope it was thrown, if not the visited one."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.at: El | None = None


class Goto(Exception):
    """To a dialog; ``heard`` is the choice or the slots with which it was entered by speech."""

    def __init__(self, uri: str, heard: El | dict[str, str] | None = None) -> None:
        self.uri = uri
        self.heard = heard


class ToItem(Exception):
    """To an item of the same form."""

    def __init__(self, name: str) -> None:
        self.name = name


class Returns(Exception):
    """Back from a subdialog, with values or an event."""

    def __init__(self, values: dict[str, Value], event: str) -> None:
        self.values = values
        self.event = event


class Run:
    """One run of an application, by what the user says or does; None is silence."""

    def __init__(
        self, documents: Mapping[str, El], answers: Iterable[str | None], voice: bool
    ) -> None:
        self.documents = documents
        self.answers = [*answers]
        self.voice = voice
        self.said: list[str] = []
        self.logs: list[str] = []
        self.ended = False
        self.steps = 0
        try:
            self.interpret(Page(self, FIRST), "", {})
        except Exits:
            self.ended = True
        except Waits:
            pass

    def step(self) -> None:
        self.steps += 1
        if self.steps > MOST_STEPS:
            raise TooLong

    def interpret(self, page: Page, name: str, params: Mapping[str, Value]) -> None:
        """Interpret one dialog after the other; a subdialog's end is :class:`Returns`."""
        heard: El | dict[str, str] | None = None
        while True:
            self.step()
            try:
                Dialog(page, page.dialog(name), params).interpret(heard)
            except Goto as goto:
                file, _, name = goto.uri.partition("#")
                page = Page(self, file, page.root) if file else page
                params, heard = {}, goto.heard


class Page:
    """A document that has been loaded, with its variables and its root's."""

    def __init__(self, run: Run, file: str, root: dict[str, Value] | None = None) -> None:
        self.run, self.file = run, file
        self.own = run.documents[file]
        self.wider = run.documents.get(ROOT) if file != ROOT else None
        above = run.documents.get(ROOT)
        self.root = declared(above) if root is None and above else root or {}
        self.values = self.root if file == ROOT else declared(self.own)

    def dialog(self, name: str) -> El:
        """A dialog by its id, or the first."""
        found = self.own.all("form", "menu")
        return next(one for one in found if name in ("", one.get("id")))


def declared(document: El) -> dict[str, Value]:
    """The variables of a document."""
    return {one.name: 0 for one in document.all("var")}


class Dialog:
    """A form or menu being interpreted."""

    def __init__(self, page: Page, form: El, params: Mapping[str, Value]) -> None:
        self.page, self.run, self.form = page, page.run, form
        self.items = form.all(*ITEMS) if form.tag == "form" else [form]
        self.local: dict[str, Value] = {}
        """The variables of the content that runs."""
        self.values: dict[str, Value] = {
            one.name: params.get(one.name, 0) for one in form.all("var")
        }
        for item in self.items:
            self.values[item.name] = self.value(item, "expr")
        self.asked = {item.name: 1 for item in self.items}
        self.came: dict[El, dict[str, int]] = {}
        self.quiet = ""
        """The item whose prompts are left out."""

    def interpret(self, heard: El | dict[str, str] | None) -> None:
        """Select, collect and process, for ever; ``heard`` enters in the process phase."""
        item, next_item = self.form, ""
        while True:
            self.run.step()
            try:
                if heard is not None:
                    item, what, heard = self.form, heard, None
                    self.follow(what) if isinstance(what, El) else self.take(what)
                    continue
                found, next_item = self.select(next_item), ""
                item = found or self.form
                self.wait() if found is None else self.collect(found)
            except ToItem as goto:
                next_item, self.quiet = goto.name, ""
            except Thrown as thrown:
                next_item = self.handle(thrown, item)

    def select(self, next_item: str) -> El | None:
        if next_item:
            return next(one for one in self.items if one.name == next_item)
        for one in self.items:
            if self.values[one.name] is None and self.holds(one):
                return one
        if self.run.voice:
            raise Exits
        return None

    def wait(self) -> None:
        """Wait for an event, when all items of a form have been visited."""
        self.quiet = ""
        if not (self.run.answers and self.run.answers[0] in OUTSIDE):
            raise Waits
        self.outside(str(self.run.answers.pop(0)), self.form)

    def collect(self, item: El) -> None:
        quiet, self.quiet = self.quiet, ""
        if item.tag != "block" and not (quiet and (self.run.voice or quiet == item.name)):
            self.prompt(item)
        if item.tag == "block":
            self.values[item.name] = True
            self.execute(item.holds)
        elif item.tag == "subdialog":
            self.call(item)
        else:
            self.ask(item)

    def prompt(self, item: El) -> None:
        reached = [
            one
            for one in item.all("prompt")
            if self.holds(one) and one.count <= self.asked[item.name]
        ]
        most = max((one.count for one in reached), default=0)
        self.run.said += [str(one.holds[0]) for one in reached if one.count == most]
        self.asked[item.name] += 1

    def call(self, item: El) -> None:
        params = {one.name: self.value(one, "expr") for one in item.all("param")}
        file, _, name = item.get("src").partition("#")
        try:
            self.run.interpret(Page(self.run, file or self.page.file), name, params)
        except Returns as back:
            if back.event:
                raise Thrown(back.event) from None
            self.values[item.name] = back.values
            self.fill([item.name])

    # Input ---------------------------------------------------------------------------

    def ask(self, item: El) -> None:
        while self.run.answers and self.run.answers[0] in OUTSIDE:
            self.outside(str(self.run.answers.pop(0)), item)
        if not self.run.answers:
            raise Waits
        said = self.run.answers.pop(0)
        if said is None:
            raise Thrown("noinput")
        for holder, one, page in self.listening(item):
            if said in one.words:
                self.heard(item, holder, one, page, said)
                return
        raise Thrown("nomatch")

    def listening(self, item: El) -> Iterable[tuple[El, El, El]]:
        """What listens, by precedence (3.1.4): its holder, itself, and its document."""
        page = self.page.own
        for holder in (item, self.form) if item is not self.form else (item,):
            yield from ((holder, one, page) for one in holder.all("grammar", "link", "choice"))
            if item.get("modal"):
                return
        for page in filter(None, (self.page.own, self.page.wider)):
            for holder in page.all("link", "form", "menu"):
                if holder.tag == "link":
                    yield page, holder, page
                elif holder is not self.form:
                    open_to_all = holder.get("scope") == "document"
                    for one in holder.all("grammar", "choice"):
                        if open_to_all or one.get("scope") == "document":
                            yield holder, one, page

    def heard(self, item: El, holder: El, one: El, page: El, said: str) -> None:
        """What the user said belongs to an item, to this dialog, to another one, or to a link."""
        file = "" if page is self.page.own else ROOT
        if one.tag == "link":
            self.follow(one, file)
        elif holder in (item, self.form) and one.tag == "choice":
            self.follow(one)
        elif holder is item:
            self.values[item.name] = said
            self.fill([item.name])
        elif holder is self.form:
            self.take(one.words[said])
        else:
            heard = one if one.tag == "choice" else one.words[said]
            raise Goto(f"{file}#{holder.get('id')}", heard)

    def follow(self, link: El, file: str = "") -> None:
        to = link.get("next")
        if to:
            raise Goto(file + to if to.startswith("#") else to)
        raise Thrown(link.get("event"))

    def take(self, slots: Mapping[str, str]) -> None:
        """Fill the fields whose slots an utterance has."""
        fields = {one.name for one in self.form.all("field")}
        filled = [name for name in slots if name in fields]
        self.values |= {name: slots[name] for name in filled}
        self.fill(filled)

    def fill(self, filled: Sequence[str]) -> None:
        """Process what has just been filled (2.4)."""
        inputs = self.form.all("field", "subdialog")
        if any(one.tag == "field" and one.name in filled for one in inputs):
            self.values |= {one.name: True for one in self.form.all("initial")}
        found: list[tuple[El, El]] = []
        for one in self.form.all("field", "subdialog", "filled"):
            held = [one] if one.tag == "filled" else one.all("filled")
            found += [(self.form if one.tag == "filled" else one, each) for each in held]
        if not self.run.voice:
            found.sort(key=lambda pair: pair[0] is self.form)
        for holder, one in found:
            every = [one.name for one in inputs] if holder is self.form else [holder.name]
            self.reach(holder, one, one.get("namelist").split() or every, filled)

    def reach(self, holder: El, one: El, names: Sequence[str], filled: Sequence[str]) -> None:
        enough = any if one.get("mode") == "any" else all
        just = any(name in filled for name in names)
        if just and enough(self.values[name] is not None for name in names):
            try:
                self.execute(one.holds)
            except Thrown as thrown:
                thrown.at = holder
                raise

    # Events --------------------------------------------------------------------------

    def handle(self, thrown: Thrown, item: El) -> str:
        """Handle an event; gives the item to which its handler has gone (5.2)."""
        at = thrown.at or item
        self.quiet = item.name if item.tag == "field" else ""
        while True:
            self.run.step()
            self.quiet = at.name if self.run.voice else self.quiet
            try:
                self.catch(thrown.name, at)
                return ""
            except ToItem as goto:
                self.quiet = self.quiet if self.run.voice else ""
                return goto.name
            except Thrown as again:
                thrown = again

    def outside(self, name: str, at: El) -> None:
        """What happens around an application is handled while it waits or listens (O4)."""
        handler = self.find(name, at)
        if handler is not None:
            self.execute(handler.holds)

    def catch(self, name: str, at: El) -> None:
        """Run the handler of an event, or do what the platform does (5.2.5)."""
        handler = self.find(name, at)
        if handler is not None:
            self.execute(handler.holds)
        elif name in ASKED_AGAIN:
            self.quiet = ""
        else:
            raise Exits

    def find(self, name: str, at: El) -> El | None:
        """The handler of an event: by scope, name, condition and count (5.2.4)."""
        came = self.came.setdefault(at, {})
        parts = name.split(".")
        for prefix in ("", *(".".join(parts[:end]) for end in range(1, len(parts) + 1))):
            came[prefix] = came.get(prefix, 0) + 1
        scopes = [at, *([self.form] if at is not self.form else []), self.page.own]
        found = [
            one
            for scope in filter(None, (*scopes, self.page.wider))
            for one in scope.all("catch", "noinput", "nomatch")
            if one.count <= max((came.get(each, 0) for each in names(one, name)), default=0)
            and self.holds(one)
        ]
        most = max((one.count for one in found), default=1)
        return next((one for one in found if one.count == most), None)

    # Content -------------------------------------------------------------------------

    def execute(self, content: Iterable[El | str]) -> None:
        """Run the content of an item or handler, which has variables of its own."""
        self.local = {}
        try:
            self.go_through(content)
        finally:
            self.local = {}

    def go_through(self, content: Iterable[El | str]) -> None:
        for one in content:
            self.run.step()
            assert isinstance(one, El)
            match one.tag:
                case "log":
                    self.run.logs.append(str(self.value(one, "expr")))
                case "say":
                    self.run.said.append(str(one.holds[0]))
                case "if":
                    self.choose(one)
                case "var":
                    self.local[one.name] = self.value(one, "expr")
                case "assign":
                    plain = one.name.rpartition(".")[2]
                    self.scope(one.name)[plain] = self.value(one, "expr")
                case "clear":
                    self.clear(one.get("namelist").split())
                case "reprompt":
                    self.quiet = ""
                case _:
                    self.leave(one)

    def leave(self, one: El) -> None:
        match one.tag:
            case "throw":
                raise Thrown(one.get("event"))
            case "goto" if one.get("nextitem"):
                raise ToItem(one.get("nextitem"))
            case "goto":
                raise Goto(one.get("next"))
            case "return":
                values = {name: self.values[name] for name in one.get("namelist").split()}
                raise Returns(values, one.get("event"))
        raise Exits

    def choose(self, one: El) -> None:
        """Run the branch of an ``if`` whose condition holds; further branches are its last parts."""
        branches = one.all("elseif", "else")
        first = [part for part in one.holds if part not in branches]
        for head, content in ((one, first), *((each, each.holds) for each in branches)):
            if self.holds(head):
                self.go_through(content)
                return

    def clear(self, listed: Sequence[str]) -> None:
        for item in self.items:
            if not listed or item.name in listed:
                self.values[item.name] = None
                self.asked[item.name] = 1
                self.came.pop(item, None)

    def holds(self, one: El) -> bool:
        """Whether an element's condition holds."""
        return one.code("cond") is None or bool(self.value(one, "cond"))

    def value(self, one: El, attribute: str) -> Value:
        code = one.code(attribute)
        if code is None:
            return None
        seen = {**self.page.root, **self.page.values, **self.values, **self.local}
        for name, scope in self.scopes.items():
            seen |= {f"{name}.{one}": value for one, value in scope.items()}
        return code.of(seen)

    @property
    def scopes(self) -> dict[str, dict[str, Value]]:
        """The scopes that have names, the widest first (5.1.2)."""
        return {"application": self.page.root, "document": self.page.values, "dialog": self.values}

    def scope(self, name: str) -> dict[str, Value]:
        """The scope that a name says, or the innermost that declares it."""
        head, dot, _ = name.rpartition(".")
        if dot:
            return self.scopes[head]
        some = (self.local, self.values, self.page.values, self.page.root)
        return next(one for one in some if name in one)


def names(handler: El, event: str) -> list[str]:
    """The names by which a handler takes an event; all events have the prefix ``""``."""
    if handler.tag != "catch":
        return [handler.tag] if handler.tag == event else []
    listed = handler.get("event").split()
    if not listed:
        return [""]
    return [one for one in listed if event == one or event.startswith(f"{one}.")]
