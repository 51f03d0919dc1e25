"""Dialogs and lists, whatever comes in when they have just changed or gone."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from rich.style import Style
from textual import events
from textual.css.stylesheet import Stylesheet
from textual.dom import DOMNode
from textual.geometry import Size
from textual.screen import Screen
from textual.widgets import Input, OptionList

from logical_robots_tui.game import ProgramSource, load_program
from logical_robots_tui.tui.commands.help import Help, PaletteScreen
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


@pytest.mark.slow
async def test_a_dialog_is_laid_out_once_and_leaves_the_styles_beneath(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sizes, styled = list[tuple[Screen[Any], Size]](), set[DOMNode]()
    take_size, update_nodes = Screen._screen_resized, Stylesheet.update_nodes

    def watched_size(screen: Screen[Any], size: Size) -> None:
        sizes.append((screen, size))
        take_size(screen, size)

    def watched_update(sheet: Stylesheet, nodes: Iterable[DOMNode], animate: bool = False) -> None:
        styled.update(nodes := [*nodes])
        update_nodes(sheet, nodes, animate)

    async with opened(data_dir, size=(80, 24)) as game:
        monkeypatch.setattr(Screen, "_screen_resized", watched_size)
        monkeypatch.setattr(Stylesheet, "update_nodes", watched_update)
        await game.press("question_mark", on=Help)
        await game.settled()
        assert sizes == []  # it has the terminal's
        styled.clear()
        await game.press("escape", on=type(game.main))
        await game.settled()
        assert game.main not in styled
        await game.resize(100, 30, until=lambda: sizes)
        await game.settled()
        assert sizes == [(game.main, Size(100, 30))]
