"""The Origin page: what a value comes from, through rules and ticks."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

from textual.content import Content

from logical_robots_tui.game import Frame, Link, Origin, origin_in_game, subject_name
from logical_robots_tui.game.debugging.origin import INCOMPLETE, is_memory, link_lines
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.inspector.line_views import CursorView
from logical_robots_tui.tui.inspector.page import Page, PageEntry, Placed
from logical_robots_tui.tui.inspector.plots import format_value, ink_value
from logical_robots_tui.tui.inspector.questions import InspectorQuestions
from logical_robots_tui.tui.layout.command_bar import CommandChosen, RobotChosen
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.tui.timeline.widget import Timeline
from logical_robots_tui.wording import count_of, one_line

if TYPE_CHECKING:
    from logical_robots_tui.game import Game
    from logical_robots_tui.tui.inspector.page import Traced

_STALE = "The robots went on in another branch. Press {origin} on a value to trace it again."
_INDENT = "    "
_INPUTS = ("from ", "copied from ", "read from ", "and from ")
_LONGEST = 60  # characters of a value that was read
_KEYS = "enter goes to that tick and says why   esc back"


class LinksView(CursorView):
    """The links of the chain, the value itself first; enter goes to one, escape leaves."""

    BINDINGS = [("enter", "open"), ("escape,backspace", "leave")]

    def __init__(self, page: OriginPage) -> None:
        super().__init__(id="links")
        self._page, self.action_leave = page, page.leave
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
        footer: list[Content] = []
        if self._origin is not None:
            if not self._origin.complete:
                footer += Content.styled(INCOMPLETE, INK.warn).wrap(max(1, self.columns))
            footer += [Content(""), Content.styled(_KEYS, INK.dim).truncate(self.columns)]
        items = [list(lines_of(n, link, self.columns)) for n, link in enumerate(links)]
        self.paint_items(items, footer)

    def cursor_moved(self) -> None:
        if self.pointed is not None:
            self._page.point_at(self.pointed)

    def clicked(self, x: int, line: int, *, again: bool) -> None:
        if again:
            self.action_open()

    def action_open(self) -> None:
        if self.pointed is not None:
            self.post_message(RobotChosen(self.pointed.robot))
            self.post_message(Timeline.TickPointed(self.pointed.tick))
            self.post_message(CommandChosen("why"))


class OriginPage(Page):
    view: LinksView

    def __init__(self, entry: PageEntry, questions: InspectorQuestions) -> None:
        super().__init__(entry, questions, LinksView(self))
        self._branch: tuple[Game, int] | None = None
        self._at = 0
        self._came_from = "", 0

    def begin(self, subject: tuple[Traced, str]) -> None:
        """Trace a value; escape returns to the page or predicate that the player came from."""
        target, came_from = subject
        if came_from != self.entry.id:
            self._came_from = came_from, self._session.frame.tick
        self._branch = self._questions.branch
        name = one_line(subject_name(target.robot, target.subject))
        when = "after" if is_memory(target.subject) else "in"
        self.caption(Content.assemble((name, INK.title), f" {when} tick {target.tick} comes from"))
        self._say_instead("")
        in_background(self, partial(self._answer, target, self._branch), "origin", exclusive=True)

    async def show(self, frame: Frame) -> None:
        """Show a note if the traced ticks were abandoned for others."""
        self.head(frame.tick)
        if self._branch is not None and self._branch != self._questions.branch:
            self._branch = None
            self.workers.cancel_group(self, "origin")
            self._say_instead(with_keys(_STALE))

    async def _answer(self, target: Traced, branch: tuple[Game, int] | None) -> None:
        if branch is None:
            return
        self._at = target.tick

        def report(tick: int) -> None:
            self._at = tick

        origin = await self.answer(
            lambda *_: origin_in_game(branch[0], target.robot, target.subject, target.tick, report),
            lambda: f"at tick {self._at}, {count_of(target.tick - self._at, 'tick')} back",
            self._say_instead,
        )
        if origin is not None:
            self.say("")
            self.view.show(origin)
        elif branch != self._questions.branch:
            await self.show(self._session.frame)

    def stopped(self) -> str:
        return f"Stopped at tick {self._at}, after {self.pending.seconds:.1f} s."

    def _say_instead(self, words: Content | str) -> None:
        """Show a message instead of the chain; the view keeps the focus."""
        self.say(words)
        self.view.show(None)

    def point_at(self, link: Link) -> None:
        """Show in the program what has set a value."""
        source, branch = link.source, self._branch
        span = (source.span or source.rule) if source is not None else None
        program = branch[0].history.program_at(link.tick) if branch is not None else None
        if span is not None and program is not None:
            part = program.for_team(self._session.level.team_of(link.robot))
            self.post_message(Placed(part.text, (span.start, span.stop)))

    def leave(self) -> None:
        if self.pending.is_long:
            self.pending.cancel()
            return
        page, tick = self._came_from
        if tick != self._session.frame.tick:
            self.post_message(Timeline.TickPointed(tick))
        self.post_message(self.Left(page))


def lines_of(number: int, link: Link, width: int) -> Iterator[Content]:
    name = one_line(f"{number + 1}. {link.name}")
    text, colour = ink_value(link.value, width)
    value = Content.assemble((name, INK.title), (" = ", INK.dim), (text, colour))
    yield value.truncate(width, ellipsis=True)
    for line in link_lines(link, partial(format_value, limit=_LONGEST)):
        ink = INK.dim if line.startswith(_INPUTS) else INK.text
        yield Content.styled(_INDENT + one_line(line), ink).truncate(width, ellipsis=True)
