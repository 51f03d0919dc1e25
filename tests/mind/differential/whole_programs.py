"""Whole robot programs: every way to drive with every way to keep a memory, of ``parts.txt``,
and those of ``players.txt``.

They run one after the other over recorded moments of three levels, where all robots reason
together as on the platform: what a program keeps at one moment of a level it finds at the next.
"""

import json
from pathlib import Path
from typing import Any

from logical_robots_tui.mind import Limits, Mind, Program
from tests.mind.differential.comparing import same
from tests.mind.differential.duckdb_reference import answer

_HERE = Path(__file__).parent

MOMENTS: list[dict[str, Any]] = json.loads(_HERE.joinpath("moments.json").read_text("utf-8"))
"""Sensor rows of three robots at some ticks of three levels."""

ROBOT = """
Robot(robot_name:, desire:, memory:) :- Drive(robot_name:, desire:), Keep(robot_name:, memory:);
"""


def _sections(name: str) -> dict[str, str]:
    sections = _HERE.joinpath(name).read_text("utf-8").split("## ")[1:]
    return {title: text for title, _, text in (part.partition("\n") for part in sections)}


_PARTS = _sections("parts.txt")

PLAYERS = _sections("players.txt")
"""Programs by title as a player writes them, each about something else."""

PROGRAMS = {
    f"{drive}, {keep}": f"{_PARTS[drive]}{_PARTS[keep]}{ROBOT}"
    for drive in _PARTS
    for keep in _PARTS
    if drive.startswith("drive") and keep.startswith("keep")
}
"""Programs by title."""


def differences(text: str, folder: Path, most: int = len(MOMENTS)) -> list[str]:
    """What robots decide or remember otherwise than DuckDB says, at the first moments."""
    program = Program.compile(text)
    limits = Limits(think_seconds=10)
    minds = [Mind(program, "all", "all", limits, plain=plain) for plain in (False, True)]
    found: list[str] = []
    level, memories = "", dict[str, Any]()
    for moment in MOMENTS[:most]:
        rows = moment["rows"]
        if moment["level"] != level:
            level, memories = moment["level"], {row["robot_name"]: "" for row in rows}
        answers = answer(ASKED.format(text), "Answer", rows, memories, folder)
        theirs = {name: (desire, memory) for name, desire, memory in answers}
        quick, plain = (mind.think(rows, memories) for mind in minds)
        for mine, other in zip(quick, plain, strict=True):
            where = f"{level}, tick {moment['tick']}, {mine.robot_name}"
            if not same(told(mine), told(other)):
                found.append(f"{where}: quick {told(mine)}, plain {told(other)}")
            wanted = theirs.get(mine.robot_name, (None, memories[mine.robot_name]))
            if not same(told(mine), (engines(wanted[0]), wanted[1])):
                found.append(f"{where}: here {told(mine)}, on DuckDB {wanted}")
        memories = {d.robot_name: d.memory for d in quick}
    for mind in minds:
        mind.close()
    return found


ASKED = """{}
Answer(robot_name:, desire:, memory:) :- Robot(robot_name:, desire:, memory:);
"""


def same_memory(ours: Any, theirs: Any, tolerance: float = 1e-9) -> bool:
    """Compare decisions; JSON in a text is here what it spells."""
    if isinstance(theirs, tuple):
        return all(map(same_memory, ours, theirs))
    if isinstance(theirs, str) and isinstance(ours, dict | list):
        theirs = json.loads(theirs)
    return same(ours, theirs, tolerance)


def told(decision: Any) -> tuple[tuple[float, float], Any]:
    desire = decision.desire
    powers = (0.0, 0.0) if desire is None else (desire.left_engine, desire.right_engine)
    return powers, decision.memory


def engines(desire: Any) -> tuple[float, float]:
    """Powers of the engines as the platform's JavaScript takes them: nothing is 0."""
    left, right = (float((desire or {}).get(f"{side}_engine") or 0) for side in ("left", "right"))
    return left, right
