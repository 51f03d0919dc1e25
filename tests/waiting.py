"""Waiting for something to become true, never for a time to pass."""

import threading
from collections.abc import Callable
from time import monotonic

__all__ = ["PATIENCE", "until"]

PATIENCE = 90.0  # seconds; generous, for machines that are busy with other things

_LOOK_AGAIN_AFTER = 0.02
_never = threading.Event()


def until(
    condition: Callable[[], object],
    otherwise: Callable[[], str] = str,
    *,
    patience: float = PATIENCE,
) -> None:
    """Return as soon as a condition holds.

    Args:
        condition: Looked at again and again.
        otherwise: What to say when patience runs out.
        patience: Seconds.
    """
    deadline = monotonic() + patience
    while not condition():
        assert monotonic() < deadline, f"not within {patience} s: {otherwise()}"
        _never.wait(_LOOK_AGAIN_AFTER)
