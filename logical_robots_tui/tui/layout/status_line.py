"""The status line: what the game is doing, as far as it fits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias

from textual.content import Content

from logical_robots_tui.game import Goal, goals
from logical_robots_tui.game.frame import Peak, is_match_over, standing
from logical_robots_tui.tui.commands.keymap import command
from logical_robots_tui.tui.terminal.diff_app import OneLine
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, one_line

if TYPE_CHECKING:
    from logical_robots_tui.player.session import Session

Activity: TypeAlias = Literal["running", "waiting", "paused", "won", "over", "compiling"]

_LONG = 2.0  # seconds of thinking
_NAMED_FROM = 60  # columns with room for the level's name beside the goals

_SIGNS: dict[Activity, tuple[str, str]] = {
    "running": ("● RUNNING", f"bold {INK.good}"),
    "paused": ("‖ PAUSED", f"bold {INK.warn}"),
    "won": ("★ WON", f"bold {INK.key}"),
    "over": ("■ MATCH OVER", f"bold {INK.key}"),
    "waiting": ("◌ waiting for the program", f"bold {INK.warn}"),
    "compiling": ("◌ COMPILING", f"bold {INK.title}"),
}


class Status(NamedTuple):
    """The content of the status line.

    Speeds are in ticks per second: chosen, None for full speed; achieved over the last second,
    None at rest. `thinking_for` is seconds of a long think, otherwise 0.0. `keep_key` is a key that
    goes on with the old program rather than wait, or "". `peak` is None unless more robots
    were in their goals at once than now.
    """

    title: str
    activity: Activity
    tick: int
    won_at: int | None
    speed: float | None
    achieved: float | None
    goals: tuple[Goal, ...]
    standing: tuple[tuple[str, float], ...]
    thinking_for: float
    keep_key: str = ""
    peak: Peak | None = None


def status_of(session: Session, *, typing: bool = False) -> Status:
    activity: Activity = "paused"
    if session.awaits_program:
        activity = "waiting"
    elif session.running:
        activity = "running"
    elif session.won_at is not None:
        activity = "won"
    elif is_match_over(session.level, session.frame.tick):
        activity = "over"
    elif session.game is None and session.state.phase in ("fresh", "compiling"):
        activity = "compiling"
    achieved = session.pace.achieved if session.running else None
    can_keep = session.awaits_program and session.game is not None and not typing
    frame = session.frame
    return Status(
        title=session.level.title,
        activity=activity,
        tick=frame.tick,
        won_at=session.won_at,
        speed=session.pace.speed,
        achieved=round(achieved, 1) if achieved else None,
        goals=goals(session.level, frame.after),
        standing=tuple(standing(session.level, frame.after).items()),
        thinking_for=round(session.thinking_for, 1),
        keep_key=command("leave").key_name if can_keep else "",
        peak=_peak(session),
    )


def _peak(session: Session) -> Peak | None:
    level, state, history = session.level, session.frame.after, session.history
    if history is None or state.won_at is not None:
        return None
    peak = history.peak(state.tick)
    return peak if peak.inside > Peak().with_tick(level, state).inside and peak.words else None


class StatusLine(OneLine):
    """The top line; omits the least important parts if there is too little room."""

    DEFAULT_CSS = "StatusLine { dock: top; height: 1; background: $panel; color: $foreground; }"

    def __init__(self) -> None:
        super().__init__(id="status")
        self._status: Status | None = None

    def show(self, status: Status) -> None:
        if status != self._status:
            self._status = status
            self.repaint()

    def render(self) -> Content:
        if self._status is None:
            return Content("")
        return fit(self._status, self.size.width)


def fit(status: Status, width: int) -> Content:
    """Return the most important parts of a status line that fit, in reading order."""
    tick = f"tick {status.tick}"
    sign, sign_style = _SIGNS[status.activity]
    if status.keep_key:
        sign = f"◌ waiting for the new program, {status.keep_key} runs the old one"
    if status.thinking_for:
        key = command("run").bar_key(typing=True) if status.thinking_for >= _LONG else ""
        stop = f", {key} stops it" if key else ""
        sign, sign_style = f"◌ thinking… {status.thinking_for:.1f} s{stop}", f"bold {INK.warn}"
    by_importance: list[tuple[int, Content]] = [
        (2, Content.styled(sign, sign_style)),
        (3, Content.styled(tick, INK.text)),
        (5, Content("")),
        (4, Content.styled(_speed(status), INK.number)),
        (0, Content.styled("LOGICAL ROBOTS", f"bold {INK.title}")),
    ]
    title = Content.styled(clip(one_line(status.title), 40), INK.text)
    by_importance.insert(2 if width >= _NAMED_FROM else -1, (1, title))
    gap, room = 3, width - 2
    parts: list[tuple[int, Content]] = []
    for place, part in by_importance:
        if place == 5:
            variants = _in_goals(status)
            part = next((v for v in variants if v.cell_length <= room - gap), part)
        need = part.cell_length + (gap if parts else 0)
        if part.cell_length and need <= room:
            parts.append((place, part))
            room -= need
    parts.sort(key=lambda pair: pair[0])
    return Content(" ").append(Content(" " * gap).join(part for _, part in parts))


def _in_goals(status: Status) -> Iterator[Content]:
    """Yield standing and goals, the longest variant first."""
    for is_long, peak in ((True, status.peak), (False, status.peak), (False, None)):
        content = _standing(status.standing).append(_goals(status.goals, long=is_long))
        if peak is not None:
            words = f"  most at once {peak.inside}/{peak.total}, tick {peak.tick}"
            content = content.append(Content.styled(words, INK.warn))
        yield content


def _standing(scores: Sequence[tuple[str, float]]) -> Content:
    best = max((points for _team, points in scores), default=0.0)
    teams = [
        Content.assemble(
            (f"{clip(one_line(team), 12)} ", INK.dim),
            (f"{round(points, 1):,.10g}", INK.good if points == best else INK.text),
        )
        for team, points in scores
    ]
    return Content("  ").join([*teams, Content("")]) if teams else Content("")


def _goals(all_goals: Sequence[Goal], *, long: bool) -> Content:
    parts: list[Content] = []
    for goal in all_goals:
        words: list[Content] = []
        colour = INK.good if goal.is_reached else INK.text if goal.active else INK.dim
        name = clip(one_line(goal.area_name), 20) or "goal"
        off = "" if goal.active else " (off)"
        words.append(Content.styled(f"{name}{off}:" if long else name, colour))
        if long:
            for robot in goal.robots:
                is_in = robot in goal.inside
                mark = "✓" if is_in else "·"
                style = INK.good if is_in else INK.dim
                words.append(Content.styled(f"{clip(one_line(robot), 12)} {mark}", style))
        else:
            words.append(Content.styled(f"{len(goal.inside)}/{len(goal.robots)}", colour))
        parts.append(Content(" ").join(words))
    return Content("  ").join(parts)


def _speed(status: Status) -> str:
    if status.speed is None:
        return f"flat out {status.achieved:.0f}/s" if status.achieved else "flat out"
    target = f"{status.speed:g}/s"
    if status.achieved is None or status.achieved > 0.9 * status.speed:
        return target
    return f"{status.achieved:.0f} of {target}"
