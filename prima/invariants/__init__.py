"""Invariants of every run, recomputed from a transcript's records alone.

No code of the mediator is used here: working memory, trees, floor, engagement
and reactions are rebuilt from requests, starts, ends, cancellations,
failures, events and windows, by the numbered rules of the mediation. The
mediator's records of its own view (``floor``, ``suspend``, ``resume``, ``hold``,
``decision``, ``stop``, ``stream-end``) are not trusted: they are claims that are
compared with the rebuilt state. So are the extensions' ``held``, ``interrupt`` and
``inserted``, the rules of ``start``, ``decision`` and ``floor``, and the outcomes of ``floor``
and ``cancel``.

The following is trusted: that a state was left of which nothing remained, if its application
requests nothing afterwards and does not end; the rule and outcome of ``unload``; and that an
application has ended on its own: if that cancels nothing by E2, no other record shows it, so a
missing ``unload`` is found only if something is cancelled, or the application was removed from
the robot. The rule of ``cancel`` has to be justified; where two rules apply, either is accepted.
An AB that follows one that failed (E1), or is in an interrupted unit (X2), may be recorded as
linked or waiting when it is cancelled. Under a baseline policy a decision's rule is trusted, and
its start has to agree with it.

Each file is a family of rules and builds on those before it: ``model``,
``table`` (Table 4.2), ``memory``, ``channel`` (K, C5), ``turn`` (X7), ``floor`` (F, C2),
``extensions`` (X), ``late`` (X8, X10), ``streams`` (C, O1), ``patience`` (E6), ``selection`` (S),
``endings`` (O2, O3, E, U5), ``leaving`` (O3), ``telling`` (fields common to records), ``starts``,
``checker``.

The extensions relax some invariants, and each may do no more than that:

- X1, X4, X9: an AB that the mediator inserted starts before the one for which it was
  inserted (4), counts as its reaction's start (6), and is there only for a reason (11);
- X2: only a restartable AB is interrupted, only for a reaction that starts in that
  instant (2), and it starts again from its beginning (3); a reaction that finds
  nothing else in its way does not wait (6);
- X3: a held stream is open, so it keeps channel and floor (5, 7); it is held
  exactly as long as requested (10);
- X5: one free and one faithful motion share devices (1); a loop that only carries
  the floor's stream may start beside it (7);
- X8: a reaction with a time limit is deleted once that is over, and a question may
  be answered before it is asked (3, 16); X10: no other application's question takes a late answer (16);
- X9: the words are said once after each break in which others have spoken (11, 16);
- X7: the asker's response to an answer starts though another has the floor (5), and before
  reactions (6); nobody speaks before it (16).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import TYPE_CHECKING

from prima.interpreter.elements import Document
from prima.invariants.checker import violations
from prima.invariants.memory import Memory
from prima.invariants.model import Record

if TYPE_CHECKING:
    from prima.session import AnyDocument

__all__ = ["callers", "check"]


def check(
    records: Iterable[Record],
    policy: str = "prima",
    declared: Sequence[str] = (),
    patience: int | None = None,
    calling: Collection[str] = (),
) -> list[str]:
    """Violations of all invariants but 8 and 9 in a run; of 1 to 5 under a baseline policy.

    10: a held stream is held as long as requested (X3). 11: what the mediator itself inserts
    has a reason, and takes the place of the AB for which it is inserted (X1, X4). 12: of all
    ABs that could start, the first by S2 starts first. 13: the records on floor, suspensions,
    decisions and reasons to wait are true. 14: a body that moves without a next loop is
    stopped (F5). 15: requests agree with Table 4.2, O1, C3, C5 and U5. 16: a user who has just
    answered hears the asker first (X7), and one who hears a topic again hears its words (X9); no
    reaction waits beyond its time (X8), and no other question takes a late answer (X10).

    ``declared`` are the applications in the order of their declaration (S2f), if neither
    the records nor the order of loading shows it; ``patience`` is E6's bound (ms), if the records
    do not show it. ``calling`` are those that have subdialogs, or are VoiceXML: their states need
    not have been left before another one makes a request. Under ``none`` invariant 1 is expected
    to fail: nothing keeps devices apart.
    """
    return violations(Memory(records, policy, declared, calling, patience))


def callers(documents: Iterable[AnyDocument]) -> set[str]:
    """Applications whose states may go on while another makes requests: for ``calling``."""
    return {
        one.id
        for one in documents
        if not isinstance(one, Document) or any(n.tag == "subdialog" for n in one.node.walk())
    }
