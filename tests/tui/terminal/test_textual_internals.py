"""Textual's private parts that the game relies on are where they were."""

import ast
import inspect
import re
from itertools import chain
from pathlib import Path

import pytest
from textual import _ansi_sequences, _compositor, events
from textual._styles_cache import StylesCache
from textual._xterm_parser import XTermParser
from textual.app import App
from textual.binding import Binding, BindingsMap
from textual.css.stylesheet import Stylesheet
from textual.document._wrapped_document import WrappedDocument
from textual.geometry import Region
from textual.strip import Strip
from textual.widgets import Input

from logical_robots_tui.tui.terminal import textual_internals
from logical_robots_tui.tui.terminal.stylesheet import SharedStylesheet
from tests.tui.conftest import opened

METHODS = [
    (App, "_handle_exception", ["self", "error"]),
    (App, "_display", ["self", "screen", "renderable"]),
    (XTermParser, "_sequence_to_key_events", ["self", "sequence", "alt"]),
    (StylesCache, "set_dirty", ["self", "regions"]),
    (_compositor.Compositor, "render_strips", ["self", "size"]),
]
ROOM = Path(textual_internals.__file__).parent
PUBLIC = {"_exit", "_replace"}  # of os, and of named tuples


def test_private_methods_take_what_the_game_gives() -> None:
    for owner, name, parameters in METHODS:
        method = getattr(owner, name, None)
        assert method is not None, f"Textual has moved {owner.__name__}.{name}"
        assert list(inspect.signature(method).parameters) == parameters, name
    assert "\x1b[A" in _ansi_sequences.ANSI_SEQUENCES_KEYS
    for name in ("ChopsUpdate", "CompositorUpdate", "LayoutUpdate"):
        assert inspect.isclass(getattr(_compositor, name))


def is_private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__")


def private_names(tree: ast.Module, ours: set[str]) -> set[str]:
    """Return the private names of other packages that a module imports or asks an object for."""
    names = set[str]()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(("textual", "rich")):
            names.update((node.module or "").split("."), (part.name for part in node.names))
        elif isinstance(node, ast.Attribute):
            owner = node.value.id if isinstance(node.value, ast.Name) else ""
            is_own = owner in ("self", "cls") or owner[:1].isupper()
            names.update(() if is_own and node.attr in ours else [node.attr])
    return {name for name in names if is_private(name)} - PUBLIC


def test_each_private_name_is_listed_with_what_would_replace_it() -> None:
    trees = {path: ast.parse(path.read_text("utf-8")) for path in ROOM.parent.rglob("*.py")}
    ours = set[str]()
    for node in chain.from_iterable(map(ast.walk, trees.values())):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            ours.add(node.name)
        elif isinstance(node, ast.Attribute | ast.Name) and isinstance(node.ctx, ast.Store):
            ours.add(node.attr if isinstance(node, ast.Attribute) else node.id)
    used = {path: private_names(tree, ours) for path, tree in trees.items()}
    assert {path.name: names for path, names in used.items() if names and path.parent != ROOM} == {}
    listed = re.findall(r"`(_\w+)`", textual_internals.__doc__ or "")
    assert set(listed) == set().union(*used.values())
    assert len(listed) <= 16


async def test_what_is_taken_from_inside_does_what_it_is_for(data_dir: Path) -> None:
    async with opened(data_dir, text="    " + "word " * 30) as game:
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
        game.app.notify("Out of date", timeout=3600)
        await game.sees("Out of date")
        textual_internals.withdraw_message(game.app, "Out of date")
        await game.until(lambda: not game.shows("Out of date"))
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
        keys = textual_internals.WidgetBindings(view)
        for bindings in ([BindingsMap([Binding("j", "bell")])], []):
            keys.put_first(*bindings)
            assert ("j" in view._bindings.key_to_bindings) is bool(bindings)


def test_a_style_sheet_is_parsed_once_for_each_theme(monkeypatch: pytest.MonkeyPatch) -> None:
    def colour_of(sheet: Stylesheet) -> str:
        return sheet.rules[0].styles.get_rules()["color"].hex

    sheet = SharedStylesheet(variables={"pen": "#0000ff"})
    sheet.add_source("Label { color: $pen; }", ("once", "once"))
    assert colour_of(sheet) == "#0000FF"
    sheet.set_variables({"pen": "#ff0000"})
    sheet.reparse()
    assert colour_of(sheet) == "#FF0000"
    monkeypatch.setattr(Stylesheet, "_parse_rules", None)  # of which nothing is asked again
    copied = sheet.copy()
    copied.parse()
    assert copied.rules == sheet.rules
    copied.set_variables({"pen": "#0000ff"})
    copied.reparse()
    assert colour_of(copied) == "#0000FF"
    assert colour_of(sheet) == "#FF0000"


def test_each_thing_that_is_taken_from_inside_is_tried_in_this_folder() -> None:
    tests = "".join(path.read_text("utf-8") for path in Path(__file__).parent.glob("test_*.py"))
    internals = vars(textual_internals).items()
    here = textual_internals.__name__
    names = [name for name, part in internals if getattr(part, "__module__", "") == here]
    assert [name for name in names if name[0] != "_" and name not in tests] == []
