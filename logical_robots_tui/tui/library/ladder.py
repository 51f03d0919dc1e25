"""The ladder of an arena, as a list of who plays in it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.progress.ladder import HOUSE, Challenger
from logical_robots_tui.tui.library.picker import Picker
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, one_line

if TYPE_CHECKING:
    from textual.app import ComposeResult

_NAME = 20
_LINE = "{rank:>5}  {name:<20}  {share:>6}  {interval:<14}  {strength:>6}"
_HEAD = _LINE.format(
    rank="rank", name="player", share="share", interval="95% interval", strength="elo"
)


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
        result = entry.result
        name = "sparring partner" if entry.player == HOUSE else entry.name or "anonymous"
        ink = f"bold {INK.key}" if entry.is_me else INK.text
        if result.problem or not result.rank:
            remark = result.problem or "waits for its first match"
            return Content.assemble(
                (f"{'-':>5}  {clip(one_line(name), _NAME):<{_NAME}}  ", ink),
                (clip(one_line(remark), 40), INK.dim),
            )
        text = _LINE.format(
            rank=result.rank,
            name=clip(one_line(name), _NAME),
            share=f"{100 * result.share:.1f}%",
            interval=f"{100 * result.low:.1f} to {100 * result.high:.1f}",
            strength=f"{round(result.strength):+d}",
        )
        note = "  a new program waits" if entry.is_new else ""
        return Content.assemble((text, ink), (note, INK.dim))
