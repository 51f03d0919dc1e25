"""The class at work, in words: who is in which level, what happened last, who asks for help."""

from __future__ import annotations

from datetime import datetime
from typing import NamedTuple

from logical_robots_tui.progress.board import Activity, Board
from logical_robots_tui.wording import clip, count_of, one_line

HEADINGS = ("STATE", "PLAYER", "LEVEL", "SINCE", "RUNS", "LAST WIN", "TROUBLE")

_WIDTHS = (5, 12, 16, 5, 4, 14, 200)  # characters
_LEVEL = 8  # characters of a level that was won: its number, and a little


class Pupil(NamedTuple):
    """What a player of a class does; `program` is the text of one who asks for help."""

    activity: Activity
    program: str | None

    def cells(self) -> tuple[str, ...]:
        """Return what stands in the columns of `HEADINGS`."""
        activity = self.activity
        state = "help" if activity.asks_for_help else "" if activity.is_open else "gone"
        victory = f"{clip(activity.won_level or '', _LEVEL)} {_time(activity.won)}"
        cells = (
            state,
            activity.player,
            activity.level,
            _time(activity.since),
            str(activity.runs or ""),
            victory,
            activity.trouble,
        )
        return tuple(
            clip(one_line(cell), width) for cell, width in zip(cells, _WIDTHS, strict=True)
        )

    def sentence(self) -> str:
        """Return everything but the program on one line."""
        activity = self.activity
        parts = [
            f"{activity.level} since {_time(activity.since)}" if activity.level else "no level"
        ]
        if activity.runs:
            parts.append(count_of(activity.runs, "run"))
        if activity.won_level:
            parts.append(f"won {activity.won_level} at {_time(activity.won)}")
        if activity.trouble:
            parts.append(activity.trouble.rstrip("."))
        if activity.asks_for_help:
            parts.append(f"asks for help since {_time(activity.help_since)}")
        if not activity.is_open:
            parts.append(f"gone since {_time(activity.last_seen)}")
        return one_line(f"{activity.player}: {', '.join(parts)}")


def pupils(board: Board) -> list[Pupil]:
    """Return all players as `Board.activities` orders them; raise InputError.

    When an open game reported last is left out, so that players are equal who look equal.
    """
    return [
        Pupil(
            activity._replace(last_seen="") if activity.is_open else activity,
            board.shown_program(activity.player) if activity.asks_for_help else None,
        )
        for activity in board.activities()
    ]


def _time(text: str | None) -> str:
    """Return a time as local hours and minutes, or if that is another day as month and day."""
    try:
        moment = datetime.fromisoformat(text or "").astimezone()
    except ValueError:
        return ""
    is_today = moment.date() == datetime.now().astimezone().date()
    return f"{moment:%H:%M}" if is_today else f"{moment:%m-%d}"
