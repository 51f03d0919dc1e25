"""Changing settings while looking at what they do; choosing a theme by trying it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

from textual import on
from textual.binding import Binding, BindingType
from textual.content import Content
from textual.widgets import OptionList

from logical_robots_tui.player.settings import Setting, Settings, rows
from logical_robots_tui.tui.library.picker import Picker
from logical_robots_tui.tui.theme.themes import INK

_NAME, _WORDS = 14, {True: "on", False: "off", None: "automatic"}


class SettingsScreen(Picker[None, Setting]):
    """All settings with their sentences; each change is seen at once.

    Args:
        settings: Gives the settings as they are now.
        change: Changes one by its name.
    """

    DEFAULT_CSS = "SettingsScreen > #box { max-width: 76; }"

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left", "change(-1)", priority=True),
        Binding("right", "change(1)", priority=True),
    ]

    heading = "Settings"
    keys = "↑↓ choose   ←→ or enter change   esc close"

    def __init__(
        self, settings: Callable[[], Settings], change: Callable[[str, Any], None]
    ) -> None:
        super().__init__(rows())
        self._settings, self._change = settings, change

    def line(self, entry: Setting) -> Content:
        value = getattr(self._settings(), entry.name)
        word = str(_WORDS[value] if value is None or isinstance(value, bool) else value)
        ink = INK.dim if value == entry.default else INK.key
        name = entry.name.replace("_", " ")
        return Content.assemble(
            (f"{name:<{_NAME}}", INK.text), (f"◂ {word} ▸", ink), "\n  ", (entry.sentence, INK.dim)
        )

    def action_change(self, step: int) -> None:
        if (row := self.highlighted) is not None:
            self._change(row.name, next_value(row, getattr(self._settings(), row.name), step))
            self.redraw(row)

    def take(self, entry: Setting) -> None:
        self.action_change(1)


def next_value(row: Setting, value: Any, step: int) -> Any:
    """Return the setting's value `step` places further; choices wrap around."""
    kind = row.kind
    if kind.base is bool:
        return not value
    if kind.base is int:
        return min(max(value + step, int(kind.bounds.minimum)), int(kind.bounds.maximum))
    choices = [*[None] * (row.default is None), *kind.choices]
    return choices[(choices.index(value) + step) % len(choices)]


class ThemeList(Picker[str, str]):
    """The themes; moving tries them, closing without a choice restores the first."""

    DEFAULT_CSS = """
    ThemeList { background: $background 0%; align: right middle; }
    ThemeList > #box { width: 34; }
    """

    heading = "Theme"
    keys = "↑↓ try   enter keep   esc back"

    def line(self, entry: str) -> Content:
        sign = "▸ " if entry == self.current else "  "
        return Content.assemble((sign, INK.key), (entry, INK.text))

    @on(OptionList.OptionHighlighted)
    def _try(self) -> None:
        if self.is_active:
            self.app.theme = self.highlighted or self.app.theme

    def action_leave(self) -> None:
        self.app.theme = self.current or self.app.theme
        super().action_leave()
