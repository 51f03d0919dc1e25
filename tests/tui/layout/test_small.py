"""In a terminal of any size nothing fails: every dialog, resized while it is open."""

from pathlib import Path

import pytest

from logical_robots_tui.tui.commands.table import COMMANDS
from tests.tui.conftest import Opened, Size, opened

# Columns and lines, so that neighbours in the list differ much in both.
SIZES = [
    *((columns, 10 if columns % 2 else 1 + columns // 2) for columns in range(1, 21)),
    *((1 if lines % 2 else 20, lines) for lines in range(1, 11)),
    *((1, 1), (2, 1), (3, 2), (120, 40), (80, 2), (2, 60), (20, 10)),
]
OTHERS = [(40, 12), (41, 13), (79, 23), (110, 24), (500, 150)]
FIRST, MORE = [(1, 1), (80, 24)], [(12, 5), (4, 3), (20, 10), (7, 1), (3, 10)]
FEW = [*FIRST, *MORE]

UNANSWERED = ("quit", "external_editor")
NAMES = [entry.id for entry in COMMANDS if entry.scope == "screen" and entry.id not in UNANSWERED]
EDITS = [entry.id for entry in COMMANDS if entry.scope == "level"]
PARTS = 10  # one of them in a quick run


async def through_all(game: Opened, sizes: list[tuple[int, int]]) -> None:
    for size in sizes:
        await game.resize(*size)
        await game.settled()
        assert game.app._exception is None, size


@pytest.mark.sampled
@pytest.mark.parametrize("size", [*FEW, *OTHERS])
async def test_the_game_opens_in(size: Size, data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, size=size, welcome=True) as game:
        await game.until(lambda: game.session.state.phase == "applied")
        await game.press("escape", "n", "2", "3", "1", tick=1)
        await through_all(game, SIZES)


async def give(game: Opened, command: str, sizes: list[tuple[int, int]]) -> None:
    await game.resize(*sizes[0])
    await game.app.run_action(f"screen.command('{command}')")
    await game.handled()
    await through_all(game, sizes)
    await game.press("tab", "down", "a", "escape", "escape", "escape")
    await game.settled()
    assert game.app._exception is None, command


@pytest.mark.sampled
@pytest.mark.parametrize("part", range(PARTS))
@pytest.mark.parametrize("sizes", [FIRST, pytest.param(MORE, marks=pytest.mark.slow)])
async def test_each_command_may_be_given_and_answered_at_any_size(
    sizes: list[tuple[int, int]], part: int, data_dir: Path, short: Path
) -> None:
    async with opened(data_dir, level=short, ready=True) as game:
        for command in NAMES[part::PARTS]:
            await give(game, command, sizes)


@pytest.mark.proof
@pytest.mark.parametrize("command", NAMES)
async def test_a_command_is_answered_if_small(command: str, data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, ready=True) as game:
        await give(game, command, SIZES)
        await give(game, command, SIZES[::-1])


@pytest.mark.sampled
@pytest.mark.parametrize("part", range(PARTS))
async def test_editing_a_level_goes_on_at_any_size(part: int, data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, ready=True) as game:
        await game.app.run_action("screen.command('edit_level')")
        await game.until(lambda: game.main.editing.is_on)
        for command in EDITS[part::PARTS]:
            await game.app.run_action(f"screen.command('{command}')")
            await through_all(game, FEW)
            await game.press("down", "escape")
            await game.settled()
            assert game.app._exception is None, command
            if not game.main.editing.is_on:
                await game.app.run_action("screen.command('edit_level')")
                await game.until(lambda: game.main.editing.is_on)
