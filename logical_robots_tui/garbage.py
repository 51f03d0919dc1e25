"""How often Python looks for objects that keep only each other alive."""

from __future__ import annotations

import gc

__all__ = ["collect_later", "collect_seldom"]


def collect_seldom() -> None:
    """Let Python look for garbage in circles a thirtieth as often as it would.

    A tick, a picture and a compiled program are made of many thousand objects that go when they
    are no longer used. To look for circles among them took a tenth of the time. For commands, which
    have their process to themselves; a library leaves this to the program that uses it.
    """
    gc.set_threshold(20_000, 20, 20)
    gc.enable()


def collect_later() -> None:
    """Let Python look for nothing until ``collect_seldom``: what loads at a start is to stay."""
    gc.disable()
