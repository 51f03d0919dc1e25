"""Editing, checking and applying; mistakes and oddities are shown in place, also while typing."""

import asyncio
from contextlib import nullcontext
from functools import partial
from pathlib import Path

import pytest
from textual import events

from logical_robots_tui.mind import Program
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.player.opening import Permissions
from logical_robots_tui.tui.app.app import LogicalRobotsApp
from tests.tui.conftest import PAPER, STILL, Opened, Size, at_both_sizes, opened
from tests.tui.program.conftest import title

WRONG = """\
Robot(robot_name:, desire:, memory: 1) :-
  Sensor(robot_name:, sensor:),
  desire = {left_engine: 1.0, right_engine: ;
"""

ORDERED = STILL.replace("memory: 1", "memory: {order: 1}")
DRIVING = "Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}"
ODD = f"# forgets everything\n\n{DRIVING}) :-\n  Sensor(robot_name:);\n"
LOST = f"""\
{DRIVING}, memory: sees) :-
  Sensor(robot_name:, sensor:),
  sees = (if sensor.forward_label == "Sola" then 1 else 0);
"""
NAMED = f"""\
{DRIVING}, memory: near) :-
  Sensor(robot_name:, sensor:),
  near = sensor.forward_distance < 60;
"""


@at_both_sizes
async def test_a_message_of_an_error_never_covers_it_and_goes_with_it(
    data_dir: Path, size: Size
) -> None:
    async with opened(data_dir, text=WRONG, size=size) as game:
        await game.until(lambda: game.session.state.phase == "mistake")
        message = "The program has an error, ^G goes to line 3: "
        await game.press("space", "space", sees=message)
        assert game.screen().count(message) == 1
        await game.press("2", "f5", sees="never closed")
        rows = [line for line in game.screen().splitlines() if "right_engine: ;" in line]
        assert rows, "it covers the line"
        await game.press("x", sees_no=message)


async def test_an_error_that_is_noticed_late_is_told_beside_the_map(data_dir: Path) -> None:
    name, size = "a-name-of-23-characters", (80, 24)
    async with opened(data_dir, text=STILL, size=size, name=name, ready=True) as game:
        await game.press("2")
        game.editor.put(WRONG)
        await game.press("f5", sees=("Runs the applied version; ^R", "^R applies yours."))
        await game.sees("The new program has an error, ^G goes to line 3: ")
        await game.press("space", "space", sees="yours has 1 error, ^G goes to line 3.")
        await game.press("ctrl+g", sees="✗ line 3, column", until=lambda: is_at(game, 2))
        await game.press("escape", sees_no="goes to line 3")
        await game.resize(100, 30, sees=f"─ 2 · 1 error · {name}* ─")
        await game.resize(120, 40, sees=f"─ Program · 1 error · {name}* ─")


async def test_what_is_typed_goes_into_the_editor_and_is_applied_when_asked(data_dir: Path) -> None:
    async with opened(data_dir, text=STILL, ready=True) as game:
        await game.press("2", "f7")
        game.app.post_message(events.Paste(PAPER.replace("\n", "\r\n")))
        await game.until(lambda: game.editor.text == PAPER and "not applied · " in title(game))
        await game.press("ctrl+r", until=lambda: title(game).startswith("Program · applied"))
        assert game.session.state.applied == PAPER
        await game.press("f8")
        await game.until(lambda: game.session.frame.memories == {"Solo": "I am a robot"})
        await game.press("x", until=lambda: game.editor.text == PAPER + "x")
        await game.command("revert", until=lambda: game.editor.text == STILL)
        await game.press("ctrl+z", until=lambda: game.editor.text == PAPER + "x")


@at_both_sizes
async def test_letters_right_behind_the_editor_s_key_are_typed(data_dir: Path, size: Size) -> None:
    async with opened(data_dir, text="", size=size) as game:
        await game.press(*["tab"] * 4)  # which never leads into the program
        for letter in "2squid":
            game.app.post_message(events.Key(letter, letter))
        await game.until(lambda: game.editor.text)
        assert game.editor.text == "squid"
        await game.press("enter", "tab", *"qrnlo", "space", "plus", "question_mark")
        await game.until(lambda: game.editor.text == "squid\n  qrnlo +?")
        assert game.app.screen is game.main
        assert game.tick == 0
        await game.press("ctrl+c", sees="Press ^C again to quit")


async def test_a_mistake_is_marked_there_and_the_last_good_program_runs_on(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        await game.press("2")
        await game.write(WRONG, until=lambda: game.session.state.phase == "mistake")
        mistake = game.session.state.mistakes[0]
        assert mistake.line == 3
        await game.sees("✗ line 3", "3✗")
        assert title(game) == "Program · 1 error · mine*"
        assert mistake.hint
        await game.sees(mistake.hint.split(".")[0][:30])
        await game.press("ctrl+home", *"# so", "enter", sees=("4✗", "✗ line 4"))
        assert game.screen().count(mistake.message[:20]) == 1
        await game.press("ctrl+g", "a", until=lambda: not game.shows("✗"))
        assert game.editor.document.get_line(3) == WRONG.splitlines()[2].replace("{", "a{", 1)
        await game.press("backspace")  # told again when its line is as it was
        await game.until(lambda: game.screen().count(mistake.message[:20]) == 1)
        game.editor.action_delete_line()
        game.editor.put(WRONG)
        await game.sees("3✗")
        await game.press("escape", "n", tick=1)
        await game.sees("Runs the applied version; yours has 1 error, ^G goes to line 3.")
        assert game.session.state.applied == PAPER
        await game.press("n", tick=2, sees_no="Runs the applied version")
        await game.press("2", "end", "a", "f8", tick=3)
        await game.sees("Runs the applied version; ^R applies yours.")
        assert game.main.program.has_focus_within
        await game.press("backspace", sees_no="Runs the applied version")
        await game.press("space", "f8", tick=4, sees="^R applies yours.")
        await game.press("f4", until=lambda: game.session.state.phase == "mistake")
        await game.press("f8", tick=5, sees="yours has 1 error")
        game.session.apply(game.editor.text)
        game.session.toggle_run()  # before it is compiled
        await game.sees("The new program has an error, ^G goes to line 3: ")
        assert not game.session.busy
        assert game.session.frame.memories == {"Solo": "I am a robot"}
        game.editor.text = PAPER  # as undoing all of it does
        await game.until(
            lambda: not game.shows("✗") and title(game).startswith("Program · applied · ")
        )


async def test_a_key_or_a_click_goes_to_the_mistake_until_it_is_mended(data_dir: Path) -> None:
    async with opened(data_dir, text=WRONG, size=(80, 24), ready=True) as game:
        await game.until(lambda: title(game) == "Program · 1 error · mine")
        await game.press("space", sees="goes to line 3: ")
        assert not game.session.busy
        await game.press("ctrl+g", until=lambda: game.editor.cursor_location[0] == 2)
        assert game.main.focused is game.editor
        await game.sees("✗ line 3")
        await game.press("escape", "2", "ctrl+home", "up", "up")
        await game.until(lambda: game.editor.cursor_location[0] == 0)
        await game.click("MistakeStrip", until=lambda: game.editor.cursor_location[0] == 2)
        await game.sees("3✗")
        await game.apply(STILL)
        await game.press("escape", "n", tick=1, sees_no="✗")
        await game.press("2")
        await game.write(STILL + "A(x) :- Nowhere(x);\n")
        await game.until(lambda: game.session.state.phase == "mistake" and game.shows("✗ line 3"))
        assert "Nowhere" in game.session.state.mistakes[0].message
        await game.write("A(1);\n")
        await game.until(lambda: game.session.state.phase == "mistake" and game.shows("✗ line 1"))
        assert "Robot" in game.session.state.mistakes[0].message
        many = "".join(f"P{number}(x) :- Nowhere{number}(x);\n" for number in range(5))
        await game.press("ctrl+home")
        await game.write(many + STILL, until=lambda: len(game.session.state.mistakes) > 3)
        line = game.session.state.mistakes[-1].line
        await game.until(lambda: not game.shows(f"line {line},"))
        game.editor.move_cursor((line - 1, 0))
        await game.sees(f"line {line},")


async def test_no_paste_or_replacement_makes_a_program_or_a_line_too_long(data_dir: Path) -> None:
    long = "a " * 50_000
    async with opened(data_dir, text=long) as game:
        await game.press("2")
        game.app.post_message(events.Paste("x = 1;\n" * 15_000))
        await game.sees("A program may have 200,000 characters, not 205,000.")
        await game.press("f3", sees="Find in the program")
        game.app.post_message(events.Paste("y" * 2_001))
        await game.sees("2,001 characters are too many here; at most 2,000 fit.")
        await game.press("a", "tab")
        game.app.post_message(events.Paste("y" * 2_000))
        await game.press("enter", sees="With that the program would have more than 200,000")
        assert game.editor.text == long


async def test_what_is_applied_last_wins(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begun, go_on, over = asyncio.Event(), asyncio.Event(), asyncio.Event()

    async def compile_slowly(text: str, _told: object) -> Program:
        begun.set()
        try:
            await go_on.wait()
            return Program.compile(text)
        finally:
            over.set()

    async with opened(data_dir, ready=True) as game:
        await game.write(PAPER.replace("robot", "fish"))
        await game.apply(STILL)
        await game.press("f8", until=lambda: game.session.frame.memories == {"Solo": 1})
        monkeypatch.setattr("logical_robots_tui.game.compile_program", compile_slowly)
        await game.write(PAPER, until=begun.is_set)
        await game.press("n", sees="waiting for the new program, esc runs the old one")
        await game.press("escape", tick=2, sees="not applied")
        begun.clear()
        await game.press("ctrl+r", until=begun.is_set)
        await game.press("2", "ctrl+z", "ctrl+r")  # back to what the robots think with
        await game.until(lambda: game.session.state.phase == "applied")
        go_on.set()
        await game.until(lambda: over.is_set() and title(game).startswith("Program · applied · "))
        await game.press("f8", tick=3)
        assert game.session.frame.memories == {"Solo": 1}


async def test_what_is_copied_is_in_a_file(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VISUAL", """sh -c 'sed -i "s/memory: 1/memory: 2/" $0'""")
    monkeypatch.setattr(LogicalRobotsApp, "suspend", lambda _: nullcontext())
    copied = data_dir / "copied.txt"
    permissions = Permissions(clipboard=False)
    async with opened(data_dir, text=STILL, ready=True, permissions=permissions) as game:
        await game.press("2", "f6", "ctrl+c", until=copied.exists, sees="Kept in")
        assert game.app.clipboard == copied.read_text("utf-8").strip() == STILL.splitlines()[0]
        await game.command("select_all")
        await game.press("ctrl+x", until=lambda: copied.read_text("utf-8") == STILL)
        assert game.editor.text == ""
        await game.press("ctrl+v", until=lambda: game.editor.text == STILL)
        await game.press("escape", "space", "E")
        edited = STILL.replace("memory: 1", "memory: 2")
        await game.until(lambda: game.session.state.applied == game.editor.text == edited)
        assert not game.session.running
        monkeypatch.setenv("VISUAL", """sh -c 'yes | head -c 200001 > $0'""")
        await game.press("E", sees="A program may have 200,000 characters, not 200,001.")
        assert (game.editor.text, len(copied.read_text("utf-8"))) == (edited, 200_001)


async def test_long_lines_are_wrapped_unless_the_player_wants_them_cut(data_dir: Path) -> None:
    long = f"# {'several words ' * 20}last\n"
    async with opened(data_dir, text=long + STILL, size=(80, 24), ready=True) as game:
        assert not game.editor.content_size.area
        game.editor.move_cursor((0, 0))
        game.editor.insert("nonsense(")
        await game.press("2")
        await game.sees("nonsense(")  # its start is not scrolled away
        await game.sees("last")
        assert not game.editor.show_horizontal_scrollbar
        await game.command("wrap", until=lambda: not game.shows("last"))
        await game.command("wrap", sees="last")
        await game.write(f"A(1);\nB({'1, ' * 80}1) :- ;\n")
        await game.until(lambda: game.session.state.phase == "mistake" and game.shows("2✗"))
        assert game.screen().count("2✗") == 1
        assert title(game).startswith("Program · 1 error · ")


def underlined(game: Opened, row: int) -> list[str]:
    line = game.editor.get_line(row)
    styles = {str(game.editor._syntax[kind]) for kind in ("mistake", "odd")}
    return [line.plain[s.start : s.end] for s in line.spans if str(s.style) in styles]


def is_first(game: Opened, line: int) -> bool:
    return f" line {line}, column" in next(s for s in game.screen().splitlines() if " column " in s)


def is_at(game: Opened, row: int) -> bool:
    return game.editor.cursor_location[0] == row


async def test_mistakes_are_marked_when_the_keys_rest_and_can_be_reached(data_dir: Path) -> None:
    async with opened(data_dir, text=STILL, ready=True) as game:
        await game.press("2")
        game.editor.move_cursor((1, len("  Sens")))
        await game.press("delete")
        await game.until(lambda: title(game).startswith("Program · 1 error · "))
        assert underlined(game, 1) == ["Sensr"]
        await game.sees("✗ line 2, column 3")
        assert game.session.state.applied == STILL
        await game.press("o", until=lambda: title(game).startswith("Program · applied · "))
        assert not game.shows("✗")
        game.editor.put(WRONG)  # what was checked is applied at once
        await game.sees("✗ line 3")
        await game.press("f4", until=lambda: game.session.state.phase == "mistake")
        misspelt = STILL.replace("Sensor(", "Sensr(")
        game.editor.put(misspelt)
        await game.until(lambda: game.session.state.checked == misspelt)
        assert len(game.session.state.diagnostics) == 1
        game.editor.put(STILL)
        await game.until(lambda: title(game).startswith("Program · applied · "))
        assert not game.shows("✗")
        checked: list[str] = []
        check = game.session.check

        def counted(text: str) -> None:
            checked.append(text)
            check(text)

        game.session.check = counted  # type: ignore[method-assign] # to see when it is called
        await game.press("ctrl+end", *"Bad(x) :- Nothing(x);", sees="✗ line 3")
        assert checked == [game.editor.text]
        game.editor.put(f"{ODD}A(x) :- Nothing(x);\nB(x) :- Nowhere(x);\n")
        await game.sees("2 errors, 1 warning   ^G", "! line 3", "✗ line 6")
        assert title(game).startswith("Program · 2 errors · ")
        for row in (5, 2):  # the message of the cursor's line is the first
            game.editor.move_cursor((row, 0))
            await game.until(partial(is_first, game, row + 1))
        lines = game.screen().splitlines()
        row = next(row for row, line in enumerate(lines) if "✗ line 6" in line)
        await game.click(offset=(lines[row].index("✗ line 6") + 3, row))
        await game.until(partial(is_at, game, 5))
        for line in (2, 4, 5):
            await game.press("ctrl+g", until=partial(is_at, game, line))


async def sees_warning(game: Opened, text: str, warning: str) -> None:
    await game.write(text, until=lambda: game.session.state.applied == text and game.shows(warning))
    assert title(game).startswith("Program · applied, 1 warning")


async def is_warned_of_the_comparison(game: Opened) -> None:
    await sees_warning(game, NAMED, "! line 3, column 3")
    (mistake,) = game.session.state.mistakes
    assert (mistake.line, mistake.column) == (3, 3)
    assert mistake.hint.endswith("near = (sensor.forward_distance < 60).")


async def test_what_is_odd_or_missing_or_fails_on_the_web_is_a_warning(data_dir: Path) -> None:
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


async def test_in_this_game_s_levels_the_web_platform_does_not_matter(data_dir: Path) -> None:
    level = shipped_folder("levels") / "01-first-steps.toml"
    async with opened(data_dir, level=level, text=ORDERED) as game:
        await game.until(lambda: title(game).startswith("Program · applied · "))
        await is_warned_of_the_comparison(game)
