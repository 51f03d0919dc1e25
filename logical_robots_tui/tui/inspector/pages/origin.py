"""The Origin page: what a value comes from, through rules and ticks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING

from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.game import Frame, Link, Origin, Superseded, origin_in_game, subject_name
from logical_robots_tui.game.debugging.origin import is_memory
from logical_robots_tui.game.debugging.origin_words import INCOMPLETE, link_lines
from logical_robots_tui.mind import QueryError
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.inspector.page import Cancelled, Page, Placed, Questions, progress
from logical_robots_tui.tui.inspector.predicate_list import ORIGIN, ROBOTS, WHY
from logical_robots_tui.tui.inspector.widgets.line_views import CursorView
from logical_robots_tui.tui.inspector.widgets.plots import format_value, inked
from logical_robots_tui.tui.layout.command_bar import RobotChosen
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.tui.timeline.widget import Timeline
from logical_robots_tui.wording import count_of, one_line

if TYPE_CHECKING:
    from logical_robots_tui.game import Game
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.tui.inspector.under_cursor import Traced

_STALE = "The robots went into another future since then. {origin} on a value asks again."
_INDENT = "    "
_INPUTS = ("from ", "copied from ", "read from ", "and from ")
_LONGEST = 60  # characters of a value that was read
_KEYS = "enter goes to that tick and says why   esc back"


class LinksView(CursorView):
    """The links of the chain, the value itself first; enter goes to one, escape leaves."""

    BINDINGS = [("enter", "open"), ("escape,backspace", "leave")]

    def __init__(
        self,
        pointed: Callable[[Link], None],
        opened: Callable[[Link], None],
        left: Callable[[], None],
    ) -> None:
        super().__init__(id="links")
        self._tell_pointed, self._tell_opened, self.action_leave = pointed, opened, left
        self._origin: Origin | None = None

    @property
    def pointed(self) -> Link | None:
        return self._origin.links[self._at] if self._origin is not None else None

    def show(self, origin: Origin | None) -> None:
        self._origin, self._at = origin, 0
        self.redraw()
        self.refresh()
        self.scroll_to(y=0, animate=False)
        if self.has_focus:
            self.cursor_moved()

    def draw(self) -> None:
        links = self._origin.links if self._origin is not None else ()
        after: list[Content] = []
        if self._origin is not None:
            if not self._origin.complete:
                after += Content.styled(INCOMPLETE, INK.warn).wrap(max(1, self.columns))
            after += [Content(""), Content.styled(_KEYS, INK.dim).truncate(self.columns)]
        items = [list(lines_of(n, link, self.columns)) for n, link in enumerate(links)]
        self.paint_items(items, after)

    def cursor_moved(self) -> None:
        if self.pointed is not None:
            self._tell_pointed(self.pointed)

    def clicked(self, x: int, line: int, *, again: bool) -> None:
        del x, line
        if again:
            self.action_open()

    def action_open(self) -> None:
        if self.pointed is not None:
            self._tell_opened(self.pointed)


class OriginPage(Page):
    DEFAULT_CSS = """
    OriginPage #origin-of { height: 1; padding: 0 1; color: $ink-dim; text-wrap: nowrap; }
    """

    title = "Origin"
    view: LinksView

    def __init__(self, session: Session, questions: Questions) -> None:
        self._of = Static(id="origin-of")
        view = LinksView(self._pointed, self._open, self._leave)
        super().__init__(session, questions, view, above=(self._of,))
        self.asked: Traced | None = None
        self._course: tuple[Game, int] | None = None
        self._came_from = ROBOTS, 0

    def come_from(self, page: str, asked: Traced | None) -> None:
        """Trace a value, or return to the last trace; escape returns to `page`."""
        if asked is not None:
            if page != ORIGIN:
                self._came_from = page, self._session.frame.tick
            self._trace(asked)

    async def show(self, frame: Frame) -> None:
        """Show a note if the traced ticks were abandoned for others."""
        self.head(frame.tick)
        if self._course is not None and self._course != self._current_course():
            self._course = None
            self.workers.cancel_group(self, "origin")
            self._say_instead(with_keys(_STALE))

    def _trace(self, asked: Traced) -> None:
        self.asked = asked
        self._course = self._current_course()
        name = one_line(subject_name(asked.robot, asked.subject))
        when = "after" if is_memory(asked.subject) else "in"
        self._of.update(
            Content.assemble((name, INK.title), f" {when} tick {asked.tick} comes from"),
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
            words = f"at tick {at}, {count_of(back, 'tick')} back"
            self._say_instead(progress(words, self.pending.seconds))

        try:
            work = origin_in_game(course[0], asked.robot, asked.subject, asked.tick, reached)
            origin = await self.pending.run(work, report)
        except Superseded:
            await self.show(self._session.frame)
        except Cancelled:
            self._say_instead(f"Stopped at tick {at}, after {self.pending.seconds:.1f} s.")
        except QueryError as error:
            self._say_instead(str(error))
        else:
            self.say("")
            self.view.show(origin)

    def _current_course(self) -> tuple[Game, int] | None:
        game = self._session.game
        return None if game is None else (game, game.history.turns)

    def _say_instead(self, words: Content | str) -> None:
        """Show a message instead of the chain; the view keeps the focus."""
        self.say(words)
        self.view.show(None)

    def _pointed(self, link: Link) -> None:
        source, course = link.source, self._course
        span = (source.span or source.rule) if source is not None else None
        program = course[0].history.program_at(link.tick) if course is not None else None
        if span is not None and program is not None:
            part = program.for_team(self._session.level.team_of(link.robot))
            self.post_message(Placed(part.text, (span.start, span.stop)))

    def _open(self, link: Link) -> None:
        self.post_message(RobotChosen(link.robot))
        self.post_message(Timeline.Pointed(link.tick))
        self.post_message(self.Opened(WHY))

    def _leave(self) -> None:
        if self.pending.is_long:
            self.pending.cancel()
            return
        page, tick = self._came_from
        if tick != self._session.frame.tick:
            self.post_message(Timeline.Pointed(tick))
        self.post_message(self.Left(page))


def lines_of(number: int, link: Link, width: int) -> Iterator[Content]:
    name = one_line(f"{number + 1}. {link.name}")
    text, colour = inked(link.value, width)
    yield _cut(Content.assemble((name, INK.title), (" = ", INK.dim), (text, colour)), width)
    for line in link_lines(link, partial(format_value, limit=_LONGEST)):
        is_input = line.startswith(_INPUTS)
        yield _cut(
            Content.styled(_INDENT + one_line(line), INK.dim if is_input else INK.text), width
        )


def _cut(line: Content, width: int) -> Content:
    return line.truncate(width, ellipsis=True)
