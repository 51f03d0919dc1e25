"""Mistakes are marked while a program is written, without being asked for."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from logical_robots_tui.tui.program.pane import ProgramPane
from tests.tui.conftest import STILL, WRONG, opened

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened

MISSPELT = STILL.replace("Sensor(", "Sensr(")


def title(game: Opened) -> str:
    return game.main.query_one(ProgramPane).label


def underlined(game: Opened, row: int) -> list[str]:
    line = game.editor.get_line(row)
    styles = {str(game.editor._syntax[kind]) for kind in ("mistake", "odd")}
    return [line.plain[s.start : s.end] for s in line.spans if str(s.style) in styles]


async def test_a_misspelt_predicate_is_marked_while_it_is_typed(data_dir: Path) -> None:
    async with opened(data_dir, text=STILL) as game:
        await game.ready()
        await game.press("2")
        game.editor.move_cursor((1, len("  Sens")))
        await game.press("delete")
        await game.until(lambda: title(game).startswith("Program · not applied, 1 error"))
        assert underlined(game, 1) == ["Sensr"]
        await game.sees("✗ line 2, column 3")
        assert game.session.state.applied == STILL
        await game.press("o")
        await game.until(lambda: title(game).startswith("Program · applied · "))
        assert not game.shows("✗")


async def test_nothing_is_marked_before_the_keys_rest(data_dir: Path) -> None:
    async with opened(data_dir, text=STILL) as game:
        await game.ready()
        checked: list[str] = []
        check = game.session.check

        def counted(text: str) -> None:
            checked.append(text)
            check(text)

        game.session.check = counted  # type: ignore[method-assign] # to see when it is called
        await game.press("2", "ctrl+end", *"Bad(x) :- Nothing(x);")
        await game.sees("✗ line 3")
        assert checked == [game.editor.text]


async def test_mistakes_are_counted_and_each_can_be_reached(data_dir: Path) -> None:
    async with opened(data_dir, text=STILL) as game:
        await game.ready()
        game.editor.put(f"{STILL}A(x) :- Nothing(x);\nB(x) :- Nowhere(x);\n")
        await game.press("2")
        await game.sees("2 errors")
        await game.sees("✗ line 4")
        lines = game.screen().splitlines()
        row = next(row for row, line in enumerate(lines) if "✗ line 4" in line)
        await game.click(offset=(lines[row].index("✗ line 4") + 3, row))
        await game.until(partial(is_at, game, 3))
        for line in (2, 3, 2):
            await game.press("ctrl+g")
            await game.until(partial(is_at, game, line))


def is_at(game: Opened, row: int) -> bool:
    return game.editor.cursor_location[0] == row


async def test_what_was_checked_is_applied_at_once(data_dir: Path) -> None:
    async with opened(data_dir, text=STILL) as game:
        await game.ready()
        game.editor.put(WRONG)
        await game.sees("✗ line 3")
        await game.press("f4")
        told = "Program · 1 error, the old version is still running"
        await game.until(lambda: title(game).startswith(told))
        game.editor.put(MISSPELT)
        await game.until(lambda: game.session.state.checked == MISSPELT)
        assert len(game.session.state.found) == 1
        game.editor.put(STILL)
        await game.until(lambda: title(game).startswith("Program · applied · "))
        assert not game.shows("✗")
