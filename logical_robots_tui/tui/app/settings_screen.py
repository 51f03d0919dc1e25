"""Changing settings while looking at what they do; choosing a theme by trying it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from textual import on
from textual.app import ComposeResult
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
        super().__init__()
        self._settings, self._change = settings, change
        self._rows = rows()
        self._list = Listing(id="rows")

    def content_widgets(self) -> ComposeResult:
        self._list.add_options([Option(self._prompt(row), id=row.name) for row in self._rows])
        yield self._list

    def on_mount(self) -> None:
        self._list.focus()
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
        super().__init__()
        self._names, self._current = names, current
        lines = [
            Content.assemble(("▸ " if name == current else "  ", INK.key), (name, INK.text))
            for name in names
        ]
        options = [Option(line, id=name) for line, name in zip(lines, names, strict=True)]
        self._list = Listing(*options, id="themes")

    def content_widgets(self) -> ComposeResult:
        yield self._list

    def on_mount(self) -> None:
        self._list.focus()
        self._list.highlighted = (
            self._names.index(self._current) if self._current in self._names else 0
        )

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
