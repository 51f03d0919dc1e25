"""Why-not with values of one's own: where rules stop when a value of a proof is changed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.widgets import Input

from logical_robots_tui.tui.inspector.pages.why import ValuesPrompt
from tests.tui.conftest import opened
from tests.tui.inspector.test_why import (
    PROVED,
    TALL,
    TWO_RULES,
    asked_why,
    go_to,
    nodes,
    told,
    view,
)

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened


async def prompted(game: Opened, text: str) -> ValuesPrompt:
    """Ask for other values on the first line that begins with a text."""
    await go_to(game, text)
    await game.press("exclamation_mark")
    await game.until(lambda: isinstance(game.app.screen, ValuesPrompt))
    assert isinstance(game.app.screen, ValuesPrompt)
    return game.app.screen


def line(prompt: ValuesPrompt) -> Input:
    return prompt.query_one(Input)


async def test_other_values_show_where_rules_stop_and_nonsense_can_be_mended(
    data_dir: Path,
) -> None:
    async with opened(data_dir, text=TWO_RULES, size=TALL) as game:
        await game.ready()
        await game.press("exclamation_mark")
        await game.sees("Put the cursor on a line of a proof; w makes one.")
        assert not view(game).lines
        await asked_why(game)
        await game.until(lambda: PROVED in told(game))

        # Another argument shows where a function stops.
        prompt = await prompted(game, "Speed(d) = 0.5")
        assert line(prompt).value.startswith("Speed(")
        line(prompt).value = "Speed(7)"
        await game.press("enter")
        await game.until(lambda: "d > 20" in told(game) and nodes(game)[0].holds is False)
        await game.sees("Speed(7)")
        await game.press("backspace")
        await game.until(lambda: told(game)[:1] and told(game)[0].startswith("Robot("))

        # The value under the cursor is selected.
        prompt = await prompted(game, "memory")
        assert line(prompt).value == 'Robot(memory: "far")'
        assert line(prompt).selected_text == '"far"'
        for nonsense, message in [
            ("Robot(memory: far + 1)", "This is not a value."),
            ("Robot(memory: ", "is never closed"),
            ("Robot(mood: 1)", "Robot has no column mood"),
            ("Robbot(1)", "no rules for Robbot"),
            ("Speed()", "Speed is a function"),
        ]:
            line(prompt).value = nonsense
            await game.press("enter")
            await game.sees(message)
            assert game.app.screen is prompt
        line(prompt).value = "Speed(30)"
        await game.press("enter")
        await game.until(lambda: told(game)[0].startswith("Speed(d)"))
        await game.press("backspace")
        await game.until(lambda: told(game)[:1] and told(game)[0].startswith("Robot("))
        await prompted(game, "memory")
        await game.press(*'"near"', "enter")
        await game.until(lambda: told(game)[0].startswith("Robot(") and not nodes(game)[0].holds)
        assert nodes(game)[0].said == "does not apply to these values"
