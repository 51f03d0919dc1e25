"""How often Python's garbage collector looks for reference cycles."""

from __future__ import annotations

import gc


def collect_seldom() -> None:
    """Run the cycle collector a thirtieth as often as by default.

    A tick, a screen update and a compiled program consist of many thousand objects that reference
    counting frees. Looking for cycles among them took a tenth of the time. Only commands call this,
    because they own their process; a library leaves it to the program that uses it.
    """
    gc.set_threshold(20_000, 20, 20)
    gc.enable()


def collect_later() -> None:
    """Turn the collector off until ``collect_seldom``: objects loaded at the start stay alive."""
    gc.disable()
