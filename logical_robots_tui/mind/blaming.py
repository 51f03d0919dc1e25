"""Notices of a thought that failed, or whose recursions ended early: what did, on whose rows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.mind.decision import Notice, NoticeKind
from logical_robots_tui.mind.failures import FailureError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from logical_robots_tui.mind.asking import Asking
    from logical_robots_tui.mind.sqlite.moment import Moment, View, Within

__all__ = ["blame", "cut_offs"]


def blame(
    failure: FailureError,
    asking: Asking,
    needed: Iterable[str],
    moment: Moment,
    view: View,
    within: Within,
) -> Notice:
    """Say which predicate failed first, and on whose rows.

    Args:
        failure: What became of `Robot`.
        asking: Whom to ask for the predicates.
        needed: Predicates that `Robot` needs, those first that others of them need.
        moment: What was reasoned over.
        view: What failed of it.
        within: What the thought may use up.
    """
    whose = " and ".join(view.viewers[:3])
    if len(view.viewers) > 3:
        whose += " and others"
    if failure.slow:
        kind: NoticeKind = "late" if failure.late else "failed"
        return Notice(kind, f"The thought about {whose} failed: {failure}.")
    culprit, reason = "Robot", str(failure)
    for predicate in needed:
        try:
            asking.rows(predicate, moment, view, within)
        except FailureError as found:
            if not found.slow:
                culprit, reason = predicate, str(found)
            break
    alone = [
        only.viewers[0]
        for only in moment.one_by_one(view)
        if _fails(culprit, asking, moment, only, within)
    ]
    if 0 < len(alone) <= 3:
        whose = " and ".join(alone)
    return Notice("failed", f"{culprit} failed on the rows of {whose}: {reason}.")


def _fails(predicate: str, asking: Asking, moment: Moment, view: View, within: Within) -> bool:
    try:
        asking.rows(predicate, moment, view, within)
    except FailureError:
        return True
    return False


def cut_offs(asking: Asking, moment: Moment, view: View, within: Within) -> Iterator[Notice]:
    """A notice for each recursion that was still changing when it reached its last step."""
    for predicate, steps in asking.still_grew(moment, view, within):
        yield Notice(
            "recursion",
            f"The recursion of {predicate} was still growing after {steps} steps, what "
            f"lies further is missing: @Recursive({predicate}, N) says how far it goes.",
        )
