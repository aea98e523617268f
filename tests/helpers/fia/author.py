"""Writes documents at random: everything that the algorithm decides, in any combination."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from random import Random

from tests.helpers.fia.algorithm import OUTSIDE
from tests.helpers.fia.documents import FIRST, OTHER, ROOT, Code, El, Value, Values

WORDS = ("red", "blue", "green", "one", "two")
SPOKEN = ("mix", "both", "jump")
"""What only grammars of forms, and links, take."""
EVENTS = ("ev1", "ev2", "ev2.x", "ev3", "noinput")
CAUGHT = ("ev1", "ev2", "ev2.x", "ev3", "noinput", "nomatch", "ev1 nomatch")


def shown(value: Value) -> str:
    """A value as ECMAScript writes it."""
    return "undefined" if value is None else str(value).lower() if value is True else str(value)


class Author:
    """Writes the documents of one application."""

    def __init__(self, random: Random, voice: bool) -> None:
        self.random = random
        self.voice = voice
        self.made = 0
        self.beside_others = False
        """Whether the content being written must run beside a question."""
        self.file, self.form = FIRST, ""
        self.fields: list[str] = []
        self.items: list[str] = []
        self.numbers: list[str] = []
        """The variables with numbers that content sees."""
        self.forms = {FIRST: self.names()}
        if voice:
            self.forms = {ROOT: ["r0"], FIRST: self.names(), OTHER: self.names()}

    def names(self) -> list[str]:
        """The ids of a document's dialogs; the subdialog is called s0."""
        found = [f"f{number}" for number in range(self.random.randint(1, 3))]
        if self.voice and self.chance(0.25):
            found.append("m0")
        return found + (["s0"] if self.chance(0.4) else [])

    def chance(self, of: float) -> bool:
        return self.random.random() < of

    def some(self, most: int, make: Callable[[], El]) -> list[El]:
        return [make() for _ in range(self.random.randint(0, most))]

    def new(self, kind: str) -> str:
        """A name or text that occurs once."""
        self.made += 1
        return f"{kind}{self.made}"

    def answers(self) -> list[str | None]:
        """What the user says and does; None is silence."""
        heard: tuple[str | None, ...] = (*WORDS, *WORDS, *SPOKEN, "zzz", None, None)
        heard += () if self.voice else (*OUTSIDE, *OUTSIDE)
        return [self.random.choice(heard) for _ in range(self.random.randint(2, 9))]

    def documents(self) -> dict[str, El]:
        return {file: self.document(file) for file in self.forms}

    def document(self, file: str) -> El:
        self.file, self.form, self.fields, self.items = file, "", [], []
        own = "av" if file == ROOT else "dv"
        self.numbers = [own] if file == ROOT or not self.voice else ["av", own]
        holds: list[El | str] = [El("var", {"name": own, "expr": self.constant("0", 0)})]
        holds += self.some(1, self.link)
        holds += self.some(3, self.handler)
        holds += [self.dialog(name) for name in self.forms[file]]
        return El("vxml", {}, holds)

    def target(self) -> str:
        """A dialog to go to; a handler of the root can run in any document."""
        found = [f"#{name}" for name in self.forms[self.file] if name not in ("s0", self.form)]
        found = found if self.file != ROOT else []
        for file, names in self.forms.items():
            if file != self.file:
                found += [f"{file}#{name}" for name in names if name != "s0"]
        return self.random.choice(found or [f"#{self.forms[self.file][0]}"])

    # Dialogs ---------------------------------------------------------------------------

    def dialog(self, name: str) -> El:
        self.form, self.fields, self.items = name, [], []
        numbers = self.numbers
        made = self.menu() if name == "m0" else self.a_form()
        self.numbers = numbers
        self.form, self.fields, self.items = "", [], []
        return made

    def menu(self) -> El:
        holds: list[El | str] = [self.prompt(), *self.some(1, self.prompt)]
        for word in self.random.sample(WORDS, 2):
            holds.append(El("choice", self.leads(("ev1", "noinput")), [word], {word: {}}))
        scope = "document" if self.chance(0.3) else None
        return El("menu", {"id": "m0", "scope": scope}, [*holds, *self.some(2, self.handler)])

    def leads(self, events: Sequence[str]) -> dict[str, str | int | Code | None]:
        """Where a link or choice leads."""
        return (
            {"next": self.target()} if self.chance(0.55) else {"event": self.random.choice(events)}
        )

    def link(self) -> El:
        word = self.random.choice((*WORDS, "jump"))
        return El("link", self.leads(("ev1", "ev2.x", "nomatch")), [], {word: {}})

    def a_form(self) -> El:
        kinds = self.kinds()
        self.items = [f"{kind[0]}{place}{self.form}" for place, kind in enumerate(kinds)]
        named = list(zip(kinds, self.items, strict=True))
        self.fields = [name for kind, name in named if kind == "field"]
        holds: list[El] = []
        if self.form == "s0" or self.chance(0.6):
            holds.append(El("var", {"name": "fv", "expr": self.constant("0", 0)}))
            self.numbers = [*self.numbers, "fv", "fv"]
        if self.voice and self.fields and ("initial" in kinds or self.chance(0.35)):
            holds.append(self.form_grammar())
        parts = [self.item(kind, name) for kind, name in named]
        inputs = [name for kind, name in named if kind in ("field", "subdialog")]
        if inputs:
            parts += self.some(2, lambda: self.filled(inputs))
            self.random.shuffle(parts)
            parts = [*self.ordered(parts)]
        parts += self.some(2, self.handler) + (self.some(1, self.link) if self.chance(0.4) else [])
        return El("form", {"id": self.form}, [*holds, *parts])

    def kinds(self) -> list[str]:
        some = ["field", "field", "block"]
        if self.form != "s0" and any("s0" in names for names in self.forms.values()):
            some.append("subdialog")
        kinds = [self.random.choice(some) for _ in range(self.random.randint(1, 3))]
        if self.voice and "field" in kinds and self.chance(0.2):
            kinds.insert(self.random.randint(0, 1), "initial")
        return kinds

    def ordered(self, parts: Sequence[El]) -> list[El]:
        """The items in their order, with the form's ``filled`` anywhere between them."""
        items = iter(
            sorted((p for p in parts if p.tag != "filled"), key=lambda p: self.items.index(p.name))
        )
        return [one if one.tag == "filled" else next(items) for one in parts]

    def form_grammar(self) -> El:
        words = {}
        for word in self.random.sample((*WORDS, "mix", "both"), 2):
            chosen = self.random.sample(self.fields, self.random.randint(1, len(self.fields)))
            slots = chosen if self.chance(0.85) else ["other"]
            words[word] = {name: self.random.choice(WORDS) for name in slots}
        often = 0.8 if self.file == ROOT else 0.4
        scope = "document" if self.form != "s0" and self.chance(often) else None
        return El("grammar", {"scope": scope}, [], words)

    def filled(self, inputs: Sequence[str]) -> El:
        named = self.random.sample(inputs, self.random.randint(1, len(inputs)))
        has = {
            "namelist": " ".join(named) if self.chance(0.5) else None,
            "mode": self.random.choice((None, "any", "all")),
        }
        return El("filled", {**has}, [*self.content()])

    # Items -----------------------------------------------------------------------------

    def item(self, kind: str, name: str) -> El:
        cond = self.condition() if self.chance(0.15) else None
        first = self.constant("true", True) if kind == "block" else self.constant("'red'", "red")
        has = {"name": name, "cond": cond, "expr": first if self.chance(0.1) else None}
        if kind == "block":
            return El(kind, {**has}, [*self.content()])
        holds: list[El] = []
        if kind != "subdialog" or self.voice:
            holds += [self.prompt(), *self.some(2, self.prompt)]
        if kind == "field":
            has["modal"] = "true" if self.voice and self.chance(0.15) else None
            holds.append(El("grammar", {}, [], {word: {} for word in self.random.sample(WORDS, 2)}))
            holds += self.some(1, self.link) if self.voice and self.chance(0.25) else []
        if kind == "subdialog":
            places = [file for file, names in self.forms.items() if "s0" in names]
            file = self.random.choice(places)
            has["src"] = f"{'' if file == self.file else file}#s0"
            if self.chance(0.6):
                holds.append(El("param", {"name": "fv", "expr": self.number()}))
        holds += self.some(2, self.handler)
        if kind != "initial":
            holds += self.some(2, lambda: El("filled", {}, [*self.content()]))
        return El(kind, {**has}, [*holds])

    def prompt(self) -> El:
        cond = self.condition() if self.chance(0.2) else None
        count = self.random.choice((None, None, 2, 3))
        return El("prompt", {"count": count, "cond": cond}, [self.new("p")])

    def handler(self) -> El:
        if not self.voice and self.chance(0.25):
            return self.beside()
        tag = self.random.choice(("catch", "catch", "noinput", "nomatch"))
        every = (*CAUGHT, None) if self.voice else CAUGHT
        has = {
            "event": self.random.choice(every) if tag == "catch" else None,
            "count": self.random.choice((2, 2, 3)) if self.chance(0.4) else None,
            "cond": self.condition() if self.chance(0.15) else None,
        }
        content = self.content()
        if self.chance(0.5):
            content.insert(self.random.randint(0, len(content) - 1), El("reprompt"))
        return El(tag, {**has}, [*content])

    def beside(self) -> El:
        """A handler that runs beside a question: it says and throws nothing."""
        has = {
            "event": self.random.choice(("touch", "touch.head", "message", "touch message")),
            "count": 2 if self.chance(0.3) else None,
            "cond": self.condition() if self.chance(0.15) else None,
        }
        self.beside_others = True
        content = self.content()
        self.beside_others = False
        return El("catch", {**has}, [*content])

    # Code ------------------------------------------------------------------------------

    def constant(self, text: str, value: Value) -> Code:
        return Code(text, lambda _: value)

    def named(self) -> str:
        """A variable with a number, sometimes by the name of its scope."""
        name = self.random.choice(self.numbers)
        scope = {"av": "application", "dv": "document", "fv": "dialog"}.get(name)
        return f"{scope}.{name}" if scope and self.chance(0.25) else name

    def number(self) -> Code:
        name = self.named()
        if self.chance(0.3):
            return Code(name, lambda values: values[name])
        return Code(f"{name} + 1", lambda values: as_number(values[name]) + 1)

    def condition(self) -> Code:
        name, least = self.named(), self.random.randint(0, 3)
        kinds = [
            Code(f"{name} < {least}", lambda values: as_number(values[name]) < least),
            Code(f"{name} >= {least}", lambda values: as_number(values[name]) >= least),
            Code(f"{name} % 2 == 0", lambda values: as_number(values[name]) % 2 == 0),
        ]
        if self.fields:
            field, word = self.random.choice(self.fields), self.random.choice(WORDS)
            kinds += [
                Code(f"{field} == '{word}'", lambda values: values[field] == word),
                Code(f"{field} == undefined", lambda values: values[field] is None),
            ]
        return self.random.choice(kinds)

    def log(self) -> El:
        """Logs where it is, and the variables that it sees."""
        where, seen = self.new("l"), (*dict.fromkeys(self.numbers), *self.fields[:2])
        text = f"'{where}'" + "".join(f" + ' ' + {name}" for name in seen)

        def said(values: Values) -> str:
            return " ".join([where, *(shown(values[name]) for name in seen)])

        return El("log", {"expr": Code(text, said)})

    # Content ---------------------------------------------------------------------------

    def content(self, depth: int = 0) -> list[El]:
        made: list[El] = [self.log()]
        seen = self.numbers
        if self.chance(0.2):
            name = self.random.choice(("lv", *self.numbers))  # it may hide a wider one
            made.append(El("var", {"name": name, "expr": self.number()}))
            self.numbers = [*self.numbers, name, name]
        for _ in range(self.random.randint(0, 2)):
            kinds = [self.add] if self.beside_others else [self.say, self.say, self.add]
            if self.fields:
                kinds += [self.assign, self.clear]
            if depth < 2:
                kinds.append(lambda: self.branches(depth))
            made.append(self.random.choice(kinds)())
        if self.chance(0.25 if depth == 0 else 0.4):
            made.append(self.leave())
        self.numbers = seen  # a branch may not be taken
        return made

    def say(self) -> El:
        return El("say", {}, [self.new("p")])

    def add(self) -> El:
        name = self.named()
        more = Code(f"{name} + 1", lambda values: as_number(values[name]) + 1)
        return El("assign", {"name": name, "expr": more})

    def assign(self) -> El:
        word = self.random.choice(WORDS)
        value = self.constant(f"'{word}'", word)
        if self.chance(0.3):
            value = self.constant("undefined", None)
        return El("assign", {"name": self.random.choice(self.fields), "expr": value})

    def clear(self) -> El:
        named = self.random.sample(self.items, self.random.randint(1, len(self.items)))
        return El("clear", {"namelist": " ".join(named) if self.chance(0.7) else None})

    def branches(self, depth: int) -> El:
        holds: list[El] = self.content(depth + 1)
        if self.chance(0.3):
            holds.append(El("elseif", {"cond": self.condition()}, [*self.content(depth + 1)]))
        if self.chance(0.5):
            holds.append(El("else", {}, [*self.content(depth + 1)]))
        return El("if", {"cond": self.condition()}, [*holds])

    def leave(self) -> El:
        """What ends content."""
        kinds = [El("goto", {"next": self.target()})]
        if not self.beside_others:
            kinds.append(El("throw", {"event": self.random.choice(EVENTS)}))
        if self.items:
            kinds.append(El("goto", {"nextitem": self.random.choice(self.items)}))
        if self.chance(0.2):
            kinds.append(El("exit"))
        if self.form == "s0":
            named = self.random.choice(self.fields) if self.fields else None
            kinds += [El("return", {"event": "ev1"}), El("return", {"namelist": named})]
        return self.random.choice(kinds)


def as_number(value: Value) -> int:
    assert isinstance(value, int)
    return value
