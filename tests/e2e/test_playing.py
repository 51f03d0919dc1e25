"""The installed game, played, edited and interrupted in a real terminal."""

import shutil

import pytest

from docs.debugging import LEVEL, PAGE, PICTURES, PROGRAM, page, play
from logical_robots_tui import list_levels, load_level
from tests.e2e.conftest import Player, Seat, tick_on
from tests.e2e.tmux import PROMPT, place_of
from tests.game.playing import SLOW
from tests.waiting import until

PASTED = '\n# pasted\nThought(robot_name:, idea: "left") :- Sensor(robot_name:);\n'


def test_a_level_is_cut_off_goes_on_exactly_there_and_is_won(player: Player) -> None:
    player.play_short_way()
    player.tmux.press("n", "n", "n")
    assert "skip the tour" not in player.wait_for_tick(3), "who names a level is not shown round"
    player.type_an_idea()
    player.tmux.hang_up()
    until(lambda: not player.tmux.is_running, lambda: "the process ends")
    player.tmux.mend()
    player.is_offered_the_idea("cut off at tick 3")
    player.wait_for_tick(3)
    player.tmux.press("F5")
    screen = player.tmux.wait_until(
        lambda screen: "WON" in screen and f"{tick_on(screen)} ticks" in screen, "the victory"
    )
    assert 40 < tick_on(screen) < 60


@pytest.mark.slow
def test_a_terminal_is_resized_another_level_chosen_and_the_game_left(player: Player) -> None:
    tmux = player.tmux
    player.play_short_way()
    tmux.click("Step")
    player.wait_for_tick(1)
    tmux.resize(20, 5)
    tmux.wait_for("20x5")
    tmux.resize(120, 40)
    player.wait_for_tick(1)
    tmux.wait_for("Inspector")

    title = load_level(list_levels()[1]).title
    tmux.press("l", sees=title)
    tmux.type(title)
    tmux.press("Enter")
    tmux.wait_until(
        lambda screen: title in screen.splitlines()[0] and "A short way" not in screen, title
    )
    tmux.press("q")
    tmux.wait_until(lambda screen: screen.rstrip().endswith(PROMPT.strip()), "the prompt")
    until(lambda: not tmux.is_running)
    assert "▄" not in tmux.screen, "of a window that has grown, tmux keeps lines of the game"
    tmux.type("echo a$((20+22))b")
    tmux.press("Enter", sees="a42b")


@pytest.mark.slow
def test_a_pasted_program_is_what_robots_think_and_nonsense_gets_a_message(player: Player) -> None:
    tmux = player.tmux
    player.play_short_way()
    tmux.press("2", "C-End")
    tmux.paste(PASTED)
    tmux.wait_for("# pasted")
    tmux.press("C-r", sees="· applied")
    tmux.press("Escape", sees="space Run")
    tmux.press("3")
    tmux.wait_until(lambda screen: "Thought" in screen and "# pasted" not in screen, "the table")
    tmux.press("2", "C-Home")
    tmux.type("nonsense(", sees="nonsense(")
    tmux.press("C-r", sees="line 1, column")
    tmux.press("F5")
    tmux.wait_for("WON")  # by the last good program


@pytest.mark.slow
def test_a_level_is_edited_with_the_mouse_saved_and_survives_a_hangup(player: Player) -> None:
    tmux = player.tmux
    player.play_short_way()
    tmux.press("M", sees="h Hand")
    tmux.click("b Brush")
    tmux.wait_for("units wide")
    tmux.drag((30, 8), (30, 18))
    tmux.wait_for("● not saved", "finding")
    tmux.press("s", sees="Saved as short")
    assert load_level(player.folder / "short.toml").walls[10:15, 15:45].any()
    tmux.press("h", "Tab")
    column, line = place_of("+", tmux.wait_for("Robot Pip at 12, 12.5", "+"))
    tmux.drag((column, line), (column + 8, line))
    tmux.wait_until(lambda screen: "Robot Pip at" in screen and "at 12, " not in screen)
    tmux.wait_for("● not saved")
    drafts = player.folder / "data" / "drafts"
    until(lambda: list(drafts.glob("*.json")), lambda: "a draft on disk")
    tmux.hang_up()
    until(lambda: not tmux.is_running, lambda: "the game has ended")
    tmux.mend()
    player.play("play", "short.toml", "ahead.l")
    tmux.wait_for("Continue editing the level", "Yes, continue")
    tmux.press("y", sees="● not saved")
    tmux.press("Escape", sees="What should happen to your changes")
    tmux.press("t", sees="q Quit")


@pytest.mark.slow
def test_a_hangup_ends_even_a_robot_that_is_deep_in_thought(player: Player) -> None:
    (player.folder / "ahead.l").write_text(SLOW)
    player.play_short_way()
    player.tmux.press("Space", sees="thinking")
    player.tmux.hang_up()
    until(lambda: not player.tmux.is_running, lambda: "the process ends")


@pytest.mark.slow
def test_the_page_is_up_to_date() -> None:
    assert PAGE.read_text("utf-8") == page(), "`make debugging` writes it anew"
    assert {path.stem for path in LEVEL.parent.glob("*.svg")} == set(PICTURES)


@pytest.mark.slow
def test_the_mistake_is_found_and_mended_as_the_page_says(seat: Seat) -> None:
    with seat(120, 40) as player:
        shutil.copy(LEVEL, player.folder)
        shutil.copy(PROGRAM, player.folder)
        player.play("play", LEVEL.name, PROGRAM.name)
        pictures = [
            step.picture for step in play(player.tmux.type, player.tmux.wait_for) if step.picture
        ]
        assert pictures == list(PICTURES)
