"""Replays: runs as files, to see again, to verify and to share.

A file is a line with the format's number, the digest of the rest, and compressed
MessagePack: the level, the programs, each robot's desires, and a hash of the world every
hundred ticks. Everything else is computed again.
"""

from __future__ import annotations

import asyncio
import hashlib
import json
import lzma
from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias

import msgspec
import numpy as np

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.advancing import are_decisions_valid
from logical_robots_tui.game.frame import Frame, Superseded
from logical_robots_tui.game.history.packing import is_shallow, is_state
from logical_robots_tui.mind import Decision
from logical_robots_tui.mind.limits import weight_of_text
from logical_robots_tui.paths import read_ordinary
from logical_robots_tui.progress.old_texts import texts_of
from logical_robots_tui.values import Desire
from logical_robots_tui.world import Level, LevelError, World, WorldState
from logical_robots_tui.world.levels.native import read_native

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.history.history import History
    from logical_robots_tui.mind import Program
    from logical_robots_tui.mind.program import Texts

SUFFIX = ".replay"
EVERY = 100
"""Ticks from one hash of the world to the next."""

NO_PROGRAM = """\
# This replay shows what the robots did, but not their program.
Robot(robot_name:, desire: {left_engine: 0.0, right_engine: 0.0}, memory: "") :-
  Sensor(robot_name:);
"""
"""What stands for a program that was left out."""

_AT_ONCE = 10  # ticks to gather before other tasks have a turn
_FORMAT = 2  # the first has the programs of all teams in one text
_MAGIC = b"logical-robots replay "
_MOST_BYTES = 64_000_000
_MOST_UNPACKED = 48_000_000
_MOST_TO_UNPACK = 100_000_000  # bytes of memory; the window alone may be as large as the content
_MOST_STATES = 16_000_000  # bytes of the states of all stages; as objects a few times as much
_HEAVIEST_MEMORIES = 120_000_000  # bytes of a stage's memories as objects, by an upper bound
MOST_TICKS = 100_000
"""The most ticks of a replay."""

_MOST_STAGES = 10_000
_MOST_ROBOTS = 10_000
_MOST_TEXT = 32_000_000  # characters of all levels that differ
_DESIRE_BYTES = 16  # two engines
_HASH_BYTES = 8


Columns: TypeAlias = Annotated[tuple[bytes, ...], msgspec.Meta(max_length=_MOST_ROBOTS)]
Hashes: TypeAlias = Annotated[dict[int, bytes], msgspec.Meta(max_length=MOST_TICKS // EVERY + 2)]


class ReplayProgram(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """A program, and when it began to decide.

    Attributes:
        tick: The first tick that it decided, at least 1.
        name: Its name.
        text: Logica text, or None if it was left out.
        team: The team that thinks with it, or "" for all robots.
    """

    tick: int
    name: str
    text: str | None
    team: str = ""


class Stage(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A stretch of a run in one level: from the start, or from a change by hand.

    Attributes:
        level: The level as the text of its file.
        memories: Each robot's memory at the beginning, by robot name, as JSON.
        is_decided: Whether the decisions of that tick are still there.
        desires: Left and right engine per robot and later tick as little-endian doubles, each
            combined by exclusive or with the tick before; NaN for no desire.
    """

    level: str
    state: WorldState
    memories: str
    is_decided: bool
    desires: Columns


class Replay(msgspec.Struct, frozen=True, forbid_unknown_fields=True, dict=True):
    """An exactly reproducible run.

    `hashes` are of the world after each multiple of `EVERY`, and after the last tick.
    """

    name: str
    last: int
    stages: Annotated[tuple[Stage, ...], msgspec.Meta(max_length=_MOST_STAGES)]
    texts: Annotated[tuple[ReplayProgram, ...], msgspec.Meta(max_length=_MOST_STAGES)]
    hashes: Hashes

    @property
    def first(self) -> int:
        """The tick that it begins after, 0 for the start of the level."""
        return self.stages[0].state.tick

    @property
    def has_programs(self) -> bool:
        return all(program.text is not None for program in self.texts)

    @property
    def programs(self) -> dict[int, Texts]:
        """What the robots think with from a tick on; `NO_PROGRAM` where that was left out."""
        programs: dict[int, Texts] = {}
        for program in self.texts:
            text = NO_PROGRAM if program.text is None else program.text
            programs[program.tick] = {**programs.get(program.tick, {}), program.team: text}
        return programs

    def states(self) -> Iterator[WorldState]:
        """Yield the world after each tick, starting with the first state; needs no programs."""
        ends = [*(stage.state.tick for stage in self.stages[1:]), self.last + 1]
        for stage, level, end in zip(self.stages, self.levels, ends, strict=True):
            world = World(level)
            world.restore(stage.state)
            yield stage.state
            for tick in range(stage.state.tick + 1, end):
                desires = self.desires_in(tick)
                world.act({name: desire for name, desire in desires.items() if desire is not None})
                yield world.save()

    def to_bytes(self) -> bytes:
        """Return the file's content, reproducible; raise InputError if it is too large."""
        content = msgspec.msgpack.encode(self)
        if len(content) > _MOST_UNPACKED:
            size = f"{len(content):,} bytes, more than the {_MOST_UNPACKED:,} of a replay"
            raise InputError(f"The run takes {size}.")
        # A window larger than the content makes it no smaller, but takes 600 MB and 30 ms.
        window = min(max(len(content), 1 << 12), 1 << 26)
        lzma2 = {"id": lzma.FILTER_LZMA2, "preset": 9, "dict_size": window}
        body = lzma.compress(content, filters=[lzma2])
        return b"%s%d\n%s" % (_MAGIC, _FORMAT, hashlib.sha256(body).digest()) + body

    @cached_property
    def levels(self) -> tuple[Level, ...]:
        """Return the level of each stage; raise LevelError for a text that is none."""
        levels = {text: read_native(text, self.name, "") for text in self._level_texts}
        return tuple(levels[stage.level] for stage in self.stages)

    @property
    def _level_texts(self) -> list[str]:
        return list(dict.fromkeys(stage.level for stage in self.stages))

    def desires_in(self, tick: int) -> Mapping[str, Desire | None]:
        index = bisect_left(self.stages, tick, key=lambda stage: stage.state.tick) - 1
        names = [robot.name for robot in self.levels[index].robots]
        rows = self._desires[index][tick - self.stages[index].state.tick - 1]
        return {
            name: None if np.isnan(engines).any() else Desire(*map(float, engines))
            for name, engines in zip(names, rows, strict=True)
        }

    @cached_property
    def _desires(self) -> list[NDArray[np.float64]]:
        """For each stage an array of ticks, robots and engines."""
        arrays = []
        for stage in self.stages:
            columns = [np.frombuffer(column, "<u8").reshape(2, -1).T for column in stage.desires]
            bits = np.stack(columns, axis=1) if columns else np.zeros((MOST_TICKS, 0, 2), "<u8")
            arrays.append(np.bitwise_xor.accumulate(bits, axis=0).view("<f8"))
        return arrays

    def check(self) -> None:
        """Raise ValueError or LevelError unless all parts are valid and fit together."""
        if sum(map(len, self._level_texts)) > _MOST_TEXT:
            raise ValueError("it has too many levels")
        begins = [stage.state.tick for stage in self.stages]
        ends = [*begins[1:], self.last]
        texts = [program.tick for program in self.texts]
        teams = {(program.tick, program.team) for program in self.texts}
        if not begins or not 0 <= begins[0] < self.last <= begins[0] + MOST_TICKS:
            raise ValueError("its ticks are out of bounds")
        if any(first >= end for first, end in zip(begins, ends[:-1], strict=False)):
            raise ValueError("its stages are out of order")
        if texts != sorted(texts) or len(teams) < len(texts) or texts[:1] != [begins[0] + 1]:
            raise ValueError("its programs are out of order")
        hashed = {self.last, *range(begins[0] - begins[0] % EVERY + EVERY, self.last, EVERY)}
        if self.hashes.keys() != hashed or {*map(len, self.hashes.values())} != {_HASH_BYTES}:
            raise ValueError("its hashes don't belong to its ticks")
        previous: Level | None = None
        for stage, level, end in zip(self.stages, self.levels, ends, strict=True):
            if weight_of_text(stage.memories) > _HEAVIEST_MEMORIES:
                raise ValueError(f"its memories at tick {stage.state.tick} are too large")
            state, memories = stage.state, json.loads(stage.memories)
            sizes = {len(column) for column in stage.desires} - {(end - state.tick) * _DESIRE_BYTES}
            if sizes or len(stage.desires) != len(level.robots):
                raise ValueError("its robots don't act in every tick")
            is_compatible = previous is not None and are_decisions_valid(previous, level)
            is_valid = is_shallow(memories) and is_state(state, memories, state.tick, level)
            if not is_valid or stage.is_decided > is_compatible:
                raise ValueError(f"its state at tick {state.tick} does not fit the level")
            previous = level


def load_replay(path: Path) -> Replay:
    """Read a replay, fully checked as it may come from anybody, or raise InputError."""
    try:
        content = read_ordinary(path, _MOST_BYTES + 1)
    except OSError as error:
        raise InputError(f"can't be read: {error.strerror or error}", place=str(path)) from error
    return read_replay(content, str(path))


def read_replay(content: bytes, place: str = "The file") -> Replay:
    """Read a replay's content, fully checked as it may come from anybody, or raise InputError."""
    try:
        replay = _read(content)
        replay.check()
    except (ValueError, lzma.LZMAError, RecursionError, LevelError) as error:
        reason = error.message if isinstance(error, LevelError) else str(error)
        hint = "Make a new one: logical-robots replay record"
        raise InputError(f"is not a replay file: {reason}", place=place, hint=hint) from error
    return replay


def _read(content: bytes) -> Replay:
    line, _, tail = content.partition(b"\n")
    if not line.startswith(_MAGIC):
        raise ValueError("its first line is wrong")
    if len(content) > _MOST_BYTES:
        raise ValueError(f"it has more than {_MOST_BYTES:,} bytes")
    number = line.removeprefix(_MAGIC)
    if number not in (b"1", b"%d" % _FORMAT):
        raise ValueError("another version of the game made it")
    body = tail[32:]
    if hashlib.sha256(body).digest() != tail[:32]:
        raise ValueError("it is damaged")
    packed = lzma.LZMADecompressor(memlimit=_MOST_TO_UNPACK)
    unpacked = packed.decompress(body, max_length=_MOST_UNPACKED)
    if not packed.eof:
        raise ValueError(f"it holds more than {_MOST_UNPACKED:,} bytes")
    parts = msgspec.msgpack.decode(unpacked, type=_Parts)
    if sum(memoryview(stage.state).nbytes for stage in parts.stages) > _MOST_STATES:
        raise ValueError("the states in it are too large")
    columns = sum(_length_of(bytes(memoryview(stage.desires)[:5])) for stage in parts.stages)
    if columns * _DESIRE_BYTES > len(unpacked) + _MOST_ROBOTS * _DESIRE_BYTES:
        raise ValueError("its robots don't act in every tick")
    replay = msgspec.msgpack.decode(unpacked, type=Replay)
    if number == b"1":
        texts = (
            ReplayProgram(p.tick, p.name, text or None, team)
            for p in replay.texts
            for team, text in texts_of(p.text or "").items()
        )
        replay = msgspec.structs.replace(replay, texts=tuple(islice(texts, _MOST_STAGES)))
    return replay


class _StageParts(msgspec.Struct):
    """The parts of a stage left undecoded, because as objects they take far more memory."""

    state: msgspec.Raw
    desires: msgspec.Raw


class _Parts(msgspec.Struct):
    stages: Annotated[tuple[_StageParts, ...], msgspec.Meta(max_length=_MOST_STAGES)]


def _length_of(array: bytes) -> int:
    """Return the number of items of an array of MessagePack, 0 if it is none."""
    if array[0] & 0xF0 == 0x90:
        return array[0] & 0x0F
    width = {0xDC: 2, 0xDD: 4}.get(array[0], 0)
    return int.from_bytes(array[1 : 1 + width], "big")


async def gather(
    history: History,
    write: Callable[[Level], str],
    name: Callable[[Program], str],
    *,
    with_programs: bool = True,
    last: int | None = None,
) -> Replay:
    """Return the replay of a history's ticks, or those up to `last`, in turn with other tasks.

    A program must have decided a tick. Raises Superseded if the branch changes meanwhile,
    InputError if the level changed too often.
    """
    begin, turns = max(history.first - 1, 0), history.turns
    last = history.last if last is None else last
    changes = [tick for tick in range(begin + 1, last + 1) if history.is_changed_in(tick)]
    if len(changes) >= _MOST_STAGES:
        raise InputError("The level was changed too often for a replay.")
    stages, hashes = [], {}
    for first, end in zip([begin, *changes], [*changes, last], strict=True):
        level = history.level_at(first)
        recorded = history.recorded(max(first, history.first))
        moment = recorded.previous if first < history.first else recorded.moment
        engines = np.full((end - first, len(level.robots), 2), np.nan, "<f8")
        is_decided = bool(moment.decisions) and first > begin
        memories = json.dumps(dict(moment.memories), ensure_ascii=False)
        for tick in range(first + 1, end + 1):
            end_moment = history.moment(tick)
            for place, decision in enumerate(end_moment.decisions):
                if decision.desire is not None:
                    desire = decision.desire
                    engines[tick - first - 1, place] = desire.left_engine, desire.right_engine
            if tick % EVERY == 0 or tick == last:
                hashes[tick] = _hash_of(end_moment.after)
            if tick % _AT_ONCE == 0 or tick == last:
                await asyncio.sleep(0)
                if history.turns != turns:
                    raise Superseded
        stages.append(Stage(write(level), moment.after, memories, is_decided, _pack(engines)))
    texts = [
        ReplayProgram(max(tick, begin + 1), name(program), text if with_programs else None, team)
        for tick, program in history.programs(last)
        for team, text in program.texts.items()
    ]
    return Replay(history.level_at(begin).name, last, tuple(stages), tuple(texts), hashes)


def _pack(engines: NDArray[np.float64]) -> tuple[bytes, ...]:
    bits = engines.view("<u8")
    bits[1:] ^= bits[:-1].copy()
    return tuple(bits[:, robot].T.tobytes() for robot in range(bits.shape[1]))


_HASHED_OF_ROBOTS = (
    *("name", "x", "y", "angle", "battery_level", "left_engine", "right_engine"),
    *("blocked", "dead"),
)
_HASHED_OF_AREAS = ("name", "active", "visitors")


def _hash_of(state: WorldState) -> bytes:
    """Return a hash of fields that the format names, so that others can be added."""
    parts = {
        "tick": state.tick,
        "robots": [{f: getattr(robot, f) for f in _HASHED_OF_ROBOTS} for robot in state.robots],
        "areas": [{f: getattr(area, f) for f in _HASHED_OF_AREAS} for area in state.areas],
        "won_at": state.won_at,
        **({"tallies": state.tallies} if state.tallies else {}),
    }
    return hashlib.sha256(msgspec.msgpack.encode(parts)).digest()[:_HASH_BYTES]


class Verifier:
    """Lets a game's robots follow a replay, and compares that with what they would do.

    `difference` is the first tick that is different now, and why, or None.
    """

    def __init__(self, replay: Replay) -> None:
        self.difference: tuple[int, str] | None = None
        self._replay = replay
        # A change by hand at the end of these ticks took their decisions away.
        self._undecided = {stage.state.tick for stage in replay.stages if not stage.is_decided}

    def decide(self, tick: int, decisions: tuple[Decision, ...]) -> tuple[Decision, ...]:
        if tick in self._undecided:
            return decisions
        desires = self._replay.desires_in(tick)
        if self._replay.has_programs:
            for decision in decisions:
                if decision.desire != desires[decision.robot_name]:
                    self._note(tick, f"{decision.robot_name} decides differently.")
        return tuple(
            [replace(decision, desire=desires[decision.robot_name]) for decision in decisions]
        )

    def look(self, frame: Frame) -> None:
        expected = self._replay.hashes.get(frame.tick)
        if expected is not None and expected != _hash_of(frame.after):
            self._note(frame.tick, "The state of the world differs.")

    def _note(self, tick: int, reason: str) -> None:
        if self.difference is None:
            self.difference = tick, reason


async def play_into(
    game: Game, replay: Replay, programs: Sequence[Program], use: Callable[[Program], None]
) -> Verifier:
    """Compute all ticks of a replay in a game, or raise Superseded."""
    verifier = Verifier(replay)
    game.decide = verifier.decide
    changes = {stage.state.tick: index for index, stage in enumerate(replay.stages)}
    uses = {tick - 1: program for tick, program in zip(replay.programs, programs, strict=True)}
    try:
        for tick in sorted({*changes, *uses, *replay.hashes, replay.last}):
            while game.frame.tick < tick and tick > replay.first:
                await game.run_until(tick=tick)
            if tick in changes:
                stage, level = replay.stages[changes[tick]], replay.levels[changes[tick]]
                memories = json.loads(stage.memories)
                game.go_on_in(level, stage.state, memories, stage.is_decided)
            if tick in uses:
                use(uses[tick])
            verifier.look(game.frame)
    finally:
        game.decide = None
    return verifier
