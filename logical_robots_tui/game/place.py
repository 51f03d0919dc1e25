"""The position in a game, so that another session can return to it."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from logical_robots_tui.game.reference import level_key

if TYPE_CHECKING:
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.source import Source
    from logical_robots_tui.world import Level

__all__ = ["Place", "place_of"]


@dataclass(frozen=True, slots=True)
class Place:
    """A tick, and how to get there: same level, same programs, same ticks.

    Attributes:
        level: Name of a shipped level, otherwise the path of its file.
        title: The level's title.
        program: Name of the last program if it is a shipped one, otherwise the path of its file.
        tick: Number of the tick, at least 1.
        programs: The first tick that each program decided, and its text, in order.
    """

    level: str
    title: str
    program: str
    tick: int
    programs: tuple[tuple[int, str], ...]

    def as_text(self) -> str:
        """Serialise the place for `from_text`."""
        return json.dumps(asdict(self), ensure_ascii=False)

    @classmethod
    def from_text(cls, text: str) -> Place:
        """Parse a place.

        Raises:
            ValueError: The text is not a place.
        """
        try:
            found = json.loads(text)
            programs = tuple((int(begin), str(program)) for begin, program in found["programs"])
            level, title, program = (str(found[name]) for name in ("level", "title", "program"))
            place = cls(level, title, program, int(found["tick"]), programs)
        except (KeyError, TypeError, ValueError) as error:
            raise ValueError("this is not a place in a game") from error
        begins = [begin for begin, _ in place.programs]
        if begins[:1] != [1] or begins != sorted(set(begins)) or begins[-1] > place.tick:
            raise ValueError("the programs of this place are out of order")
        return place

    def stretches(self) -> list[tuple[str, int]]:
        """Return the programs' texts, each with the last tick that it decided."""
        ends = [begin - 1 for begin, _ in self.programs[1:]]
        return [
            (text, end) for (_, text), end in zip(self.programs, [*ends, self.tick], strict=True)
        ]


def place_of(game: Game, level: Level, source: Source) -> Place | None:
    """Return the position of a game.

    Args:
        game: The game.
        level: The level as saved in its file.
        source: The source of the program.

    Returns:
        None at the start, where there is nothing to return to, and if the level was edited on the
        way, because the tick can't be reproduced then.
    """
    history, tick = game.history, game.frame.tick
    if tick == 0 or history.level_at(0) is not level or history.is_changed_up_to(tick):
        return None
    programs = tuple((begin, program.text) for begin, program in history.programs(tick))
    program = source.name if source.shipped else str(source.path)
    return Place(level_key(level), level.title, program, tick, programs)
