"""The origin of a value on the screen: a chain of assignments, with a cursor on one of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from textual.binding import Binding
from textual.content import Content
from textual.message import Message

from logical_robots_tui.game.debugging.origin import written_path
from logical_robots_tui.tui.inspector.widgets.cells import cell
from logical_robots_tui.tui.inspector.widgets.line_views import CursorView
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.game import Link, Origin
    from logical_robots_tui.mind.why.sourcing import Read

__all__ = ["LinksView", "link_lines"]

_INDENT = "    "
_SHOWN_READS = 5
_LONGEST = 60  # characters of a value that was read
_KEYS = "enter goes to that tick and says why   esc back"
_INCOMPLETE = "This is not all of it: more values were read than are traced here."


class LinksView(CursorView):
    """The links of the chain, the value itself first; enter goes to one, escape leaves."""

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("enter", "open", show=False),
        Binding("escape,backspace", "leave", show=False),
    ]

    @dataclass
    class Pointed(Message):
        """The cursor is on another link.

        Attributes:
            link: The link.
        """

        link: Link

    @dataclass
    class Opened(Message):
        """The player goes to a link.

        Attributes:
            link: The link.
        """

        link: Link

    class Left(Message):
        """The player goes back."""

    def __init__(self) -> None:
        super().__init__(id="links")
        self._origin: Origin | None = None

    @property
    def pointed(self) -> Link | None:
        """The link under the cursor."""
        return self._origin.links[self._at] if self._origin is not None else None

    def show(self, origin: Origin | None) -> None:
        """Show an origin, with the cursor on the value itself, or nothing."""
        self._origin, self._at = origin, 0
        if self.columns > 0:
            self.draw()
        self.refresh()
        self.scroll_to(y=0, animate=False)
        if self.has_focus:
            self.cursor_moved()

    def draw(self) -> None:
        """Paint the chain."""
        links = self._origin.links if self._origin is not None else ()
        after: list[Content] = []
        if self._origin is not None:
            if not self._origin.complete:
                after += Content.styled(_INCOMPLETE, INK.warn).wrap(max(1, self.columns))
            after += [Content(""), Content.styled(_KEYS, INK.dim).truncate(self.columns)]
        items = [list(link_lines(n, link, self.columns)) for n, link in enumerate(links)]
        self.paint_items(items, after)

    def cursor_moved(self) -> None:
        """Point out the link under the cursor."""
        if self.pointed is not None:
            self.post_message(self.Pointed(self.pointed))

    def clicked(self, x: int, line: int, *, again: bool) -> None:
        """Go to the link at a second click."""
        del x, line
        if again:
            self.action_open()

    def action_open(self) -> None:
        """Go to the link under the cursor."""
        if self.pointed is not None:
            self.post_message(self.Opened(self.pointed))

    def action_leave(self) -> None:
        """Go back."""
        self.post_message(self.Left())


def link_lines(number: int, link: Link, width: int) -> Iterator[Content]:
    """The lines of a link.

    Args:
        number: Its place in the chain, from 0.
        link: The link.
        width: Columns to fill.
    """
    name = one_line(f"{number + 1}. {link.robot}'s {written_path(link.path)}")
    text, colour = cell(link.value, width)
    yield _cut(Content.assemble((name, INK.title), (" = ", INK.dim), (text, colour)), width)
    yield _cut(_when(link), width)
    if link.span is not None and link.tick:
        place = f"{_INDENT}line {link.span.line}: "
        yield _cut(Content.assemble((place, INK.key), (one_line(link.span.text), INK.text)), width)
    for read in link.reads[:_SHOWN_READS]:
        yield _cut(_read(read), width)
    if (more := len(link.reads) - _SHOWN_READS) > 0:
        yield Content.styled(f"{_INDENT}and from {more} more", INK.warn)
    if link.before:
        numbers = ", ".join(f"{each + 1}." for each in link.before)
        yield _cut(Content.styled(f"{_INDENT}goes on with {numbers}", INK.dim), width)


def _when(link: Link) -> Content:
    """The tick and rule that assigned the value, and how long it was kept."""
    kept = f", kept until tick {link.until}" if link.until > link.tick else ""
    if link.tick == 0:
        return Content.styled(f"{_INDENT}there since the start{kept}", INK.text)
    rule = f" by the rule in line {link.rule.line}" if link.rule is not None else ""
    return Content.assemble(
        f"{_INDENT}set in ", (f"tick {link.tick}", INK.number), (f"{rule}{kept}", INK.text)
    )


def _read(read: Read) -> Content:
    """A value read from a sensor or a memory; rays go by their number."""
    path = read.path
    name = written_path(path, read.what)
    if read.what == "sensor" and path[:1] == ("radar",) and len(path) > 1:
        name = f"ray {path[1]}{written_path(path[2:], '')}"
    text, colour = cell(read.value, _LONGEST)
    words = one_line(f"from {read.robot}'s {name}")
    return Content.assemble(_INDENT, (words, INK.dim), (" = ", INK.dim), (text, colour))


def _cut(line: Content, width: int) -> Content:
    return line.truncate(width, ellipsis=True)
