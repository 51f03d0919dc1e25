"""The ghost: shows another run beside the present one, and tells who reaches areas first."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.ghost import BEST, REPLAY, ghost_of, reached_areas
from logical_robots_tui.player.session_state import SessionListener
from logical_robots_tui.wording import clip, count_of, one_line
from logical_robots_tui.world.level import alike

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame
    from logical_robots_tui.game.replay import Replay
    from logical_robots_tui.player.best_runs import BestRuns
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.tui.app.ui import Dialogs
    from logical_robots_tui.tui.labyrinth.view import LabyrinthView
    from logical_robots_tui.world import Level


class GhostController(SessionListener):
    """Switches the ghost; `replays` is the folder of saved ones."""

    def __init__(
        self, session: Session, ui: Dialogs, view: LabyrinthView, best: BestRuns, replays: Path
    ) -> None:
        self._session, self._ui, self._view = session, ui, view
        self._best, self._replays = best, replays
        self._reached: dict[int, int] = {}
        self._tick = self._turns = 0
        best.on_kept = self._best_kept

    async def toggle(self) -> None:
        """Show the player's best run of the level, or no ghost."""
        if self._view.ghost is not None:
            self._view.ghost = None
            self._ui.tell("The ghost is off.")
        else:
            await self._race_best(is_new=False)

    async def choose(self) -> None:
        from logical_robots_tui.tui.library.chooser import Chooser, ReplayShelf

        shelf = ReplayShelf(self._replays, "Race a replay", does="race")
        replay = await self._ui.ask(Chooser["Replay"](shelf, ""))
        if replay is not None:
            await self.race(replay, REPLAY)

    def level_opened(self, level: Level) -> None:
        self._view.ghost = None
        self.restarted()

    def level_changed(self) -> None:
        ghost = self._view.ghost
        if ghost is not None and not alike(ghost.level, self._session.level):
            self._view.ghost = None
            self._ui.tell("The level was changed: the ghost is off.")

    def restarted(self) -> None:
        self._reached.clear()
        self._tick = 0

    def tick_shown(self, frame: Frame) -> None:
        """Note which areas are reached, once in each run; tell it if there is a ghost."""
        is_next, self._tick = frame.tick == self._tick + 1, frame.tick
        history = self._session.history
        if history is not None and history.turns != self._turns:
            self._turns = history.turns
            reached_ticks = self._reached.items()
            self._reached = {area: tick for area, tick in reached_ticks if tick < frame.tick}
        level, ghost = self._session.level, self._view.ghost
        for area, name in reached_areas(level, frame.after):
            if area in self._reached:
                continue
            self._reached[area] = frame.tick
            if ghost is not None and is_next and frame.tick > 1:  # earlier it began there
                names = (name, level.areas[area].name)
                robot, place = (clip(one_line(text), 30) for text in names)
                comparison = ghost.comparison(area, frame.tick)
                comma = "," * comparison.startswith("which")
                self._ui.tell(f"{robot} reached {place or 'an area'}{comma} {comparison}.")

    def _best_kept(self) -> None:
        ghost = self._view.ghost
        if ghost is not None and ghost.name == BEST:
            self._ui.spawn(lambda: self._race_best(is_new=True), "ghost", exclusive=True)

    async def _race_best(self, *, is_new: bool) -> None:
        from logical_robots_tui.game.replay import load_replay
        from logical_robots_tui.tui.commands.keymap import with_keys

        path = self._best.path(self._session.opened)
        if not path.exists():
            words = "No run of yours is kept here yet. Win this level; then {ghost} shows the best."
            self._ui.tell(with_keys(words))
            return
        try:
            replay = await asyncio.to_thread(load_replay, path)
        except InputError as error:
            self._ui.warn(
                f"Your best run can't be read: it {error.message}. Win again to keep a new one."
            )
            return
        await self.race(replay, BEST, is_told=not is_new)

    async def race(self, replay: Replay, name: str, *, is_told: bool = True) -> None:
        level = self._session.level
        try:
            ghost = await asyncio.to_thread(ghost_of, replay, level, name)
        except InputError as error:
            self._ui.warn(f"This {name} can't be raced against. {error}")
            return
        if level is not self._session.level:
            return
        self._view.ghost = ghost
        if is_told:
            sign = self._view.drawing.glyphs.ghost(0.0)
            self._ui.tell(
                f"Faint {sign}: the robots of {ghost.run}, {count_of(ghost.last, 'tick')}."
            )
