"""The bottom line, at any width."""

from __future__ import annotations

from contextvars import copy_context

from textual.geometry import Size

from logical_robots_tui.tui.commands.keymap import KEY_MAP, KeyMap
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.layout.command_bar import CommandBar


class Bar(CommandBar):
    width = 80

    @property
    def size(self) -> Size:
        return Size(self.width, 1)


def words_by_width() -> dict[int, list[str]]:
    KEY_MAP.set(KeyMap(COMMANDS))
    bar, found = Bar(), {}
    for bar.width in range(60, 160):
        found[bar.width] = bar.render().plain.split()
    return found


def test_a_key_without_words_is_shown_with_the_next_or_not_at_all() -> None:
    seen = set()
    for width, words in copy_context().run(words_by_width).items():
        assert ("-" in words) == ("+" in words) == ("Speed" in words), width
        seen.add("-" in words)
    assert seen == {False, True}
