"""Proofs that take long: what is shown meanwhile, and how they are stopped."""

import asyncio
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.explain import Ask, Explanation, Proof
from logical_robots_tui.game import Frame, Inquiry
from logical_robots_tui.mind import Program
from tests.tui.conftest import SLOW, opened
from tests.tui.inspector.test_why import CALL, PROVED, TALL, TWO_RULES, asked_why, go_to, told, view


async def test_a_slow_proof_can_be_stopped(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    is_proved, is_asked, asked_for = asyncio.Event(), asyncio.Event(), list[str]()
    prove, ask = Inquiry.proof, Inquiry.why
    is_asked.set()

    async def proof(
        inquiry: Inquiry, program: Program, robot: str, frame: Frame, asked: Ask, depth: int
    ) -> Proof:
        asked_for.append(asked.predicate)
        if asked.predicate == "Robot":
            await is_proved.wait()
        return await prove(inquiry, program, robot, frame, asked, depth=depth)

    async def why(*about: Any, **options: Any) -> Explanation:
        await is_asked.wait()
        return await ask(*about, **options)

    monkeypatch.setattr(Inquiry, "proof", proof)
    monkeypatch.setattr(Inquiry, "why", why)
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await asked_why(game)
        await game.until(lambda: game.shows("Solo: Robot  ") and game.shows("unfolding"))

        # Unfolding can be stopped and goes on call by call.
        await game.press("escape", sees="Stopped after")
        place = await go_to(game, CALL)
        await game.press("right", until=lambda: PROVED in told(game))
        assert asked_for == ["Robot", "Speed"]

        # A call that is opened meanwhile waits for the proof that is on its way.
        await game.press("left", "n")
        await game.until(lambda: game.shows("Why · tick 2") and game.shows("unfolding"))
        assert not view(game).is_open(place)
        await game.press("right", until=lambda: view(game).is_open(place))
        assert asked_for == ["Robot", "Speed", "Robot"]
        is_proved.set()
        await game.until(lambda: PROVED in told(game))
        assert told(game)[place + 1] == PROVED
        assert view(game).line is view(game).lines[place]
        await game.sees_no("unfolding")

        # The cursor stays while a slow answer for another tick is awaited.
        is_asked.clear()
        await game.press("n", sees="taking the rules of Robot apart")
        assert not view(game).lines
        await game.sees("s  esc here stops it")
        await game.press("escape", sees="Stopped after ")
        assert view(game).has_focus
        await game.press("n", sees="taking the rules of Robot apart")
        is_asked.set()
        await game.until(lambda: view(game).lines and view(game).line is view(game).lines[place])
        assert told(game)[place] == CALL

        # While robots run, the first level is enough.
        game.inspector.inspect("robots")
        await game.press("space", "w", sees="a pause unfolds it")
        assert CALL in told(game)
        assert PROVED not in told(game)
        await game.press("space", until=lambda: PROVED in told(game), sees_no="a pause unfolds it")
        await game.sees(f"Why · tick {game.tick}")


@pytest.mark.slow
async def test_no_old_proof_stands_under_a_new_question(data_dir: Path) -> None:
    text = SLOW.split("Robot(")[0] + TWO_RULES
    async with opened(data_dir, text=text) as game:
        await asked_why(game)
        game.inspector.inspect("Many")
        await game.press("w", sees="Solo: Many")
        assert not any(line.startswith("Robot(") for line in told(game))
