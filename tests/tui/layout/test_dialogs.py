"""Dialogs and lists, whatever comes in when they have just changed or gone."""

from pathlib import Path

import pytest
from rich.style import Style
from textual import events
from textual.widgets import Input, OptionList

from logical_robots_tui.game import ProgramSource, load_program
from logical_robots_tui.tui.commands.help import PaletteScreen
from logical_robots_tui.tui.layout.dialogs import QuestionDialog
from logical_robots_tui.tui.library.chooser import Chooser, ProgramShelf
from logical_robots_tui.tui.library.save_dialog import SaveAs
from tests.tui.conftest import PAPER, opened
from tests.virtual_time import Hold


async def test_saves_and_choices_come_late(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hold, choice = Hold(), Hold()

    def save_slowly(path: Path, text: str) -> None:
        hold.here()
        path.write_text(text)

    def take(shelf: ProgramShelf, name: str) -> ProgramSource:
        choice.here()
        return load_program(name, shelf.folder)

    monkeypatch.setattr("logical_robots_tui.tui.library.save_dialog.save_program", save_slowly)
    monkeypatch.setattr(ProgramShelf, "take", take)
    async with opened(data_dir) as game:
        await game.press("s", on=SaveAs)
        await game.fill("other")
        saving = game.app.screen
        await game.press("enter", until=lambda: hold.has_begun)
        game.app.push_screen(QuestionDialog("Above", "All of it?", [("yes", "Yes")]))
        await game.until(lambda: isinstance(game.app.screen, QuestionDialog))
        hold.release()
        await next(worker for worker in game.app.workers if worker.group == "save").wait()
        await game.press("y", until=lambda: game.app.screen is saving)
        await game.press("escape", until=lambda: game.app.screen is game.main)

        # A choice that comes when the dialog is left already is too late.
        await game.ready()
        await game.press("o", on=Chooser)
        chooser = game.app.screen
        await game.fill("herd")
        await game.press("enter", until=lambda: choice.has_begun)
        assert isinstance(chooser, Chooser)
        chooser.action_leave()
        choice.release()
        await game.until(lambda: game.app.screen is game.main and not chooser.is_attached)
        await game.press("n", tick=1)
        assert game.session.source.name == "mine"
    assert (data_dir / "programs" / "other.l").read_text() == PAPER


async def test_a_long_line_is_seen_at_its_end_and_late_clicks_do_nothing(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.press("s", on=SaveAs)
        await game.fill("abcdefghij" * 10)
        await game.press("end", *"-end", sees="efghij-end")
        await game.press("escape")
        await game.ready()

        # At an entry that has just gone.
        await game.press("o", on=Chooser)
        entries = game.app.screen.query_one("#entries", OptionList)
        await game.until(lambda: entries.option_count)
        stale = Style(meta={"option": entries.option_count})
        click = events.Click(entries, 2, 2, 0, 0, 1, False, False, False, 2, 2, stale)
        entries.post_message(click)
        await game.press("m", until=lambda: game.app.screen.query_one(Input).value == "m")
        assert isinstance(game.app.screen, Chooser)
        await game.press("escape")

        # A double click beside the palette, which closes it once.
        await game.press("ctrl+p", on=PaletteScreen)
        for kind in 2 * (events.MouseDown, events.MouseUp):
            game.app.post_message(kind(None, 1, 1, 0, 0, 1, False, False, False, 1, 1))
        await game.until(lambda: game.app.screen is game.main)
        await game.press("n", tick=1)
