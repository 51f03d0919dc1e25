"""What every page of the inspector has: a heading, a view that takes the focus, and `show`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from textual.containers import Vertical
from textual.content import Content
from textual.message import Message
from textual.widgets import Static

from logical_robots_tui.tui.inspector.widgets.line_views import LinesView
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Sequence

    from textual.widget import Widget

    from logical_robots_tui.game import Frame
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.inspector.background_query import BackgroundQuery
    from logical_robots_tui.tui.inspector.questions import Questions, Survey
    from logical_robots_tui.tui.inspector.widgets.table import ValueTable

__all__ = ["NO_PROGRAM", "Page"]

NO_PROGRAM = "There is no program to query yet."


class Page(Vertical):
    """Shows one thing about the current tick.

    Args:
        session: The level, program and game at hand.
        questions: Runs queries against the program.
        view: The widget that takes the focus.
        above: Widgets above the message.
        below: Widgets below the view.

    Attributes:
        view: The widget that takes the focus.
        title: The page's name, for the heading.
        robot: Name of the robot that the page is about.
        table: The table of the page, if it has one.
        pending: The background query that escape cancels, if the page has one.
    """

    DEFAULT_CSS = """
    Page { height: 1fr; }
    Page > .heading { height: 1; padding: 0 1; color: $ink-dim; text-wrap: nowrap; }
    Page > .message { height: auto; padding: 1 2; display: none; }
    """

    title: ClassVar[str]
    replays: ClassVar[bool] = True
    """Whether it computes past ticks with the current program, which may not have decided them."""

    @dataclass
    class Ready(Message):
        """A hidden page has something to show.

        Attributes:
            page: The page.
        """

        page: Page

    class Changed(Message):
        """The page has something else to show for the same tick."""

    @dataclass
    class Opened(Message):
        """The player follows a link to a predicate, a query or another page.

        Attributes:
            name: Which one.
        """

        name: str

    @dataclass
    class Left(Message):
        """The player returns to what was shown before this page.

        Attributes:
            name: A page or a predicate.
        """

        name: str

    def __init__(
        self,
        session: Session,
        questions: Questions,
        view: Widget,
        *,
        above: Sequence[Widget] = (),
        below: Sequence[Widget] = (),
    ) -> None:
        self._session, self._questions = session, questions
        self._heading = Static(classes="heading")
        self._message = Static(classes="message")
        self.view = view
        middle = () if view in above else (view,)
        children = (self._heading, *above, self._message, *middle, *below)
        super().__init__(*children, id=type(self).__name__)
        self.robot = ""
        self.table: ValueTable | None = None
        self.pending: BackgroundQuery | None = None

    @property
    def depends_on_robot(self) -> bool:
        """Whether choosing another robot changes what is shown."""
        return False

    async def show(self, frame: Frame) -> None:
        """Show a tick. Cancelled when another tick or page is wanted."""
        raise NotImplementedError

    def show_survey(self, survey: Survey) -> None:
        """Use the rows of all predicates at the current tick, which have just been counted."""

    def head(self, tick: int, more: str = "", title: str = "") -> None:
        """Set the heading, now that the page shows a tick.

        Args:
            tick: The tick.
            more: More about it.
            title: Replaces the page's title.
        """
        name = Content.styled(one_line(title or self.title), f"bold {INK.title}")
        parts = [name, Content(f"tick {tick}"), *([Content(more)] if more else [])]
        if self.replays and self._questions.is_by_another_program(tick):
            parts.append(Content.styled("by the current program", INK.warn))
        self._heading.update(Content(" · ").join(parts), layout=False)
        if not self.display:
            self.post_message(self.Ready(self))

    def redraw(self) -> None:
        """Draw at the present size.

        Textual loses the resize event of a widget that is shown while another one scrolls.
        """
        if isinstance(self.view, LinesView):
            self.view.redraw()
        if self.table is not None:
            self.table.redraw()

    def say(self, words: Content | str) -> None:
        """Show a message above the view, or none if there are no words."""
        content = words if isinstance(words, Content) else Content.styled(one_line(words), INK.warn)
        self._message.update(content)
        self._message.display = bool(content)
