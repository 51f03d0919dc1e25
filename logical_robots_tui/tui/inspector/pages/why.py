"""The Why page: the proof of a row, and the questions that led to it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.explain import Ask, Explanation, Node, Proof
from logical_robots_tui.game import Frame, Superseded
from logical_robots_tui.mind import QueryError
from logical_robots_tui.schema import VALUE
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.inspector.page import (
    NO_PROGRAM,
    Cancelled,
    Page,
    Placed,
    Questions,
    Sighted,
    progress,
    sight,
)
from logical_robots_tui.tui.inspector.widgets.plots import format_value
from logical_robots_tui.tui.inspector.widgets.proof_view import WhyView
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.values import spell
from logical_robots_tui.wording import clip, one_line

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.nearest import Suggestion
    from logical_robots_tui.player.session import Session

_LONGEST_ARGUMENT = 24
_LONGEST_VALUE = 60
_FIRST_DEPTH = 2  # predicates deep; mostly fills the pane
_DEPTH = 100


@dataclass(frozen=True, slots=True, eq=False)
class _Question:
    """A question at a tick: the last of the steps that led here."""

    robot: str
    steps: tuple[Ask, ...]
    frame: Frame

    @property
    def asked(self) -> Ask:
        return self.steps[-1]

    def is_like(self, other: _Question | None) -> bool:
        return other is not None and (self.robot, self.steps) == (other.robot, other.steps)


class WhyPage(Page):
    """Explains what a robot did: the first level of the proof at once, the rest soon after."""

    DEFAULT_CSS = """
    WhyPage #way {
        height: 1; padding: 0 1; color: $ink-dim; text-wrap: nowrap; text-overflow: ellipsis;
    }
    """

    title = "Why"
    view: WhyView
    depends_on_robot = True

    def __init__(self, session: Session, questions: Questions) -> None:
        self._way = Static(id="way")
        view = WhyView(
            pointed=self._pointed, deeper=self.ask, lacking=self._unfold, back=self._back
        )
        super().__init__(session, questions, view, above=(self._way,))
        self._steps: list[Ask] = [Ask("Robot", {})]
        self._shown: _Question | None = None
        self._answered: _Question | None = None
        self._roots: Sequence[Node] = ()
        self._lacking: list[tuple[_Question, int, Ask]] = []
        self._is_proving = False
        self._depth = _FIRST_DEPTH

    @property
    def asked(self) -> Ask:
        """The question whose answer is shown."""
        return self._steps[-1]

    def begin(self, predicate: str) -> None:
        self._steps = [Ask(predicate, {})]
        self.post_message(self.Changed())

    def ask(self, asked: Ask) -> None:
        """Go on with another question; backspace leads back."""
        self._steps.append(asked)
        self.post_message(self.Changed())

    @property
    def question_here(self) -> tuple[Ask, str] | None:
        """The question that the line under the cursor belongs to, and its column of it, or ""."""
        line = self.view.pointed
        if self._answered is None or line is None:
            return None
        asked = next(iter(self.view.questions_above), self._answered.asked)
        own: tuple[Node, ...] = ()
        if line.kind == "column" and line.asked is None:
            own = (line,)
        elif line.kind == "rule" and line.holds:
            own = tuple(n for n in line.children if n.kind == "column" and _is_short(n))
        program = self._questions.program
        columns = {program.label(asked.predicate, column): column for column in asked.given}
        values = {node.text.split(":")[0]: node.values[0] for node in own if len(node.values) == 1}
        given = {columns.get(label, label): value for label, value in values.items()}
        label = line.text.split(":")[0]
        here = columns.get(label, label)
        given = {**asked.given, **given}
        if here not in (VALUE, "value"):  # with other arguments a function has another value
            given.pop(VALUE, None)
        return replace(asked, given=given), here

    async def show(self, frame: Frame) -> None:
        """Answer the question at a tick; while the game runs, only with the first level."""
        question = _Question(self.robot, tuple(self._steps), frame)
        if not question.is_like(self._shown):
            self._depth = _FIRST_DEPTH

        def report() -> None:
            what = f"taking the rules of {question.asked.predicate} apart"
            self._say_instead(question, progress(what, self.pending.seconds))

        if self._session.game is None:
            self._say_instead(question, NO_PROGRAM)
            return
        try:
            inquiry, program = self._questions.about()
            why = inquiry.why(program, question.robot, frame, question.asked)
            found = await self.pending.run(why, report)
            if self._session.running:
                self._show(question, found, _proving(found))
                self._name_way(question, Content.styled("a pause unfolds it", INK.dim))
            else:
                await self._prove(question, found)
                await self._suggest(question, found)
        except Superseded:
            return
        except Cancelled:
            self._say_instead(question, f"Stopped after {self.pending.seconds:.1f} s.")
        except QueryError as error:
            self._say_instead(question, str(error))

    async def _prove(self, question: _Question, found: Explanation) -> None:
        """Show the first level of a proof until it is as deep as there is room for.

        It is as deep as possible after the player has expanded what it ended with.
        """

        def report() -> None:
            if self._answered is not question:
                self._show(question, found, _proving(found))
            self._name_way(question, progress("unfolding", self.pending.seconds))

        robot, asked, frame = question.robot, question.asked, question.frame
        trouble = ""
        self._is_proving = True
        try:
            for depth in (self._depth, _DEPTH):
                work = self._proof(robot, frame, asked, depth)
                proof = await self.pending.run(work, report)
                self._show(question, proof.explanation, proof.nodes)
                if not (proof.is_cut and self.view.has_room_for_proofs):
                    break
                self._depth = _DEPTH
        except Cancelled:
            trouble = f"stopped after {self.pending.seconds:.1f} s"
        except QueryError as error:
            trouble = str(error)
        except Superseded:
            pass  # calls are then proved one by one, as they are expanded
        finally:
            self._is_proving = False
        if self._answered is not question:
            self._show(question, found, _proving(found))
        self._name_way(question, Content.styled(one_line(trouble), INK.warn))

    async def _suggest(self, question: _Question, found: Explanation) -> None:
        if found.row is not None or self._answered is not question:
            return
        try:
            inquiry, program = self._questions.about()
            robot, frame = question.robot, question.frame
            misses = await inquiry.nearest(program, robot, frame, question.asked)
        except (QueryError, Superseded):
            return
        if misses and self._answered is question:
            nodes = (_suggestion(line, each) for line, each in misses)
            said = "This change" if len(misses) == 1 else "Each of these changes"
            head = Node("note", f"{said} would give a row", children=tuple(nodes))
            self._show_nodes(question, (*self._roots, head), ())

    def _show(self, question: _Question, found: Explanation, roots: Sequence[Node]) -> None:
        self._answered, self._roots = question, roots
        self.say("")
        self._show_nodes(question, roots, () if found.row is None else _others(found))

    def _say_instead(self, question: _Question, words: Content | str) -> None:
        """Show a message instead of a proof; the view keeps the focus, and can go back."""
        self._answered = None
        self.say(words)
        self._show_nodes(question, (), ())
        self.post_message(Sighted(None, question.frame))

    def _show_nodes(self, question: _Question, roots: Sequence[Node], rest: Sequence[Node]) -> None:
        anew = not question.is_like(self._shown)
        self._shown = question
        tick = question.frame.tick
        self.head(tick, "" if tick or self._session.game is None else "nobody has thought yet")
        self._name_way(question)
        self.view.show(roots, rest, anew=anew, has_way_back=len(question.steps) > 1)

    def _name_way(self, question: _Question, more: Content | None = None) -> None:
        names = [
            f"{step.predicate}({_arguments(step)})" if step.given else step.predicate
            for step in question.steps
        ]
        way = Content.assemble(
            (f"{one_line(question.robot)}: ", INK.robot), (one_line(names[-1]), INK.title)
        )
        if more:
            way = way.append("  ").append(more)
        if len(names) > 1:
            before = " ← ".join(map(one_line, reversed(names[:-1])))
            way = way.append(Content.styled(f"  ← {before}", INK.faint))
        self._way.update(way, layout=False)

    def _back(self) -> None:
        if len(self._steps) > 1:
            self._steps.pop()
            self.post_message(self.Changed())

    def _unfold(self, key: int, asked: Ask) -> None:
        self._depth = _DEPTH
        if self._answered is not None and not self._is_proving:
            self._lacking.append((self._answered, key, asked))
            if len(self._lacking) == 1:
                in_background(self, self._unfold_all, "unfold")

    async def _unfold_all(self) -> None:
        """Prove the lines one by one: a newer query would cancel an older one."""
        while self._lacking:
            question, key, asked = self._lacking[0]
            try:
                if self._answered is question:
                    nodes = await self._proved(question, asked)
                    if self._answered is question:
                        self.view.unfold(key, nodes)
            except Superseded:
                self._lacking.clear()
            finally:
                del self._lacking[:1]

    async def _proof(self, robot: str, frame: Frame, asked: Ask, depth: int = _DEPTH) -> Proof:
        inquiry, program = self._questions.about()
        return await inquiry.proof(program, robot, frame, asked, depth=depth)

    async def _proved(self, question: _Question, asked: Ask) -> Sequence[Node]:
        try:
            proof = await self._proof(question.robot, question.frame, asked)
        except QueryError as error:
            return (Node("note", str(error)),)
        return proof.nodes

    def _pointed(self, node: Node, moved: bool) -> None:
        question = self._answered
        if question is None:
            return
        highlight = sight(node, question.robot, question.frame)
        self.post_message(Sighted(highlight, question.frame))
        if moved and node.span is not None:
            place = node.span.start, node.span.stop
            self.post_message(Placed(self._questions.program.text, place))


def _is_short(node: Node) -> bool:
    return all(len(spell(value, _LONGEST_VALUE)) <= _LONGEST_VALUE for value in node.values)


def _suggestion(rule: int, each: Suggestion) -> Node:
    return Node("note", each.text, f"rule in line {rule}", span=each.span)


def _proving(found: Explanation) -> Sequence[Node]:
    """Return the rule that derives the row, or all rules if none does."""
    if found.row is None:
        return found.nodes
    giving = [rule.node for rule in found.rules if rule.row is not None]
    return giving[:1] or found.nodes[-1:]


def _others(found: Explanation) -> Sequence[Node]:
    proving = _proving(found)
    return [node for node in found.nodes if node is not proving[0]]


def _arguments(asked: Ask) -> str:
    return ", ".join(clip(format_value(value), _LONGEST_ARGUMENT) for value in asked.given.values())
