"""History: every tick comes back exactly as it was, whatever way was taken to it."""

from dataclasses import dataclass, replace
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule
from hypothesis.stateful import run_state_machine_as_test as run_machine

from logical_robots_tui.game import Frame, History, load_program, reference_for
from logical_robots_tui.game.history.packing import Moment, Packed
from logical_robots_tui.mind import Decision, Notice, Program
from logical_robots_tui.values import Desire, Value
from logical_robots_tui.world import Area, AreaState, Robot, RobotState, WorldState, list_levels
from logical_robots_tui.world import load_level as load
from tests.game.playing import Play
from tests.world.making import make_level

numbers = st.floats(allow_nan=False)
values = st.recursive(
    st.none() | st.booleans() | st.integers() | numbers | st.text(max_size=8),
    lambda deeper: st.lists(deeper, max_size=4) | st.dictionaries(st.text(max_size=4), deeper),
    max_leaves=12,
)
desires = st.none() | st.builds(Desire, numbers, numbers)
notices = st.lists(st.builds(Notice, st.just("failed"), st.text(max_size=5)), max_size=2)
ROBOTS = ("Ada", "Bo")
LEVEL = make_level(
    [Robot(name, 1.5, 2.5) for name in ROBOTS], areas=[Area("Home", 1, 1, 1, victory_robots=ROBOTS)]
)


@dataclass(frozen=True)
class Deed:
    desire: Desire | None
    memory: Value
    notices: tuple[Notice, ...]
    x: float
    blocked: bool


deeds = st.builds(Deed, desires, values, notices.map(tuple), st.floats(-1e6, 1e6), st.booleans())
ticks = st.lists(deeds, min_size=len(ROBOTS), max_size=len(ROBOTS))


def start() -> Frame:
    robots = tuple(RobotState(name, 1.5, 2.5, 0.25, 7.0) for name in ROBOTS)
    state = WorldState(0, robots, (AreaState("Home", active=False),))
    memories: dict[str, Value] = dict.fromkeys(ROBOTS, "")
    return Frame(0, state, state, (), memories, (), memories, 0.0)


def after(past: Frame, done: list[Deed], won_at: int | None = None) -> Frame:
    pairs = list(zip(past.after.robots, done, strict=True))
    robots = tuple(replace(robot, x=deed.x, blocked=deed.blocked) for robot, deed in pairs)
    home = AreaState("Home", done[0].blocked, ROBOTS if done[1].blocked else ())
    state = WorldState(past.tick + 1, robots, (home,), won_at)
    decisions = tuple(Decision(robot.name, it.desire, it.memory, it.notices) for robot, it in pairs)
    memories = {decision.robot_name: decision.memory for decision in decisions}
    return Frame(past.tick + 1, past.after, state, (), past.memories, decisions, memories, 1.25)


def as_told(moment: Moment) -> str:
    """All of a moment but the distance and the weight; 1, 1.0 and true are told apart."""
    return repr(replace(moment, driven=0.0, weight=0))


def moment_of(frame: Frame) -> Moment:
    driven = frame.tick / 3
    return Moment(frame.after, frame.memories, frame.decisions, frame.think_milliseconds, driven)


def as_moment(frame: Frame) -> str:
    return as_told(moment_of(frame))


@given(st.lists(st.tuples(ticks, st.none() | st.integers(1, 9)), max_size=6))
def test_what_is_packed_comes_out_again_to_the_last_bit(run: list[tuple[Any, ...]]) -> None:
    frames = [start()]
    for done, won_at in run:
        frames.append(after(frames[-1], done, won_at))
    moments = [*map(moment_of, frames)]
    packed = Packed(moments)
    assert [repr(packed.moment(at)) for at in range(len(moments))] == list(map(repr, moments))


LENGTH = 90
NOBODY = Program("", (), {})


class Histories(RuleBasedStateMachine):
    """A history beside lists that forget nothing."""

    def __init__(self) -> None:
        super().__init__()
        self.branch = [start()]
        self.other: list[Frame] | None = None
        self.latest = 0
        self.out_of_reach: list[Frame] | None = None  # the other branch, if that has diverged so
        self.history = History(self.branch[0], LEVEL, LENGTH)

    @rule(done=ticks, times=st.integers(1, 80))
    def go_on(self, done: list[Deed], times: int) -> None:
        for _ in range(times):
            self.branch.append(after(self.branch[-1], done))
            self.history.add(self.branch[-1], NOBODY)
        self.latest = max(self.latest, self.history.last)

    @rule(done=ticks, data=st.data())
    def go_back_and_do_something(self, done: list[Deed], data: st.DataObject) -> None:
        tick = data.draw(st.integers(self.history.first, self.history.last))
        if tick < self.history.last:
            if self.other is None or len(self.other) <= len(self.branch):
                self.other = self.branch
            self.branch = self.branch[: tick + 1]
        self.go_on(done, 1)

    @precondition(lambda self: self.other is not None)
    @rule()
    def change_branch(self) -> None:
        assert self.other is not None
        self.branch, self.other = self.other, self.branch
        self.history.change_branch()

    @rule(data=st.data())
    def forget(self, data: st.DataObject) -> None:
        tick = data.draw(st.integers(self.history.first, self.history.last))
        self.history.forget_future(tick)
        self.branch = self.branch[: tick + 1]

    @invariant()
    def every_tick_is_as_it_was(self) -> None:
        assert self.history.last == self.branch[-1].tick
        assert self.history.first <= max(self.latest - LENGTH + 1, 0)
        # The start needs no tick before it, so it is there beside as many ticks as there may be.
        assert self.history.last - max(self.history.first, 1) < LENGTH
        for tick in range(self.history.first, self.history.last + 1):
            _, before, moment = self.history.recorded(tick)
            assert as_told(moment) == as_moment(self.branch[tick])
            assert isinstance(before, Moment)
            assert as_told(before) == as_moment(self.branch[max(tick - 1, 0)])

    @invariant()
    def memories_that_changed_are_marked(self) -> None:
        for frame in self.branch[max(self.history.first, 1) :]:
            now, then = frame.memories, frame.memories_before
            changed = tuple(name for name in ROBOTS if now[name] != then[name])
            marks = self.history.marks.marks_at(frame.tick)
            marked = [mark.names for mark in marks if mark.kind == "memory"]
            assert marked == ([changed] if changed else [])

    @invariant()
    def the_most_robots_at_home_at_once_are_known(self) -> None:
        homes = [frame.after.areas[0] for frame in self.branch]
        counts = [len(home.visitors) * home.active for home in homes]
        for tick in range(len(counts)):
            most = max(counts[: tick + 1])
            assert self.history.peak(tick)[::2] == (most, counts.index(most))

    @invariant()
    def the_first_difference_from_the_other_branch_is_known(self) -> None:
        known = self.history.divergence
        if self.other is None or self.history.other_ticks is None:
            assert known is None
            return
        pairs = zip(self.branch, self.other, strict=False)
        diverged = next((a.tick for a, b in pairs if differ(a, b)), None)
        if known is not None:
            assert differ(self.branch[known.tick], self.other[known.tick])
        in_reach = max(self.history.first, self.history.other_ticks.start)
        if diverged is not None and diverged < in_reach:
            # Where the future is forgotten, older ticks are in reach again; nobody compares them.
            self.out_of_reach = self.other
        elif not any(self.out_of_reach is branch for branch in (self.other, self.branch)):
            assert diverged == (known.tick if known else None)


def differ(one: Frame, other: Frame) -> bool:
    return (one.decisions, one.after) != (other.decisions, other.after)


def test_a_history_is_right_whatever_is_done_to_it() -> None:
    examples = min(25, settings().max_examples)
    few = settings(max_examples=examples, stateful_step_count=12, deadline=None)
    run_machine(Histories, settings=few)


def grown(history: History, ticks: int, *memory: str) -> tuple[list[Frame], list[Deed]]:
    """The frames of a history that has gone on for so many ticks, with what was always done."""
    branch, deed = [start()], [Deed(None, [*memory], (), 1.0, False)] * 2
    for _ in range(ticks):
        branch.append(after(branch[-1], deed))
        history.add(branch[-1], NOBODY)
    return branch, deed


def test_bytes_are_bounded_and_the_other_branch_goes_first() -> None:
    memory = [f"{number:x}" * 8 for number in range(400)]
    history = History(start(), LEVEL, most_bytes=4000 + 64 * 2000)
    branch, deed = grown(history, 300, *memory)
    history.add(after(branch[200], deed), NOBODY)
    assert history.other_ticks is not None
    for frame in branch[202:]:
        history.add(frame, NOBODY)
    before = history.first
    last = branch[-1]
    while history.first == before:
        last = after(last, [Deed(None, [str(last.tick), *memory], (), 1.0, False)] * 2)
        history.add(last, NOBODY)
    assert history.other_ticks is None
    assert history.kept_bytes <= 4000 + 64 * 2000
    assert history.dropped == history.first
    assert as_told(history.moment(last.tick)) == as_moment(last)


def test_of_two_branches_that_were_left_the_longer_one_is_kept() -> None:
    history = History(start(), LEVEL)
    branch, still = grown(history, 50)
    history.add(after(branch[20], still), NOBODY)
    history.add(after(branch[10], still), NOBODY)
    assert history.other_ticks == range(51)
    assert history.last == 11


WHOLE = [pytest.param(name, 200, marks=pytest.mark.slow) for name in list_levels()]
TO_VICTORY = [pytest.param(name, 0, marks=pytest.mark.proof) for name in list_levels()]


@pytest.mark.parametrize(("name", "most"), [("06-breadcrumbs", 50), *WHOLE, *TO_VICTORY])
async def test_back_and_forth_is_the_same_in_every_tick(play: Play, name: str, most: int) -> None:
    level = load(name)
    reference = reference_for(level)
    assert reference is not None
    ticks = min(most, max(80, 2_500 // len(level.robots))) if most else reference.ticks + 10
    game = play(load_program(level.solution).text, level)
    frames = [game.frame]
    game.listen(frames.append)
    while game.frame.tick < ticks:
        await game.run_until(tick=ticks)
    there = frames[:]
    assert [frame.tick for frame in there] == list(range(ticks + 1))
    for expected in reversed(there[:-1]):
        assert game.back() == expected
    frames.clear()
    while game.frame.tick < ticks:
        await game.run_until(tick=ticks)
    assert frames == there[1:]
    decisions, before = ([frame.decisions for frame in way] for way in (frames, there[1:]))
    assert repr(decisions) == repr(before)
    assert game.history.other_ticks is None
