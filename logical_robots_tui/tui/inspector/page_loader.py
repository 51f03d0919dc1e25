"""All pages but the first one: loading their modules takes 70 ms, which the start does not wait."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.inspector.page import Page, Questions
from logical_robots_tui.tui.inspector.pages.ask import AskPage
from logical_robots_tui.tui.inspector.pages.decision import DecisionPage
from logical_robots_tui.tui.inspector.pages.diagnosis import DiagnosisPage
from logical_robots_tui.tui.inspector.pages.origin import OriginPage
from logical_robots_tui.tui.inspector.pages.predicate import PredicatePage
from logical_robots_tui.tui.inspector.pages.watch import WatchPage
from logical_robots_tui.tui.inspector.pages.why import WhyPage
from logical_robots_tui.tui.inspector.predicate_list import (
    ASK,
    DECISION,
    DIAGNOSIS,
    ORIGIN,
    WATCH,
    WHY,
)

if TYPE_CHECKING:
    from logical_robots_tui.player.session import Session


class Pages:
    """The pages by name, except predicates, from left to right."""

    def __init__(self, session: Session, questions: Questions) -> None:
        self.decision = DecisionPage(session, questions)
        self.why = WhyPage(session, questions)
        self.ask = AskPage(session, questions)
        self.watch = WatchPage(session, questions)
        self.diagnosis = DiagnosisPage(session, questions)
        self.origin = OriginPage(session, questions)
        self.predicate = PredicatePage(session, questions)
        self.table, self.pins = self.predicate.view, self.watch.view
        self.by_name: dict[str, Page] = {
            WHY: self.why,
            ASK: self.ask,
            WATCH: self.watch,
            DIAGNOSIS: self.diagnosis,
            ORIGIN: self.origin,
            DECISION: self.decision,
        }
