"""What the commands of the level editor do, where that takes more than one call."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from logical_robots_tui.tui.commands.keymap import with_keys

if TYPE_CHECKING:
    from logical_robots_tui.tui.level_editor.editor import Settings
    from logical_robots_tui.tui.level_editor.mode import EditMode


def take(tool: str) -> Callable[[EditMode], None]:
    def act(mode: EditMode) -> None:
        from logical_robots_tui.tui.level_editor.editor import Tool

        mode.editor.configure(tool=Tool(tool))

    return act


def set_tools(change: Callable[[Settings], Settings]) -> Callable[[EditMode], None]:
    """Return what changes the settings of the tools without ending the stroke under way."""

    def act(mode: EditMode) -> None:
        mode.editor.settings = change(mode.editor.settings)

    return act


toggle_grid = set_tools(lambda now: replace(now, is_grid_shown=not now.is_grid_shown))


def undo(mode: EditMode) -> None:
    if not mode.editor.cancel():
        what = mode.editor.undo()
        mode.ui.tell(f"Undone: {what}." if what else "There is nothing to undo.")


def redo(mode: EditMode) -> None:
    what = mode.editor.redo()
    mode.ui.tell(f"Redone: {what}." if what else "There is nothing to redo.")


def select(mode: EditMode, steps: int) -> None:
    mode.editor.select_next(steps)
    mode.view.go_to(mode.editor.cursor)


def properties(mode: EditMode) -> None:
    from logical_robots_tui.tui.level_editor.forms import ThingForm

    ref = mode.editor.selected
    if ref is None or mode.editor.thing is None:
        mode.ui.warn(with_keys("Select an object first: click it, or press {next_object}."))
    else:
        mode.ui.show(ThingForm(mode.editor, ref, mode.session.put), lambda _: mode.redraw())


def level_properties(mode: EditMode) -> None:
    from logical_robots_tui.tui.level_editor.forms import LevelForm

    mode.ui.show(LevelForm(mode.editor), lambda _: mode.redraw())


async def findings(mode: EditMode) -> None:
    from logical_robots_tui.tui.level_editor.forms import FindingList

    if mode.findings is None:
        mode.ui.tell("Checking the level…")
        return
    if not mode.findings:
        mode.ui.tell("Nothing looks wrong.")
        return
    finding = await mode.ui.ask(FindingList(mode.findings))
    if finding is not None and finding.x is not None and finding.y is not None:
        mode.view.go_to((finding.x, finding.y))
    mode.redraw()


async def save_level(mode: EditMode) -> None:
    from logical_robots_tui.tui.level_editor.saving import save

    mode.editor.finish()
    await save(mode)


async def save_level_as(mode: EditMode) -> None:
    from logical_robots_tui.tui.level_editor.saving import save_as

    mode.editor.finish()
    await save_as(mode)


async def discard_changes(mode: EditMode) -> None:
    from logical_robots_tui.tui.level_editor.saving import ask_to_throw_away

    await ask_to_throw_away(mode)


def stop_editing(mode: EditMode) -> None:
    from logical_robots_tui.tui.level_editor.saving import ask_what_to_keep

    if mode.editor.cancel():
        return
    if mode.levels.is_saved:
        mode.leave()
    else:
        mode.ui.spawn(partial(ask_what_to_keep, mode), "dialog", exclusive=True)
