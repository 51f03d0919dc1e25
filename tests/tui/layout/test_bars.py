"""The lines at the top and the bottom keep what matters most, at any width."""

from contextvars import copy_context

from hypothesis import given
from hypothesis import strategies as st
from textual.geometry import Size

from logical_robots_tui.game import Goal
from logical_robots_tui.game.frame import goals
from logical_robots_tui.tui.commands.keymap import KEY_MAP, KeyMap
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.layout.command_bar import CommandBar
from logical_robots_tui.tui.layout.status_line import Status, fit
from logical_robots_tui.world import World, list_levels, load_level

HOME = Goal("Home", True, ("Ada", "Bo", "Cy"), ("Ada",))
STATUS = Status("Everybody home", "running", 1204, None, 40.0, 17.2, (HOME,), (), 1.23, 0.0)


def test_the_status_line_tells_everything_where_there_is_room() -> None:
    assert fit(STATUS, 120).plain.split("   ") == [
        *(" LOGICAL ROBOTS", "Everybody home", "● RUNNING", "tick 1204", "17 of 40/s"),
        *("Home: Ada ✓ Bo · Cy ·", "1.2 ms"),
    ]


@given(st.integers(0, 200))
def test_the_status_line_fits_and_keeps_the_most_important(width: int) -> None:
    line = fit(STATUS, width)
    assert line.cell_length <= max(width, 1)
    if width >= 40:
        assert "● RUNNING   tick 1204" in line.plain
        assert "Home" in line.plain


def test_the_name_of_the_level_stays_in_eighty_columns() -> None:
    for name in list_levels():
        level = load_level(name)
        now = goals(level, World(level).save())
        busy = STATUS._replace(tick=12_345, think_milliseconds=123.4, achieved=12.5)
        line = fit(busy._replace(title=level.title, goals=now), 80).plain
        assert all(words in line for words in (level.title, "RUNNING", "tick 12345")), line
        assert len(line) <= 80


class Bar(CommandBar):
    width = 80

    @property
    def size(self) -> Size:
        return Size(self.width, 1)


def words_by_width() -> dict[int, list[str]]:
    KEY_MAP.set(KeyMap(COMMANDS))
    bar, words = Bar(), {}
    for bar.width in range(60, 160):
        words[bar.width] = bar.render().plain.split()
    return words


def test_a_key_without_words_is_shown_with_the_next_or_not_at_all() -> None:
    shown = copy_context().run(words_by_width)
    for width, words in shown.items():
        assert ("-" in words) == ("+" in words) == ("Speed" in words), width
    assert {"-" in words for words in shown.values()} == {False, True}
