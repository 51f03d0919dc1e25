"""Lines of clickable labels: the command bar and the tabs of the panes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from textual import events
from textual.content import Content
from textual.message import Message
from textual.widget import Widget

from logical_robots_tui.tui.commands.command import Command
from logical_robots_tui.tui.commands.keymap import command, commands
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip

_GAP = 2
_WHILE_EDITING = ("run", "help")
_WITH_NEXT = ("slower",)  # commands whose label says nothing without that of the next


@dataclass
class CommandChosen(Message):
    command_id: str


@dataclass
class RobotChosen(Message):
    robot_name: str


class Labels(Widget):
    """Lines of labels for commands; a click runs the command."""

    ALLOW_SELECT = False
    choice: ClassVar[type[CommandChosen | RobotChosen]] = CommandChosen

    def __init__(self, widget_id: str | None = None) -> None:
        super().__init__(id=widget_id)
        self.places: list[tuple[int, int, int, str]] = []
        """Row, first column, column after the last, and command of each label."""

    def line(
        self, labels: list[tuple[Content, str]], gap: int, width: int | None = None
    ) -> Content:
        content, self.places = Content(" "), []
        for label, command_id in labels:
            start = content.cell_length + (gap if self.places else 0)
            end = start + label.cell_length
            if end > (self.size.width if width is None else width):
                continue
            content = content.append(" " * (start - content.cell_length)).append(label)
            self.places.append((0, start, end, command_id))
        return content

    def on_click(self, event: events.Click) -> None:
        event.stop()
        for row, start, end, command_id in self.places:
            if command_id and event.y == row and start <= event.x < end:
                self.post_message(self.choice(command_id))


class CommandBar(Labels):
    """The bottom line: the commands that apply now, with their keys."""

    DEFAULT_CSS = "CommandBar { dock: bottom; height: 1; background: $panel; }"

    def __init__(self) -> None:
        super().__init__("commands")
        self._situation: tuple[bool, bool, bool, Sequence[tuple[str, str]]]
        self._situation = False, False, False, ()

    def show(
        self,
        *,
        typing: bool,
        running: bool,
        editing: bool = False,
        focus_keys: Sequence[tuple[str, str]] = (),
    ) -> None:
        """Show a situation's commands, after the focused widget's `focus_keys`."""
        situation = typing, running, editing, focus_keys
        if situation != self._situation:
            self._situation = situation
            self.refresh()

    def render(self) -> Content:
        typing, running, edits, focus_keys = self._situation
        unwanted = "outside" if typing else "editor"
        bar_entries = [entry for entry in commands() if entry.bar]
        entries = [e for e in bar_entries if e.scope != "level" and e.place != unwanted]
        if edits and not typing:
            general = [entry for entry in entries if entry.id in _WHILE_EDITING]
            editing = [entry for entry in bar_entries if entry.scope == "level"]
            entries = [*general[:1], *editing, *general[1:]]
        if typing:
            entries.sort(key=lambda entry: entry.id != "apply")
        if focus_keys:
            entries = [entry for entry in entries if entry.place == "anywhere"]
        labels: dict[str, Content] = {}
        for entry in entries:
            title = "Pause" if entry.id == "run" and running else entry.bar
            labels[entry.id] = _label(entry.bar_key(typing=typing), title)
        room = self.size.width - 1
        focus_labels: list[tuple[Content, str]] = []
        if focus_keys:  # as many as leave room for the first command
            first_width = labels[entries[0].id].cell_length if entries else 0
            for label in (_label(key, does) for key, does in focus_keys):
                if room - label.cell_length - _GAP < first_width:
                    break
                focus_labels.append((label, ""))
                room -= label.cell_length + _GAP
        groups: list[list[Command]] = []
        for entry in entries:
            if groups and groups[-1][-1].id in _WITH_NEXT:
                groups[-1].append(entry)
            else:
                groups.append([entry])
        fitting: set[str] = set()
        for group in sorted(groups, key=lambda group: group[0].spare):
            need = sum(labels[entry.id].cell_length + _GAP for entry in group)
            need -= 0 if fitting else _GAP
            if need <= room:
                fitting.update(entry.id for entry in group)
                room -= need
        fit = [(label, name) for name, label in labels.items() if name in fitting]
        return self.line([*focus_labels, *fit], gap=_GAP)


def _label(key: str, title: str) -> Content:
    label = Content.styled(key, f"bold {INK.key}")
    if title == key:
        return label
    return label.append(" " * bool(key)).append(Content.styled(title, INK.text))


class PaneTabs(Labels):
    """The names of the panes, when only one fits on the screen."""

    DEFAULT_CSS = "PaneTabs { height: 1; background: $background; }"

    def __init__(self) -> None:
        super().__init__("tabs")
        self._tabs: tuple[tuple[str, str], ...] = ()
        self._active = ""
        self._free = 0

    def show(self, tabs: tuple[tuple[str, str], ...], active: str, free: int) -> None:
        """Show tabs, but none that reaches beyond the first `free` columns."""
        if (tabs, active, free) != (self._tabs, self._active, self._free):
            self._tabs, self._active, self._free = tabs, active, free
            self.refresh()

    def render(self) -> Content:
        keys = [command(command_id).key_name for command_id, _ in self._tabs]
        room = self.size.width - sum(len(key) + 4 for key in keys)
        widths = [len(text) for _, text in self._tabs]
        # The longest titles are cut, so that no tab is missing.
        limit = max(widths, default=0)
        while limit > 1 and sum(min(width, limit) for width in widths) > room:
            limit -= 1
        labels = []
        for key_name, (command_id, text) in zip(keys, self._tabs, strict=True):
            is_active = command_id == self._active
            style = f"bold {INK.title} on $tab-here" if is_active else INK.dim
            key = INK.key if not is_active else f"bold {INK.key} on $tab-here"
            label = Content.assemble((f" {key_name} ", key), (f"{clip(text, limit)} ", style))
            labels.append((label, command_id))
        return self.line(labels, gap=1, width=min(self._free, self.size.width))
