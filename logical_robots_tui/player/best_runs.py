"""The player's best run of each level, kept as a replay."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import Superseded, level_key
from logical_robots_tui.paths import write_atomically
from logical_robots_tui.player.session_state import SessionListener, Ui
from logical_robots_tui.world.level import alike

if TYPE_CHECKING:
    from logical_robots_tui.game.history.history import History
    from logical_robots_tui.game.replay import Replay
    from logical_robots_tui.game.victory import Victory
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.world import Level

MOST_BYTES = 4_000_000
"""The largest file of a best run."""
MOST_RUNS = 200
"""How many best runs are kept; a level played longer ago loses its own."""


class BestRuns(SessionListener):
    """Keeps the run with the fewest ticks of those that won, then calls `on_kept`."""

    def __init__(self, session: Session, ui: Ui, folder: Path) -> None:
        self.on_kept: Callable[[], None] = lambda: None
        self._session, self._ui, self._folder = session, ui, folder

    def won(self, victory: Victory) -> None:
        history = self._session.history
        if victory.verdict == "counts" and history is not None and not history.first:
            self._ui.spawn(partial(self._keep, history, victory), "best run", exclusive=False)

    def path(self, level: Level) -> Path:
        from hashlib import sha256  # takes time that the first picture needs

        name = re.sub(r"[^\w-]+", "-", level.name, flags=re.ASCII)[:40]
        digest = sha256(level_key(level).encode("utf-8", "replace")).hexdigest()[:12]
        return self._folder / f"{name}-{digest}.replay"

    async def _keep(self, history: History, victory: Victory) -> None:
        from logical_robots_tui.editing.level_text import write_native
        from logical_robots_tui.game.replay import gather

        path, name = self.path(victory.level), self._session.source.name
        turns = history.turns
        try:
            is_best = await asyncio.to_thread(_is_best, path, victory)
            if not is_best or history.turns != turns:
                return
            replay = await gather(history, write_native, lambda _: name, last=victory.tick)
            await asyncio.to_thread(_write, path, replay)
        except Superseded:  # the robots went another way meanwhile
            pass
        except (InputError, OSError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            self._ui.warn(f"This run can't be kept to race against: {reason or error}")
        else:
            self.on_kept()


def _is_best(path: Path, victory: Victory) -> bool:
    """Return whether no better run is kept; one that can't be read is renamed."""
    from logical_robots_tui.game.replay import load_replay

    if not path.exists():
        return True
    try:
        best = load_replay(path)
    except InputError:
        path.replace(path.with_name(f"{path.stem}-unreadable{path.suffix}"))
        return True
    return best.last > victory.tick or not alike(best.levels[0], victory.level)


def _write(path: Path, replay: Replay) -> None:
    """Write a run, and remove the oldest of too many; raise InputError, OSError."""
    content = replay.to_bytes()
    if len(content) > MOST_BYTES:
        raise InputError(f"It takes {len(content):,} bytes.")
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(path, content)
    runs = sorted(path.parent.glob("*.replay"), key=lambda run: run.stat().st_mtime)
    for old in runs[:-MOST_RUNS]:
        old.unlink(missing_ok=True)
