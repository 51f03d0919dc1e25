"""A proof of 10,000 nodes in the inspector: from a key or a click to the lines to send."""

from __future__ import annotations

import asyncio
from time import process_time
from typing import TYPE_CHECKING

from textual.app import App, ComposeResult

from benchmarks.measure import Effort, Measurement, at_most, repeated, summed_up
from logical_robots_tui.explain import ProofNode
from logical_robots_tui.tui.inspector.proof import WhyView
from logical_robots_tui.tui.theme.themes import NIGHT, colours_in

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["folding"]

SIZE = (120, 40)
NEXT_TICK = "another tick, all open"
NODES, BESIDE, DEEP = 10_000, 99, 100


def folding(effort: Effort) -> Iterator[Measurement]:
    """Measure the processor time in milliseconds of actions on a large proof."""
    found: dict[str, list[float]] = {}
    for once in repeated(effort.repeats, lambda: asyncio.run(_in_a_view())):
        for what, milliseconds in once.items():
            found.setdefault(what, []).append(milliseconds)
    subject = f"{NODES:,} nodes, {SIZE[0]}x{SIZE[1]}"
    for what, times in found.items():
        target = at_most(100) if what == NEXT_TICK else at_most(50)
        yield summed_up(what, subject, "ms", times, target=target)


async def _in_a_view() -> dict[str, float]:
    """Return the milliseconds of each action."""
    app, found = _Proof(), {}
    async with app.run_test(size=SIZE) as pilot:
        await pilot.pause()
        view, proof = app.view, _proof()

        async def measure(what: str, work: Callable[[], object]) -> None:
            began = process_time()
            work()
            await pilot.pause(0)
            for row in range(view.size.height):
                view.render_line(row)
            found[what] = 1000 * (process_time() - began)

        await measure("another proof comes", lambda: view.show([proof], anew=True))
        while folded := _folded(view):
            for number in reversed(folded):
                view.open(number)
        assert len(view.lines) == NODES
        await pilot.pause()
        await measure("the next line", lambda: view.action_move(1))
        await measure("a page on", lambda: view.action_page(1))
        await measure("to the end", lambda: view.action_move(NODES))
        view.action_move(-NODES)
        await measure("all is folded", lambda: view.close(0))
        await measure("all is opened", lambda: view.open(0))
        await measure(NEXT_TICK, lambda: view.show([proof]))
    return found


def _folded(view: WhyView) -> list[int]:
    """Return the lines that are still folded."""
    return [n for n, line in enumerate(view.lines) if line.folds and not view.is_open(n)]


def _proof() -> ProofNode:
    """Return a rule with several deep branches."""
    branches = []
    for branch in range(BESIDE):
        node = ProofNode(
            "value", f"ray.distance of {branch}", values=({"angle": 0.1, "distance": 3},)
        )
        for depth in range(DEEP):
            node = ProofNode("call", f"Calls{depth}(x:)", holds=True, children=(node,))
        branches.append(node)
    return ProofNode("rule", "Robot(robot_name:) :- Many()", holds=True, children=tuple(branches))


class _Proof(App[None]):
    """An app that shows only a proof."""

    def __init__(self) -> None:
        super().__init__()

        def ignore(*_: object) -> None:
            """The benchmark only draws."""

        self.view = WhyView(pointed=ignore, deeper=ignore, lacking=ignore, back=lambda: False)
        self.register_theme(NIGHT)
        self.theme = NIGHT.name

    def get_theme_variable_defaults(self) -> dict[str, str]:
        """Return the colours that the widgets use."""
        return colours_in(self.current_theme)

    def compose(self) -> ComposeResult:
        """Yield the view."""
        yield self.view
