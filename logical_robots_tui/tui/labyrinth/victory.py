"""Announcing the task of a level, and victories."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from logical_robots_tui.game import Frame
from logical_robots_tui.game.frame import is_match_over, standing_words
from logical_robots_tui.game.history.marks import trouble
from logical_robots_tui.game.victory import robustness_line
from logical_robots_tui.player.session_state import SessionListener
from logical_robots_tui.wording import one_line
from logical_robots_tui.world import Level

if TYPE_CHECKING:
    from logical_robots_tui.game.victory import Victory
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.progress import Measures
    from logical_robots_tui.tui.labyrinth.pane import LabyrinthPane


class VictoryAnnouncer(SessionListener):
    def __init__(
        self,
        session: Session,
        pane: LabyrinthPane,
        recorder: ProgressRecorder,
        tell: Callable[[str], None],
        is_hidden: Callable[[], bool],
    ) -> None:
        self._session, self._pane, self._recorder = session, pane, recorder
        self._tell, self._is_hidden = tell, is_hidden
        self._waiting: Victory | None = None
        self._is_held = False
        self._tick = 0

    def level_opened(self, level: Level) -> None:
        self.restarted()

    def restarted(self) -> None:
        self._waiting = None
        self._pane.banner.close()
        self._brief()

    def tick_shown(self, frame: Frame) -> None:
        """Show the briefing whenever the start is shown, and hide it afterwards."""
        before, self._tick = self._tick, frame.tick
        if before and not frame.tick:
            self._brief()
        elif frame.tick and not before:
            self._pane.briefing.close()
        history = self._session.history
        if frame.tick != before + 1 or history is None:
            return
        level = self._session.level
        if is_match_over(level, frame.tick):
            self._tell(f"The match is over: {one_line(standing_words(level, frame.after))}.")
        for mark in history.marks.at(frame.tick):
            if words := trouble(mark):
                self._tell(words)

    def _brief(self) -> None:
        self._tick = 0
        if not self._is_held:
            self._pane.briefing.tell(self._session.level)

    def won(self, victory: Victory) -> None:
        """Announce a victory, now or once level editing ends."""
        self._waiting = victory
        if not self._is_held:
            self._announce()

    def hold(self, is_held: bool) -> None:
        """Delay announcements, or stop; a victory meanwhile is announced if it still holds."""
        self._is_held = is_held
        if not self._tick:
            self._brief()
        if not is_held and self._session.won_at is not None:
            self._announce()

    def measured(self, level: Level, found: Measures, is_here: bool) -> None:
        if not (is_here and self._pane.banner.display):
            self._tell(one_line(robustness_line(level, found)))

    def _announce(self) -> None:
        victory, self._waiting = self._waiting, None
        if victory is None:
            return
        who = "You are there" if len(victory.level.robots) == 1 else "Everybody is there"
        self._pane.briefing.close()
        if victory.refusal:
            self._tell(victory.refusal)
        self._pane.banner.celebrate(victory.tick, who, self._recorder)
        if self._is_hidden():
            self._tell(f"★ {who}: {victory.tick} ticks ★")
