"""The Origin page: where a value in a memory comes from, tick by tick."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.explain.why.sourcing import Read
from logical_robots_tui.game import Frame, Link, Origin, Superseded, origin_in_game
from logical_robots_tui.game.debugging.pins import path_text
from logical_robots_tui.mind import QueryError
from logical_robots_tui.tui.app.frame_scheduler import in_background
from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.inspector.page import Cancelled, Page, Placed, Questions, progress
from logical_robots_tui.tui.inspector.predicate_list import ORIGIN, ROBOTS, WHY
from logical_robots_tui.tui.inspector.widgets.line_views import CursorView
from logical_robots_tui.tui.inspector.widgets.plots import inked
from logical_robots_tui.tui.layout.command_bar import RobotChosen
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.tui.timeline.widget import Timeline
from logical_robots_tui.wording import count_of

if TYPE_CHECKING:
    from logical_robots_tui.game import Game
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.inspector.under_cursor import MemoryPart

_STALE = "The robots went into another future since then. {origin} on a value asks again."
_INDENT = "    "
_SHOWN_READS = 5
_LONGEST = 60  # characters of a value that was read
_KEYS = "enter goes to that tick and says why   esc back"
_INCOMPLETE = "This is not all of it: more values were read than are traced here."


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
                after += Content.styled(_INCOMPLETE, INK.warn).wrap(max(1, self.columns))
            after += [Content(""), Content.styled(_KEYS, INK.dim).truncate(self.columns)]
        items = [list(link_lines(n, link, self.columns)) for n, link in enumerate(links)]
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
        self.asked: MemoryPart | None = None
        self._course: tuple[Game, int] | None = None
        self._came_from = ROBOTS, 0

    def come_from(self, page: str, asked: MemoryPart | None) -> None:
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

    def _trace(self, asked: MemoryPart) -> None:
        self.asked = asked
        self._course = self._current_course()
        name = one_line(f"{asked.robot}'s {path_text(asked.path)}")
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
            words = f"at tick {at}, {count_of(back, 'tick')} back"
            self._say_instead(progress(words, self.pending.seconds))

        try:
            work = origin_in_game(course[0], asked.robot, asked.path, asked.tick, reached)
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
        span, course = link.span or link.rule, self._course
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


def link_lines(number: int, link: Link, width: int) -> Iterator[Content]:
    name = one_line(f"{number + 1}. {link.robot}'s {path_text(link.path)}")
    text, colour = inked(link.value, width)
    yield _cut(Content.assemble((name, INK.title), (" = ", INK.dim), (text, colour)), width)
    yield _cut(_when(link), width)
    if link.span is not None and link.tick:
        place = f"{_INDENT}line {link.span.line}: "
        yield _cut(Content.assemble((place, INK.key), (one_line(link.span.text), INK.text)), width)
    for read in link.reads[:_SHOWN_READS]:
        yield _cut(_read(read), width)
    if (more := len(link.reads) - _SHOWN_READS) > 0:
        yield Content.styled(f"{_INDENT}and from {more} more", INK.warn)
    if link.before:
        numbers = ", ".join(f"{each + 1}." for each in link.before)
        yield _cut(Content.styled(f"{_INDENT}goes on with {numbers}", INK.dim), width)


def _when(link: Link) -> Content:
    kept = f", kept until tick {link.until}" if link.until > link.tick else ""
    if link.tick == 0:
        return Content.styled(f"{_INDENT}there since the start{kept}", INK.text)
    rule = f" by the rule in line {link.rule.line}" if link.rule is not None else ""
    return Content.assemble(
        f"{_INDENT}set in ", (f"tick {link.tick}", INK.number), (f"{rule}{kept}", INK.text)
    )


def _read(read: Read) -> Content:
    path = read.path
    name = path_text(path, read.what)
    if read.what == "sensor" and path[:1] == ("radar",) and len(path) > 1:
        name = f"ray {path[1]}{path_text(path[2:], '')}"
    text, colour = inked(read.value, _LONGEST)
    words = one_line(f"from {read.robot}'s {name}")
    return Content.assemble(_INDENT, (words, INK.dim), (" = ", INK.dim), (text, colour))


def _cut(line: Content, width: int) -> Content:
    return line.truncate(width, ellipsis=True)
