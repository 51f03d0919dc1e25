"""The chain of a value's origin as lines, a few for each link, with a cursor on one of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual.binding import Binding
from textual.content import Content
from textual.geometry import Region
from textual.message import Message

from logical_robots_tui.game.debugging.origin import written_path
from logical_robots_tui.tui.inspector.widgets.cells import cell
from logical_robots_tui.tui.inspector.widgets.lines import LinesView
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK, rich_style

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.style import Style
    from textual import events

    from logical_robots_tui.game import Link, Origin
    from logical_robots_tui.mind.why.sourcing import Read

__all__ = ["LinksView", "link_lines"]

_END = 1_000_000
_HERE = "on $here"
_INDENT = "    "
_SHOWN_READS = 5
_LONGEST = 60  # characters of a value that was read
_KEYS = "enter goes to that tick and says why   esc back"
_NOT_ALL = "This is not all of it: more was read than is followed here."


class LinksView(LinesView):
    """The links, the value itself first; enter goes to one, escape leaves."""

    DEFAULT_CSS = """
    LinksView { margin: 0 1; }
    """

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("up", "move(-1)", show=False),
        Binding("down", "move(1)", show=False),
        Binding("home", f"move({-_END})", show=False),
        Binding("end", f"move({_END})", show=False),
        Binding("enter", "open", show=False),
        Binding("escape,backspace", "leave", show=False),
    ]

    class Pointed(Message):
        """The cursor is on another link.

        Attributes:
            link: The link.
        """

        def __init__(self, link: Link) -> None:
            super().__init__()
            self.link = link

    class Opened(Message):
        """The player wants to go to a link.

        Attributes:
            link: The link.
        """

        def __init__(self, link: Link) -> None:
            super().__init__()
            self.link = link

    class Left(Message):
        """The player wants to go back."""

    def __init__(self) -> None:
        super().__init__(id="links")
        self._origin: Origin | None = None
        self._at = 0
        self._owners: list[int | None] = []

    @property
    def pointed(self) -> Link | None:
        """The link under the cursor."""
        return self._origin.links[self._at] if self._origin is not None else None

    def show(self, origin: Origin | None) -> None:
        """Show an origin, with the cursor on the value itself, or none."""
        self._origin, self._at = origin, 0
        self._draw()
        self.scroll_to(y=0, animate=False)
        self._tell()

    def on_resize(self) -> None:
        """Use the width there is now."""
        self._draw()

    def on_focus(self) -> None:
        """Show the cursor."""
        self._draw()
        self._tell()

    def on_blur(self) -> None:
        """Hide the cursor."""
        self._draw()

    def on_click(self, event: events.Click) -> None:
        """Put the cursor on a link; a second click goes there."""
        line = event.y + self.scroll_offset.y
        owner = self._owners[line] if line < len(self._owners) else None
        if owner == self._at:
            self.action_open()
        elif owner is not None:
            self.action_move(owner - self._at)

    def action_move(self, down: int) -> None:
        """Move the cursor from link to link."""
        if self._origin is None:
            return
        self._at = max(0, min(self._at + down, len(self._origin.links) - 1))
        self._draw()
        mine = [number for number, owner in enumerate(self._owners) if owner == self._at]
        # The last link brings what is said below it into sight, too.
        is_last = self._at == len(self._origin.links) - 1
        height = (len(self._owners) if is_last else mine[-1] + 1) - mine[0]
        self.scroll_to_region(Region(0, mine[0], 1, height), animate=False, force=True)
        self._tell()

    def action_open(self) -> None:
        """Go to the link under the cursor."""
        if self.pointed is not None:
            self.post_message(self.Opened(self.pointed))

    def action_leave(self) -> None:
        """Go back."""
        self.post_message(self.Left())

    def fill(self, number: int) -> Style:
        """The style behind the end of a line."""
        is_here = self.has_focus and number < len(self._owners) and self._owners[number] == self._at
        return self.rich_style + rich_style(_HERE) if is_here else self.rich_style

    def _tell(self) -> None:
        if self.pointed is not None and self.has_focus:
            self.post_message(self.Pointed(self.pointed))

    def _draw(self) -> None:
        if self.columns <= 0:
            return
        lines: list[Content] = []
        self._owners = []
        for number, link in enumerate(self._origin.links if self._origin is not None else ()):
            told = list(link_lines(number, link, self.columns))
            is_here = number == self._at and self.has_focus
            lines += [each.stylize_before(_HERE) for each in told] if is_here else told
            self._owners += [number] * len(told)
        if self._origin is not None:
            if not self._origin.complete:
                lines += Content.styled(_NOT_ALL, INK.warn).wrap(self.columns)
            lines += [Content(""), Content.styled(_KEYS, INK.dim).truncate(self.columns)]
        self._owners += [None] * (len(lines) - len(self._owners))
        self.paint(lines)


def link_lines(number: int, link: Link, width: int) -> Iterator[Content]:
    """What there is to say of a link.

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
    """In which tick it was made, by which rule, and how long it was kept."""
    kept = f", kept until tick {link.until}" if link.until > link.tick else ""
    if link.tick == 0:
        return Content.styled(f"{_INDENT}there since the start{kept}", INK.text)
    rule = f" by the rule in line {link.rule.line}" if link.rule is not None else ""
    return Content.assemble(
        f"{_INDENT}set in ", (f"tick {link.tick}", INK.number), (f"{rule}{kept}", INK.text)
    )


def _read(read: Read) -> Content:
    """What was read of a sensor or a memory; of a ray its number."""
    path = read.path
    name = written_path(path, read.what)
    if read.what == "sensor" and path[:1] == ("radar",) and len(path) > 1:
        name = f"ray {path[1]}{written_path(path[2:], '')}"
    text, colour = cell(read.value, _LONGEST)
    words = one_line(f"from {read.robot}'s {name}")
    return Content.assemble(_INDENT, (words, INK.dim), (" = ", INK.dim), (text, colour))


def _cut(line: Content, width: int) -> Content:
    return line.truncate(width, ellipsis=True)
