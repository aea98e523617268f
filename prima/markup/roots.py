"""What kind of document a root element begins, and the problems of a wrong one."""

from __future__ import annotations

from collections.abc import Sequence

from prima.errors import DocumentError, Hint, Problem, argument, one_of, suggestion
from prima.errors.diagnoses.structure import WRONG_NAMESPACE, WRONG_ROOT
from prima.markup.spans import value_span
from prima.markup.tree import Node
from prima.markup.vocabulary import Vocabulary

APPLICATION, GRAMMAR = "an application", "a grammar"
NATIVE = "an application in PRIMA's language"
VOICEXML = "a VoiceXML document"
DOCUMENTS = {
    "urn:prima:dialogue:1": APPLICATION,
    "urn:prima:world:1": "a world",
    "urn:prima:robot:1": "a robot",
    "urn:prima:scenario:1": "a scenario",
    "urn:prima:user:1": "a user",
    "urn:prima:services:1": "a list of services",
    "http://www.w3.org/2001/06/grammar": GRAMMAR,
}
"""Kinds of documents by their namespaces."""
VOICEXML_NAMESPACE = "http://www.w3.org/2001/vxml"

OTHER_ROOT = WRONG_ROOT.says(
    "The root element is <{tag}>; it must be <{root}>.", "Begin with <{root}>."
)
OTHER_DOCUMENT = WRONG_NAMESPACE.says(
    "This is {own}; {wanted} is needed here.", "Name the file of {wanted}."
)
ROOT_HAS = WRONG_NAMESPACE.says("The root element <{tag}> has {found}.", "Begin with {wanted}.")


def check_root(root: Node, vocabularies: Sequence[Vocabulary]) -> Vocabulary:
    """Find the vocabulary of a document by its root element's namespace.

    Raises:
        DocumentError: it belongs to none of these vocabularies.
    """
    known = root.tag in [one.root_tag for one in vocabularies]
    for one in vocabularies:
        if (root.namespace, root.tag) == (one.namespace, one.root_tag):
            return one
        if root.namespace == one.namespace and not known:
            raise DocumentError([OTHER_ROOT.at(root.place, tag=root.tag, root=one.root_tag)])
    other = None if known else _other_document(root, vocabularies)
    raise DocumentError([other or _no_document(root, vocabularies)])


def _other_document(root: Node, vocabularies: Sequence[Vocabulary]) -> Problem | None:
    """The problem of a document of another kind."""
    own = kind_of(root)
    if not own:
        return None
    wanted = one_of(DOCUMENTS.get(one.namespace, VOICEXML) for one in vocabularies)
    if (own, wanted) == (VOICEXML, APPLICATION):
        wanted = NATIVE  # as a VoiceXML document is an application, too
    return OTHER_DOCUMENT.at(root.place, Hint(_use(root, own, wanted)), own=own, wanted=wanted)


def _no_document(root: Node, vocabularies: Sequence[Vocabulary]) -> Problem:
    """The problem of a root element whose namespace is unknown or missing."""
    found = f'namespace "{root.namespace}"' if root.namespace else "no namespace"
    known = [(one.root_tag, one.namespace) for one in vocabularies]
    likely = [one for one in known if one[0] == root.tag]
    if not likely and "prima" in dict(known) and _seems_voicexml(root):
        likely = [("vxml", VOICEXML_NAMESPACE)]
    likely = likely or known
    wanted = " or ".join(f'<{tag} xmlns="{space}">' for tag, space in likely)
    spaces = [space for _, space in likely if space != root.namespace]
    near = suggestion(root.namespace, spaces, *value_span(root, "xmlns"))
    place = root.source.place(root.index, "xmlns", value=True)
    return ROOT_HAS.at(place, near, tag=root.tag, found=found, wanted=wanted)


def _seems_voicexml(root: Node) -> bool:
    """Whether a document whose root element is none of PRIMA's is meant to be VoiceXML."""
    return root.namespace == VOICEXML_NAMESPACE or root.source.file.lower().endswith(".vxml")


def kind_of(root: Node) -> str:
    """The kind of document that an element is the root of, such as ``a world``; or nothing."""
    if root.tag == "vxml" and root.namespace in ("", VOICEXML_NAMESPACE):
        return VOICEXML
    return DOCUMENTS.get(root.namespace, "")


def _use(root: Node, own: str, wanted: str) -> str:
    """How to use a document of its own kind, where another is wanted; or nothing."""
    if own == GRAMMAR:
        return 'An application names it by <grammar src="..."/>.'
    if wanted != "a scenario" or own not in (APPLICATION, VOICEXML):
        return ""
    option = f"--{root.get('kind', 'ea')} {argument(root.source.file)}"
    return (
        f"prima run, talk and live take it by {option}."
        ' A scenario names it by <application src="..."/>.'
    )
