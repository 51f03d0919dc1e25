"""Pictures give way where others want the processors, and a key never waits for that."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.clock import CLOCK, Clock
from logical_robots_tui.tui.app.frame_scheduler import FrameRate

PICTURE = 0.006  # seconds of computing
GENTLY, MOST = 2.5, 12.0  # seconds waited per second of computing: some others, very many
CORES, GAMES = 2, 60


class Machine(Clock):
    """A machine with a clock of its own, whose processors others take as much as a test wants."""

    def __init__(self, *, tells: bool = True) -> None:
        self.time = self.busy = self.waited = 0.0
        self._tells = tells
        self.rate = FrameRate(self)

    def now(self) -> float:
        return self.time

    def computed(self) -> float:
        return self.busy

    def processor_times(self) -> tuple[float, float] | None:
        return (self.busy, self.waited) if self._tells else None

    def draw(self, strain: float) -> None:
        """Draw a picture as soon as it may be, where that waits so long per second of computing."""
        self.time += max(self.rate.wait, 0.0)
        with self.rate.drawing():
            self.busy += PICTURE
            self.waited += strain * PICTURE
            self.time += (1 + strain) * PICTURE

    def frames_per_second(self, strain: float) -> float:
        for _ in range(60):
            self.draw(strain)
        return 1 / self.spacing

    @property
    def spacing(self) -> float:
        """Seconds from the last picture to the next."""
        return self.rate.wait + self.rate.idle_seconds


@pytest.fixture(params=[True, False], ids=["tells", "tells not"])
def machine(request: pytest.FixtureRequest) -> Machine:
    return Machine(tells=request.param)


def test_frame_rates_give_way_gently_then_further_and_recover(machine: Machine) -> None:
    assert machine.frames_per_second(0.0) == pytest.approx(30)
    assert 8 < machine.frames_per_second(GENTLY) < 15
    assert 0.9 < machine.frames_per_second(MOST) < 1.5
    assert machine.frames_per_second(100 * MOST) > 0.9
    assert machine.frames_per_second(0.0) == pytest.approx(30, rel=0.02)


def test_many_games_together_leave_room_for_keys() -> None:
    machines = [Machine() for _ in range(GAMES)]
    for _ in range(200):
        load = sum(PICTURE / machine.spacing for machine in machines) / CORES
        strain = load / (1 - load) if load < 0.9 else MOST  # as in a queue at random
        for machine in machines:
            machine.draw(strain)
    assert 0.5 < load < 0.85


def test_neither_short_waits_nor_one_picture_that_was_held_up_cost_frames(machine: Machine) -> None:
    assert machine.frames_per_second(0.2) == pytest.approx(30)
    machine.frames_per_second(0.0)
    machine.draw(MOST)
    assert machine.rate.spacing < 0.05


def test_after_a_key_press_nothing_is_left_to_others_for_a_moment(machine: Machine) -> None:
    machine.frames_per_second(MOST)
    assert machine.rate.wait > 0.1
    machine.rate.hurry()
    assert machine.spacing == pytest.approx(1 / 30)
    machine.time += 0.2
    assert machine.spacing > 0.2


def test_the_rate_that_is_set_is_never_exceeded() -> None:
    machine = Machine()
    machine.rate.frames = 5
    assert machine.frames_per_second(0.0) == pytest.approx(5)


@given(st.lists(st.floats(-1.0, 1e6), max_size=30))
def test_whatever_was_measured_a_picture_comes_within_a_second(strains: list[float]) -> None:
    machine = Machine()
    for strain in strains:
        machine.draw(strain)
        assert 0 <= machine.rate.spacing <= 1


def test_this_system_tells_both_times_or_none() -> None:
    before, enough = CLOCK.processor_times(), CLOCK.computed() + 0.05
    while CLOCK.computed() < enough:
        pass
    after = CLOCK.processor_times()
    if before is None or after is None:
        assert before is after
    else:
        assert after[0] > before[0]
        assert after[1] >= before[1] >= 0
