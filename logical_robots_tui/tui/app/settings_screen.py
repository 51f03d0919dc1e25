"""Changing settings while looking at what they do; choosing a theme by trying it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from textual import on
from textual.content import Content
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from logical_robots_tui.player.settings import Setting, Settings, rows
from logical_robots_tui.tui.layout.dialogs import Dialog, Listing
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Sequence

_NAME, _WORDS = 14, {True: "on", False: "off", None: "automatic"}


class SettingsScreen(Dialog[None]):
    """All settings with their sentences; each change is seen at once.

    Args:
        settings: Gives the settings as they are now.
        change: Changes one by its name.
    """

    DEFAULT_CSS = """
    SettingsScreen > #box { max-width: 76; }
    SettingsScreen #rows { height: auto; max-height: 100%; }
    """

    BINDINGS = [("left", "change(-1)"), ("right,space", "change(1)")]

    heading = "Settings"
    keys = "↑↓ choose   ←→ or enter change   esc close"

    def __init__(
        self, settings: Callable[[], Settings], change: Callable[[str, Any], None]
    ) -> None:
        self._settings, self._change, self._rows = settings, change, rows()
        options = [Option(self._prompt(row), id=row.name) for row in self._rows]
        self._list = Listing(*options, id="rows")
        super().__init__("", self._list)

    def on_mount(self) -> None:
        self._list.highlighted = 0

    def _prompt(self, row: Setting) -> Content:
        value = getattr(self._settings(), row.name)
        word = str(_WORDS[value] if value is None or isinstance(value, bool) else value)
        ink = INK.dim if value == row.default else INK.key
        name = row.name.replace("_", " ")
        return Content.assemble(
            (f"{name:<{_NAME}}", INK.text), (f"◂ {word} ▸", ink), "\n  ", (row.sentence, INK.dim)
        )

    def action_change(self, step: int) -> None:
        if self._list.highlighted is None:
            return
        row = self._rows[self._list.highlighted]
        value = next_value(row, getattr(self._settings(), row.name), step)
        self._change(row.name, value)
        self._list.replace_option_prompt(row.name, self._prompt(row))

    @on(OptionList.OptionSelected, "#rows")
    def _selected(self) -> None:
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


class ThemeList(Dialog[str]):
    """The themes; moving tries them, closing without a choice restores the first."""

    DEFAULT_CSS = """
    ThemeList { background: $background 0%; align: right middle; }
    ThemeList > #box { width: 34; }
    ThemeList #themes { height: auto; max-height: 100%; }
    """

    heading = "Theme"
    keys = "↑↓ try   enter keep   esc back"

    def __init__(self, names: Sequence[str], current: str) -> None:
        self._list = Listing(id="themes")
        super().__init__("", self._list)
        self._names, self._current = names, current
        for name in names:
            sign = "▸ " if name == current else "  "
            line = Content.assemble((sign, INK.key), (name, INK.text))
            self._list.add_option(Option(line, id=name))

    def on_mount(self) -> None:
        names, current = self._names, self._current
        self._list.highlighted = names.index(current) if current in names else 0

    @on(OptionList.OptionHighlighted, "#themes")
    def _tried(self, event: OptionList.OptionHighlighted) -> None:
        if event.option_id is not None and self.is_active:
            self.app.theme = event.option_id

    @on(OptionList.OptionSelected, "#themes")
    def _chosen(self, event: OptionList.OptionSelected) -> None:
        self.dismiss(event.option_id)

    def action_leave(self) -> None:
        self.app.theme = self._current
        super().action_leave()
