"""The Why page: the proof of a row, and the questions that led to it."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import isclose

from textual.content import Content
from textual.widgets.input import Selection

from logical_robots_tui.explain import Ask, Proof, ProofNode
from logical_robots_tui.explain.why.explanation import Subject, spell_call
from logical_robots_tui.game import Breakpoint, Frame, Inquiry, Superseded, read_part
from logical_robots_tui.mind import Program, ProgramError, QueryError
from logical_robots_tui.schema import VALUE
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.inspector.page import PageEntry, Placed, RobotPage, Sighted, Traced
from logical_robots_tui.tui.inspector.plots import format_value
from logical_robots_tui.tui.inspector.proof import WhyView
from logical_robots_tui.tui.inspector.questions import InspectorQuestions
from logical_robots_tui.tui.inspector.value_tree import ValueBranch
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Highlight
from logical_robots_tui.tui.layout.dialogs import Prompt
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.values import spell
from logical_robots_tui.wording import clip, one_line

_LONGEST_ARGUMENT = 24
_LONGEST_VALUE = 60
_FIRST_DEPTH = 2  # predicates deep; mostly fills the pane
_DEPTH = 100


@dataclass(frozen=True, slots=True, eq=False)
class _WhyQuestion:
    """A question at a tick: the last of the steps that led here."""

    robot: str
    steps: tuple[Ask, ...]
    frame: Frame

    @property
    def call(self) -> Ask:
        return self.steps[-1]

    def is_like(self, question: _WhyQuestion | None) -> bool:
        return question is not None and (self.robot, self.steps) == (question.robot, question.steps)


class WhyPage(RobotPage):
    """Explains what a robot did: the first level of the proof at once, the rest soon after."""

    fills = True
    view: WhyView

    def __init__(self, entry: PageEntry, questions: InspectorQuestions) -> None:
        view = WhyView(
            pointed=self._pointed, deeper=self.ask, lacking=self._unfold, back=self._back
        )
        super().__init__(entry, questions, view)
        self._steps: list[Ask] = [Ask()]
        self._shown: _WhyQuestion | None = None
        self._answered: _WhyQuestion | None = None
        self._lacking: list[tuple[_WhyQuestion, int, Ask]] = []
        self._is_proving = False
        self._depth = _FIRST_DEPTH

    def begin(self, subject: Ask) -> None:
        self._steps = [subject]

    def forget(self) -> None:
        self.begin(Ask())

    def ask(self, call: Ask) -> None:
        """Go on with another question; backspace leads back."""
        self._steps.append(call)
        self.post_message(self.Changed())

    async def show(self, frame: Frame) -> None:
        """Answer the question at a tick; while the game runs, only with the first level."""
        question = _WhyQuestion(self.robot, tuple(self._steps), frame)
        if not question.is_like(self._shown):
            self._depth = _FIRST_DEPTH
        proof = await self.answer(
            partial(self._proof, question, question.call, 1),
            lambda: f"taking the rules of {question.call.predicate} apart",
            partial(self._say_instead, question),
        )
        if proof is None:
            return
        if self._session.running:
            self._show(question, proof)
            self._show_caption(question, Content.styled("a pause unfolds it", INK.dim))
        else:
            await self._suggest(question, await self._deepen(question, proof))

    def values_here(self) -> tuple[str, Sequence[ValueBranch]]:
        node = self.view.pointed if self.view.has_focus else None
        if node is None or not node.values:
            return super().values_here()
        title = f"{node.text} (and {node.excess:,} more)" if node.excess else node.text
        if len(node.values) == 1:
            return title, (ValueBranch(node.text, node.values[0]),)
        return title, [ValueBranch(f"{n}", value) for n, value in enumerate(node.values, 1)]

    def traced_here(self) -> Traced | None:
        """The value of a column, a call, an expression or a variable."""
        robot, tick = self.robot, self._session.frame.tick
        node, *above = self.view.path or (None,)
        rule = next((n for n, step in enumerate(above) if step.is_rule), None)
        if node is None or rule is None:
            return None
        calls = (step.query for step in above[rule:] if step.query is not None)
        call = next(calls, self._steps[-1])
        if node.kind == "read" and above[0].text.startswith("Memory("):
            try:
                path = read_part(node.text)[1]
            except ValueError:
                return None
            return Traced(above[0].robot or robot, Subject(path=path), max(0, tick - 1))
        if node.kind in ("column", "aggregate") and node.query is None and not rule:
            column = node.text.split(":")[0]
            is_memory = call.predicate == "Robot" and column == "memory"
            return Traced(robot, Subject() if is_memory else Subject(call, column), tick)
        if len(node.values) != 1 or (node.span is None and node.kind != "value"):
            return None
        variable, (value,) = "" if node.span is not None else node.text, node.values
        subject = Subject(call, "", span=node.span, variable=variable, value=value)
        return Traced(robot, subject, tick)

    def breakpoint_here(self) -> Breakpoint | None:
        return self.breakpoint_at(self._steps[-1].predicate, self.robot)

    async def change_values_here(self) -> None:
        target, program = self._question_here(), self._session.program
        if target is None or program is None:
            await super().change_values_here()
            return
        program = program.for_team(self._session.level.team_of(self.robot))
        call = await self.app.push_screen_wait(ValuesPrompt(program, *target))
        if call is not None:
            self.ask(call)

    def _question_here(self) -> tuple[Ask, str] | None:
        """The question that the line under the cursor belongs to, and its column of it, or ""."""
        line = self.view.pointed
        if self._answered is None or line is None:
            return None
        above = (node.query for node in self.view.path if node.query is not None)
        call = next(above, self._answered.call)
        nodes: tuple[ProofNode, ...] = ()
        if line.kind == "column" and line.query is None:
            nodes = (line,)
        elif line.is_rule and line.holds:
            limit = _LONGEST_VALUE
            columns_below = (node for node in line.children if node.kind == "column")
            nodes = tuple(
                node
                for node in columns_below
                if all(len(spell(value, limit)) <= limit for value in node.values)
            )
        program = self._questions.program
        columns = {program.label(call.predicate, column): column for column in call.given}
        values = {n.text.split(":")[0]: n.values[0] for n in nodes if len(n.values) == 1}
        line_arguments = {columns.get(label, label): value for label, value in values.items()}
        label = line.text.split(":")[0]
        column_name, arguments = columns.get(label, label), {**call.given, **line_arguments}
        if column_name not in (VALUE, "value"):  # with other arguments a function has another value
            arguments.pop(VALUE, None)
        return replace(call, given=arguments), column_name

    async def _deepen(self, question: _WhyQuestion, proof: Proof) -> Proof:
        """Show the first level of a proof until it is as deep as there is room for; return it.

        It is as deep as possible after the player has expanded what it ended with.
        """
        trouble = ""

        def say(words: Content | str) -> None:
            nonlocal trouble
            trouble = words if isinstance(words, str) else ""
            if self._answered is not question:
                self._show(question, proof)
            self._show_caption(question, words)

        self._is_proving = True
        try:
            for depth in (self._depth, _DEPTH):
                work = partial(self._proof, question, question.call, depth)
                deeper_proof = await self.answer(work, lambda: "unfolding", say)
                if deeper_proof is None:  # calls are then proved one by one, as they are expanded
                    say(trouble)
                    break
                proof = deeper_proof
                self._show(question, proof)
                if not (proof.is_cut and self.view.has_room_for_proofs):
                    break
                self._depth = _DEPTH
        finally:
            self._is_proving = False
        return proof

    async def _suggest(self, question: _WhyQuestion, proof: Proof) -> None:
        if proof.explanation.row is not None or self._answered is not question:
            return
        try:
            inquiry, program = self._questions.context()
            robot, frame = question.robot, question.frame
            misses = await inquiry.nearest(program, robot, frame, question.call)
        except (QueryError, Superseded):
            return
        if misses and self._answered is question:
            notes = []
            for line, miss in misses:  # the reason is below, because one line would cut it off
                reason = ProofNode("note", f"{miss.reason}.", span=miss.span)
                place = f"rule in line {line}"
                notes.append(
                    ProofNode("note", miss.advice, place, span=miss.span, children=(reason,))
                )
            subject = "This change" if len(misses) == 1 else "Each of these changes"
            head = ProofNode("note", f"{subject} would give a row", children=tuple(notes))
            self._show_nodes(question, (*proof.nodes, head), ())

    def _show(self, question: _WhyQuestion, proof: Proof) -> None:
        self._answered = question
        self.say("")
        self._show_nodes(question, proof.nodes, proof.alternatives)

    def _say_instead(self, question: _WhyQuestion, words: Content | str) -> None:
        """Show a message instead of a proof; the view keeps the focus, and can go back."""
        self._answered = None
        self.say(words)
        self._show_nodes(question, (), ())
        self.post_message(Sighted(None, question.frame))

    def _show_nodes(
        self, question: _WhyQuestion, roots: Sequence[ProofNode], alternatives: Sequence[ProofNode]
    ) -> None:
        anew = not question.is_like(self._shown)
        self._shown = question
        tick = question.frame.tick
        self.head(tick, "" if tick or self._session.game is None else "what it will decide")
        self._show_caption(question)
        self.view.show(roots, alternatives, anew=anew)

    def _show_caption(self, question: _WhyQuestion, note: Content | str = "") -> None:
        names = []
        for step in question.steps:
            values = map(format_value, step.given.values())
            arguments = ", ".join(clip(value, _LONGEST_ARGUMENT) for value in values)
            names.append(f"{step.predicate}({arguments})" if arguments else step.predicate)
        line = Content.assemble(
            (f"{one_line(question.robot)}: ", INK.robot), (one_line(names[-1]), INK.title)
        )
        if note:
            words = note if isinstance(note, Content) else Content.styled(one_line(note), INK.warn)
            line = line.append("  ").append(words)
        if len(names) > 1:
            previous_names = " ← ".join(map(one_line, reversed(names[:-1])))
            line = line.append(Content.styled(f"  ← {previous_names}", INK.faint))
        self.caption(line)

    def _back(self) -> bool:
        if len(self._steps) == 1:
            return False
        self._steps.pop()
        self.post_message(self.Changed())
        return True

    def _unfold(self, key: int, call: Ask) -> None:
        self._depth = _DEPTH
        if self._answered is not None and not self._is_proving:
            self._lacking.append((self._answered, key, call))
            if len(self._lacking) == 1:
                in_background(self, self._unfold_all, "unfold")

    async def _unfold_all(self) -> None:
        """Prove the lines one by one: a newer query would cancel an older one."""
        while self._lacking:
            question, key, call = self._lacking[0]
            try:
                if self._answered is not question:
                    continue
                context = self._questions.context()
                nodes = (await self._proof(question, call, _DEPTH, *context)).nodes
            except QueryError as error:
                nodes = (ProofNode("note", str(error)),)
            except Superseded:
                self._lacking.clear()
                return
            finally:
                del self._lacking[:1]
            if self._answered is question:
                self.view.unfold(key, nodes)

    async def _proof(
        self, question: _WhyQuestion, call: Ask, depth: int, inquiry: Inquiry, program: Program
    ) -> Proof:
        return await inquiry.proof(program, question.robot, question.frame, call, depth=depth)

    def _pointed(self, node: ProofNode, moved: bool) -> None:
        question = self._answered
        if question is None:
            return
        highlight = sight(node, question.robot, question.frame)
        self.post_message(Sighted(highlight, question.frame))
        if moved and node.span is not None:
            place = node.span.start, node.span.stop
            self.post_message(Placed(self._questions.program.text, place))


def sight(node: ProofNode, robot: str, frame: Frame) -> Highlight | None:
    """The robot or ray that a proof's node is about; of equal rays, that of `robot`."""
    if node.robot:
        return Highlight(node.robot)
    if node.ray is None or len(node.values) > 1:
        return None
    value = node.values[0]
    assert isinstance(value, Mapping)
    for row in sorted(frame.sensors, key=lambda row: row["robot_name"] != robot):
        for ray in row["sensor"]["radar"]:
            # SQLite may change the last digits of an angle.
            is_at = isclose(node.ray, ray["angle"], abs_tol=1e-9)
            if is_at and value == {**ray, "angle": node.ray}:
                return Highlight(row["robot_name"], ray["angle"])
    return None


class ValuesPrompt(Prompt[Ask]):
    """Returns a question with other values; the one in `column` is selected at first."""

    DEFAULT_CSS = "ValuesPrompt > #box { max-width: 100; }"

    keys = "enter ask why   esc close"

    def __init__(self, program: Program, call: Ask, column: str) -> None:
        super().__init__("Why, or why not, with these values?", spell_call(call))
        self._program, self._within = program, call.within
        self._line.select_on_focus = False
        value = spell(call.given[column]) if column in call.given else ""
        start = self._line.value.find(value, len(call.predicate)) if value else -1
        if start >= 0:
            self._line.selection = Selection(start, start + len(value))

    def take(self, text: str) -> None:
        from logical_robots_tui.explain.why.explainer import read_ask  # which loads much

        async def read() -> None:
            try:
                call = await asyncio.to_thread(read_ask, self._program, text, self._within)
            except ProgramError as error:
                first = error.first
                self.complain(f"{first.message}. {first.hint}")
            except QueryError as error:
                self.complain(str(error))
            else:
                self.dismiss(call)

        in_background(self, read, "question", exclusive=True)

    def forget(self) -> None:
        self.workers.cancel_group(self, "question")
        self.complain("")
