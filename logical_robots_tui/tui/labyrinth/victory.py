"""Announcing the task of a level, and victories."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from logical_robots_tui.game import Frame
from logical_robots_tui.game.frame import is_match_over, standing_words
from logical_robots_tui.game.history.marks import trouble
from logical_robots_tui.game.victory import robustness_line
from logical_robots_tui.player.session_state import SessionListener
from logical_robots_tui.wording import clip, count_of, one_line
from logical_robots_tui.world import Level, LevelError, list_arenas

if TYPE_CHECKING:
    from logical_robots_tui.game.victory import Verdict, Victory
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.progress import Measures
    from logical_robots_tui.tui.app.ui import ScreenOffers, ScreenUi
    from logical_robots_tui.tui.labyrinth.briefing import Briefing
    from logical_robots_tui.tui.labyrinth.drawing.cells import Cells, Palette
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
    from logical_robots_tui.tui.labyrinth.results import ResultsDialog
    from logical_robots_tui.tui.library.controller import BoardController

_PICTURE_ROWS = 9
_FURTHER = (("next_level", "First arena"), ("daily", "Daily"), ("new_level", "Own swarm"))
_AFTER_THE_LAST = (
    " This was the last level. Go on in the arenas, against another team, in the labyrinth that "
    "everybody has today, or with a swarm in a level of your own."
)
_PAUSE = 1.0
"""Seconds without a key after which a text that is typed may be interrupted."""

_DIAGNOSIS = " Diagnosis, in {palette}, says what stands out in the run."

_NOTES: dict[Verdict, str] = {
    "counts": "Several programs drove on the way, so this run has no result: press {restart}, then "
    "{run}, for one of this program.",
    "reference": "Won by a reference program: not counted.",
    "clock": "Press {restart}, then {run}, to try again; {sql} shows what takes long.",
    "edited": "Save or discard what has changed ({edit_level}), then press {restart} and {run}.",
}
"""What is said of a victory without measures, and what to press."""


@dataclass(eq=False)
class VictoryAnnouncer(SessionListener):
    """Tells the task at a level's start, and what happens; celebrates victories.

    Args:
        pause: How many seconds ago a text was typed; inf if none is.
        is_test: Whether a level that is edited is being tried.
        look: How pictures are drawn now, or None where there is no room for one.
        following: Finds the name of the next level, if there is one.
        run: Runs a command.
        board: Draws the histogram, and asks how to be on the board.
    """

    session: Session
    briefing: Briefing
    recorder: ProgressRecorder
    ui: ScreenUi
    offers: ScreenOffers
    pause: Callable[[], float]
    is_test: Callable[[], bool]
    look: Callable[[], tuple[Drawing, Palette] | None]
    following: Callable[[], Awaitable[str | None]]
    run: Callable[[str], None]
    board: BoardController
    _waiting: Victory | None = None
    _results: ResultsDialog | None = None
    _is_held: bool = False
    _has_explained: bool = False
    _has_hinted: bool = False
    _tick: int = 0

    def level_opened(self, level: Level) -> None:
        self.restarted()

    def restarted(self) -> None:
        self._waiting, self._has_hinted = None, False
        self._brief()

    def tick_shown(self, frame: Frame) -> None:
        """Show the briefing whenever the start is shown, and hide it afterwards."""
        previous_tick, self._tick = self._tick, frame.tick
        if previous_tick and not frame.tick:
            self._brief()
        elif frame.tick and not previous_tick:
            self.briefing.close()
        history = self.session.history
        if frame.tick != previous_tick + 1 or history is None:
            return
        level = self.session.level
        if is_match_over(level, frame.tick):
            standing = one_line(standing_words(level, frame.after))
            self.ui.tell(f"The match is over: {standing}.")
        for mark in history.marks.marks_at(frame.tick):
            if words := trouble(mark):
                from logical_robots_tui.tui.commands.keymap import with_keys

                hint = "" if self._has_hinted else with_keys(_DIAGNOSIS)
                self._has_hinted = True
                self.ui.tell(f"{words}{hint}")

    def _brief(self) -> None:
        self._tick = 0
        if not self._is_held:
            self.briefing.tell(self.session.level)

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
        if not is_held and self.session.won_at is not None:
            self._announce()

    def measured(self, level: Level, measures: Measures, is_here: bool) -> None:
        is_shown = self._results is not None and self._results.is_active
        if not (is_here and is_shown):
            self.ui.tell(one_line(robustness_line(level, measures)))

    def follow(self) -> None:
        """Show in the results what is measured meanwhile."""
        if self._results is not None:
            self._results.follow()

    def results(self) -> None:
        from logical_robots_tui.tui.labyrinth.results import ResultsDialog

        answers = [("solution", "References"), ("versions", "Versions"), ("results", "Close")]
        histogram = self.board.histogram
        self._results = ResultsDialog(self.recorder, "", answers, histogram=histogram)
        self.ui.show(self._results, self._obey)

    def _announce(self) -> None:
        if self._waiting is not None:
            self.briefing.close()
            self.ui.spawn(self._celebrate, "victory", exclusive=True)

    async def _celebrate(self) -> None:
        from logical_robots_tui.tui.app.ui import NOTICING
        from logical_robots_tui.tui.labyrinth.results import ResultsDialog

        following = await self.following()
        is_first_arena = following in await asyncio.to_thread(list_arenas)
        picture = await self._picture_of(following)
        pause = await self.offers.at_hand(self._end_of_typing)
        victory, self._waiting = self._waiting, None
        if victory is None:
            return
        who = "You made it" if len(victory.level.robots) == 1 else "Everyone made it"
        headline = f"★ {clip(who, 50)} — {count_of(victory.tick, 'tick')} ★"
        answers, story = [("restart", "Again"), ("leave", "Stay")], victory.level.story
        if self.is_test():
            answers[:0] = [("test", "Edit")]
        elif is_first_arena and not victory.level.teams:
            answers = [*_FURTHER, ("restart", "Again"), ("lesson", "Lesson")]
            story = story.strip() + _AFTER_THE_LAST
        else:
            answers[:0] = [("next_level", "Next level")] * (following is not None)
            answers[-1:-1] = [("lesson", "Lesson")] * bool(victory.level.lesson)
        noticing = NOTICING if pause < math.inf else 0.0
        self._results = ResultsDialog(
            self.recorder,
            headline,
            answers,
            note=f"{victory.refusal} {_NOTES[victory.verdict]}".lstrip(),
            seed=victory.tick,
            noticing=noticing,
            story=story,
            picture=picture,
            explains=not self._has_explained,
            histogram=self.board.histogram,
        )
        self._has_explained = True
        answer = await self.offers.put(self._results)
        await self.board.join_once()
        self._obey(answer)

    async def _end_of_typing(self) -> float:
        while (pause := self.pause()) < _PAUSE:  # noqa: ASYNC110 - each key begins it anew
            await asyncio.sleep(_PAUSE - pause)
        return pause

    async def _picture_of(self, level: str | None) -> Cells | None:
        """Draw what comes next; without it the story is told alone."""
        from logical_robots_tui.tui.labyrinth.results import STORY_WIDTH
        from logical_robots_tui.tui.library.cards import shipped_miniature

        if level is None or (look := self.look()) is None:
            return None
        with suppress(LevelError):
            return await asyncio.to_thread(
                shipped_miniature, level, STORY_WIDTH, _PICTURE_ROWS, *look
            )
        return None

    def _obey(self, answer: str | None) -> None:
        if answer not in (None, "results", "leave"):
            self.run(answer)
