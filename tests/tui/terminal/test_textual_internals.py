"""Textual's private parts that the game relies on are where they were."""

import inspect
from pathlib import Path

from textual import _ansi_sequences, _compositor, events
from textual._styles_cache import StylesCache
from textual._xterm_parser import XTermParser
from textual.app import App
from textual.binding import Binding, BindingsMap
from textual.document._wrapped_document import WrappedDocument
from textual.drivers.linux_driver import LinuxDriver
from textual.geometry import Region
from textual.screen import Screen
from textual.strip import Strip
from textual.widget import Widget
from textual.widgets import Input, OptionList
from textual.widgets.option_list import Option

from logical_robots_tui.tui.terminal import textual_internals
from tests.tui.conftest import opened

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


async def test_private_attributes_and_modules_are_there() -> None:
    app: App[None] = App()
    async with app.run_test():
        things: list[object] = [app, app.screen, OptionList(), Widget()]
        for owner, names in ATTRIBUTES:
            thing = next(thing for thing in things if isinstance(thing, owner))
            missing = [name for name in names if not hasattr(thing, name)]
            assert not missing, f"Textual has moved {missing} of {owner.__name__}"
    assert "\x1b[A" in _ansi_sequences.ANSI_SEQUENCES_KEYS
    for name in ("ChopsUpdate", "CompositorUpdate", "LayoutUpdate"):
        assert inspect.isclass(getattr(_compositor, name))
    assert {"_app", "_loop", "_debug"} <= set(vars(LinuxDriver(App())))


async def test_what_is_taken_from_inside_does_what_it_is_for(data_dir: Path) -> None:
    characters = textual_internals.characters_by_key()
    assert (characters["full_stop"], characters["left_curly_bracket"]) == (".", "{")
    assert not textual_internals.has_active_app()
    async with opened(data_dir, text="    " + "word " * 30) as game:
        assert textual_internals.has_active_app()
        await game.press("s", *"mine")
        dialog = game.app.screen
        await game.until(lambda: dialog.query_one(Input).value.endswith("mine"))
        game.app.post_message(events.Paste("x" * 3_000))  # `limit_input_lines` has been called
        await game.sees("characters are too many here")
        # `KeyQueue` holds back what comes at once, until what is before it has led elsewhere.
        game.app.post_message(events.Key("escape", "\x1b"))
        game.app.post_message(events.Key("2", "2"))
        game.app.post_message(events.Key("x", "x"))
        await game.until(lambda: game.editor.text.startswith("x"))
        assert textual_internals.is_being_removed(dialog)
        await game.press("backspace")
        await game.settled()
        document = game.editor.wrapped_document  # `hang_wrapped_lines` has been called
        assert isinstance(document, textual_internals.HangingDocument)
        assert [document.hang(0, section) for section in (0, 1)] == [0, 4]
        assert document.height == WrappedDocument.height.fget(document)  # type: ignore[attr-defined] # a property
        lines = textual_internals.rendered_lines(game.app.screen)
        assert lines[0].text.startswith(" LOGICAL ROBOTS")
        view = game.main.labyrinth.view
        before, view._strips[0] = view.render_line(0), Strip.blank(view.size.width)
        assert view.render_lines(view.size.region)[0].text == before.text
        textual_internals.mark_rendered_stale(view, [Region(0, 0, view.size.width, 1)])
        assert view.render_lines(view.size.region)[0].text == " " * view.size.width
        textual_internals.keep_copy(game.app, "mine")
        assert game.app.clipboard == "mine"
        keys = textual_internals.WidgetBindings(view)
        for bindings in ([BindingsMap([Binding("j", "bell")])], []):
            keys.put_first(*bindings)
            assert ("j" in view._bindings.key_to_bindings) is bool(bindings)


def test_each_thing_that_is_taken_from_inside_is_tried_in_this_folder() -> None:
    tests = "".join(path.read_text("utf-8") for path in Path(__file__).parent.glob("test_*.py"))
    internals = vars(textual_internals).items()
    here = textual_internals.__name__
    names = [name for name, part in internals if getattr(part, "__module__", "") == here]
    assert [name for name in names if name[0] != "_" and name not in tests] == []
