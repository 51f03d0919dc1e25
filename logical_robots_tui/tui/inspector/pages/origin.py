"""The Origin page: where a value in a memory comes from, tick by tick."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual import on
from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.game import Superseded, origin_in_game
from logical_robots_tui.game.debugging.origin import written_path
from logical_robots_tui.mind import QueryError
from logical_robots_tui.tui.app.background import in_background
from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.inspector.background_query import BackgroundQuery, Cancelled, progress
from logical_robots_tui.tui.inspector.highlights import Placed
from logical_robots_tui.tui.inspector.page import Page
from logical_robots_tui.tui.inspector.pages.robots import RobotsView
from logical_robots_tui.tui.inspector.predicate_list import ORIGIN, ROBOTS, WHY
from logical_robots_tui.tui.inspector.widgets.origin_chain import LinksView
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.tui.timeline.widget import Timeline

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame, Game
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.inspector.questions import Questions
    from logical_robots_tui.tui.inspector.under_cursor import MemoryPart

__all__ = ["OriginPage"]

_STALE = "The robots went into another future since then. {origin} on a value asks again."


class OriginPage(Page):
    """The chain of assignments that a value goes back to.

    Attributes:
        asked: The value that is traced, or None before the first one.
    """

    DEFAULT_CSS = """
    OriginPage #origin-of { height: 1; padding: 0 1; color: $ink-dim; text-wrap: nowrap; }
    """

    title = "Origin"
    view: LinksView

    def __init__(self, session: Session, questions: Questions) -> None:
        self._of = Static(id="origin-of")
        super().__init__(session, questions, LinksView(), above=(self._of,))
        self.pending = self._query = BackgroundQuery()
        self.asked: MemoryPart | None = None
        self._course: tuple[Game, int] | None = None
        self._came_from = ROBOTS, 0

    def come_from(self, page: str, asked: MemoryPart | None) -> None:
        """Trace a value, or return to the last trace.

        Args:
            page: What was inspected, for escape to return to.
            asked: The value, or None for the last one.
        """
        if asked is not None:
            if page != ORIGIN:
                self._came_from = page, self._session.frame.tick
            self._trace(asked)

    async def show(self, frame: Frame) -> None:
        """Say so if the traced ticks have been abandoned for others."""
        self.head(frame.tick)
        if self._course is not None and self._course != self._current_course():
            self._course = None
            self.workers.cancel_group(self, "origin")
            self._say_instead(with_keys(_STALE))

    def _trace(self, asked: MemoryPart) -> None:
        """Trace a value; the trace before is cancelled."""
        self.asked = asked
        self._course = self._current_course()
        name = one_line(f"{asked.robot}'s {written_path(asked.path)}")
        self._of.update(
            Content.assemble((name, INK.title), f" after tick {asked.tick} comes from"),
            layout=False,
        )
        self._say_instead("")
        in_background(self, self._answer, "origin", exclusive=True)

    async def _answer(self) -> None:
        asked, course = self.asked, self._course
        if asked is None or course is None:
            return
        at = asked.tick

        def reached(tick: int) -> None:
            nonlocal at
            at = tick

        def report() -> None:
            back = asked.tick - at
            words = f"at tick {at}, {back:,} tick{'s' * (back != 1)} back"
            self._say_instead(progress(words, self._query.seconds))

        try:
            work = origin_in_game(course[0], asked.robot, asked.path, asked.tick, reached)
            origin = await self._query.run(work, report)
        except Superseded:
            await self.show(self._session.frame)
        except Cancelled:
            self._say_instead(f"Stopped at tick {at}, after {self._query.seconds:.1f} s.")
        except QueryError as error:
            self._say_instead(str(error))
        else:
            self.say("")
            self.view.show(origin)

    def _current_course(self) -> tuple[Game, int] | None:
        game = self._session.game
        return None if game is None else (game, game.history.turns)

    def _say_instead(self, words: Content | str) -> None:
        """Show a message and no chain; the view keeps the focus."""
        self.say(words)
        self.view.show(None)

    @on(LinksView.Pointed)
    def _pointed(self, event: LinksView.Pointed) -> None:
        """Show the rule in the program that decided that tick."""
        event.stop()
        span, course = event.link.span or event.link.rule, self._course
        program = course[0].history.program_at(event.link.tick) if course is not None else None
        if span is not None and program is not None:
            self.post_message(Placed(program.text, (span.start, span.stop)))

    @on(LinksView.Opened)
    def _open(self, event: LinksView.Opened) -> None:
        event.stop()
        self.post_message(RobotsView.Chosen(event.link.robot))
        self.post_message(Timeline.Pointed(event.link.tick))
        self.post_message(self.Opened(WHY))

    @on(LinksView.Left)
    def _leave(self, event: LinksView.Left) -> None:
        """Cancel the trace that is running, or else go back."""
        event.stop()
        if self._query.is_long:
            self._query.cancel()
            return
        page, tick = self._came_from
        if tick != self._session.frame.tick:
            self.post_message(Timeline.Pointed(tick))
        self.post_message(self.Left(page))
