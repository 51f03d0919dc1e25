"""An arena: in how many matches the leader changes, and how well simple programs do there."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from statistics import mean
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_least, at_most, summed_up
from logical_robots_tui import Program, load_level
from logical_robots_tui.game import load_program
from logical_robots_tui.game.frame import standing
from logical_robots_tui.game.measuring import play_through, start_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.mind import Mind

__all__ = ["arenas"]

ARENA = "16-high-ground"
SIMPLE = frozenset({"stand", "circle", "follow"})
PLAYERS = Path(__file__).with_name("programs") / "arenas"


@dataclass(frozen=True, slots=True)
class _Match:
    """Two players on the seats of red and blue; their shares, and whether the leader changed."""

    players: tuple[str, str]
    share: float
    has_new_leader: bool


def arenas(effort: Effort) -> Iterator[Measurement]:
    """Let programs of different ideas play everybody, and look who leads when."""
    texts = {path.stem: path.read_text("utf-8") for path in sorted(PLAYERS.glob("*.l"))}
    level = load_level(ARENA)
    names = (level.solution, level.starter)
    texts |= {name: load_program(name).text for name in names}
    if effort.is_quick:
        texts = {name: texts[name] for name in ("circle", "stand", *names)}
    cases = [
        ((pair if (number + start) % 2 else pair[::-1]), start)
        for start in range(1 if effort.is_quick else 2)
        for number, pair in enumerate(combinations(texts, 2))
    ]
    with ProcessPoolExecutor() as pool:
        programs = [(texts[red], texts[blue]) for (red, blue), _ in cases]
        matches = [
            _Match(players, *result)
            for (players, _), result in zip(
                cases, pool.map(_play, programs, [start for _, start in cases]), strict=True
            )
        ]
    shares = {name: mean(_shares(matches, name)) for name in texts}
    ranking = sorted(texts, key=lambda name: -shares[name])
    for rank, name in enumerate(ranking, 1):
        yield summed_up("arenas", f"{rank}. {name}, share", "%", [100 * shares[name]])
    half = {*ranking[: (len(ranking) + 1) // 2]}
    subject = f"simple programs in the upper half of {len(ranking)}"
    yield summed_up("arenas", subject, "", [len(half & SIMPLE)], target=at_most(0))
    good = [match for match in matches if half.issuperset(match.players)]
    changed = 100 * mean(match.has_new_leader for match in good)
    subject = f"{len(good)} matches of the upper half: the leader changes"
    yield summed_up("arenas", subject, "%", [changed], target=at_least(51))


def _shares(matches: list[_Match], name: str) -> Iterator[float]:
    for match in matches:
        if name in match.players:
            yield match.share if match.players[0] == name else 1 - match.share


def _play(texts: tuple[str, str], start: int) -> tuple[float, bool]:
    """Play a match; return red's share, and whether another team led than before at some tick."""
    level = start_of(load_level(ARENA), start)
    red, blue = (team.name for team in level.teams)
    leaders: list[str] = []
    points: dict[str, float] = {}

    def note_leader(frame: Frame, _mind: Mind) -> bool:
        points.update(standing(level, frame.after))
        if points[red] != points[blue]:
            leader = max(red, blue, key=points.__getitem__)
            if leader not in leaders[-1:]:
                leaders.append(leader)
        return False

    program = Program.compile({red: texts[0], blue: texts[1]})
    play_through(level, program, level.match_ticks, is_over=note_leader)
    total = points[red] + points[blue]
    return points[red] / total if total else 0.5, len(leaders) > 1
