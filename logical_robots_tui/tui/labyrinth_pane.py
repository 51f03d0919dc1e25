"""The labyrinth pane: the picture, and over it the briefing and the banner of victory."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING, ClassVar

from textual.content import Content
from textual.style import Style
from textual.widgets import Static

from logical_robots_tui.tui.commands import command, key_name
from logical_robots_tui.tui.labyrinth import LabyrinthView
from logical_robots_tui.tui.pane import Pane
from logical_robots_tui.tui.plain import clip, one_line, visible
from logical_robots_tui.tui.theme import INK

if TYPE_CHECKING:
    from textual import events

    from logical_robots_tui.game import Frame
    from logical_robots_tui.world import Level

__all__ = ["LabyrinthPane"]

_OFFERS = (("next level", "next_level"), ("again", "restart"), ("stay", "leave"))
_CONFETTI = "·*✦•˚+"
_COLOURS = ("#ff8a7a", "#f5d76e", "#a6da7b", "#79b8ff", "#c9b8f0", "#ffb454")


class LabyrinthPane(Pane, can_focus=True):
    """Shows the world at the tick on the screen."""

    command_id: ClassVar[str] = "labyrinth"

    DEFAULT_CSS = """
    LabyrinthPane { layers: picture over; }
    LabyrinthPane LabyrinthView { layer: picture; }
    """

    def __init__(self) -> None:
        self.view = LabyrinthView(id="picture")
        self.briefing = Briefing()
        self.banner = VictoryBanner()
        super().__init__(self.view, self.briefing, self.banner, title="Labyrinth")

    def show(self, level: Level, frame: Frame) -> None:
        """Show a tick."""
        self.view.show(level, frame)

    def enter(self) -> None:
        """Take the focus, so that single letters are commands."""
        self.focus()


class _Overlay(Static):
    """Text over the picture; a click closes it. It never takes the focus."""

    DEFAULT_CSS = """
    _Overlay { layer: over; display: none; background: $panel 92%; width: 100%; height: auto; }
    """

    def on_click(self, event: events.Click) -> None:
        """Close."""
        event.stop()
        self.display = False


class Briefing(_Overlay):
    """What the level asks for, until the game runs or the player closes it."""

    DEFAULT_CSS = """
    Briefing {
        layer: picture; dock: bottom; padding: 0 1; max-height: 50%; border-top: solid $faint;
    }
    """

    def __init__(self) -> None:
        super().__init__(id="briefing")
        self._has_text = False

    def tell(self, level: Level) -> None:
        """Show the text of a level, if it has one."""
        self._has_text = bool(level.briefing.strip())
        text = "\n".join(visible(line) for line in level.briefing.strip().splitlines())
        run, close = command("run"), command("briefing")
        keys = f"{key_name(run.keys[0])} runs   {key_name(close.keys[0])} hides this"
        self.update(
            Content.assemble(
                (f"{one_line(level.title)}\n", f"bold {INK.title}"),
                (f"{text}\n", INK.text),
                (keys, INK.dim),
            )
        )
        self.display = self._has_text

    def toggle(self) -> bool:
        """Show or hide it; False if there is nothing to show."""
        self.display = self._has_text and not self.display
        return self._has_text


class VictoryBanner(_Overlay):
    """Celebrates; its keys are those of ordinary commands, so nobody who types is disturbed."""

    DEFAULT_CSS = """
    VictoryBanner { dock: top; height: 5; text-wrap: nowrap; }
    MainScreen.-narrow VictoryBanner { height: 3; }
    """

    def __init__(self) -> None:
        super().__init__(id="banner")
        self._ticks = 0
        self._who = ""

    def celebrate(self, ticks: int, who: str) -> None:
        """Tell that it is won.

        Args:
            ticks: How many ticks it took.
            who: Who is where, a few words.
        """
        self._ticks, self._who = ticks, who
        self.display = True
        self.refresh()

    def render(self) -> Content:
        """Lines with confetti, as wide as the widget."""
        width, height = self.size
        chance = random.Random(self._ticks)  # noqa: S311 - confetti
        ticks = "1 tick" if self._ticks == 1 else f"{self._ticks} ticks"
        said = Content.styled(f"★ {clip(self._who, 50)} — {ticks} ★", f"bold {INK.key}")
        offers = Content("   ").join(_offer(label, name) for label, name in _OFFERS)
        nothing = Content("")
        tall = [nothing, said, nothing, offers, nothing]
        lines = tall if height >= len(tall) else [said, nothing, offers]
        return Content("\n").join(_confetti(width, line, chance) for line in lines)


def _offer(label: str, command_id: str) -> Content:
    """The key and the label of a command, which can be clicked too."""
    key = key_name(command(command_id).keys[0])
    content = Content.assemble((key, f"bold {INK.key}"), f" {label}")
    return content.stylize(Style.from_meta({"@click": f"screen.command('{command_id}')"}))


def _confetti(width: int, middle: Content, chance: random.Random) -> Content:
    """A line with something in its middle and confetti at its sides."""
    left = max((width - middle.cell_length) // 2 - 2, 0)
    right = max(width - middle.cell_length - left - 4, 0)
    if not middle.cell_length:
        return _sprinkle(width, chance)
    return Content("  ").join([_sprinkle(left, chance), middle, _sprinkle(right, chance)])


def _sprinkle(width: int, chance: random.Random) -> Content:
    parts = [
        (chance.choice(_CONFETTI), chance.choice(_COLOURS)) if chance.random() < 0.14 else " "
        for _ in range(width)
    ]
    return Content.assemble(*parts)
