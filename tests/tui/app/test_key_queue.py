"""Keys that come all at once, as they do over a slow line."""

from functools import partial
from pathlib import Path

from textual import events
from textual.widgets import Button, Input

from logical_robots_tui.tui.layout.dialogs import LinePrompt, QuestionDialog
from tests.tui.conftest import Opened, key_event, opened


def press_at_once(game: Opened, *keys: str) -> None:
    for key in keys:
        game.app.post_message(key_event(key))


async def test_keys_go_where_those_before_them_have_led(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        for key in "soU":
            press_at_once(game, key, *"n12")
            await game.until(lambda: game.app.screen is not game.main)
            await game.until(partial(holds, game.app.screen.query_one(Input), "n12"))
            press_at_once(game, "escape", "n")
            await game.until(lambda: game.app.screen is game.main)
        await game.until(lambda: game.tick == 3)

        dialogs = (QuestionDialog("Title", "Really?", [("yes", "Yes")]), LinePrompt("Title"))
        for tick, dialog in enumerate(dialogs, start=4):  # for what an answer leads to
            game.app.push_screen(dialog)
            await game.until(lambda: isinstance(game.app.focused, Button | Input))
            press_at_once(game, "enter", "n")
            await game.press(tick=tick)

        before = game.editor.text
        press_at_once(game, *"2x", "escape", *"1n")  # for a pane
        await game.until(lambda: game.tick == 6)
        assert len(game.editor.text) == len(before) + 1

        press_at_once(game, *"Mb", "shift+right", "enter", "enter", *"uMn")  # for the level editor
        await game.until(lambda: game.tick == 7)
        assert not game.main.editing.is_on
        assert game.main.editing.levels.edits.can_redo
    assert not game.app.screen_stack
    for event in (events.Key("x", "x"), events.Paste("x")):  # while the game ends
        await game.app.on_event(event)


def holds(field: Input, text: str) -> bool:
    return field.value == text
