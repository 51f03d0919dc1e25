"""``logical-robots replay``: record a run, play it again, verify it and show it."""

from __future__ import annotations

import argparse
import asyncio
import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from logical_robots_tui.cli.command import (
    Commands,
    add_data_dir,
    add_no_solutions,
    add_programs,
    add_start,
    finite,
    harmless,
    named_programs,
    new_command,
    new_group,
    number_from,
)
from logical_robots_tui.cli.level import add_force, refuse_existing, write
from logical_robots_tui.cli.runs.common import open_run, progress_bar
from logical_robots_tui.errors import InputError
from logical_robots_tui.wording import count_of

if TYPE_CHECKING:
    from logical_robots_tui.game import Game
    from logical_robots_tui.game.replay import Replay, Verifier

SAME, DIFFERENT = 0, 3
DEFAULT_TICKS = 5000

EPILOG = """\
examples:
  logical-robots replay record 01-first-steps first-steps -o first.replay
  logical-robots replay play first.replay
  logical-robots replay verify first.replay
  logical-robots replay show first.replay --svg first.svg

`logical-robots replay COMMAND --help` explains a command.
"""


def declare(commands: Commands) -> None:
    summary = "record a run in a file, play it again, verify it and show it"
    inner = new_group(commands, "replay", summary=summary, epilog=EPILOG)
    _declare_record(inner)
    play = new_command(inner, "play", _play)
    play.add_argument("replay", type=Path, metavar="FILE", help="a replay")
    add_data_dir(play)
    add_no_solutions(play)
    verify = new_command(inner, "verify", _verify)
    verify.add_argument("replay", type=Path, metavar="FILE", help="a replay")
    verify.add_argument("--json", action="store_true", help="print JSON")
    show = new_command(inner, "show", _show)
    show.add_argument("replay", type=Path, metavar="FILE", help="a replay")
    form = show.add_mutually_exclusive_group()
    form.add_argument("--svg", type=Path, metavar="OUT", help="write a drawing")
    form.add_argument("--json", action="store_true", help="print all of it as JSON")


def _declare_record(commands: Commands) -> None:
    command = new_command(commands, "record", _record)
    command.add_argument("level", metavar="LEVEL", help="a level's name or file")
    add_programs(command)
    command.add_argument(
        "-o", "--output", type=Path, required=True, metavar="FILE", help="to write"
    )
    command.add_argument(
        "--ticks",
        type=number_from(1),
        default=DEFAULT_TICKS,
        metavar="N",
        help="end after this many ticks (default: %(default)s)",
    )
    add_start(command)
    command.add_argument(
        "--no-programs", action="store_true", help="leave the text of the program out"
    )
    add_force(command)
    add_data_dir(command)
    add_no_solutions(command)


def _record(options: argparse.Namespace) -> int:
    """run a program and record the run

    Run a program in a level until it is won, and record the run.

    examples:
      logical-robots replay record 01-first-steps first-steps -o first.replay
      logical-robots replay record 08-formation formation -o chain.replay --ticks 600
      logical-robots replay record 01-first-steps first-steps -o third.replay --start 3

    exit status: 0 recorded, 2 bad level or program, or the file can't be written
    """
    from logical_robots_tui.editing.level_text import write_native
    from logical_robots_tui.game import Game
    from logical_robots_tui.game.replay import MOST_TICKS, gather

    if options.ticks > MOST_TICKS:
        raise InputError(f"--ticks {options.ticks}: a replay has at most {MOST_TICKS:,} ticks")
    refuse_existing(options.output, force=options.force)
    level, program = open_run(options)

    async def run() -> Replay:
        game = Game(level, program, history=options.ticks)
        try:
            with progress_bar(level.title, options.ticks) as show:
                game.listen(lambda frame: show(frame.tick))
                await game.run_until(tick=options.ticks)
            name = "-".join(Path(each).stem for each in named_programs(options))
            return await gather(
                game.history, write_native, lambda _: name, with_programs=not options.no_programs
            )
        finally:
            await game.close()

    replay = asyncio.run(run())
    content = replay.to_bytes()
    write(options.output, content)
    print(harmless(f"Recorded {_ticks(replay)} in {options.output} ({len(content):,} bytes)."))
    return SAME


def _ticks(replay: Replay) -> str:
    return count_of(replay.last - replay.first, "tick")


def _play(options: argparse.Namespace) -> int:
    """open a replay in the game

    Open a replay in the game.

    The game opens at the end of the replay, with its whole timeline. Go to any tick and
    go on from there, or change the program, as in a game of your own.

    exit status: 0 after quitting, 2 if the replay can't be opened
    """
    from logical_robots_tui.cli.play import play_replay
    from logical_robots_tui.game.replay import load_replay

    return play_replay(options, load_replay(options.replay))


def _verify(options: argparse.Namespace) -> int:
    """compute a replay again and compare

    Compute a replay again and compare.

    All ticks are computed again: what the program wants in each tick is compared with
    the replay, and the world with a hash of it every 100 ticks.

    exit status: 0 the same, 2 the replay can't be used, 3 something is different
    """
    from logical_robots_tui.game.replay import load_replay

    replay = load_replay(options.replay)
    verifier = asyncio.run(_compute(replay))
    tick, reason = verifier.difference or (None, "")
    if options.json:
        told = {"same": tick is None, "tick": tick, "reason": reason, "ticks": replay.last}
        print(json.dumps({**told, "programs": replay.has_programs}))
    elif tick is not None:
        print(harmless(f"Tick {tick} is different: {reason}"))
    elif replay.has_programs:
        print(f"The same: {_ticks(replay)}.")
    else:
        print(f"The same world: {_ticks(replay)}. The programs are not in the replay.")
    return SAME if tick is None else DIFFERENT


async def _compute(replay: Replay) -> Verifier:
    """Compute a replay to its end and compare; raise ProgramError if a program is wrong."""
    from logical_robots_tui.game import Game, compile_program
    from logical_robots_tui.game.replay import play_into

    programs = [await compile_program(texts) for texts in replay.programs.values()]
    game: Game = Game(replay.levels[0], programs[0], history=replay.last)
    try:
        with progress_bar(replay.levels[0].title, replay.last) as show:
            game.listen(lambda frame: show(frame.tick))
            return await play_into(game, replay, programs, game.use)
    finally:
        await game.close()


def _show(options: argparse.Namespace) -> int:
    """print what is in a replay, or draw where the robots drove

    Print what is in a replay, or draw where the robots drove.

    examples:
      logical-robots replay show first.replay
      logical-robots replay show first.replay --json
      logical-robots replay show first.replay --svg first.svg

    exit status: 0 shown, 2 the replay can't be read or the file can't be written
    """
    from logical_robots_tui.game.replay import load_replay

    replay = load_replay(options.replay)
    if options.svg is not None:
        from logical_robots_tui.tui.labyrinth.svg import svg

        write(options.svg, svg(replay.levels[-1], paths=_paths(replay)))
        print(harmless(f"Wrote {options.svg}."))
    elif options.json:
        print(json.dumps(finite(_as_json(replay)), indent=2))
    else:
        print(*(harmless(line) for line in _lines(replay)), sep="\n")
    return SAME


def _paths(replay: Replay) -> dict[str, list[tuple[float, float]]]:
    paths: dict[str, list[tuple[float, float]]] = {}
    for state in replay.states():
        for robot in state.robots:
            paths.setdefault(robot.name, []).append((robot.x, robot.y))
    return paths


def _as_json(replay: Replay) -> dict[str, Any]:
    return {
        "level": replay.name,
        "first": replay.first,
        "last": replay.last,
        "levels": [{"tick": stage.state.tick, "text": stage.level} for stage in replay.stages],
        "programs": [
            {"tick": each.tick, "name": each.name, "team": each.team, "text": each.text}
            for each in replay.texts
        ],
        "desires": [
            {
                name: each and [each.left_engine, each.right_engine]
                for name, each in replay.desires_in(tick).items()
            }
            for tick in range(replay.first + 1, replay.last + 1)
        ],
        "hashes": {tick: known.hex() for tick, known in replay.hashes.items()},
    }


def _lines(replay: Replay) -> Iterator[str]:
    level = replay.levels[0]
    yield f"{level.title} ({replay.name}): {_ticks(replay)}, from tick {replay.first}"
    names = ", ".join(robot.name for robot in level.robots)
    yield f"robots    {names}"
    for text in replay.texts:
        size = "left out" if text.text is None else f"{len(text.text):,} characters"
        whose = f" for {text.team}" if text.team else ""
        yield f"program   {text.name}{whose} from tick {text.tick}, {size}"
    for stage in replay.stages[1:]:
        yield f"change    the level or a robot, by hand, after tick {stage.state.tick}"
    won = next((state.won_at for state in replay.states() if state.won_at is not None), None)
    yield "won       " + ("no" if won is None else f"at tick {won}")
