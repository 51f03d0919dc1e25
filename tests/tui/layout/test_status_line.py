"""The line at the top keeps what matters most in a narrow terminal."""

from __future__ import annotations

from logical_robots_tui.game.frame import goals
from logical_robots_tui.tui.layout.status_line import Status, fit
from logical_robots_tui.world import Level, World, list_levels, load_level


def test_the_name_of_the_level_stays_in_eighty_columns() -> None:
    for name in list_levels():
        shows_its_name(load_level(name))


def shows_its_name(level: Level) -> None:
    status = Status(
        title=level.title,
        activity="running",
        tick=12_345,
        won_at=None,
        speed=40.0,
        achieved=12.5,
        goals=goals(level, World(level).save()),
        standing=(),
        think_milliseconds=123.4,
        thinking_for=0.0,
    )
    line = fit(status, 80).plain
    assert level.title in line
    assert "RUNNING" in line
    assert "tick 12345" in line
    assert len(line) <= 80
