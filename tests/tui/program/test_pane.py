"""Editing, applying, and mistakes shown in place."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest
from textual import events
from textual.widgets.text_area import Selection

from logical_robots_tui.mind import Program
from logical_robots_tui.player.opening import Permissions
from logical_robots_tui.tui.program.pane import ProgramPane
from tests.tui.conftest import PAPER, STILL, WRONG, opened
from tests.virtual_time import virtual_loop

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.tui.program.editor import Editor
    from tests.tui.conftest import Opened


def title(game: Opened) -> str:
    return game.main.query_one(ProgramPane).label


async def test_the_listing_of_the_paper_is_pasted_as_printed_and_applied(data_dir: Path) -> None:
    async with opened(data_dir, text=STILL) as game:
        await game.ready()
        await game.press("2", "f7")
        game.app.post_message(events.Paste(PAPER.replace("\n", "\r\n")))
        await game.until(lambda: game.editor.text == PAPER and "not applied · " in title(game))
        await game.press("ctrl+r")
        await game.until(
            lambda: (
                game.session.state.applied == PAPER and title(game).startswith("Program · applied")
            )
        )
        await game.press("f8")
        await game.until(lambda: game.session.frame.memories == {"Solo": "I am a robot"})


async def test_a_paste_of_ten_thousand_lines_can_be_undone_and_done_again(data_dir: Path) -> None:
    long = "# One line of a long paste.\n" * 10_000
    async with opened(data_dir, text=STILL) as game:
        await game.ready()
        await game.press("2")
        game.app.post_message(events.Paste(long))
        await game.until(lambda: game.editor.text == long + STILL)
        await game.press("ctrl+z")
        await game.until(lambda: game.editor.text == STILL)
        await game.press("ctrl+y")
        await game.until(lambda: game.editor.text == long + STILL)


async def test_a_paste_through_a_terminal_without_bracketed_paste_is_the_same(
    data_dir: Path,
) -> None:
    async with opened(data_dir, text="") as game:
        await game.press("2")
        for character in PAPER:
            key = {"\n": "ctrl+j"}.get(character, character)
            game.app.post_message(events.Key(key, character))
        await game.until(lambda: game.editor.text == PAPER)


@pytest.mark.sampled
@pytest.mark.parametrize("size", [(80, 24), (120, 40)], ids=["80x24", "120x40"])
async def test_letters_right_behind_the_key_for_the_editor_are_typed(
    data_dir: Path, size: tuple[int, int]
) -> None:
    async with opened(data_dir, text="", size=size) as game:
        for letter in "2squid":
            game.app.post_message(events.Key(letter, letter))
        await game.until(lambda: game.editor.text)
        assert game.editor.text == "squid"
        assert game.app.screen is game.main


async def test_a_mistake_is_marked_in_its_line_with_message_and_hint(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("2")
        await game.write(WRONG)
        await game.until(lambda: game.session.state.phase == "mistake")
        mistake = game.session.state.mistakes[0]
        assert mistake.line == 3
        await game.sees("✗ line 3")
        await game.sees("3✗")
        assert title(game) == "Program · 1 error, the old version is still running · mine*"
        assert mistake.hint
        await game.sees(mistake.hint.split(".")[0][:30])
        assert game.session.state.applied is not None
        await game.press("ctrl+home", *"# so", "enter")
        await game.sees("4✗")
        await game.sees("✗ line 4")
        assert game.screen().count(mistake.message[:20]) == 1
        await game.press("ctrl+g", "a")
        await game.until(lambda: not game.shows("✗"))
        assert game.editor.document.get_line(3) == WRONG.splitlines()[2].replace("{", "a{", 1)
        game.editor.action_delete_line()
        game.editor.put(WRONG)
        await game.sees("3✗")
        game.editor.text = game.session.state.applied  # as undoing all of it does
        await game.until(
            lambda: not game.shows("✗") and title(game).startswith("Program · applied · ")
        )


async def test_the_last_good_program_runs_on_after_a_mistake(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("space")
        await game.until(lambda: game.tick > 1)
        await game.write(WRONG)
        await game.until(lambda: game.session.state.phase == "mistake")
        now = game.tick
        await game.until(lambda: game.tick > now + 3)
        assert game.session.state.applied == PAPER
        assert game.session.frame.memories == {"Solo": "I am a robot"}


async def test_a_mended_program_takes_the_mark_away(data_dir: Path) -> None:
    async with opened(data_dir, text=WRONG) as game:
        await game.sees("3✗")
        await game.write(STILL)
        await game.until(lambda: game.session.state.applied == STILL)
        await game.until(lambda: not game.shows("✗"))


async def test_a_key_or_a_click_goes_to_the_mistake(data_dir: Path) -> None:
    async with opened(data_dir, text=WRONG) as game:
        await game.sees("✗ line 3")
        await game.press("ctrl+g")
        await game.until(lambda: game.editor.cursor_location[0] == 2)
        assert game.main.focused is game.editor
        await game.press("escape", "2", "ctrl+home", "up", "up")
        await game.until(lambda: game.editor.cursor_location[0] == 0)
        await game.click("MistakeStrip")
        await game.until(lambda: game.editor.cursor_location[0] == 2)


async def test_an_undefined_predicate_and_a_missing_robot_are_named(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.write(STILL + "A(x) :- Nowhere(x);\n")
        await game.until(lambda: game.session.state.phase == "mistake" and game.shows("✗ line 3"))
        assert "Nowhere" in game.session.state.mistakes[0].message
        await game.write("A(1);\n")
        await game.until(lambda: game.session.state.phase == "mistake" and game.shows("✗ line 1"))
        assert "Robot" in game.session.state.mistakes[0].message


@pytest.mark.slow
async def test_a_program_of_a_megabyte_is_refused_and_the_game_goes_on(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.press("2", "f7")
        game.app.post_message(events.Paste("x = 1 + Foo(bar: 3), # note\n" * 36_000))
        await game.until(lambda: len(game.editor.text) > 1_000_000)
        await game.press("f4")
        await game.until(lambda: game.session.state.phase == "mistake")
        await game.sees("✗ line 1")
        await game.press("escape", "n")
        await game.until(lambda: game.tick == 1)


async def test_a_later_apply_overtakes_an_earlier_one(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.ready()
        await game.write(STILL)
        await game.write(PAPER + "# more\n")
        await game.until(lambda: game.session.state.applied == PAPER + "# more\n")
        await game.press("f8")
        await game.until(lambda: game.session.frame.memories == {"Solo": "I am a robot"})


async def test_the_text_that_the_robots_think_with_overtakes_one_that_is_compiled(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, go_on, over = asyncio.Event(), asyncio.Event(), asyncio.Event()

    async def compile_slowly(text: str, _told: object) -> Program:
        begun.set()
        try:
            await go_on.wait()
            return Program.compile(text)
        finally:
            over.set()

    async with opened(data_dir, text=STILL) as game:
        await game.ready()
        monkeypatch.setattr("logical_robots_tui.game.compile_program", compile_slowly)
        await game.write(PAPER)
        await game.until(begun.is_set)
        await game.press("2", "ctrl+z", "ctrl+r")
        await game.until(lambda: game.session.state.phase == "applied")
        go_on.set()
        await game.until(lambda: over.is_set() and title(game).startswith("Program · applied · "))
        await game.press("f8")
        await game.until(lambda: game.session.frame.memories == {"Solo": 1})


async def test_tab_inserts_two_spaces_and_letters_are_letters(data_dir: Path) -> None:
    async with opened(data_dir, text="") as game:
        await game.press("2", "tab", *"qrnlo", "space", "plus", "question_mark")
        await game.until(lambda: game.editor.text == "  qrnlo +?")
        assert game.app.screen is game.main
        assert game.tick == 0
        await game.press("ctrl+c")
        await game.sees("Press ^C again to quit")


async def test_lines_are_indented_alone_and_together(data_dir: Path) -> None:
    async with opened(data_dir, text="A(x) :-\n  B(x),") as game:
        await game.press("2", "ctrl+end")
        await game.until(lambda: game.editor.cursor_location == (1, 7))
        now = virtual_loop().time()
        for later, key in enumerate(("enter", "C", "enter", "D")):
            event = events.Key(key, key if len(key) == 1 else "\r")
            event.time = now + 0.001 * later if later > 2 else now + 1 + later
            game.app.post_message(event)
        await game.until(lambda: game.editor.text.endswith("D"))
        assert game.editor.text == "A(x) :-\n  B(x),\n  C\n  D"
        game.editor.selection = Selection((1, 3), (3, 0))
        await game.press("tab")
        await game.until(lambda: game.editor.text == "A(x) :-\n    B(x),\n    C\n  D")
        assert game.editor.selection == Selection((1, 5), (3, 0))
        await game.press("shift+tab", "shift+tab")
        await game.until(lambda: game.editor.text == "A(x) :-\nB(x),\nC\n  D")
        assert game.main.focused is game.editor


async def test_comments_are_toggled_as_one_edit(data_dir: Path) -> None:
    async with opened(data_dir, text="a\n  b\n\nc\n") as game:
        await game.press("2")
        await game.until(lambda: game.main.focused is game.editor)
        game.editor.selection = Selection((0, 0), (3, 0))
        await game.press("ctrl+underscore")
        await game.until(lambda: game.editor.text == "# a\n#   b\n\nc\n")
        await game.press("ctrl+z")
        await game.until(lambda: game.editor.text == "a\n  b\n\nc\n")
        await game.press("ctrl+y")
        await game.until(lambda: game.editor.text == "# a\n#   b\n\nc\n")
        game.editor.selection = Selection((0, 0), (3, 0))
        await game.press("ctrl+underscore")
        await game.until(lambda: game.editor.text == "a\n  b\n\nc\n")


async def test_control_characters_are_shown_and_not_sent_to_the_terminal(data_dir: Path) -> None:
    async with opened(data_dir, text="a\x1b[2Jb\x07[bold]c\n") as game:
        await game.sees("a␛[2Jb␇[bold]c")
        assert "\x1b" not in game.screen()


async def test_a_comment_over_several_lines_is_coloured_as_it_grows(data_dir: Path) -> None:
    async with opened(data_dir, text="A(1);\nB(2);\n") as game:
        editor = game.editor
        assert styles(editor, 1) != {"comment"}
        await game.press("2", "slash", "*")
        await game.until(lambda: editor.text.startswith("/*"))
        assert len(editor.get_line(1).spans) == 1
        await game.press("ctrl+z")
        await game.until(lambda: editor.text.startswith("A"))
        assert len(editor.get_line(1).spans) > 1


def styles(editor: Editor, line: int) -> set[str]:
    return {str(span.style) for span in editor.get_line(line).spans}


async def test_the_text_of_the_file_comes_back_and_undo_brings_mine_back(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.press("2", "x")
        await game.until(lambda: game.editor.text == "x" + PAPER)
        game.main.action_command("revert")
        await game.until(lambda: game.editor.text == PAPER)
        await game.press("ctrl+z")
        await game.until(lambda: game.editor.text == "x" + PAPER)


REMEMBERS = """\
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory:) :-
  Memory(robot_name:, memory:);
"""


async def test_what_is_typed_before_the_pane_has_room_does_not_scroll_its_start_away(
    data_dir: Path,
) -> None:
    async with opened(data_dir, text=f"# {'a long line ' * 20}", size=(80, 24)) as game:
        await game.ready()
        assert not game.editor.content_size.area
        game.editor.insert("nonsense(")
        await game.press("2")
        await game.until(lambda: game.shows("nonsense("))


async def test_keys_that_arrive_at_once_are_obeyed_in_their_order(data_dir: Path) -> None:
    async with opened(data_dir) as game:
        await game.press("2")
        await game.until(lambda: game.editor.has_focus)
        keys = ["down", "down", "end", *["backspace"] * 2, *"abc", "left", "x", "enter", "y"]
        for key in keys:
            letter = key if len(key) == 1 else None
            game.app.post_message(events.Key(key, letter))
        await game.until(lambda: "y" in game.editor.document.get_line(3)[:2])
        line = PAPER.splitlines()[2]
        assert game.editor.document.get_line(2) == line[:-2] + "abx"
        assert game.editor.document.get_line(3) == "yc"


async def test_what_is_copied_or_cut_is_in_a_file_too(data_dir: Path) -> None:
    copied = data_dir / "copied.txt"
    async with opened(data_dir, text=STILL) as game:
        await game.ready()
        game.main.permissions = Permissions(clipboard=False)
        await game.press("2", "f6", "ctrl+c")
        await game.until(copied.exists)
        await game.sees("Kept in")
        first = STILL.splitlines()[0]
        assert game.app.clipboard == copied.read_text("utf-8").strip() == first
        game.main.action_command("select_all")
        await game.press("ctrl+x")
        await game.until(lambda: copied.read_text("utf-8") == STILL)
        assert game.editor.text == ""
        await game.press("ctrl+v")
        await game.until(lambda: game.editor.text == STILL)


LONG = f"# {'several words ' * 12}last\n" + STILL


async def test_long_lines_are_wrapped_unless_the_player_wants_them_cut(data_dir: Path) -> None:
    async with opened(data_dir, text=LONG, size=(80, 24)) as game:
        await game.ready()
        await game.press("2")
        await game.sees("last")
        assert not game.editor.show_horizontal_scrollbar
        game.main.action_command("wrap")
        await game.until(lambda: not game.shows("last"))
        game.main.action_command("wrap")
        await game.sees("last")


async def test_a_wrapped_line_with_a_mistake_is_marked_once_and_on_all_its_rows(
    data_dir: Path,
) -> None:
    async with opened(data_dir, text=f"A(1);\nB({'1, ' * 80}1) :- ;\n", size=(80, 24)) as game:
        await game.press("2")
        await game.until(lambda: game.session.state.phase == "mistake" and game.shows("2✗"))
        assert game.screen().count("2✗") == 1
        assert title(game) == "Program · 1 error · mine"
