"""Write ``docs/debugging.md`` and its pictures: ``python -m docs.debugging``.

The game is played in a terminal, step by step as the page says it; the ticks in the page are
computed. A test plays the same steps, so that the page can't say what is not so.
"""

from __future__ import annotations

import asyncio
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from docs.screenshot import SIZE, svg
from logical_robots_tui import Game, Program, load_level
from tests.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["LEVEL", "PAGE", "PICTURES", "PROGRAM", "page", "play"]

FOLDER = Path(__file__).with_name("debugging")
PAGE = FOLDER.with_suffix(".md")
LEVEL, PROGRAM = FOLDER / "fork.toml", FOLDER / "courier.l"
PICTURES = ("1-wrong", "2-why", "3-tree", "4-graph", "5-watch", "6-deeper", "7-won")
END, MENDED = "ray.distance < 40;", ', ray.label in ["left", "right"];'
QUERY = 'Sensor(sensor:), ray in sensor.radar, ray.object == "beacon", word == ray.label'
UP, DOWN, RIGHT = "\x1b[A", "\x1b[B", "\x1b[C"
ENTER, ESCAPE, RUB_OUT, APPLY = "\r", "\x1b", "\x7f", "\x12"
HOME, LINE_END = "\x1b[H", "\x1b[F"


@dataclass(frozen=True)
class Facts:
    """What happens when.

    Attributes:
        lost: The tick in which the memory is overwritten.
        turned: The tick in which the robot begins to turn to the wrong side.
    """

    lost: int
    turned: int

    @property
    def wrong(self) -> int:
        """A tick in which one sees that the robot went wrong."""
        return self.turned + 60


@dataclass(frozen=True)
class Step:
    """Something that the reader does.

    Attributes:
        keys: What is typed.
        shows: What stands on the screen after it.
        picture: Name of the picture that is made then, or "".
    """

    keys: str
    shows: str
    picture: str = ""


def facts() -> Facts:
    """What happens when, as the game computes it."""

    async def look() -> Facts:
        game = Game(load_level(LEVEL), Program.compile(PROGRAM.read_text("utf-8")))
        lost = 0
        try:
            while True:
                frame = await game.step()
                (robot,) = frame.decisions
                if not lost and robot.memory != {"word": "left"}:
                    lost = frame.tick
                assert robot.desire is not None
                if robot.desire.left_engine - robot.desire.right_engine > 0.5:
                    return Facts(lost, frame.tick)
        finally:
            await game.close()

    return asyncio.run(look())


def walk(found: Facts) -> Iterator[Step]:
    """The whole way, from the first key to the victory."""
    yield Step("", "· applied")
    yield Step("U", "Run until tick")
    yield Step(f"{found.wrong}{ENTER}", f"tick {found.wrong} of 0-{found.wrong}")
    yield Step("a", 'Dot remembers {word: "lamp"}', "1-wrong")
    yield Step("g", "Go to tick")
    yield Step(f"{found.turned}{ENTER}", f"tick {found.turned} of")
    yield Step("w", "✓ 22: Drive")
    yield Step(f"{DOWN * 3}{RIGHT}", "col1 = lamp")
    yield Step(f"{DOWN * 3}{RIGHT}", "Turn(word) = {left", "2-why")
    yield Step(f"{HOME}X", "memory after")
    yield Step(f"{DOWN * 13}@", "Pinned: Robot.memory.word for Dot.", "3-tree")
    yield Step(ESCAPE, f"Why · tick {found.turned}")
    yield Step("R", "╰▶ • Mind")
    yield Step(f"{RIGHT}{DOWN}", "╰▶ • Mind", "4-graph")
    yield Step(ENTER, f"Mind · tick {found.turned} · 1 row")
    yield Step(UP, f"Remembered · tick {found.turned}")
    yield Step(UP, f"Sign · tick {found.turned}")
    yield Step("@", "Pinned: Sign: rows.")
    yield Step("V", f"Watch · tick {found.turned}")
    yield Step("{", f"Watch · tick {found.lost}")
    yield Step("", "┼", "5-watch")
    yield Step("w", "✓ 27: Robot")
    yield Step(LINE_END, "✓ Mind(robot_name:, word:) →")
    yield Step(ENTER, "Dot: Mind(")
    yield Step(DOWN * 3, "✓ Sign(robot_name:, word:) →")
    yield Step(ENTER, "Dot: Sign(")
    yield Step(f"{LINE_END}{UP * 2}{RIGHT * 2}", "ray = {angle", "6-deeper")
    yield Step("/", "Ask anything")
    yield Step(f"{QUERY}{ENTER}", "lamp  ")
    yield Step(ESCAPE, "space Run")
    yield Step("p", f"Ask · tick {found.lost - 1}")
    yield Step("2", "esc Leave")
    yield Step(f"{UP * 40}{DOWN * 4}{LINE_END}{RUB_OUT}", "edited, not applied")
    yield Step(f"\x1b[200~{MENDED}\x1b[201~", "in [")
    yield Step(APPLY, "· applied")
    yield Step(ESCAPE, "space Run")
    yield Step("U", "Run until tick")
    yield Step(f"2000{ENTER}", "★ WON", "7-won")


def play(send: Callable[[str], None], wait_for: Callable[[str], None]) -> Iterator[Step]:
    """Take each step of the walk, and give it when it is done."""
    for step in walk(facts()):
        if step.keys:
            send(step.keys)
        wait_for(step.shows)
        yield step


def page() -> str:
    """The text of the page."""
    found = facts()
    pictures = {name[0]: f"![The game]({FOLDER.name}/{name}.svg)" for name in PICTURES}
    program = PROGRAM.read_text("utf-8").strip()
    return f"""\
# Find a mistake

When a robot does something stupid, the cause is often many ticks back. This is a walk through one
such case with nothing but the game. Play along:

```
logical-robots play docs/debugging/{LEVEL.name} docs/debugging/{PROGRAM.name}
```

Dot carries a parcel. A sign beside the start says `left`: at the far end of the hall the way to the
office is to the left. Dot sees the sign only while it passes, so it has to remember the word.

```prolog
{program}
```

## It goes wrong

`U` and `{found.wrong}` run until that tick. At the fork Dot has turned to the right, away from the
office. `a` selects Dot, so that a card tells of it, and the timeline of its memory.

{pictures["1"]}

## Why did it do that?

Drag the timeline back to the turn, or press `g` and type its tick, `{found.turned}`. `w` says why:
the rule that gave the row and what it comes from, as a tree to fold. Go down to the rule of `Drive`
and open it with `→`, and its `if` as well: a wall is near, so it turns, and the word is `lamp`. For
every word but `left`, `Turn` goes to the right. So `Turn` does what it says; the word is wrong.

{pictures["2"]}

`Home` goes to the top; there `X` opens all that the decision came from as a tree. The wrong word is
in the memory that the robot had before, and in the one that it has after this tick. Go down to the
last `word` and pin it with `@`: from now on it is watched.

{pictures["3"]}

## Where does the word come from?

`R` draws which predicate uses which. `Robot` is in the middle, what it uses to the right: the word
comes from `Mind`. Move there with the arrows; `Enter` opens its rows. In the list go up to `Sign`,
which reads what stands by the way, and pin that, too.

{pictures["4"]}

## When did it become wrong?

`V` shows what is pinned, with a line of the ticks around. The word has been the same as far as the
line reaches. `{{` goes back to where Dot's memory changed before: to tick {found.lost},
{found.turned - found.lost} ticks before the turn.

{pictures["5"]}

In this tick the word became another one: the `┼` in its line. In the very same tick `Sign` got a
row: Dot has read something.

## What happened there?

`w` again, down to `Mind` and `Enter`: one step deeper, why `Mind` has this row. Its first rule gave
it, from `Sign`. One more `Enter`, there, shows the rule of `Sign` with its values, down to the ray
that it took: the labyrinth shows it, the program the place of each line that the cursor is on.

{pictures["6"]}

Everything that is asked of a ray holds: it ends at a beacon, and near. Nothing asks what stands
there. `/` is a line for any question about this tick:

```prolog
{QUERY}
```

It answers with all beacons in sight: there is only the lamp in the hall. In this tick it came near
enough, and overwrote what Dot had read on the sign.

## Mend it

`p` steps back, to before the memory was lost. `2` goes to the program; let `Sign` read signs only:

```prolog
  Sensor(robot_name:, sensor:), ray in sensor.radar, ray.object == "beacon", {END[:-1]}{MENDED}
```

`Ctrl+R` applies it, `Esc` leaves the editor. Going on from here Dot keeps its word, turns to the
left and wins. The old future is still there: `C` goes to where the two part, and says in
what and why.

{pictures["7"]}

## The tools in short

| | |
|---|---|
| `w` | why: a proof to fold with `→` and `←`; `Enter` one step deeper, `Backspace` back |
| `R` | which predicate uses which |
| `@` | pin a value or a number of rows; `V` shows the pins, `←` `→` go to where one changes |
| `X` | look into a record or a list, or all that a decision came from, as a tree |
| `<` | which tick and rule a memory, or the part of it under the cursor, comes from |
| `{{` `}}` | to the mark before and the next one: memories, notices, switches, breakpoints |
| `/` | ask anything about this tick |
| `*` | stop when the predicate that is inspected changes; `B` lists what a run stops at |
| `C` | where the old and the new future part, and which derivation differs first |
"""


def main() -> None:
    """Write the page, play the game and draw the pictures."""
    PAGE.write_text(page(), encoding="utf-8")
    with tempfile.TemporaryDirectory() as data_dir:
        game = [sys.executable, "-m", "logical_robots_tui", "play", LEVEL, PROGRAM]
        with Terminal([*game, "--data-dir", data_dir], size=SIZE) as terminal:
            for step in play(terminal.send, terminal.wait_for):
                if step.picture:
                    terminal.read_for(6.0)  # until what was said in passing is gone
                    picture = FOLDER / f"{step.picture}.svg"
                    picture.write_text(svg(terminal.screen), encoding="utf-8")


if __name__ == "__main__":
    main()
