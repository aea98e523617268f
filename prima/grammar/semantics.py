"""The meaning of an utterance by the tags of the matched rules (SISR 1.0).

Tags and the rules that are referred to are evaluated from left to right. Every matched rule has a
value: without tags it is that of the last rule that it refers to, or else the text of its tokens.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from prima.errors import Place
from prima.grammar.legacy import translate
from prima.grammar.model import GrammarDocument, Tag, Words
from prima.grammar.ranking import RuleFrame, Value
from prima.grammar.text import join
from prima.script.budget import Budget
from prima.script.evaluation import EngineLost, ScriptError
from prima.script.hoisting import in_turn
from prima.script.sandbox import NEXT

if TYPE_CHECKING:
    from prima.messages import Json


@dataclass(frozen=True, slots=True)
class SemanticError:
    """Why an utterance has no meaning: a tag failed (``error.semantic``)."""

    message: str
    place: Place

    def __str__(self) -> str:
        return f"{self.place}: {self.message}"


class TagFailed(Exception):
    """A tag failed."""

    def __init__(self, error: SemanticError) -> None:
        super().__init__(str(error))
        self.error = error


@dataclass(slots=True)
class _Result:
    """The value of one matched rule."""

    document: GrammarDocument
    home: GrammarDocument
    """The owner of the engine that holds the value, if any: itself, or a rule that passed it on."""
    first: int
    """Its tokens, by number."""
    last: int = 0
    value: Json = None
    box: Any = None
    """The value inside an engine, if it is in one."""
    tag: Tag | None = None
    """The last tag that ran for it, if any."""

    def place(self) -> Place:
        """Where the value comes from."""
        return self.tag.where() if self.tag is not None else self.home.where()


class TagInterpreter:
    """Interprets one analysis of an utterance."""

    def __init__(self, mode: str, budget: Budget) -> None:
        self.mode = mode
        self.budget = budget
        self.tokens: list[str] = []
        self.valued = False
        """Whether a built-in type has given a value."""
        self.last: Tag | None = None
        """The last tag executed, of any rule."""
        self._engines: dict[int, Any] = {}
        self._results: dict[int, _Result] = {}

    def interpret(self, top: RuleFrame) -> Json:
        """The value of the root rule.

        Raises:
            TagFailed: a tag failed.
        """
        self._read(top)
        todo = [self._evaluate(top)]
        while todo:
            inner = next(todo[-1], None)
            if inner is None:
                todo.pop()
            else:
                todo.append(self._evaluate(inner))
        return self._plain(self._results[id(top)])

    # Tokens

    def _read(self, top: RuleFrame) -> None:
        """Note the tokens of each rule: its tags may read all of them."""
        todo: list[tuple[RuleFrame, int]] = [(top, 0)]
        self._results[id(top)] = _result(top, 0)
        while todo:
            frame, at = todo.pop()
            while at < len(frame.events):
                event = frame.events[at]
                at += 1
                if isinstance(event, RuleFrame):
                    todo.append((frame, at))
                    todo.append((event, 0))
                    self._results[id(event)] = _result(event, len(self.tokens))
                    break
                self._token(event)
            else:
                self._results[id(frame)].last = len(self.tokens)

    def _token(self, event: Words | Tag | Value) -> None:
        if isinstance(event, Words):
            self.tokens += event.tokens
        elif isinstance(event, Tag):
            self.last = event
        else:
            self.tokens.append(event.text)
            self.valued = True

    def text(self, result: _Result | None = None) -> str:
        """The tokens of a rule, or all of them, as text."""
        found = self.tokens[result.first : result.last] if result else self.tokens
        return "".join(found) if self.mode == "dtmf" else join(found)

    # Values

    def _evaluate(self, frame: RuleFrame) -> Iterator[RuleFrame]:
        """Find the value of a rule; gives each rule that it refers to when its turn comes."""
        result = self._results[id(frame)]
        tags = [event for event in frame.events if isinstance(event, Tag)]
        if tags and result.document.dialect not in ("literals", "last"):
            yield from self._script(frame, result, tags)
            return
        yield from (event for event in frame.events if isinstance(event, RuleFrame))
        if tags:
            result.value = tags[-1].code.strip()
        else:
            self._default(frame, result)

    def _default(self, frame: RuleFrame, result: _Result) -> None:
        """The value of a rule without tags (SISR 1.0: default assignment)."""
        values = [event for event in frame.events if isinstance(event, RuleFrame | Value)]
        if not values:
            result.value = self.text(result)
            return
        slots = self._slots(values) if result.document.merges else None
        if slots is not None:
            result.value = slots
            return
        last = values[-1]
        if isinstance(last, Value):
            result.value = last.value
        else:
            inner = self._results[id(last)]
            result.value, result.box = inner.value, inner.box
            result.home, result.tag = inner.home, inner.tag

    def _slots(self, values: list[RuleFrame | Value]) -> dict[str, Json] | None:
        """The slots that rules have filled, later ones over earlier ones; None if there are none."""
        rules = [self._results[id(one)] for one in values if isinstance(one, RuleFrame)]
        slots = [plain for one in rules if isinstance(plain := self._plain(one), dict)]
        return {name: value for one in slots for name, value in one.items()} if slots else None

    def _plain(self, result: _Result) -> Json:
        return result.value if result.box is None else self._given(result, "json")

    def _given(self, result: _Result, way: Literal["json", "carry"]) -> Any:
        """A value of an engine as plain data."""
        engine = self._engine(result.home)
        try:
            return engine.json(result.box) if way == "json" else engine.carry(result.box)
        except EngineLost as error:
            raise EngineLost(f"{result.place()}: {error}") from None
        except ScriptError as error:
            failed = SemanticError(f"The value cannot be given: {error}.", result.place())
            raise TagFailed(failed) from None

    def _script(self, frame: RuleFrame, result: _Result, tags: list[Tag]) -> Iterator[RuleFrame]:
        """Run the tags of a rule; before those behind it comes each rule that it refers to."""
        engine = self._engine(result.document)
        legacy = result.document.dialect == "legacy"
        result.tag = tags[-1]
        codes = [translate(tag.code) if legacy else tag.code for tag in tags]
        _check(list(zip(tags, codes, strict=True)), result.document, engine)
        environment: Any = None
        try:
            environment = engine.environment(self.text(result), result.document.merges)
            result.box = engine.rule(_program(frame, in_turn(codes)), environment)
            for event in frame.events:
                if isinstance(event, RuleFrame):
                    yield event
                    inner = self._results[id(event)]
                    given = event.name, self._box(inner, result), self.text(inner)
                    result.box = engine.resume(environment, *given)
        except EngineLost as error:
            raise EngineLost(f"{tags[0].where()}: {error}") from None
        except ScriptError as error:
            reached = engine.reached(environment) if environment is not None else 0
            raise _failure(tags[min(reached, len(tags) - 1)], str(error)) from None

    def _box(self, inner: _Result, result: _Result) -> Any:
        engine = self._engine(result.document)
        if inner.box is None:
            return engine.box(inner.value)
        if inner.home is result.document:
            return inner.box
        return engine.take(self._given(inner, "carry"))

    def _engine(self, document: GrammarDocument) -> Any:
        """The engine of a document, in which its global tags have run (SISR 1.0: once)."""
        found = self._engines.get(id(document))
        if found is None:
            from prima.script.shared import IsolatedTagEngine

            found = self._engines[id(document)] = IsolatedTagEngine(self.budget, len(self._engines))
            _check([(tag, tag.code) for tag in document.globals], document, found)
            for tag in document.globals:
                try:
                    found.run(tag.code)
                except EngineLost as error:
                    raise EngineLost(f"{tag.where()}: {error}") from None
                except ScriptError as error:
                    raise _failure(tag, str(error)) from None
        return found


def _result(frame: RuleFrame, first: int) -> _Result:
    document = frame.rule.document
    return _Result(document, document, first)


def _program(frame: RuleFrame, codes: list[str]) -> str:
    """The tags of a rule as the body of a generator, which waits for each rule that it refers to."""
    pieces: list[str] = []
    numbered = enumerate(codes)
    for event in frame.events:
        if isinstance(event, Tag):
            number, code = next(numbered)
            pieces.append(f"{NEXT}.at = {number};\n{code}\n;")
        elif isinstance(event, RuleFrame | Value):
            pieces.append(f"yield {NEXT}; {NEXT}(out);")
    return "\n".join(pieces)


def _check(tags: list[tuple[Tag, str]], document: GrammarDocument, engine: Any) -> None:
    """Check that each tag is a script by itself (SISR 1.0 section 3); each is checked once.

    Raises:
        TagFailed: one is not.
    """
    known = document.faults
    for tag, code in tags:
        fault = known.get(code)
        if fault is None:
            fault = engine.fault(code)
            if not fault or fault.startswith("SyntaxError"):  # anything else is a lack of memory
                known[code] = fault
        if fault:
            raise _failure(tag, fault)


def _failure(tag: Tag, why: str) -> TagFailed:
    shown = json.dumps(" ".join(tag.code.split())[:60], ensure_ascii=False)
    return TagFailed(SemanticError(f"The tag {shown} failed: {why}.", tag.where()))
