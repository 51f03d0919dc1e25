"""The page of the inspector that says why, with the way that led to the question."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual import on
from textual.containers import Vertical
from textual.content import Content
from textual.message import Message
from textual.widgets import Static

from logical_robots_tui.game import Superseded
from logical_robots_tui.mind import Ask, QueryError, tell
from logical_robots_tui.tui.inspector.cells import written
from logical_robots_tui.tui.inspector.why import WhyView
from logical_robots_tui.tui.plain import clip, one_line
from logical_robots_tui.tui.theme import INK

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame
    from logical_robots_tui.tui.inspector.questions import Questions

__all__ = ["ReasonsPage"]

_LONGEST_ARGUMENT = 24


class ReasonsPage(Vertical):
    """Why a robot did what it did, one step deeper on demand.

    Args:
        questions: Whom to ask.
    """

    DEFAULT_CSS = """
    ReasonsPage { height: 1fr; }
    ReasonsPage #way { height: 1; padding: 0 1; color: $ink-dim; text-wrap: nowrap; }
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
        self._steps: list[Ask] = [Ask("Robot", {})]
        self._shown: tuple[str, tuple[Ask, ...]] | None = None

    @property
    def asked(self) -> Ask:
        """What is asked at the moment."""
        return self._steps[-1]

    def begin(self, predicate: str) -> None:
        """Begin with the question why a predicate has its rows."""
        self._steps = [Ask(predicate, {})]
        self.post_message(self.Asked())

    async def follow(self, robot: str, frame: Frame) -> None:
        """Answer the question at a tick.

        Args:
            robot: In whose reasoning.
            frame: The tick.
        """
        steps = tuple(self._steps)
        if self._shown is None or self._shown[1] != steps:
            self._name_way(robot, " · taking the rules apart…")
        try:
            found = await self._questions.why(robot, frame, steps[-1])
        except Superseded:
            return
        except QueryError as error:
            self._say(robot, str(error))
            return
        if steps == tuple(self._steps):
            self._name_way(robot)
            self._said.display, self.view.display = False, True
            self.view.show(tuple(tell(found)), anew=self._shown != (robot, steps))
            self._shown = (robot, steps)

    def _say(self, robot: str, message: str) -> None:
        self._name_way(robot)
        self._said.update(Content.styled(one_line(message), INK.warn))
        self._said.display, self.view.display = True, False
        self._shown = None

    def _name_way(self, robot: str, more: str = "") -> None:
        names = [
            f"{step.predicate}({_arguments(step)})" if step.given else step.predicate
            for step in self._steps
        ]
        way = Content.assemble((f"{one_line(robot)}: ", INK.robot), (names[-1], INK.title))
        if len(names) > 1:
            way = way.append(Content.styled(f"  ← {' ← '.join(reversed(names[:-1]))}", INK.faint))
        self._way.update(way.append(Content.styled(more, INK.dim)), layout=False)

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


def _arguments(asked: Ask) -> str:
    return ", ".join(clip(written(value), _LONGEST_ARGUMENT) for value in asked.given.values())
