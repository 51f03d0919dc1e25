"""Write the course, its solutions and a picture of each level: ``python -m docs.learn``.

All of it is made from the levels and programs that the game shows, so that they can't disagree.
"""

from __future__ import annotations

from html import escape
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.game.level_questions import program_of, ticks_in_words
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.world import list_levels, load_level

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.world import Level

__all__ = ["files"]

FOLDER = Path(__file__).parent
PICTURES = "lessons"
HEAD = """\
# The course

One lesson for each level, with the Logica that it needs. Read it next to the game: play the level
until you are stuck, read on, try again. The game shows the same text bit by bit: the briefing next
to the labyrinth, `h` for a hint, `t` for the lesson, and Enter in it for the questions: each is
answered with one query about a frozen tick, which the game checks. So does `logical-robots learn`.
Programs that win are on [a page of their own](solutions.md).
"""

SOLUTIONS_HEAD = """\
# Solutions of the course

For each level of [the course](learn.md), a program that wins it in the way the lesson teaches.
Yours may well be better: `m` in the game compares them. In a class, `play --no-solutions` hides
each of these programs until its level is won.
"""

SEES = {
    ("own", "own"): "A robot sees only its own memory and sensor.",
    ("seen", "own"): "A robot sees its own sensor, and also the memory of each robot on its radar.",
    ("all", "own"): "A robot sees its own sensor, and the memories of all robots.",
    ("own", "all"): "A robot sees its own memory, and the sensors of all robots.",
    ("seen", "all"): "A robot sees all sensors, and also the memory of each robot on its radar.",
    ("all", "all"): "A robot sees the memories and sensors of all robots.",
}

FLOOR, WALL, ROBOT, BEACON, AREA = "#f4f1ea", "#4a4e5f", "#e8590c", "#b8860b", "#868e96"


def files() -> dict[Path, str]:
    """What is written: the pages and the pictures, by path."""
    levels = [load_level(name) for name in list_levels()]
    page = "\n".join([HEAD, *(line for level in levels for line in _lesson(level))])
    solutions = "\n".join([SOLUTIONS_HEAD, *(part for lv in levels for part in _solution(lv))])
    pictures = {FOLDER / PICTURES / f"{level.name}.svg": _picture(level) for level in levels}
    return {FOLDER / "learn.md": page, FOLDER / "solutions.md": solutions, **pictures}


def _lesson(level: Level) -> Iterator[str]:
    yield _title(level)
    yield f"*{level.idea}*\n"
    yield f"![The labyrinth of {level.title}]({PICTURES}/{level.name}.svg)\n"
    yield f"{level.briefing.strip()}\n"
    yield f"{SEES[level.visibility.memory, level.visibility.sensor]}\n"
    yield "The starter program:\n"
    yield from _program(level.starter)
    yield f"{level.lesson.strip()}\n"
    for number, question in enumerate(level.questions, 1):
        yield f"**Question {number}.** {_escaped(question.ask)}\n"
        where = f"{ticks_in_words(question.ticks)} of `{program_of(level, question)}`"
        yield f"<details><summary>An answer, for {where}</summary>\n"
        yield f"```\n{question.answer}\n```\n\n</details>\n"
    for number, hint in enumerate(level.hints, 1):
        yield f"<details><summary>Hint {number}</summary>\n\n{_escaped(hint)}\n\n</details>\n"
    goals = "; ".join(goal.words for goal in level.second_goals)
    yield f"**Bonus goals.** {goals.capitalize()}.\n"
    yield f"**Further.** {level.further.strip()}\n"


def _solution(level: Level) -> Iterator[str]:
    yield _title(level)
    yield from _program(level.solution)


def _title(level: Level) -> str:
    number = int(level.name.partition("-")[0])
    return f"## {number}. {level.title}\n"


def _escaped(text: str) -> str:
    """Escape text for Markdown, except for code between backticks, which is shown as it is."""
    parts = text.split("`")
    parts[::2] = (escape(part, quote=False) for part in parts[::2])
    return "`".join(parts)


def _program(name: str) -> Iterator[str]:
    text = (shipped_folder("programs") / f"{name}.l").read_text(encoding="utf-8")
    yield f"```prolog\n{text.strip()}\n```\n"


def _picture(level: Level) -> str:
    """The level at its start, as SVG in map units."""
    size = f"{level.width} {level.height}"
    shapes = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size}" width="{level.width}">',
        f'<rect width="{level.width}" height="{level.height}" fill="{FLOOR}"/>',
    ]
    shapes += [
        f'<circle cx="{area.x:g}" cy="{area.y:g}" r="{area.radius:g}" fill="{area.color or AREA}"'
        ' fill-opacity="0.45"/>'
        for area in level.areas
    ]
    shapes.append(f'<path fill="{WALL}" d="{"".join(_walls(level))}"/>')
    shapes += [
        f'<circle cx="{beacon.x:g}" cy="{beacon.y:g}" r="8" fill="{BEACON}">'
        f"<title>{escape(beacon.name)}</title></circle>"
        for beacon in level.beacons
    ]
    shapes += [
        f'<path transform="translate({robot.x:g} {robot.y:g}) rotate({_degrees(robot.angle):g})"'
        f' d="M13 0L-9 9L-5 0L-9 -9Z" fill="{robot.color or ROBOT}" stroke="#222">'
        f"<title>{escape(robot.name)}</title></path>"
        for robot in level.robots
    ]
    return "\n".join([*shapes, "</svg>", ""])


def _degrees(angle: float) -> float:
    return round(angle * 57.29577951308232, 1)


def _walls(level: Level) -> Iterator[str]:
    """Subpaths, one for each run of wall in rows that are alike."""
    top = 0
    for row, alike in groupby(bytes(line) for line in level.walls):
        height, left = len(list(alike)), 0
        for is_wall, run in groupby(row):
            width = len(list(run))
            if is_wall:
                yield f"M{left} {top}h{width}v{height}h-{width}z"
            left += width
        top += height


def main() -> None:
    """Write the pages and the pictures; pictures of levels that are gone are removed."""
    wanted = files()
    for path in (FOLDER / PICTURES).glob("*.svg"):
        if path not in wanted:
            path.unlink()
    for path, text in wanted.items():
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
