"""``logical-robots trace``: every tick of a run as one JSON object per line."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, TypeAlias

from logical_robots_tui.cli.command import Commands, line_of_json
from logical_robots_tui.cli.runs.common import check_name, new_run_command, open_run

if TYPE_CHECKING:
    import argparse
    import threading

    from logical_robots_tui.game import Frame
    from logical_robots_tui.mind import Mind, Program, QueryError, Table
    from logical_robots_tui.world import Level

    _Tables: TypeAlias = dict[str, Table | QueryError]

WON, NOT_WON = 0, 1
DEFAULT_TICKS = 5000


def declare(commands: Commands) -> None:
    command = new_run_command(
        commands,
        "trace",
        start,
        ticks=(DEFAULT_TICKS, "stop after this many ticks"),
        robot="only this robot",
        only_json=True,
    )
    command.add_argument(
        "--predicates",
        type=lambda text: tuple(name.strip() for name in text.split(",") if name.strip()),
        default=(),
        metavar="A,B",
        help="include the rows of these predicates",
    )
    command.add_argument("--times", action="store_true", help="include how long thinking took")


def start(options: argparse.Namespace) -> int:
    """print every tick of a run as a line of JSON

    Print every tick of a run, up to victory, as a line of JSON.

    examples:
      logical-robots trace 01-first-steps first-steps > run.jsonl
      logical-robots trace 06-breadcrumbs breadcrumbs --ticks 100 --robot Crow \\
        | jq .decisions
      logical-robots trace 06-breadcrumbs breadcrumbs --ticks 100 \\
        --predicates Next | jq -c .predicates.Next.rows

    A line holds: tick, won, robots (after the tick), sensors and memories (as the
    program saw them), decisions (desire, memory, notices), areas, the rows of the
    requested predicates, and reliable: false once a time limit has cut a thought
    short, so that another run may differ.

    exit status: 0 won, 1 not won in time, 2 bad level or program
    """
    level, program = open_run(options)
    for name in options.predicates:
        check_name("predicate", name, (p.name for p in program.predicates if p.has_rows))
    won = asyncio.run(_trace(level, program, options))
    return WON if won else NOT_WON


async def _trace(level: Level, program: Program, options: argparse.Namespace) -> bool:
    from logical_robots_tui.game import Run
    from logical_robots_tui.mind import QueryError

    def ask(frame: Frame, mind: Mind, stop: threading.Event) -> tuple[Frame, _Tables]:
        tables: _Tables = {}
        for name in options.predicates:
            try:
                tables[name] = mind.query(name, frame.sensors, frame.memories_before, stop=stop)
            except QueryError as error:
                tables[name] = error
        return frame, tables

    run = Run(level, program)
    won, reliable = False, True
    try:
        async for frame, tables in run.each(1, options.ticks, ask, to_victory=True):
            won = frame.after.won_at is not None
            reliable = reliable and frame.is_reliable
            data = _data(level, frame, options.robot, tables)
            data["reliable"] = reliable
            if options.times:
                data["think_milliseconds"] = round(frame.think_milliseconds, 4)
            print(line_of_json(data))
        return won
    finally:
        await run.close()


def _data(level: Level, frame: Frame, robot: str | None, tables: _Tables) -> dict[str, Any]:
    mine = frozenset([robot] if robot is not None else [each.name for each in level.robots])
    after = frame.after
    return {
        "tick": frame.tick,
        "won": after.won_at is not None,
        "robots": [
            {
                "name": now.name,
                "x": now.x,
                "y": now.y,
                "angle": now.angle,
                "battery_level": now.battery_level if given.has_battery else None,
                "left_engine": now.left_engine,
                "right_engine": now.right_engine,
                "blocked": now.blocked,
                "dead": now.dead,
            }
            for given, now in zip(level.robots, after.robots, strict=True)
            if now.name in mine
        ],
        "sensors": {
            row["robot_name"]: row["sensor"] for row in frame.sensors if row["robot_name"] in mine
        },
        "memories": {name: frame.memories_before.get(name) for name in sorted(mine)},
        "decisions": [
            {
                "robot": decision.robot_name,
                "desire": decision.desire
                and {
                    "left_engine": decision.desire.left_engine,
                    "right_engine": decision.desire.right_engine,
                },
                "memory": decision.memory,
                "notices": [
                    {"kind": notice.kind, "message": notice.message} for notice in decision.notices
                ],
            }
            for decision in frame.decisions
            if decision.robot_name in mine
        ],
        "areas": [
            {"name": area.name, "active": area.active, "visitors": area.visitors}
            for area in after.areas
        ],
        "predicates": {name: _rows(table, robot) for name, table in tables.items()},
    }


def _rows(table: Table | QueryError, robot: str | None) -> dict[str, Any]:
    if isinstance(table, Exception):
        return {"error": str(table)}
    mine = table.in_mind_of(robot)
    data: dict[str, Any] = {"columns": mine.columns, "rows": mine.rows}
    if table.viewers:
        data["minds"] = mine.viewers
    if table.truncated:
        data["truncated"] = True
    return data
