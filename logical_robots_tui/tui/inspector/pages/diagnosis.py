"""The Diagnosis page: what in the whole run may be a mistake."""

from __future__ import annotations

from textual import on
from textual.content import Content
from textual.widgets import OptionList
from textual.widgets.option_list import Option
from textual.worker import Worker

from logical_robots_tui.explain.diagnosis.telling import Finding
from logical_robots_tui.game import Frame, Game, Superseded
from logical_robots_tui.game.diagnosing import Diagnosis, diagnose, extent
from logical_robots_tui.mind import Program, QueryError
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.inspector.page import Page, PageEntry, Placed
from logical_robots_tui.tui.inspector.questions import NO_PROGRAM, InspectorQuestions
from logical_robots_tui.tui.layout.dialogs import Listing
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.tui.timeline.widget import Timeline
from logical_robots_tui.wording import one_line

_START = "(start)"
_EVERY = 10  # ticks between two progress reports


class _Findings(Listing):
    bar_keys = (("enter", "Scan, or go to the finding"),)


class DiagnosisPage(Page):
    DEFAULT_CSS = """
    DiagnosisPage > .about { height: auto; text-wrap: wrap; }
    DiagnosisPage #findings { height: 1fr; border: none; padding: 0; background: $surface; }
    """

    view: _Findings

    def __init__(self, entry: PageEntry, questions: InspectorQuestions) -> None:
        super().__init__(entry, questions, _Findings(id="findings", markup=False))
        self.diagnosis: Diagnosis | None = None
        self._scanned: tuple[Game, int, Program] | None = None
        self._worker: Worker[None] | None = None
        self._shown: tuple[object, ...] | None = None

    @property
    def is_diagnosing(self) -> bool:
        return self._worker is not None and not self._worker.is_finished

    def forget(self) -> None:
        if self._worker is not None:
            self._worker.cancel()
        self._worker = self._scanned = self.diagnosis = None

    async def show(self, frame: Frame) -> None:
        """Show the findings; offer a new scan if the run has gone on or is another."""
        self.head(frame.tick)
        self._list()

    def _list(self) -> None:
        game = self._session.game
        last = 0 if game is None else game.history.last
        diagnosis = self.diagnosis
        findings = diagnosis.findings if diagnosis is not None else ()
        state = (findings, self.is_diagnosing, last, self._questions.run_key)
        if state == self._shown:
            return
        self._shown = state
        index = self.view.highlighted
        self.view.clear_options()
        offer = f"Scan {'the run' if diagnosis is None else 'again'} up to tick {last}"
        offer = "Stop scanning" if self.is_diagnosing else offer
        options = [Option(Content.styled(offer, f"bold {INK.key}"), id=_START)]
        options += [Option(_describe(finding), id=str(n)) for n, finding in enumerate(findings)]
        self.view.add_options(options)
        self.view.highlighted = min(index or 0, len(options) - 1)
        if self.is_diagnosing:
            return
        former, current, age = self._scanned, self._questions.run_key, ""
        if former is not None and former != current:
            is_same = current is not None and current[2].texts == former[2].texts
            age = f"This is about an earlier {'run' if is_same else 'program'}. "
        self._describe("" if diagnosis is None else f"{age}{extent(diagnosis)}")

    def _describe(self, text: str) -> None:
        findings = self.diagnosis.findings if self.diagnosis is not None else None
        nothing = findings is not None and not findings and not self.is_diagnosing
        text = f"{text} Nothing stands out." if nothing else text
        self.caption(Content(one_line(text) or " "))  # the line stays, so that the list does

    async def _look(self) -> None:
        game = self._session.game
        self._scanned = self._questions.run_key
        if game is None:
            self._describe(NO_PROGRAM)
            return
        try:
            self.diagnosis = await diagnose(game, report=self._report, show=self._fill)
        except QueryError as error:
            self._describe(str(error))
        except Superseded:
            self._describe("Another branch has begun. Scan again.")
        finally:
            self._worker = None
            self._shown = None
        self._list()

    def _fill(self, diagnosis: Diagnosis) -> None:
        self.diagnosis = diagnosis
        self._list()

    def _report(self, count: int, total: int) -> None:
        if not count % _EVERY:
            self._describe(f"Scanning: {count} of {total} ticks")

    @on(OptionList.OptionSelected)
    def _chosen(self, event: OptionList.OptionSelected) -> None:
        event.stop()
        if event.option_id != _START:
            if (finding := self._finding(event.option_id)) is not None:
                self.post_message(Timeline.TickPointed(finding.tick))
        elif self._worker is not None and self.is_diagnosing:
            self._worker.cancel()
            self._worker = self._shown = None
            self._list()
            if self.diagnosis is None:
                self._describe("Stopped.")
        else:
            self.diagnosis = None
            self._worker = in_background(self, self._look, "diagnose", exclusive=True)
            self._describe("Scanning…")
            self._list()

    @on(OptionList.OptionHighlighted)
    def _pointed(self, event: OptionList.OptionHighlighted) -> None:
        event.stop()
        finding = self._finding(event.option_id)
        if finding is not None and finding.span is not None and self._scanned is not None:
            place = finding.span.start, finding.span.stop
            self.post_message(Placed(self._scanned[2].text, place))

    def _finding(self, option: str | None) -> Finding | None:
        if self.diagnosis is None or option in (None, _START):
            return None
        return self.diagnosis.findings[int(option)]


def _describe(finding: Finding) -> Content:
    line = f"line {finding.span.line}" if finding.span is not None else "the run"
    ink = INK.warn if finding.severity == "warning" else INK.dim
    return Content.assemble(
        (f"{finding.severity}, {line}, tick {finding.tick}", f"bold {ink}"),
        "\n",
        one_line(finding.message),
        "\n",
        (one_line(f"{finding.hint} {finding.see_also}".strip()), INK.dim),
    )
