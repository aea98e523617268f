"""URIs in documents, most of which name files beside the document."""

from __future__ import annotations

import posixpath
from urllib.parse import quote, unquote, urldefrag, urljoin, urlsplit


def legal(uri: str) -> str:
    """A legal URI: an illegal one, such as ``http://[``, is made harmless."""
    try:
        urlsplit(uri)
    except ValueError:
        return quote(uri, safe="%/?#:=&")
    return uri


def join(base: str, uri: str) -> str:
    """A URI resolved against its base; one that leads out of the folder begins with ``..``."""
    if not uri:
        return base
    uri = legal(uri)
    if urlsplit(base).scheme or urlsplit(uri).scheme or uri.startswith(("#", "?", "/")):
        return urljoin(base, uri)
    path, mark, rest = uri.partition("#")
    path, query, asked = path.partition("?")
    folder = posixpath.dirname(base.partition("#")[0].partition("?")[0])
    whole = posixpath.normpath(posixpath.join(folder, path))
    end = "/" if path.rpartition("/")[2] in ("", ".", "..") else ""
    return f"{whole}{end}{query}{asked}{mark}{rest}"


def parted(uri: str) -> tuple[str, str]:
    """A URI without its fragment, and the decoded fragment: ``%C3%A9`` is ``é``."""
    base, fragment = urldefrag(uri)
    return base, unquote(fragment)
