"""Playing an asciicast in a terminal in memory."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pyte

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["events_of", "played"]


def events_of(path: Path) -> tuple[dict[str, Any], list[tuple[float, str, str]]]:
    """The head and the events of an asciicast of version 2, which must be well formed."""
    head, *events = [json.loads(line) for line in path.read_text("utf-8").splitlines()]
    assert head["version"] == 2
    assert all(len(event) == 3 and event[1] in ("o", "r") for event in events)
    times = [event[0] for event in events]
    assert times == sorted(times)
    return head, [tuple(event) for event in events]


def played(path: Path) -> pyte.Screen:
    """The screen as it is at the end."""
    head, events = events_of(path)
    screen = pyte.Screen(head["width"], head["height"])
    stream = pyte.Stream(screen)
    for _, kind, data in events:
        if kind == "r":
            columns, _, lines = data.partition("x")
            screen.resize(int(lines), int(columns))
        else:
            stream.feed(data)
    return screen
