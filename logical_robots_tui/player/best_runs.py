"""The player's best run of each level, kept as a replay."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.editing.level_text import write_native
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
    """Keeps the run with the fewest ticks of those that won; `kept` is called after that."""

    def __init__(self, session: Session, ui: Ui, folder: Path) -> None:
        self.kept: Callable[[], None] = lambda: None
        self._session, self._ui, self._folder = session, ui, folder

    def won(self, victory: Victory) -> None:
        history = self._session.history
        if victory.verdict == "counts" and history is not None and not history.first:
            self._ui.spawn(partial(self._keep, history, victory), "best run", exclusive=False)

    def path(self, level: Level) -> Path:
        name = re.sub(r"[^\w-]+", "-", level.name, flags=re.ASCII)[:40]
        digest = sha256(level_key(level).encode("utf-8", "replace")).hexdigest()[:12]
        return self._folder / f"{name}-{digest}.replay"

    async def _keep(self, history: History, victory: Victory) -> None:
        from logical_robots_tui.game.replay import gather

        path, name = self.path(victory.level), self._session.source.name
        try:
            replay = await gather(history, write_native, lambda _: name, last=victory.tick)
            is_best = await asyncio.to_thread(_keep_best, path, replay)
        except Superseded:
            return
        except (InputError, OSError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            self._ui.warn(f"This run can't be kept to race against: {reason or error}")
            return
        if is_best:
            self.kept()


def _keep_best(path: Path, replay: Replay) -> bool:
    """Write a run unless a better one is there, and return whether; raise InputError, OSError."""
    from logical_robots_tui.game.replay import load_replay

    path.parent.mkdir(parents=True, exist_ok=True)
    if path.exists():
        try:
            known = load_replay(path)
        except InputError:
            path.replace(path.with_name(f"{path.stem}-unreadable{path.suffix}"))
        else:
            if known.last <= replay.last and alike(known.levels[0], replay.levels[0]):
                return False
    content = replay.to_bytes()
    if len(content) > MOST_BYTES:
        raise InputError(f"it takes {len(content):,} bytes.")
    write_atomically(path, content)
    runs = sorted(path.parent.glob("*.replay"), key=lambda run: run.stat().st_mtime)
    for old in runs[:-MOST_RUNS]:
        with suppress(OSError):
            old.unlink()
    return True
