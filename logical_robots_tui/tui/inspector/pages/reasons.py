"""The page of the inspector that says why, with the way that led to the question."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from textual import on
from textual.containers import Vertical
from textual.content import Content
from textual.message import Message
from textual.widgets import Static

from logical_robots_tui.game import Superseded
from logical_robots_tui.mind import Ask, Node, QueryError
from logical_robots_tui.tui.app.background import in_background
from logical_robots_tui.tui.inspector.pages.why import WhyView
from logical_robots_tui.tui.inspector.pointing import Placed, Sighted, sight
from logical_robots_tui.tui.inspector.waiting import GivenUp, Waiting, under_way
from logical_robots_tui.tui.inspector.widgets.cells import written
from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Explanation
    from logical_robots_tui.mind.diagnosis.nearest import Suggestion
    from logical_robots_tui.tui.inspector.questions import Questions

__all__ = ["ReasonsPage"]

_LONGEST_ARGUMENT = 24


@dataclass(frozen=True, slots=True, eq=False)
class _Question:
    """What is asked.

    Attributes:
        robot: In whose reasoning.
        steps: The way to it; the last one is asked.
        frame: The tick.
    """

    robot: str
    steps: tuple[Ask, ...]
    frame: Frame

    def is_like(self, other: _Question | None) -> bool:
        """Whether another one differs in the tick at most."""
        return other is not None and (self.robot, self.steps) == (other.robot, other.steps)


class ReasonsPage(Vertical):
    """Why a robot did what it did: one level of the proof at once, all of it soon.

    Args:
        questions: Whom to ask.
    """

    DEFAULT_CSS = """
    ReasonsPage { height: 1fr; }
    ReasonsPage #way {
        height: 1; padding: 0 1; color: $ink-dim; text-wrap: nowrap; text-overflow: ellipsis;
    }
    ReasonsPage #no-reason { padding: 1 2; height: auto; }
    """

    class Asked(Message):
        """There is another question to answer."""

    def __init__(self, questions: Questions) -> None:
        self._questions = questions
        self._way = Static(id="way")
        self._said = Static(id="no-reason")
        self.view = WhyView()
        super().__init__(self._way, self._said, self.view, id="reasons")
        self.waiting = Waiting()
        self._steps: list[Ask] = [Ask("Robot", {})]
        self._shown: _Question | None = None
        self._answered: _Question | None = None
        self._roots: Sequence[Node] = ()
        self._lacking: list[tuple[_Question, WhyView.Lacking]] = []
        self._is_proving = False
        self._told: Callable[[], None] = lambda: None

    @property
    def asked(self) -> Ask:
        """What is asked at the moment."""
        return self._steps[-1]

    def begin(self, predicate: str) -> None:
        """Begin with the question why a predicate has its rows."""
        self._steps = [Ask(predicate, {})]
        self.post_message(self.Asked())

    async def follow(
        self, robot: str, frame: Frame, told: Callable[[], None], *, whole: bool = True
    ) -> None:
        """Answer the question at a tick.

        Args:
            robot: In whose reasoning.
            frame: The tick.
            told: Called when what is shown begins to be about this tick.
            whole: Whether the first level is not enough; while robots run, they come first.
        """
        self._told = told
        question = _Question(robot, tuple(self._steps), frame)
        try:
            why = self._questions.why(robot, frame, question.steps[-1])
            found = await self.waiting.answer(why, partial(self._wait, question))
            if whole:
                await self._prove(question, found)
                await self._suggest(question, found)
            else:
                self._show(question, found, _proving(found))
                self._name_way(question, Content.styled("a pause unfolds it", INK.dim))
        except Superseded:
            return
        except GivenUp:
            self._say(question, f"Stopped after {self.waiting.seconds:.1f} s.")
        except QueryError as error:
            self._say(question, str(error))

    async def _prove(self, question: _Question, found: Explanation) -> None:
        """Show the whole proof, and as long as that is not there the first level of it."""

        def wait() -> None:
            if self._answered is not question:
                self._show(question, found, _proving(found))
            self._name_way(question, under_way("unfolding", self.waiting.seconds))

        robot, asked, frame = question.robot, question.steps[-1], question.frame
        trouble = ""
        self._is_proving = True
        try:
            proof = await self.waiting.answer(self._questions.proof(robot, frame, asked), wait)
            self._show(question, proof.explanation, proof.nodes)
        except GivenUp:
            trouble = f"stopped after {self.waiting.seconds:.1f} s"
        except QueryError as error:
            trouble = str(error)
        except Superseded:
            pass  # calls are unfolded one by one then
        finally:
            self._is_proving = False
        if self._answered is not question:
            self._show(question, found, _proving(found))
        self._name_way(question, Content.styled(one_line(trouble), INK.warn))

    async def _suggest(self, question: _Question, found: Explanation) -> None:
        """Show which one change would have given a row, if there is none."""
        asked = question.steps[-1]
        if found.row is not None or asked.given or asked.within or self._answered is not question:
            return
        try:
            misses = await self._questions.nearest(question.robot, question.frame, asked.predicate)
        except (QueryError, Superseded):
            return
        if misses and self._answered is question:
            nodes = (_suggestion(line, each) for line, each in misses)
            head = Node("note", "One of these would give a row", children=tuple(nodes))
            self._show_nodes(question, (*self._roots, head), ())

    def _show(self, question: _Question, found: Explanation, roots: Sequence[Node]) -> None:
        self._answered, self._roots = question, roots
        self._said.display = False
        self._show_nodes(question, roots, () if found.row is None else _others(found))

    def _wait(self, question: _Question) -> None:
        """Show that a question is under way, and no answer to another one."""
        what = f"taking the rules of {question.steps[-1].predicate} apart"
        self._show_words(question, under_way(what, self.waiting.seconds))

    def _say(self, question: _Question, message: str) -> None:
        self._show_words(question, Content.styled(one_line(message), INK.warn))

    def _show_words(self, question: _Question, words: Content) -> None:
        self._answered = None
        self._said.update(words)
        self._said.display = True
        self._show_nodes(question, (), ())  # the view keeps the focus, and knows the way back
        self.post_message(Sighted(None, question.frame))

    def _show_nodes(self, question: _Question, roots: Sequence[Node], rest: Sequence[Node]) -> None:
        anew = not question.is_like(self._shown)
        self._shown = question
        self._told()
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

    @on(WhyView.Deeper)
    def _deeper(self, event: WhyView.Deeper) -> None:
        event.stop()
        self._steps.append(event.asked)
        self.post_message(self.Asked())

    @on(WhyView.Back)
    def _back(self, event: WhyView.Back) -> None:
        event.stop()
        if len(self._steps) > 1:
            self._steps.pop()
            self.post_message(self.Asked())

    @on(WhyView.Lacking)
    def _unfold(self, event: WhyView.Lacking) -> None:
        """Ask for the proof of what a line asks, unless the whole proof is on its way."""
        event.stop()
        if self._answered is not None and not self._is_proving:
            self._lacking.append((self._answered, event))
            if len(self._lacking) == 1:
                in_background(self, self._unfold_all, "unfold")

    async def _unfold_all(self) -> None:
        """Ask for one proof after the other: a newer question would end an older one."""
        while self._lacking:
            question, event = self._lacking[0]
            try:
                if self._answered is question:
                    nodes = await self._proved(question, event.asked)
                    if self._answered is question:
                        self.view.unfold(event.key, nodes)
            except Superseded:
                self._lacking.clear()
            finally:
                del self._lacking[:1]

    async def _proved(self, question: _Question, asked: Ask) -> Sequence[Node]:
        try:
            proof = await self._questions.proof(question.robot, question.frame, asked)
        except QueryError as error:
            return (Node("note", str(error)),)
        return proof.nodes

    @on(WhyView.Pointed)
    def _pointed(self, event: WhyView.Pointed) -> None:
        """Show where the node under the cursor stands in the program and in the labyrinth."""
        event.stop()
        question, node = self._answered, event.node
        if question is None or node is not self.view.pointed:
            return
        highlight = sight(node, question.robot, question.frame)
        self.post_message(Sighted(highlight, question.frame))
        if event.moved and node.span is not None:
            place = node.span.start, node.span.stop
            self.post_message(Placed(self._questions.program.text, place))


def _suggestion(rule: int, each: Suggestion) -> Node:
    change = f"write {each.change}" if each.change else f"leave out {each.span.text}"
    text = f"line {each.span.line}: {change}"
    return Node("note", text, f"rule in line {rule}: {each.text}", span=each.span)


def _proving(found: Explanation) -> Sequence[Node]:
    """The rule that gives the row, or all if none does."""
    if found.row is None:
        return found.nodes
    giving = [rule.node for rule in found.rules if rule.row is not None]
    return giving[:1] or found.nodes[-1:]


def _others(found: Explanation) -> Sequence[Node]:
    """The rules that have no part in the proof of the row."""
    proving = _proving(found)
    return [node for node in found.nodes if node is not proving[0]]


def _arguments(asked: Ask) -> str:
    return ", ".join(clip(written(value), _LONGEST_ARGUMENT) for value in asked.given.values())
