"""Textual's private parts that the game relies on are where they were."""

from __future__ import annotations

import inspect

from textual import _ansi_sequences, _compositor
from textual._styles_cache import StylesCache
from textual._xterm_parser import XTermParser
from textual.app import App
from textual.drivers.linux_driver import LinuxDriver
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from logical_robots_tui.tui.terminal import textual_internals

METHODS = [
    (App, "_handle_exception", ["self", "error"]),
    (App, "_display", ["self", "screen", "renderable"]),
    (App, "_begin_update", ["self"]),
    (App, "_end_update", ["self"]),
    (App, "_post_message", ["self", "message"]),
    (LinuxDriver, "_get_terminal_size", ["self"]),
    (XTermParser, "_sequence_to_key_events", ["self", "sequence", "alt"]),
    (StylesCache, "set_dirty", ["self", "regions"]),
    (_compositor.Compositor, "render_strips", ["self", "size"]),
    (Option, "_set_prompt", ["self", "prompt"]),
]
ATTRIBUTES = [
    (App, ("_batch_count", "_running", "_closed", "_driver")),
    (Screen, ("_compositor", "_layout_required", "_bindings")),
    (Widget, ("_styles_cache", "_layout_cache", "_set_dirty", "_pruning", "_parent")),
    (OptionList, ("_option_render_cache",)),
]


def test_private_methods_take_what_the_game_gives() -> None:
    for owner, name, parameters in METHODS:
        method = getattr(owner, name, None)
        assert method is not None, f"Textual has moved {owner.__name__}.{name}"
        assert list(inspect.signature(method).parameters) == parameters, name


async def test_private_attributes_are_there() -> None:
    app: App[None] = App()
    async with app.run_test():
        things: list[object] = [app, app.screen, OptionList(), Widget()]
        for owner, names in ATTRIBUTES:
            thing = next(thing for thing in things if isinstance(thing, owner))
            missing = [name for name in names if not hasattr(thing, name)]
            assert not missing, f"Textual has moved {missing} of {owner.__name__}"


async def test_private_modules_hold_what_the_terminal_needs() -> None:
    assert "\x1b[A" in _ansi_sequences.ANSI_SEQUENCES_KEYS
    for name in ("ChopsUpdate", "CompositorUpdate", "LayoutUpdate"):
        assert inspect.isclass(getattr(_compositor, name))
    assert {"_app", "_loop", "_debug"} <= set(vars(LinuxDriver(App())))


def test_characters_have_the_names_that_textual_gives_to_keys() -> None:
    names = textual_internals.characters_by_key()
    assert names["full_stop"] == "."
    assert names["left_curly_bracket"] == "{"
