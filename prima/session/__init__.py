"""Applications and one mediator, wired: inbound values in, orders out.

A :class:`Session` owns no clock, thread or file. What it does is a function of its documents and of
what happens, so recording the inbound values is a journal, and feeding them again a replay.
"""

from __future__ import annotations

from prima.session.applications import AnyDocument
from prima.session.session import Session

__all__ = ["AnyDocument", "Session"]
