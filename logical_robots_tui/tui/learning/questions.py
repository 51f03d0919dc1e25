"""The questions of a lesson: a line for a query, its rows, and what they are worth."""

from __future__ import annotations

from textual import on
from textual.content import Content
from textual.widgets import Input, Static

from logical_robots_tui.clock import Clock
from logical_robots_tui.errors import LogicalRobotsError
from logical_robots_tui.game import Superseded
from logical_robots_tui.game.level_questions import (
    Examiner,
    mistake_lines,
    program_of,
    ticks_in_words,
)
from logical_robots_tui.language.services.completion import NAMES
from logical_robots_tui.mind import ProgramError
from logical_robots_tui.player.learning import Learning
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.inspector.pages.ask import QueryLine
from logical_robots_tui.tui.inspector.questions import BackgroundQuery, Cancelled
from logical_robots_tui.tui.inspector.table import ValueTable
from logical_robots_tui.tui.layout.dialogs import Dialog
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, one_line, visible
from logical_robots_tui.world import Level
from logical_robots_tui.world.level import LevelQuestion


class LevelQuestions(Dialog[None]):
    """Asks the questions of a level, at first one that is not answered yet."""

    DEFAULT_CSS = """
    LevelQuestions > #box { height: 90%; max-width: 88; padding: 1 2 0 2; }
    LevelQuestions #ask, LevelQuestions #where { height: auto; }
    LevelQuestions #where { color: $ink-dim; margin-bottom: 1; }
    LevelQuestions QueryLine { margin-bottom: 0; }
    LevelQuestions #verdict { height: auto; max-height: 6; margin-bottom: 1; }
    LevelQuestions ValueTable { height: 1fr; margin: 0; }
    """

    BINDINGS = [
        ("tab", "go(1)"),
        ("shift+tab", "go(-1)"),
        ("pagedown", "scroll_rows(10)"),
        ("pageup", "scroll_rows(-10)"),
    ]

    keys = "enter check   tab next question   PgDn scroll the rows   esc close"

    def __init__(self, level: Level, learning: Learning, clock: Clock) -> None:
        self._level, self._learning = level, learning
        self._examiner = Examiner(level)
        self._pending = BackgroundQuery(clock)
        self._line, self._table = QueryLine(self._leave), ValueTable()
        self._table.can_focus = False
        above = Static(id="ask"), Static(id="where")
        super().__init__("", *above, self._line, Static(id="verdict"), self._table)
        self._right = ""
        asks = [question.ask for question in level.questions]
        self._at = next((n for n, ask in enumerate(asks) if ask not in learning.answers), 0)

    @property
    def _question(self) -> LevelQuestion:
        return self._level.questions[self._at]

    def on_mount(self) -> None:
        self._show_question()

    async def on_unmount(self) -> None:
        self._pending.cancel()
        await self._examiner.close()

    def action_go(self, questions: int) -> None:
        self._at = (self._at + questions) % len(self._level.questions)
        self._show_question()

    def action_scroll_rows(self, rows: int) -> None:
        self._table.action_go(rows, 0)

    def _show_question(self) -> None:
        self._right = ""
        self._line.value = self._learning.answers.get(self._question.ask, "")
        self._line.cursor_position = len(self._line.value)
        self._table.show(None)
        self._say("")
        self._head()
        in_background(self, self._name_predicates, "predicates", exclusive=True)

    def _head(self) -> None:
        title = f"Questions · {self._level.title} · {self._learning.answered} answered"
        self.query_one("#box").border_title = Content(one_line(title))
        question, is_answered = self._question, self._question.ask in self._learning.answers
        number = f"{self._at + 1} of {len(self._level.questions)}"
        self.query_one("#ask", Static).update(
            Content.assemble(
                (f"{number}{' ✓' * is_answered}  ", INK.good if is_answered else INK.key),
                (one_line(question.ask), INK.text),
            )
        )

    async def _name_predicates(self) -> None:
        question = self._question
        where = f"{ticks_in_words(question.ticks)} of {program_of(self._level, question)}"
        where = f"About {where}, in the rows of all robots"
        self.query_one("#where", Static).update(Content(f"{where}."))
        try:
            names = [predicate.name for predicate in await self._examiner.predicates(question)]
        except LogicalRobotsError as error:
            self._say(Content.styled(one_line(str(error)), INK.bad))
            return
        self._line.complete_from([*names, *NAMES, "robot_name", "sensor", "memory"])
        self.query_one("#where", Static).update(Content(f"{where}: {', '.join(names)}."))

    def _leave(self) -> None:
        if self._pending.is_long:
            self._pending.cancel()
        else:
            self.dismiss(None)

    @on(Input.Submitted)
    def _submitted(self, event: Input.Submitted) -> None:
        event.stop()
        query = event.value.strip()
        if query and query == self._right:
            self.action_go(1)
        elif query:
            self._line.remember(query)
            in_background(self, lambda: self._check(self._question, query), "check", exclusive=True)

    async def _check(self, question: LevelQuestion, query: str) -> None:
        tick = question.ticks[0]

        def reach(reached_tick: int) -> None:
            nonlocal tick
            tick = reached_tick

        self._table.show(None)
        try:
            work = self._examiner.check(question, query, reach)
            verdict = await self._pending.run(work, lambda: f"tick {tick}", self._say)
        except (Superseded, Cancelled):
            self._say("")
        except ProgramError as error:
            self._refuse(query, error)
        except LogicalRobotsError as error:
            self._say(Content.styled(one_line(str(error)), INK.bad))
        else:
            if question is not self._question:
                return
            self._table.show(verdict.table)
            self._say(Content.styled(verdict.words, INK.good if verdict.is_right else INK.warn))
            if verdict.is_right:
                self._right = query
                self._learning.answer(question, query)
                self._head()

    def _refuse(self, query: str, error: ProgramError) -> None:
        line, caret, words = mistake_lines(query, error)
        width = max(self._line.size.width - 2, 20)
        mistake = Content(f"{caret}\n")
        if len(line) > width:  # the line above may show another part of it
            start = max(caret.index("^") - width // 2, 0)
            part = clip(visible(line[start:]), width)
            mistake = Content(f"{part}\n{caret[start:][:width]}\n")
        self._say(Content.assemble(mistake.stylize(INK.bad), (one_line(words), INK.warn)))

    def _say(self, words: Content | str) -> None:
        self.query_one("#verdict", Static).update(words)
