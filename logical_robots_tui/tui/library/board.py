"""The board: how to be on it, whom to race, and the ladder of an arena."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

from textual import on
from textual.binding import Binding
from textual.content import Content
from textual.widgets import Input, Static

from logical_robots_tui.errors import InputError
from logical_robots_tui.player.board import MOST_NAME, board_name
from logical_robots_tui.progress.board import BoardMembership, GhostEntry, shown_name
from logical_robots_tui.progress.ladder import Challenger
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.layout.dialogs import Dialog
from logical_robots_tui.tui.library.picker import Picker
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, count_of, one_line

if TYPE_CHECKING:
    from textual.app import ComposeResult

_TEXT = (
    "Everybody who plays on this server and has won this level sees how well you won it, under the "
    "name that you choose. Nobody sees your program. If you stay off, your entries are deleted."
)


class JoinDialog(Dialog[BoardMembership]):
    """Asks how a player is on the board; `join` changes it, or raises InputError."""

    DEFAULT_CSS = """
    JoinDialog > #box { max-width: 72; padding: 1 2 0 2; }
    JoinDialog #text { margin-bottom: 1; }
    """

    BINDINGS = [
        Binding("ctrl+g", "share", priority=True),
        Binding("ctrl+n", "stay_off", priority=True),
    ]

    heading = "The board"
    keys = "enter join   ^G ghost   ^N stay off   esc later"

    def __init__(
        self,
        membership: BoardMembership | None,
        join: Callable[[BoardMembership], Awaitable[None]],
    ) -> None:
        self._join, self._shares = join, membership is not None and membership.shares
        name = (membership and membership.name) or ""
        self._ghost = Static(id="ghost")
        super().__init__(
            "",
            Static(_TEXT, id="text", markup=False),
            Input(name, "your name; without one: anonymous", max_length=MOST_NAME, id="name"),
            self._ghost,
        )

    def on_mount(self) -> None:
        self._ghost.update(
            Content.assemble(
                ("☑" if self._shares else "☐", INK.key),
                " others may race my best run as a ghost",
            )
        )

    def action_share(self) -> None:
        self._shares = not self._shares
        self.on_mount()

    def action_stay_off(self) -> None:
        in_background(self, partial(self._leave_with, BoardMembership(is_listed=False)), "join")

    @on(Input.Submitted)
    def _submitted(self) -> None:
        try:
            name = board_name(self.query_one("#name", Input).value)
        except InputError as error:
            self.complain(str(error))
            return
        membership = BoardMembership(True, name, self._shares)
        in_background(self, partial(self._leave_with, membership), "join")

    async def _leave_with(self, membership: BoardMembership) -> None:
        try:
            await self._join(membership)
        except InputError as error:
            self.complain(str(error))
        else:
            self.dismiss(membership)


class GhostPicker(Picker[GhostEntry, GhostEntry]):
    heading = "Race a player"
    keys = "enter race   ↑↓ choose   esc close"

    def line(self, entry: GhostEntry) -> Content:
        name = Content.styled(one_line(shown_name(entry.name)), INK.text)
        return Content.assemble(
            name.truncate(_NAME, ellipsis=True, pad=True),
            (f"  {count_of(entry.ticks, 'tick'):>12}  size {entry.size:,}", INK.dim),
        )


_NAME = 20
_HEAD = f"{'rank':>5}  {'player':<{_NAME}}  {'share':>6}  {'95% interval':<14}  {'elo':>6}"


class LadderDialog(Picker[Challenger, Challenger]):
    """Who plays in a ladder; the player who is taken is the opponent in a match to watch."""

    placeholder = "type a name"
    keys = "enter watch your match against them   ↑↓ choose   esc close"

    DEFAULT_CSS = "LadderDialog #head { color: $ink-dim; padding-left: 1; }"

    def __init__(self, title: str, challengers: Sequence[Challenger]) -> None:
        self.heading = f"{title}: the ladder"
        super().__init__(challengers, next((c for c in challengers if c.is_me), None))

    def content_widgets(self) -> ComposeResult:
        yield self._filter
        yield Static(_HEAD, id="head", markup=False)
        yield self._list

    def line(self, entry: Challenger) -> Content:
        result, (rank, name, share, remark) = entry.result, entry.cells
        text = f"{rank:>5}  {clip(one_line(name), _NAME):<{_NAME}}  "
        if share:
            interval = f"{100 * result.low:.1f} to {100 * result.high:.1f}"
            text += f"{share:>6}  {interval:<14}  {round(result.strength):>+6d}  "
        ink = f"bold {INK.key}" if entry.is_me else INK.text
        return Content.assemble((text, ink), (clip(one_line(remark), 40), INK.dim))
