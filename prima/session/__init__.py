"""Applications connected to one mediator: inbound values in, orders out.

A :class:`Session` owns no clock, thread or file. Its output is a function of its documents and of
its inbound values, so recording these yields a journal, and feeding them in again a replay.
"""

from __future__ import annotations

from prima.session.applications import AnyDocument
from prima.session.session import Session

__all__ = ["AnyDocument", "Session"]
