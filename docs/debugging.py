"""Write ``docs/debugging.md`` and its pictures: ``python -m docs.debugging``.

The game is played in a terminal, step by step as the page says it; the ticks in the page are
computed. A test plays the same steps, so that the page can't say what is not so.
"""

from __future__ import annotations

import asyncio
import re
import shlex
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
PICTURES = ("1-diagnosis", "2-why", "3-search", "4-watch", "5-deeper", "6-won", "7-parted")
FILES = f"docs/{FOLDER.name}/{LEVEL.name} docs/{FOLDER.name}/{PROGRAM.name}"
END, MENDED = "ray.distance < 40;", ', ray.label in ["left", "right"];'
QUERY = 'Sensor(sensor:), ray in sensor.radar, ray.object == "beacon", word == ray.label'
SOUGHT = 'Sign(word: "lamp")'
UP, DOWN, RIGHT, LEFT = "\x1b[A", "\x1b[B", "\x1b[C", "\x1b[D"
ENTER, ESCAPE, RUB_OUT, APPLY, PALETTE = "\r", "\x1b", "\x7f", "\x12", "\x10"
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
    yield Step(f"{found.wrong}{ENTER}", f"tick {found.wrong} of {found.wrong}")
    yield Step("a", 'Dot remembers {word: "lamp"}')
    yield Step(PALETTE, "Find a command")
    yield Step("Diagnosis", "Scan the whole run for likely mistakes.")
    yield Step(ENTER, f"Scan the run up to tick {found.wrong}")
    yield Step(ENTER, '"left"` never held')
    yield Step(DOWN, '"left"` never held', "1-diagnosis")
    yield Step(ENTER, f"tick {found.turned} of")
    yield Step("w", "✓ 22: Drive")
    yield Step(f"{DOWN * 3}{RIGHT}", 'word = "lamp"')
    yield Step(f"{DOWN * 3}{RIGHT}", "Turn(word) = {left", "2-why")
    yield Step(f"{HOME}X", "memory after")
    yield Step(f"{DOWN * 13}@", "Pinned: Robot.memory.word for Dot.")
    yield Step(ESCAPE, f"Why · tick {found.turned}")
    yield Step("(", "tick 0 of")
    yield Step("Q", "Go to the next tick in which")
    yield Step(f"{SOUGHT}{ENTER}", f"Why · tick {found.lost}", "3-search")
    yield Step("V", f"Watch · tick {found.lost}")
    yield Step("", "┼", "4-watch")
    yield Step("w", "✓ 27: Robot")
    yield Step(LINE_END, "✓ Mind(robot_name:, word:) →")
    yield Step(ENTER, "Dot: Mind(")
    yield Step(DOWN * 3, "✓ Sign(robot_name:, word:) →")
    yield Step(ENTER, "Dot: Sign(")
    yield Step(f"{LINE_END}{UP * 2}{RIGHT * 2}", "ray = {angle", "5-deeper")
    yield Step("/", "Ask, such as")
    yield Step(f"{QUERY}{ENTER}", "lamp  ")
    yield Step(ESCAPE, "space Run")
    yield Step("p", f"Ask · tick {found.lost - 1}")
    yield Step("2", "esc Leave")
    yield Step(f"{UP * 60}{DOWN * 9}{LINE_END}{RUB_OUT}", "not applied")
    yield Step(f"\x1b[200~{MENDED}\x1b[201~", "in [")
    yield Step(APPLY, "· applied")
    yield Step(ESCAPE, "space Run")
    yield Step("U", "Run until tick")
    yield Step(f"2000{ENTER}", "Again", "6-won")
    yield Step(f"{LEFT}{ENTER}", "Ask · tick")  # the last answer, to stay, uncovers it
    yield Step("C", "The two branches differ", "7-parted")


def play(send: Callable[[str], None], wait_for: Callable[[str], object]) -> Iterator[Step]:
    """Take each step of the walk, and give it when it is done."""
    for step in walk(facts()):
        if step.keys:
            send(step.keys)
        wait_for(step.shows)
        yield step


def told(line: str) -> str:
    """What a command says in a terminal, with the line that starts it, as a reader would see it.

    Args:
        line: The command line.

    Raises:
        ValueError: The command fails.
    """
    _, *arguments = shlex.split(line)
    command = [sys.executable, "-m", "logical_robots_tui", *arguments]
    wide = {"COLUMNS": "100", "LINES": "100"}  # whatever the environment says
    with Terminal(command, size=(100, 100), env=wide) as terminal:
        if terminal.finish() > 1:
            raise ValueError(terminal.text)
        return f"```\n{line}\n```\n\n```text\n{terminal.text}\n```"


def page() -> str:
    """The text of the page."""
    found = facts()
    pictures = {name[0]: f"![The game]({FOLDER.name}/{name}.svg)" for name in PICTURES}
    program = PROGRAM.read_text("utf-8").strip()
    at = f"{FILES} --tick {found.turned} --robot Dot"
    before = f"{FILES} --tick {found.lost - 1} --robot Dot"
    origin = told(f"logical-robots origin {at} --value memory.word")
    diagnosis = told(f"logical-robots diagnose {FILES}")
    made = re.search(r"the same since tick (\d+)", origin)
    won = re.search(r"Ticks 1 to (\d+), won", diagnosis)
    assert made
    assert won
    return f"""\
# Find a mistake

When a robot does something stupid, the cause often lies many ticks back. Each question below
brings you one step closer: from what you see to the decision, from the decision to a value, from
the value to the tick and the rule that made it. All of them are asked about one case, in the game
or on the command line. [A table](#which-question-for-which-symptom) at the end says which question
fits which symptom.

```
logical-robots play {FILES}
```

Dot carries a parcel. A sign near the start says `left`: at the far end of the hall the office is
to the left. Dot sees the sign only while passing it, so it has to remember the word.

```prolog
{program}
```

## The symptom

`U` and `{found.wrong}` run until that tick. At the fork Dot has turned right, away from the
office. `a` selects Dot: a card shows its engines and its memory, and the timeline marks where that
memory changed.

## Where do I begin? Diagnosis

`^P` and “Diagnosis” open a page. `Enter` there scans the whole run for [likely
mistakes](diagnose.md): rules that never produced a row, conditions that never changed, memories
that were lost.

{pictures["1"]}

Whenever Dot had to turn, the word was another than `"left"`, although the sign says so. `Enter`
goes to the first tick of a finding. The same on the command line:

{diagnosis}

Dot does arrive, but late: at tick {won[1]}, after a long detour.

## Why did it do that? Why

`w` proves the decision at tick {found.turned}: the rule that produced it, with the values of this
one derivation, and what it called. `→` and `←` open and close lines. A wall is near, so `Drive`
turns. `Turn` was called with `lamp`, and for every word but `left` it turns right. So `Turn` is
correct, and the word is wrong. The program highlights the place of the line under the cursor.

{pictures["2"]}

`Enter` asks the same about a call, here `Mind`, which supplied the word. So does `--predicate`,
and `--tree` follows every call down to what was sensed and remembered:

{told(f"logical-robots why {at} --predicate Mind --tree")}

The word was already in memory. The proof also explains why `Sign` has no row here: for each rule
that produced none, it shows the first part that nothing satisfies.

## Where does the value come from? Origin

`origin` finds the tick in which the value last changed, and what it was made from then, through
rules, earlier ticks and other robots:

{origin}

So the word became "lamp" in tick {made[1]}, {found.turned - int(made[1])} ticks before the turn,
read from a lamp, by the rule that should read signs. In the game `<` shows the same for
the value under the cursor; `Enter` goes to the tick that made it.

## When does it happen? Search

`(` goes to the start. `Q` asks for a query, here `{SOUGHT}`, and goes to
the next tick in which it holds; `;` and `:` go to the following and the previous one.

{pictures["3"]}

The command line shows all of them at once:

{told(f"logical-robots when {FILES} '{SOUGHT}'")}

`*` right after a search makes its query a breakpoint: a run stops where it begins to hold. `B`
lists all breakpoints.

## When did it change? Watch

`@` pins a query, a number of rows, or the value under the cursor, here the word in Dot's
memory. `V` shows the pinned values, each with a line of the surrounding ticks. `←` and `→` go to
where a value changes: the `┼` marks where `left` became `lamp`.

{pictures["4"]}

## What happened at that tick?

Press `w` again, and `Enter` on `Mind` and on `Sign`, down to the ray that was chosen. The
labyrinth shows the ray under the cursor.

{pictures["5"]}

Every condition on it holds: it ends at a beacon, and close by. No condition checks what is written
there. `/` answers any query about this tick, here which beacons are in sight:

```prolog
{QUERY}
```

## Why not? The nearest miss

One tick earlier, `Sign` has no row. For a rule that produced none, `why` shows the first part that
nothing satisfies, and which single change would have produced a row. Each change was tested.

{told(f"logical-robots why {before} --predicate Sign")}

So only the distance kept Dot from reading a lamp.

## Fix it: two branches

`p` steps back to before the memory was lost. `2` goes to the program. Let `Sign` read only signs:

```prolog
  Sensor(robot_name:, sensor:), ray in sensor.radar, ray.object == "beacon", {END[:-1]}{MENDED}
```

`^R` applies it, `esc` leaves the editor. From now on Dot remembers the right word and wins.

{pictures["6"]}

The old branch is still there, dotted on the timeline. `C` goes to the first tick in which the two
differ, says how, and shows where the two proofs differ; `F` switches to the other branch and back.

{pictures["7"]}

## Which question for which symptom

| what you see | what to ask | in the game | `logical-robots` |
|---|---|---|---|
| it goes wrong somewhere | what stands out in the run? | Diagnosis, in `^P` | `diagnose` |
| it does the wrong thing now | why? | `w` | `why --tree` |
| it doesn't do what it should | why not? | `w`, on a rule without a row | `why --predicate P` |
| it should hold for other values | why not? | `!` in a proof | `why --predicate 'P(x: 1)'` |
| a rule almost holds | what would have to change? | `w`, below that rule | `why --predicate P` |
| a value is wrong | where does it come from? | `<` | `origin` |
| it turns in circles | which rule repeats itself? | Diagnosis, in `^P` | `diagnose` |
| it happens now and then | in which ticks? | `Q`, then `;` `:` | `when` |
| it happens too late to wait for | stop there | `*`, `B` | `when` |
| a value comes and goes | when does it change? | `@`, `V` | `trace --predicates P` |
| you have a question about one tick | a query in Logica | `/` | `query` |
| a record or a list is too long to read | what is in it? | `X`, enter on a value | `query --json` |
| two programs behave differently | where do they diverge? | `C`, `F` | |
| you don't know a program | what uses what? | `R` | |
| it thinks slowly | what does each predicate cost? | `K` | |
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
