"""Opening the game: the level, the programs and the text that a player begins with."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.source import Source, load_program
from logical_robots_tui.player.continuing import level_to_begin_with, programs_to_begin_with
from logical_robots_tui.player.recorder import TOUR
from logical_robots_tui.player.session_state import Opening, Permissions
from logical_robots_tui.world import Level, LevelError, load_level
from logical_robots_tui.world.level import alike

if TYPE_CHECKING:
    from logical_robots_tui.game.replay import Replay
    from logical_robots_tui.player.open_games import OpenGames
    from logical_robots_tui.progress import Progress


def open_game(
    progress: Progress,
    data_dir: Path,
    level_name: str | None = None,
    programs: Sequence[str] = (),
    teams: Mapping[str, str] | None = None,
    *,
    start: int = 0,
    permissions: Permissions = Permissions(),  # noqa: B008 - immutable
    games: OpenGames | None = None,
) -> Opening:
    """Return what a game opens with: by default the last level, with the player's last program.

    `programs` follow the order of teams. Raises InputError if the level or a program can't be used.
    """
    level = load_level(level_name) if level_name else level_to_begin_with(progress)
    if start:
        from logical_robots_tui.game.measuring import named_start_of

        level = named_start_of(level, start)
    own = data_dir / "programs"
    sources, text = programs_to_begin_with(progress, level, programs, teams or {}, own)
    return Opening(
        level=level,
        sources=sources,
        data_dir=data_dir,
        text=text,
        welcome=not level_name and progress.fact(TOUR) is None,
        permissions=permissions,
        games=games,
    )


def open_replay(replay: Replay, data_dir: Path) -> Opening:
    return Opening(
        level=level_of(replay),
        sources=sources_of(replay, data_dir / "programs"),
        data_dir=data_dir,
        replay=replay,
    )


def level_of(replay: Replay) -> Level:
    """Return a replay's first level; the shipped level if it is the same."""
    level = replay.levels[0]
    try:
        shipped = load_level(replay.name)
    except LevelError:
        return level
    return shipped if alike(shipped, level) else level


def sources_of(replay: Replay, own: Path) -> dict[str, Source]:
    """Return each team's last program ("" without teams), the player's or shipped if equal."""
    name = re.sub(r"[^\w.-]+", "-", replay.texts[-1].name, flags=re.ASCII)[:40] or "replay"
    texts = replay.programs[replay.texts[-1].tick]
    if "" in texts:
        teams = [team.name for team in replay.levels[-1].teams]
        texts = dict.fromkeys(teams or [""], texts[""])
    return {
        team: _source_of(f"{name}-{team}" if team else name, part, own)
        for team, part in texts.items()
    }


def _source_of(name: str, text: str, own: Path) -> Source:
    try:
        source = load_program(name, own)
        if source.text == text:
            return source
        name += "-in-replay"
    except InputError:
        pass
    return Source(name, text, own / f"{name}.l", shipped=False)
