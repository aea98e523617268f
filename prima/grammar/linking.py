"""Resolving rule references, inside a document and to others (SRGS 2.2)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from urllib.parse import urlsplit

from prima.errors import Hint, PrimaError, Span, meant
from prima.errors.diagnoses.names import RELATIVE
from prima.grammar.builtin import WrongParameter, built_in, uri_mode
from prima.grammar.errors import (
    GrammarError,
    NotThere,
    Problems,
    UnsupportedBuiltIn,
    UnsupportedFormat,
    Where,
    other_rule,
)
from prima.grammar.legacy import FORMATS, settle
from prima.grammar.media import check_form, check_known, media_type
from prima.grammar.model import GrammarDocument, Mode, Reference, Rule
from prima.grammar.prefixes import index_choices
from prima.markup.uris import join, parted

REMOTE = "Only a VoiceXML application fetches it, in a run with --allow-host."
MOST_DOCUMENTS = 64
MOST_BYTES = 20_000_000
"""The maximum number of documents of one grammar, and their total size."""

Fetch = Callable[[str], bytes]
Refusal = Callable[[str, str], str]
"""Returns why one grammar may not refer to another, by their URIs; empty if it may."""
Written = Callable[[str], tuple[Span, ...]]
"""Finds a part of a URI as the document writes it."""
Read = Callable[["Library", str, bytes, str], GrammarDocument]
"""Reads the bytes of a URI, with its media type if known, into a document."""
FAILURES = (OSError, LookupError, ValueError, PrimaError)
"""Exceptions of fetching a document that is unavailable."""


class Library:
    """The documents of one grammar, each read once."""

    def __init__(self, fetch: Fetch | None, read: Read, refusal: Refusal | None = None) -> None:
        self.problems = Problems()
        self.documents: dict[str, GrammarDocument | None] = {}
        self._fetch = fetch
        self._read = read
        self._refusal = refusal
        self._bytes = 0
        self._unlinked: list[GrammarDocument] = []
        self._linked: list[GrammarDocument] = []

    def add(self, document: GrammarDocument) -> None:
        """Add a document whose references are to be resolved."""
        if document.uri:
            self.documents.setdefault(document.uri, document)
        self._unlinked.append(document)

    def link(self) -> None:
        """Resolve all references, and those of the documents that they lead to."""
        while self._unlinked:
            document = self._unlinked.pop(0)
            self._linked.append(document)
            self._format(document)
            for reference in document.references:
                if self.problems.full:
                    return
                rule = self._resolve(document, reference)
                if rule is not None:
                    reference.resolve(rule)
        if not self.problems.found:
            index_choices(self._linked)

    def fetch(self, uri: str, media: str, where: Where, written: Written) -> GrammarDocument | None:
        """The document of a URI, fetched on first use; problems are noted."""
        try:
            check_known(media_type(media), where(), "")
        except GrammarError as error:
            self._refused(error)
            return None
        if uri in self.documents:
            found = self.documents[uri]
        else:
            found = self._first(uri, media, where, written)
        if found is not None:
            check_form(self.problems, media_type(media), found.form, uri, where)
        return found

    def _first(
        self, uri: str, media: str, where: Where, written: Written
    ) -> GrammarDocument | None:
        self.documents[uri] = None
        if self._fetch is None:
            message = f'Nothing fetches the grammar "{uri[:200]}" here.'
            self.problems.note(where, "not-fetched", message, "Give load() a function fetch.")
            return None
        if len(self.documents) > MOST_DOCUMENTS:
            message = f"This grammar is made of more than {MOST_DOCUMENTS} documents."
            self.problems.note(where, "too-large", message)
            return None
        try:
            data = self._fetch(uri)
        except FAILURES as error:
            message = f'The grammar "{uri[:200]}" cannot be fetched: {error}.'
            remedy = Hint(REMOTE if uri.startswith(("http:", "https:")) else RELATIVE)
            other = error.meant if isinstance(error, NotThere) else ""
            folder, slash, last = uri.rpartition("/")
            if other and (spans := written(uri)):
                hint = meant(f"{folder}{slash}{other}", *spans)
            else:
                hint = meant(other, *written(last)) if other else remedy
            self.problems.note(where, "no-such-file", message, hint)
            return None
        self._bytes += len(data)
        if self._bytes > MOST_BYTES:
            message = f"The documents of this grammar have more than {MOST_BYTES:,} bytes."
            self.problems.note(where, "too-large", message)
            return None
        return self._take(uri, data, media)

    def _refused(self, error: GrammarError) -> None:
        """Note what is wrong with another document; it determines the error unless more is wrong."""
        if not self.problems.found:
            self.problems.kind = type(error)
        self.problems.extend(error.problems)

    def _take(self, uri: str, data: bytes, media: str) -> GrammarDocument | None:
        try:
            document = self._read(self, uri, data, media)
        except GrammarError as error:
            self._refused(error)
            return None
        self.documents[uri] = document
        self._unlinked.append(document)
        return document

    def _format(self, document: GrammarDocument) -> None:
        """Check the tag format (SRGS 4.8)."""
        if document.tag_format in FORMATS:
            settle(document)
        elif document.tags or document.globals:
            message = f'The tag format "{document.tag_format[:80]}" is not known.'
            known = "Known are semantics/1.0 and semantics/1.0-literals."
            where = document.formatted or document.where
            self.problems.unsupported(UnsupportedFormat, where, "tag-format", message, known)

    # References

    def _resolve(self, document: GrammarDocument, reference: Reference) -> Rule | None:
        uri = reference.uri
        if uri.startswith("#"):
            return self._local(document, reference, parted(uri)[1])
        if uri.startswith("builtin:"):
            return self._built_in(document, reference)
        if not uri:
            self.problems.note(reference.where, "bad-value", "The reference names no rule.")
            return None
        try:
            base = document.uri
            if document.base:  # SRGS 4.9
                base = joined(base, document.base, document.where)
            where, name = parted(joined(base, uri, reference.where))
        except GrammarError as error:
            self.problems.extend(error.problems)
            return None
        if self._refusal is not None and (why := self._refusal(document.uri, where)):
            self.problems.note(reference.where, "no-such-file", f'"{where[:200]}": {why}.')
            return None
        if where == document.uri:
            found: GrammarDocument | None = document
        else:
            written = partial(_word_in, reference)
            found = self.fetch(where, reference.media, reference.where, written)
        if found is None:
            return None
        return self._external(document, found, reference, name)

    def _local(self, document: GrammarDocument, reference: Reference, name: str) -> Rule | None:
        rule = document.rules.get(name)
        if rule is None:
            hint = other_rule(name, document.rules, _name_in(reference, name))
            message = f'There is no rule "{name[:80]}".'
            self.problems.note(reference.where, "no-such-rule", message, hint)
        return rule

    def _external(
        self, document: GrammarDocument, found: GrammarDocument, reference: Reference, name: str
    ) -> Rule | None:
        """A rule of another document: its root, or a public one."""
        note = self.problems.note
        if found.mode != document.mode:
            self._other_mode(document, found.mode, reference)
            return None
        name, named = name or found.root, bool(name)
        rule = found.rules.get(name)
        if not name:
            message = f'The grammar "{found.uri}" names no root rule.'
            note(reference.where, "no-root", message, f"Name a rule: {found.uri}#name.")
        elif rule is None:
            hint = other_rule(name, found.public(), _name_in(reference, name))
            note(reference.where, "no-such-rule", f'There is no rule "{name[:80]}" there.', hint)
        elif named and not rule.public and found is not document:
            message = f'The rule "{name}" is private to its grammar.'
            public = f'"public ${name} = ...;"' if found.form == "ABNF" else 'scope="public"'
            remedy = f"Refer to {found.uri}." if name == found.root else f"Write {public} there."
            note(reference.where, "private-rule", message, remedy)
            return None
        return rule

    def _other_mode(self, document: GrammarDocument, mode: Mode, reference: Reference) -> None:
        """Note a reference to a grammar of the other mode (SRGS 4.6)."""
        message = f"A grammar for {document.mode} refers to one for {mode}."
        remedy = f"Refer to one for {document.mode}."
        self.problems.note(reference.where, "mode", message, remedy)

    def _built_in(self, document: GrammarDocument, reference: Reference) -> Rule | None:
        try:
            found = built_in(reference.uri, document.lang)
        except ValueError as error:
            kind = UnsupportedBuiltIn
            remedy = error.remedy if isinstance(error, WrongParameter) else ""
            self.problems.unsupported(kind, reference.where, "no-such-name", str(error), remedy)
            return None
        if (mode := uri_mode(reference.uri)) and mode != document.mode:
            self._other_mode(document, mode, reference)
            return None
        home = GrammarDocument("", reference.where, dialect="literals")
        home.rules[found.name] = Rule(found.name, found, home)
        return home.rules[found.name]


def joined(base: str, uri: str, where: Where) -> str:
    """A URI resolved against a base.

    Raises:
        GrammarError: one of them is not a URI.
    """
    try:
        urlsplit(uri)
        urlsplit(base)
    except ValueError as error:
        message = f'"{uri[:80]}" is not a URI: {error}.'
        raise GrammarError.of(where(), "bad-value", message) from None
    return join(base, uri)


def _word_in(reference: Reference, word: str) -> tuple[Span, ...]:
    """A part of a reference as written, if it is there."""
    at, place = reference.uri.find(word), reference.where()
    before = place._replace(column=place.column + reference.lead + at)
    return () if at < 0 else (Span.of(before, word),)


def _name_in(reference: Reference, name: str) -> Span:
    """The rule's name in a reference as written."""
    place = reference.where()
    before = reference.lead + reference.uri.find("#") + 1
    return Span.of(place._replace(column=place.column + before), name)
