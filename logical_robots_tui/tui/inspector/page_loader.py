"""The pages of the inspector besides that of the robots; it loads them when first wanted."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from textual.containers import VerticalScroll
from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.tui.inspector.answers import counted
from logical_robots_tui.tui.inspector.choice import ASK, DECISION, DIAGNOSIS, ORIGIN, WATCH, WHY
from logical_robots_tui.tui.inspector.pages.ask import AskView
from logical_robots_tui.tui.inspector.pages.decision import DecisionView
from logical_robots_tui.tui.inspector.pages.diagnosis import DiagnosisPage
from logical_robots_tui.tui.inspector.pages.origin import OriginPage
from logical_robots_tui.tui.inspector.pages.reasons import ReasonsPage
from logical_robots_tui.tui.inspector.watching import Watching
from logical_robots_tui.tui.inspector.widgets.cells import written
from logical_robots_tui.tui.inspector.widgets.table import ValueTable
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Callable

    from textual.widget import Widget

    from logical_robots_tui.game import Frame
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.inspector.questions import Questions, Survey
    from logical_robots_tui.tui.inspector.waiting import Waiting

__all__ = ["Pages"]


class Pages:
    """Decision, reasons, answers, what is watched, diagnosis, an origin, and rows of a predicate.

    Args:
        session: Whose ticks.
        questions: Whom to ask.
    """

    def __init__(self, session: Session, questions: Questions) -> None:
        self.decision = DecisionView()
        self.reasons = ReasonsPage(questions)
        self.asking = AskView(questions)
        self.watching = Watching(session, questions)
        self.pins = self.watching.view
        self.diagnosis = DiagnosisPage(session)
        self.origin = OriginPage(session)
        self._session = session
        self.table = ValueTable()
        self._value = Static(id="value-text")
        self._value_box = VerticalScroll(self._value, id="value", can_focus=False)
        self._told = Content("")
        self.widgets: tuple[Widget, ...] = (
            self.decision,
            self.reasons,
            self.asking,
            self.pins,
            self.diagnosis,
            self.origin,
            self.table,
            self._value_box,
        )
        """All of them; the last one stands below the rows, and tells one value in full."""
        self.show_only(None)

    @property
    def waiting(self) -> Waiting | None:
        """What waits for an answer so long that it says so, if that is on the screen."""
        pages = (self.asking, self.reasons, self.origin)
        return next((p.waiting for p in pages if p.display and p.waiting.is_long), None)

    def view_of(self, name: str) -> Widget:
        """What takes the focus on a page, or for the rows of a predicate."""
        views: dict[str, Widget] = {
            DECISION: self.decision,
            WHY: self.reasons.view,
            ASK: self.asking.line,
            WATCH: self.pins,
            DIAGNOSIS: self.diagnosis.view,
            ORIGIN: self.origin.view,
        }
        return views.get(name, self.table)

    def shown(self, page: str, robot: str) -> tuple[str, Widget]:
        """The title and the widget of a page that tells of a robot."""
        pages: dict[str, tuple[str, Widget]] = {
            DECISION: (f"Decision of {robot}", self.decision),
            WHY: ("Why", self.reasons),
            ASK: ("Ask", self.asking),
            WATCH: ("Watch", self.pins),
            DIAGNOSIS: ("Diagnosis", self.diagnosis),
            ORIGIN: ("Origin", self.origin),
        }
        return pages[page]

    async def follow(
        self,
        page: str,
        robot: str,
        frame: Frame,
        survey: Survey | None,
        told: Callable[[str], None],
    ) -> None:
        """Show a tick on a page.

        Args:
            page: Which one.
            robot: The robot that is told of.
            frame: The tick.
            survey: The rows of every predicate at some tick, if they are known.
            told: Called when what is shown begins to be about the tick, with what more there is
                to say of it.
        """
        if page == WHY:
            more = "" if frame.tick else "nobody has thought yet"
            is_still = not self._session.running
            await self.reasons.follow(robot, frame, partial(told, more), whole=is_still)
        elif page == ASK:
            await self.asking.follow(frame, lambda table: told("" if not table else counted(table)))
        elif page == WATCH:
            told("")
            await self.watching.follow(frame)
        elif page in (DIAGNOSIS, ORIGIN):
            told("")
            (self.origin if page == ORIGIN else self.diagnosis).follow()
        else:
            told("")
            known = survey if survey is not None and survey.frame is frame else None
            self.decision.show(self._session.program, frame, robot, known)

    def show_only(self, view: Widget | None) -> None:
        """Show one of them, or none."""
        for each in self.widgets:
            each.display = each is view
        self.tell_value()

    def tell_value(self) -> None:
        """Tell the value under the cursor in full."""
        pointed = self.table.pointed
        self._value_box.display = self.table.display and pointed is not None
        if pointed is not None:
            told = Content.assemble((f"{one_line(pointed[0])} = ", INK.dim), written(pointed[1]))
            if told != self._told:
                self._told = told
                self._value.update(told)
