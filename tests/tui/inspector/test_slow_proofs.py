"""Proofs that take long: what is shown meanwhile, and how they are stopped."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

import pytest

from logical_robots_tui.explain import Ask, Node
from logical_robots_tui.game import Inquiry
from tests.tui.conftest import SLOW, opened
from tests.tui.inspector.test_why import CALL, TALL, TWO_RULES, asked_why, go_to, told, view

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.explain import Explanation, Proof
    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Program


async def test_a_proof_that_takes_long_says_so_and_can_be_stopped(data_dir: Path) -> None:
    async with opened(data_dir, text=SLOW) as game:
        await game.ready()
        with game.impatient():
            await game.press("w")
            await game.sees("taking the rules of Robot apart")
            await game.sees("s  esc here stops it")
            await game.press("escape")
            await game.sees("Stopped after ")
        assert view(game).has_focus


async def test_the_first_level_is_there_before_the_whole_proof(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    is_let, prove = asyncio.Event(), Inquiry.proof

    async def late(*asked: Any, **about: Any) -> Proof:
        await is_let.wait()
        return await prove(*asked, **about)

    monkeypatch.setattr(Inquiry, "proof", late)
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: game.shows("Solo: Robot  ") and game.shows("unfolding"))
        place = await go_to(game, CALL)
        assert not view(game).is_open(place)
        await game.press("right")  # which waits for the proof that is on its way
        await game.until(lambda: view(game).is_open(place))
        is_let.set()
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        assert told(game)[told(game).index(CALL) + 1] == "Speed(d) = 0.5 :- d > 20"
        assert view(game).line is view(game).lines[place]
        await game.sees_no("unfolding")


async def test_while_robots_run_the_first_level_is_enough(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.press("space")
        await game.sees("a pause unfolds it")
        assert CALL in told(game)
        assert "Speed(d) = 0.5 :- d > 20" not in told(game)
        await game.press("space")
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        await game.sees_no("a pause unfolds it")
        await game.sees(f"Why · tick {game.tick}")


async def test_unfolding_can_be_stopped_and_goes_on_call_by_call(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    prove, asked_for = Inquiry.proof, list[str]()

    async def never_of_robot(
        inquiry: Inquiry, program: Program, robot: str, frame: Frame, asked: Ask, depth: int
    ) -> Proof:
        asked_for.append(asked.predicate)
        if asked.predicate == "Robot":
            await asyncio.Event().wait()
        return await prove(inquiry, program, robot, frame, asked, depth=depth)

    monkeypatch.setattr(Inquiry, "proof", never_of_robot)
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.sees("unfolding")
        await game.press("escape")
        await game.sees("Stopped after")
        await go_to(game, CALL)
        await game.press("right")
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        assert asked_for == ["Robot", "Speed"]


async def test_two_calls_that_are_opened_at_once_are_both_proved(data_dir: Path) -> None:
    text = TWO_RULES.replace("d <= 20,", "Close(d), Low(d),")
    text += "Close(d) :- d <= 20;\nLow(d) :- d <= 30;\n"
    async with opened(data_dir, text=text, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        lacking = [
            Node("call", f"{name}(d)", asked=Ask(name, {"col0": 10})) for name in ("Close", "Low")
        ]
        view(game).show([Node("rule", "both", children=tuple(lacking))], anew=True)
        view(game).open(2)
        view(game).open(1)
        await game.until(lambda: any(each.startswith("Close(d) :-") for each in told(game)))
        await game.until(lambda: any(each.startswith("Low(d) :-") for each in told(game)))


async def test_the_cursor_stays_while_a_slow_answer_for_another_tick_is_awaited(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    is_let, ask = asyncio.Event(), Inquiry.why
    is_let.set()

    async def late(*asked: Any, **about: Any) -> Explanation:
        await is_let.wait()
        return await ask(*asked, **about)

    monkeypatch.setattr(Inquiry, "why", late)
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: "Speed(d) = 0.5 :- d > 20" in told(game))
        place = await go_to(game, CALL)
        is_let.clear()
        await game.press("n")
        await game.sees("taking the rules of Robot apart")
        assert not view(game).lines
        is_let.set()
        await game.until(lambda: view(game).lines)
        await game.until(lambda: view(game).line is view(game).lines[place])
        assert told(game)[place] == CALL


@pytest.mark.slow
async def test_no_old_proof_stands_under_a_new_question(data_dir: Path) -> None:
    text = SLOW.split("Robot(")[0] + TWO_RULES
    async with opened(data_dir, text=text) as game:
        await asked_why(game)
        game.inspector.inspect("Many")
        await game.press("w")
        await game.sees("Solo: Many")
        assert not any(text.startswith("Robot(") for text in told(game))
