"""``logical-robots replay``: record a run, play it again, verify, show and export it."""

from __future__ import annotations

import argparse
import asyncio
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from logical_robots_tui import game
from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import harmless, named_programs, print_json, progress_bar
from logical_robots_tui.cli.level import refuse_existing, write
from logical_robots_tui.cli.run import DEFAULT_TICKS, open_run
from logical_robots_tui.errors import InputError
from logical_robots_tui.game.verification import SECONDS, FileBudget, OverBudgetError, check_size
from logical_robots_tui.wording import count_of

if TYPE_CHECKING:
    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.game.replay import Replay, Verifier
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

SAME, DIFFERENT = 0, 3

command.group(
    "replay",
    "record a run in a file, play it again, verify, show and export it",
    """\
  logical-robots replay record 01-first-steps first-steps -o first.replay
  logical-robots replay play first.replay
  logical-robots replay verify first.replay
  logical-robots replay show first.replay --svg first.svg
  logical-robots replay export first.replay moving.svg
""",
)

_SECONDS = command.number(
    "--seconds", command.number_from(1), SECONDS, "give up after so many processor seconds"
)
_REPLAY = command.option("replay", "FILE", "a replay", type=Path)


@command.declare(
    "replay record",
    command.LEVEL,
    command.programs(),
    command.option("-o --output", "FILE", "the file to write", type=Path, required=True),
    command.number("--ticks", command.number_from(1), DEFAULT_TICKS, "end after this many ticks"),
    command.START,
    command.flag("--no-programs", "leave the text of the program out"),
    command.FORCE,
    command.DATA_DIR,
    command.NO_SOLUTIONS,
)
def _record(options: argparse.Namespace) -> int:
    """run a program and record the run

    Run a program in a level until it is won, and record the run.

    examples:
      logical-robots replay record 01-first-steps first-steps -o first.replay
      logical-robots replay record 08-formation formation -o chain.replay --ticks 600
      logical-robots replay record 01-first-steps first-steps -o third.replay --start 3

    exit status: 0 recorded, 2 bad level or program, or the file can't be written
    """
    from logical_robots_tui.game.replay import MOST_TICKS

    if options.ticks > MOST_TICKS:
        raise InputError(f"--ticks {options.ticks}: a replay has at most {MOST_TICKS:,} ticks")
    refuse_existing(options.output, force=options.force)
    level, program = open_run(options)

    name = "-".join(Path(program).stem for program in named_programs(options))
    with progress_bar(level.title, options.ticks) as show:
        replay = asyncio.run(
            record_run(
                level,
                program,
                options.ticks,
                name,
                with_programs=not options.no_programs,
                show=lambda frame: show(frame.tick),
            )
        )
    content = replay.to_bytes()
    write(options.output, content)
    print(harmless(f"Recorded {_ticks(replay)} in {options.output} ({len(content):,} bytes)."))
    return SAME


async def record_run(
    level: Level,
    program: Program,
    ticks: int,
    name: str,
    *,
    with_programs: bool,
    show: Callable[[Frame], None] = lambda _: None,
) -> Replay:
    """Run a program in a level until it is won or over, for at most so many ticks."""
    from logical_robots_tui.editing.level_text import write_native
    from logical_robots_tui.game.replay import gather

    live_game = game.Game(level, program, history=ticks)
    try:
        live_game.listen(show)
        await live_game.run_until(tick=ticks)
        history = live_game.history
        return await gather(history, write_native, lambda _: name, with_programs=with_programs)
    finally:
        await live_game.close()


def _ticks(replay: Replay) -> str:
    return count_of(replay.last - replay.first, "tick")


@command.declare("replay play", _REPLAY, command.DATA_DIR, command.NO_SOLUTIONS)
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


@command.declare("replay verify", _REPLAY, command.JSON, _SECONDS)
def _verify(options: argparse.Namespace) -> int:
    """compute a replay again and compare

    Compute a replay again and compare.

    All ticks are computed again: what the program wants in each tick is compared with
    the replay, and the world with a hash of it every 100 ticks.

    exit status: 0 the same, 2 the replay can't be used or takes too long, 3 something is different
    """
    from logical_robots_tui.game.replay import load_replay

    replay = load_replay(options.replay)
    try:
        verifier = asyncio.run(_compute(replay, options.seconds))
    except InputError as error:
        raise InputError(error.message, place=str(options.replay), hint=error.hint) from error
    tick, reason = verifier.difference or (None, "")
    if options.json:
        verdict = {"same": tick is None, "tick": tick, "reason": reason, "ticks": replay.last}
        print(json.dumps({**verdict, "programs": replay.has_programs}))
    elif tick is not None:
        print(harmless(f"Tick {tick} is different: {reason}"))
    elif replay.has_programs:
        print(f"The same: {_ticks(replay)}.")
    else:
        print(f"The same world: {_ticks(replay)}. The programs are not in the replay.")
    return SAME if tick is None else DIFFERENT


async def _compute(replay: Replay, seconds: int) -> Verifier:
    """Compute a replay to its end and compare.

    Raises ProgramError if a program is wrong, InputError if it is too large or takes too long.
    """
    from logical_robots_tui.game.replay import play_into

    texts_in_order = replay.programs.values()
    robots = max(len(level.robots) for level in replay.levels)
    check_size(sum(map(len, texts_in_order)), (replay.last - replay.first) * robots)
    budget = FileBudget(seconds)
    programs = [await budget.compile(texts) for texts in texts_in_order]
    live_game = game.Game(replay.levels[0], programs[0], history=replay.last)
    try:
        with progress_bar(replay.levels[0].title, replay.last) as show:
            live_game.listen(lambda frame: show(frame.tick))
            return await budget.bound(play_into(live_game, replay, programs, live_game.use))
    except OverBudgetError as error:
        message = f"Tick {live_game.frame.tick:,} of {replay.last:,}: {error.message}"
        raise InputError(message, hint=error.hint) from error
    finally:
        await live_game.close()


@command.declare(
    "replay show",
    _REPLAY,
    command.one_of(
        command.option("--svg", "OUT", "write a drawing", type=Path),
        command.flag("--json", "print all of it as JSON"),
    ),
)
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

        paths: dict[str, list[tuple[float, float]]] = {}
        for state in replay.states():
            for robot in state.robots:
                paths.setdefault(robot.name, []).append((robot.x, robot.y))
        write(options.svg, svg(replay.levels[-1], paths=paths))
        print(harmless(f"Wrote {options.svg}."))
    elif options.json:
        print_json(_as_json(replay))
    else:
        print(*(harmless(line) for line in _lines(replay)), sep="\n")
    return SAME


@command.declare(
    "replay export",
    _REPLAY,
    command.option("file", "OUT", "the file to write, .svg", type=Path),
    command.FORCE,
)
def _export(options: argparse.Namespace) -> int:
    """write a replay as a moving picture

    Write a replay as a moving picture, an SVG file that every browser plays.

    It plays 40 ticks a second, or a longer run in a minute.

    examples:
      logical-robots replay export first.replay moving.svg

    exit status: 0 written, 2 the replay can't be read or the file can't be written
    """
    from logical_robots_tui.game.replay import load_replay
    from logical_robots_tui.tui.labyrinth.svg import moving_svg

    if options.file.suffix.lower() != ".svg":
        raise InputError(
            "A moving picture is an SVG file.",
            place=str(options.file),
            hint="Choose a name that ends in .svg.",
        )
    refuse_existing(options.file, force=options.force)
    replay = load_replay(options.replay)
    picture, step = moving_svg(replay.levels[-1], replay.states(), replay.last - replay.first)
    write(options.file, picture)
    size = f"{_ticks(replay)}, drawn every {step} ticks ({len(picture):,} bytes)"
    print(harmless(f"Wrote {options.file}: {size}."))
    if len(set(replay.levels)) > 1:
        print("The level was changed on the way; it is drawn as it was at the end.")
    return SAME


def _as_json(replay: Replay) -> dict[str, Any]:
    return {
        "level": replay.name,
        "first": replay.first,
        "last": replay.last,
        "levels": [{"tick": stage.state.tick, "text": stage.level} for stage in replay.stages],
        "programs": [
            {"tick": text.tick, "name": text.name, "team": text.team, "text": text.text}
            for text in replay.texts
        ],
        "desires": [
            {
                name: desire and [desire.left_engine, desire.right_engine]
                for name, desire in replay.desires_in(tick).items()
            }
            for tick in range(replay.first + 1, replay.last + 1)
        ],
        "hashes": {tick: state_hash.hex() for tick, state_hash in replay.hashes.items()},
    }


def _lines(replay: Replay) -> Iterator[str]:
    level = replay.levels[0]
    yield f"{level.title} ({replay.name}): {_ticks(replay)}, from tick {replay.first}"
    names = ", ".join(robot.name for robot in level.robots)
    yield f"robots    {names}"
    for text in replay.texts:
        size = "left out" if text.text is None else f"{len(text.text):,} characters"
        team = f" for {text.team}" if text.team else ""
        yield f"program   {text.name}{team} from tick {text.tick}, {size}"
    for stage in replay.stages[1:]:
        yield f"change    the level or a robot, by hand, after tick {stage.state.tick}"
    win_tick = next((state.won_at for state in replay.states() if state.won_at is not None), None)
    yield "won       " + ("no" if win_tick is None else f"at tick {win_tick}")
