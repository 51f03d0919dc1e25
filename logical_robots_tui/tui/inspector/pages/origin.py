"""The page of the inspector that tells where a value in a memory comes from, tick by tick."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual import on
from textual.containers import Vertical
from textual.content import Content
from textual.message import Message
from textual.widgets import Static

from logical_robots_tui.game import Superseded, origin_in_game
from logical_robots_tui.game.debugging.origin import written_path
from logical_robots_tui.mind import QueryError
from logical_robots_tui.tui.app.background import in_background
from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.inspector.choice import ORIGIN, ROBOTS
from logical_robots_tui.tui.inspector.pages.robots import RobotsView
from logical_robots_tui.tui.inspector.pointing import Placed
from logical_robots_tui.tui.inspector.waiting import GivenUp, Waiting, under_way
from logical_robots_tui.tui.inspector.widgets.links import LinksView
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.tui.timeline.widget import Timeline

if TYPE_CHECKING:
    from logical_robots_tui.game import Game
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.inspector.remembered import Remembered

__all__ = ["OriginPage"]

_LEFT = "The robots went into another future since then. {origin} on a value asks anew."


class OriginPage(Vertical):
    """The chain of ticks and rules that a value goes back to.

    Args:
        session: Whose game.

    Attributes:
        asked: What is asked, or None as long as nothing was.
    """

    DEFAULT_CSS = """
    OriginPage { height: 1fr; }
    OriginPage #origin-of { height: 1; padding: 0 1; color: $ink-dim; text-wrap: nowrap; }
    OriginPage #origin-said { padding: 1 2; height: auto; }
    """

    class Opened(Message):
        """The player has gone to the tick of a link, and wants to see why it is so there."""

    class Left(Message):
        """The player has gone back to the tick at which this was asked.

        Attributes:
            page: What was inspected when this was asked.
        """

        def __init__(self, page: str) -> None:
            super().__init__()
            self.page = page

    def __init__(self, session: Session) -> None:
        self._session = session
        self._of = Static(id="origin-of")
        self._said = Static(id="origin-said")
        self.view = LinksView()
        super().__init__(self._of, self._said, self.view, id="origin")
        self.waiting = Waiting()
        self.asked: Remembered | None = None
        self._about: tuple[Game, int] | None = None
        self._asked_at = ROBOTS, 0

    def come_from(self, page: str, asked: Remembered | None) -> None:
        """Ask where a value comes from, or show again what was asked last.

        Args:
            page: What was inspected, which escape returns to.
            asked: The value; None is for that of the last time.
        """
        if asked is not None:
            if page != ORIGIN:
                self._asked_at = page, self._session.frame.tick
            self.ask(asked)

    def ask(self, asked: Remembered) -> None:
        """Ask where a value comes from; what was asked before is given up."""
        self.asked = asked
        self._about = self._present()
        name = one_line(f"{asked.robot}'s {written_path(asked.path)}")
        self._of.update(
            Content.assemble((name, INK.title), f" after tick {asked.tick} comes from"),
            layout=False,
        )
        self._say(Content(""))
        in_background(self, self._answer, "origin", exclusive=True)

    def follow(self) -> None:
        """Say so if the answer is about ticks that were left for others."""
        if self._about is not None and self._about != self._present():
            self._about = None
            self.workers.cancel_group(self, "origin")
            self._say(Content.styled(with_keys(_LEFT), INK.warn))

    async def _answer(self) -> None:
        asked, about = self.asked, self._about
        if asked is None or about is None:
            return
        game, _ = about
        at = asked.tick

        def told(tick: int) -> None:
            nonlocal at
            at = tick

        def wait() -> None:
            back = asked.tick - at
            words = f"at tick {at}, {back:,} tick{'s' * (back != 1)} back"
            self._say(under_way(words, self.waiting.seconds))

        try:
            work = origin_in_game(game, asked.robot, asked.path, asked.tick, told)
            origin = await self.waiting.answer(work, wait)
        except Superseded:
            self.follow()
        except GivenUp:
            self._say(Content(f"Stopped at tick {at}, after {self.waiting.seconds:.1f} s."))
        except QueryError as error:
            self._say(Content.styled(one_line(str(error)), INK.warn))
        else:
            self._said.display = False
            self.view.show(origin)

    def _present(self) -> tuple[Game, int] | None:
        game = self._session.game
        return None if game is None else (game, game.history.turns)

    def _say(self, words: Content) -> None:
        """Show words in place of an answer; the view keeps the focus."""
        self._said.update(words)
        self._said.display = True
        self.view.show(None)

    @on(LinksView.Pointed)
    def _pointed(self, event: LinksView.Pointed) -> None:
        """Show where the rule stands in the program that decided then."""
        event.stop()
        span, about = event.link.span or event.link.rule, self._about
        program = about[0].history.program_at(event.link.tick) if about is not None else None
        if span is not None and program is not None:
            self.post_message(Placed(program.text, (span.start, span.stop)))

    @on(LinksView.Opened)
    def _open(self, event: LinksView.Opened) -> None:
        event.stop()
        self.post_message(RobotsView.Chosen(event.link.robot))
        self.post_message(Timeline.Pointed(event.link.tick))
        self.post_message(self.Opened())

    @on(LinksView.Left)
    def _leave(self, event: LinksView.Left) -> None:
        """Give up what is under way, or else go back."""
        event.stop()
        if self.waiting.is_long:
            self.waiting.stop()
            return
        page, tick = self._asked_at
        if tick != self._session.frame.tick:
            self.post_message(Timeline.Pointed(tick))
        self.post_message(self.Left(page))
