"""Mistakes and oddities are marked while a program is written, without being asked for."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from logical_robots_tui.paths import shipped_folder
from tests.tui.conftest import STILL, WRONG, Opened, opened
from tests.tui.program.conftest import title

MISSPELT = STILL.replace("Sensor(", "Sensr(")
ODD = """\
# forgets everything

Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}) :-
  Sensor(robot_name:);
"""
ORDERED = STILL.replace("memory: 1", "memory: {order: 1}")
LOST = """\
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: sees) :-
  Sensor(robot_name:, sensor:),
  sees = (if sensor.forward_label == "Sola" then 1 else 0);
"""
NAMED = """\
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: near) :-
  Sensor(robot_name:, sensor:),
  near = sensor.forward_distance < 60;
"""


def underlined(game: Opened, row: int) -> list[str]:
    line = game.editor.get_line(row)
    styles = {str(game.editor._syntax[kind]) for kind in ("mistake", "odd")}
    return [line.plain[s.start : s.end] for s in line.spans if str(s.style) in styles]


def is_at(game: Opened, row: int) -> bool:
    return game.editor.cursor_location[0] == row


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
        game.editor.put(WRONG)  # what was checked is applied at once
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


async def test_mistakes_are_counted_when_the_keys_rest_and_each_can_be_reached(
    data_dir: Path,
) -> None:
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
        game.editor.put(f"{STILL}A(x) :- Nothing(x);\nB(x) :- Nowhere(x);\n")
        await game.sees("2 errors")
        await game.sees("✗ line 4")
        lines = game.screen().splitlines()
        row = next(row for row, line in enumerate(lines) if "✗ line 4" in line)
        await game.click(offset=(lines[row].index("✗ line 4") + 3, row))
        await game.until(partial(is_at, game, 3))
        for line in (2, 3, 2):
            await game.press("ctrl+g")
            await game.until(partial(is_at, game, line))


async def sees_warning(game: Opened, text: str, warning: str) -> None:
    await game.write(text)
    await game.until(lambda: game.session.state.applied == text and game.shows(warning))
    assert title(game).startswith("Program · applied, 1 warning")


async def is_warned_of_the_comparison(game: Opened) -> None:
    await sees_warning(game, NAMED, "! line 3, column 3")
    (mistake,) = game.session.state.mistakes
    assert (mistake.line, mistake.column) == (3, 3)
    assert mistake.hint.endswith("near = (sensor.forward_distance < 60).")


async def test_what_is_odd_lacks_in_the_level_or_fails_on_the_web_platform_is_a_warning(
    data_dir: Path,
) -> None:
    async with opened(data_dir, text=ORDERED) as game:
        await game.until(lambda: title(game).startswith("Program · applied, 1 warning"))
        await game.sees("order is a word of SQL")
        await sees_warning(game, ODD, "! line 3")
        assert game.session.state.mistakes[0].severity == "warning"
        await game.sees(f"{game.session.state.mistakes[0].line}! ")
        await sees_warning(game, LOST, 'Did you mean "Solo"?')
        await game.write(LOST.replace("Sola", "Solo"))
        await game.until(lambda: game.session.state.mistakes == () and not game.shows("warning"))
        await is_warned_of_the_comparison(game)


async def test_in_a_level_of_this_game_it_does_not_matter_what_fails_on_the_web_platform(
    data_dir: Path,
) -> None:
    level = shipped_folder("levels") / "01-first-steps.toml"
    async with opened(data_dir, level=level, text=ORDERED) as game:
        await game.until(lambda: title(game).startswith("Program · applied · "))
        await is_warned_of_the_comparison(game)
