"""The applications of a run: their interpreters, which are live, and how errors stay in one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, ParamSpec, TypeAlias, TypeVar

from prima.interpreter.application import Interpreter
from prima.interpreter.bounds import ElementVisit
from prima.interpreter.elements import Document
from prima.interpreter.protocol import App
from prima.interpreter.transfers import GoOut
from prima.language.commands import CommandType
from prima.language.values import moment
from prima.script.evaluation import EngineLost
from prima.script.isolated import Engines

if TYPE_CHECKING:
    from prima.voicexml.document import VoiceDocument

AnyDocument: TypeAlias = "Document | VoiceDocument"
AnyApp: TypeAlias = App[Any]


P = ParamSpec("P")
T = TypeVar("T")


class Applications:
    """The applications of a run, in declared order.

    Args:
        documents: the documents that they run.
        commands: the robot's Commands, by their names.
        date: when the run begins, by its own calendar.
        isolate: whose code runs in a process of its own.
    """

    def __init__(
        self,
        documents: Iterable[AnyDocument],
        commands: Mapping[str, CommandType],
        date: str,
        isolate: str,
    ) -> None:
        self._began = moment(date)
        self._engines = Engines(isolate)
        self._arguments = {name: frozenset(row.arguments) for name, row in commands.items()}
        self.documents = {document.id: document for document in documents}
        self.named = {name: self._made(one) for name, one in self.documents.items()}
        self.order = {name: index for index, name in enumerate(self.named)}
        self.loaded: set[str] = set()
        self.alive: list[AnyApp] | None = []
        """Those that are loaded and not over, in declared order; None if to be determined anew."""
        self.defects: list[Exception] = []
        """Errors in the interpreters themselves: each has ended its application."""

    def _made(self, document: AnyDocument) -> AnyApp:
        """The interpreter of a document; if its engine is unavailable, it ends at its start."""
        try:
            return self._interpreter(document)
        except EngineLost as error:
            return self._engines.without(error, lambda: self._interpreter(document))

    def _interpreter(self, document: AnyDocument) -> AnyApp:
        """The interpreter of a document in either language."""
        app: AnyApp
        if isinstance(document, Document):
            app = Interpreter(document, self._arguments, self._engines)
        else:
            from prima.voicexml.application import VoiceInterpreter

            app = VoiceInterpreter(document, self._engines)
        app.began = self._began
        return app

    def close(self) -> None:
        """End the processes in which code was evaluated."""
        self._engines.close()

    def drain_visits(self) -> list[ElementVisit]:
        """The elements reached since the last call, one application after the other."""
        found: list[ElementVisit] = []
        for app in self.named.values():
            found += app.visits
            app.visits.clear()
        return found

    # Driving ------------------------------------------------------------------

    def load(self, name: str) -> AnyApp | None:
        """Load an application, anew if it is over; None if it is already loaded."""
        app = self.named[name]
        if name in self.loaded:
            if not app.over:
                return None
            before, app = app, self._made(self.documents[name])
            app.visits[:0] = before.visits
            app.sends = before.sends
            self.named[name] = app
        self.loaded.add(name)
        self.alive = None
        return app

    def there(self, name: str) -> AnyApp | None:
        """The application of that name, if it has been loaded; it may be over."""
        return self.named.get(name) if name in self.loaded else None

    def living(self) -> list[AnyApp]:
        """Those that are loaded and not over, in declared order."""
        if self.alive is None:
            self.alive = [
                app for name, app in self.named.items() if name in self.loaded and not app.over
            ]
        return self.alive

    def alone(self, name: str) -> list[AnyApp]:
        """The application of that name, if it is live."""
        app = self.there(name)
        return [app] if app is not None and not app.over else []

    def guard(
        self, app: AnyApp, act: Callable[P, T], *given: P.args, **named: P.kwargs
    ) -> T | None:
        """Let an application's interpreter do something; an error ends that application alone (E2)."""
        try:
            return act(*given, **named)
        except Exception as error:
            self.fail(app, error)
            return None

    def fail(self, app: AnyApp, error: Exception) -> None:
        """End an application with an error."""
        if not isinstance(error, EngineLost | GoOut):
            self.defects.append(error)
        app.fail(error)
