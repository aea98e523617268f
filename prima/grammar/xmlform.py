"""The XML form of SRGS 1.0, read into rules."""

from __future__ import annotations

from functools import partial

from prima.errors import suggestion
from prima.grammar.errors import Problems, other_rule
from prima.grammar.model import GrammarDocument, Part, Reference, Repeat, Rule, Special, Tag, Words
from prima.grammar.text import fold, keys, tokens
from prima.grammar.values import (
    MODES,
    RESERVED,
    choice,
    cost,
    decimal,
    name_problem,
    probability,
    repeat,
    sequence,
)
from prima.grammar.vocabulary import SRGS
from prima.grammar.xmlcheck import GrammarChecker
from prima.markup.spans import value_span
from prima.markup.tree import Node


def read_xml(
    node: Node, document: GrammarDocument, problems: Problems, inline: bool, lenient: bool = False
) -> None:
    """Read a <grammar> element into a document; ``inline`` if it is part of another one.

    ``lenient`` accepts a file without a namespace as SRGS.
    """
    _Reader(document, problems, inline, lenient).grammar(node)


class _Reader(GrammarChecker):
    """Reads one grammar; notes problems and continues."""

    def __init__(
        self, document: GrammarDocument, problems: Problems, inline: bool, lenient: bool
    ) -> None:
        super().__init__(problems)
        self.document = document
        self.inline = inline
        self.lenient = lenient

    # Header (section 4)

    def grammar(self, node: Node) -> None:
        spaces = (SRGS, "") if self.lenient else (SRGS,)
        if node.tag != "grammar" or (not self.inline and node.namespace not in spaces):
            remedy = f'Begin with <grammar xmlns="{SRGS}" version="1.0" ...>.'
            self.note(node, "wrong-root", f"<{node.tag}> is not a grammar of SRGS.", remedy)
            return
        self.space = node.namespace
        # Where it is part of a document, the document's checks know its attributes.
        self.attributes(node, set(node.attributes) if self.inline else {"scope"})
        if not self.inline and "scope" in node.attributes:
            message = "scope has no effect in a grammar's file."
            remedy = "Write it where VoiceXML names the file."
            self.problems.warn(
                partial(node.attribute_place, "scope"), "unknown-attribute", message, remedy
            )
        self._version(node)
        self._mode(node)
        self._language(node)
        document = self.document
        document.tag_format = node.get("tag-format").strip()
        document.formatted = partial(node.attribute_place, "tag-format")
        document.base = node.get("xml:base").strip()
        document.root = node.get("root").strip()
        self._children(node)
        if "root" in node.attributes and document.root not in document.rules:
            hint = other_rule(document.root, document.rules, *value_span(node, "root"))
            message = f'The root rule "{document.root}" is not there.'
            self.note(node, "no-such-rule", message, hint, "root")

    def _version(self, node: Node) -> None:
        version = node.get("version")
        if "version" not in node.attributes and not self.inline:
            self.note(node, "missing-attribute", "The version is missing.", 'Write version="1.0".')
        elif version.strip() != "1.0" and "version" in node.attributes:
            message = f'Version "{version}" of SRGS is not known.'
            self.note(node, "bad-value", message, 'Write version="1.0".', "version")

    def _mode(self, node: Node) -> None:
        mode = node.get("mode", self.document.mode or "voice")
        if mode not in MODES:
            message = f'A grammar\'s mode is voice or dtmf, not "{mode}".'
            self.note(node, "bad-value", message, 'Write mode="voice" or mode="dtmf".', "mode")
        self.document.mode = "dtmf" if mode == "dtmf" else "voice"

    def _language(self, node: Node) -> None:
        inherits = self.inline or self.lenient
        lang = node.get("xml:lang", self.document.lang if inherits else "")
        inherited = self.inline and lang
        if self.document.mode == "voice" and not (node.get("xml:lang") or inherited):
            tell = self.problems.warn if lang else self.problems.note
            message = "A grammar for voice says its language."
            remedy = 'Write xml:lang="en-US" or the like.'
            tell(partial(node.attribute_place, "xml:lang"), "missing-attribute", message, remedy)
        self.document.lang = lang or self.document.lang

    def _children(self, node: Node) -> None:
        self.no_text(node)
        seen_rule = False
        for child in node.nodes:
            if not self.known(child, node):
                continue
            if child.tag == "rule":
                seen_rule = True
                self._rule(child)
            else:
                if seen_rule:
                    message = f"<{child.tag}> comes after a rule."
                    self.note(child, "misplaced-element", message, "Put it before all rules.")
                self._header(child)

    def _header(self, node: Node) -> None:
        if node.tag == "tag":
            self.document.globals.append(Tag(node.own_text, partial(node.attribute_place, "")))
        elif node.tag == "lexicon" and not node.get("uri"):
            message, remedy = "<lexicon> needs a uri.", 'Write <lexicon uri="words.pls"/>.'
            self.note(node, "missing-attribute", message, remedy)
        elif node.tag == "meta":
            self._meta(node)

    def _meta(self, node: Node) -> None:
        given = [name for name in ("name", "http-equiv") if name in node.attributes]
        if len(given) != 1 or "content" not in node.attributes:
            message = "<meta> has content, and either a name or http-equiv."
            remedy = 'Write <meta name="author" content="..."/>.'
            self.note(node, "missing-attribute", message, remedy)
        self.document.meta[node.get("name") or node.get("http-equiv")] = node.get("content")

    # Rules (section 3)

    def _rule(self, node: Node) -> None:
        name = node.get("id").strip()
        if not name:
            self.note(node, "missing-attribute", "A rule needs an id.", 'Write <rule id="name">.')
        elif problem := name_problem(name):
            self.note(node, "bad-value", problem, "Choose another name.", "id")
        elif name in self.document.rules:
            self.note(node, "duplicate-id", f'There are two rules "{name}".', "Rename one.", "id")
        scope = node.get("scope", "private")
        if scope not in ("public", "private"):
            message = f'The scope of a rule is public or private, not "{scope}".'
            self.note(node, "bad-value", message, 'Write scope="public", or remove it.', "scope")
        before = len(self.problems.found)
        parts = self._parts(node)
        if not parts and len(self.problems.found) == before:
            message = f'The rule "{name}" holds nothing.'
            remedy = 'Write <ruleref special="NULL"/> for one that is matched by nothing said.'
            self.note(node, "empty", message, remedy)
        rule = Rule(name, sequence(parts), self.document, scope == "public")
        self.document.rules.setdefault(name, rule)

    # Expansions (section 2)

    def _parts(self, node: Node) -> list[Part]:
        """The expansions in a rule or an item."""
        parts: list[Part] = []
        for item in node.content:
            if isinstance(item, str):
                if item.strip() and (words := self._words(node, item)):
                    parts.append(words)
            elif not self.known(item, node):
                continue
            elif item.tag != "example":
                parts += self._part(item)
            elif parts:
                message = "<example> comes after the rule's expansion."
                self.note(item, "misplaced-element", message, "Put it first in the <rule>.")
        return parts

    def _part(self, node: Node) -> list[Part]:
        match node.tag:
            case "token":
                return self._token(node)
            case "ruleref":
                return self._ruleref(node)
            case "one-of":
                return self._one_of(node)
            case "tag":
                tag = Tag(node.own_text, partial(node.attribute_place, ""))
                self.document.tags.append(tag)
                return [tag]
            case _:
                self._number(node, "weight")  # without effect outside of <one-of>
                return [self._item(node)]

    def _words(self, node: Node, text: str) -> Part | None:
        """Text as tokens (section 2.1)."""
        found = tokens(text)
        if found is None:
            message, remedy = "A quote is opened and not closed.", 'Write the other ".'
            where = partial(node.text_place, text[text.rindex('"') :])
            self.problems.note(where, "bad-token", message, remedy)
            return None
        if "" in found:
            remedy = 'Write <ruleref special="NULL"/> for nothing.'
            self.note(node, "bad-token", "A token holds something.", remedy)
            return None
        return self._said(node, found)

    def _token(self, node: Node) -> list[Part]:
        text = node.text
        if not text or '"' in text:
            message = "<token> holds one token, without quotes."
            self.note(node, "bad-token", message, "Write <token>New York</token>.")
            return []
        words = self._said(node, [text])
        return [words] if words else []

    def _said(self, node: Node, found: list[str]) -> Part | None:
        if self.document.mode != "dtmf":
            return Words(fold(" ".join(found)), tuple(found))
        pressed = [keys(token) for token in found]
        for token, key in zip(found, pressed, strict=True):
            if key is None or len(key) != 1:
                message = f'"{token[:40]}" is not a telephone key.'
                remedy = "Keys are 0 to 9, *, #, and A to D, with spaces between them."
                self.problems.note(partial(node.text_place, token), "bad-token", message, remedy)
                return None
        shown = [key for key in pressed if key]
        return Words("".join(shown), tuple(shown))

    def _ruleref(self, node: Node) -> list[Part]:
        special, uri = node.get("special"), node.get("uri").strip()
        if ("special" in node.attributes) == ("uri" in node.attributes):
            message = "<ruleref> has either a uri or special."
            code = "exclusive" if "uri" in node.attributes else "missing-attribute"
            self.note(node, code, message, 'Write uri="#name" or special="NULL".')
            return []
        if "special" in node.attributes:
            if special not in RESERVED:
                message = f'"{special}" is not a special rule: they are NULL, VOID and GARBAGE.'
                remedy = (
                    suggestion(special, RESERVED, *value_span(node, "special"))
                    or 'Write uri="#name" for a rule of your own.'
                )
                self.note(node, "bad-value", message, remedy, "special")
            return [Special(special)]
        found = Reference(uri, partial(node.attribute_place, "uri"), node.get("type"))
        self.document.references.append(found)
        return [found]

    def _one_of(self, node: Node) -> list[Part]:
        parts: list[Part] = []
        weights: list[float | None] = []
        for child in node.nodes:
            if self.known(child, node):
                parts.append(self._item(child))
                weights.append(self._number(child, "weight"))
        if not parts:
            self.note(node, "missing-element", "<one-of> has no <item>.", "Write at least one.")
            return []
        return [choice(parts, weights)]

    def _item(self, node: Node) -> Part:
        inside = sequence(self._parts(node))
        chance = self._number(node, "repeat-prob")
        if "repeat" not in node.attributes:
            return inside
        try:
            low, high = repeat(node.get("repeat"))
        except ValueError as error:
            self.note(node, "bad-value", str(error), 'Write one such as "0-1".', "repeat")
            return inside
        if chance is None:
            return Repeat(inside, low, high)
        return Repeat(inside, low, high, cost(chance), cost(1 - chance))

    def _number(self, node: Node, name: str) -> float | None:
        """A weight or a repeat probability, if there is one."""
        text = node.attributes.get(name)
        if text is None:
            return None
        try:
            return probability(text) if name == "repeat-prob" else decimal(text, name)
        except ValueError as error:
            self.note(node, "bad-value", str(error), 'Write one such as "0.5".', name)
            return None
