"""A victory: what it counts for, and keeping it. With a screen and without it is the same."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias

from logical_robots_tui.game.reference import count_rules
from logical_robots_tui.game.source import shipped_texts
from logical_robots_tui.progress import Measures
from logical_robots_tui.world.level import alike

if TYPE_CHECKING:
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.history.history import History
    from logical_robots_tui.mind import Program
    from logical_robots_tui.progress import Progress
    from logical_robots_tui.world import Level

__all__ = ["Verdict", "Victory", "is_by_the_book", "keep_victory", "result_line", "victory_of"]

Verdict: TypeAlias = Literal["counts", "reference", "clock", "edited"]

_REFUSALS: dict[Verdict, str] = {
    "clock": "A thought was ended by the clock on the way: this victory is not kept.",
    "edited": "The level was changed by hand: this victory is not kept.",
}


class Victory(NamedTuple):
    """The tick in which a level was won.

    Attributes:
        level: Where, as it is in its file.
        program: What the robots thought with at the end.
        tick: Its number.
        verdict: Whether it ``counts`` for the player, is that of the ``reference`` program, or is
            not kept because a ``clock`` ended a thought or somebody ``edited`` the level.
        measures: How good it is; None if other programs decided on the way, too.
    """

    level: Level
    program: Program
    tick: int
    verdict: Verdict
    measures: Measures | None

    @property
    def refusal(self) -> str:
        """Why it is not kept, one sentence, or ""."""
        return _REFUSALS.get(self.verdict, "")


def victory_of(game: Game, level: Level) -> Victory | None:
    """The victory at the present tick of a game, or None if it is not the tick of one.

    Args:
        game: The game.
        level: Its level as it is in its file.
    """
    tick, program, history = game.frame.tick, game.program, game.history
    if game.won_at != tick:
        return None
    verdict: Verdict = "counts"
    if not history.is_reliable_up_to(tick):
        verdict = "clock"
    elif not is_by_the_book(history, level, tick):
        verdict = "edited"
    elif level.solution and program.text == shipped_texts().get(level.solution):
        verdict = "reference"
    measures = None
    if history.is_all_by(program.text, tick):
        measures = Measures(tick, count_rules(program.text), history.driven(tick))
    return Victory(level, program, tick, verdict, measures)


def is_by_the_book(history: History, level: Level, tick: int) -> bool:
    """Whether all up to a tick happened in a level as it is in its file."""
    return not history.is_changed_up_to(tick) and alike(history.level_at(0), level)


def keep_victory(progress: Progress, key: str, victory: Victory) -> None:
    """Keep a victory that counts in the record of the level with that key. Blocks."""
    if victory.verdict == "counts":
        progress.win(key, victory.program.text, victory.measures)


def result_line(level: Level, measures: Measures) -> str:
    """Return a result as a line of text to share.

    Args:
        level: Where it was achieved.
        measures: How good it is.
    """
    rules = f"{measures.rules} rule{'s' * (measures.rules != 1)}"
    line = f"Logical Robots · {level.title} · {measures.ticks:,} ticks · {rules}"
    line += f" · {measures.distance:,.0f} units driven"
    if measures.wins is not None:
        line += f" · {measures.wins} of {measures.starts} starts"
    return line
