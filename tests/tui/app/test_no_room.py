"""Where there is no memory, a restricted game says so and goes on, or ends with all of it saved."""

import re
import resource
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from benchmarks.halls import halls
from logical_robots_tui.editing.files import save_level
from logical_robots_tui.world.levels.fields import MOST_OF_A_KIND, MOST_SIDE
from tests.game.test_memory import HUNGRY
from tests.memory_use import memory_use
from tests.mind.rows import ROBOT
from tests.terminal import Terminal

MIB = 1024**2
SLOW_FOR_MANY = ("empty records", "empty lists", "many numbers", "what can't be packed")
ADDRESSES = 2 * 1024**3  # as in restricted mode


@pytest.mark.slow
@pytest.mark.parametrize(
    ("work", "room"),
    [("draw", 4), ("draw", 30), ("think", 1), ("think", 12), ("compile", 1), ("compile", 12)],
)
def test_restricted_games_out_of_memory_lose_nothing(work: str, room: int, tmp_path: Path) -> None:
    play = [sys.executable, "-m", "logical_robots_tui", "play", "01-first-steps", "--restricted"]
    with Terminal([*play, "--data-dir", tmp_path]) as terminal:
        terminal.wait_for("· applied")
        terminal.send("2", sees="Leave")
        terminal.send("# typed by ada", sees="not applied")
        playing = terminal.game
        # The last bound stays where it was, and can be returned to.
        most = memory_use(playing, "VmSize") + room * MIB
        resource.prlimit(playing, resource.RLIMIT_AS, (most, ADDRESSES))
        if work == "draw":
            terminal.resize(1000, 400)
        else:
            terminal.send({"think": "\x1b ", "compile": "\x12"}[work])
        terminal.wait_for_quiet(1.0)
        if terminal.process.poll() is None:
            with suppress(ProcessLookupError):  # it may be about to end
                resource.prlimit(playing, resource.RLIMIT_AS, (ADDRESSES, ADDRESSES))
            terminal.press_until("\x1bq\r", lambda: terminal.process.poll() is not None)
            assert terminal.process.poll() in (0, 70)
        else:
            assert terminal.process.poll() == 70
            assert "memory" in terminal.everything
    drafts = [path.read_text() for path in tmp_path.rglob("drafts/*.json")]
    assert any("# typed by ada" in draft for draft in drafts)


def played_on_screen(level: str | Path, what: str, ticks: int, folder: Path) -> int:
    """The most MiB that a game held which ran flat out and went back through its history."""
    program = folder / "hungry.l"
    program.write_text(ROBOT + HUNGRY[what] + ";")
    play = [sys.executable, "-m", "logical_robots_tui", "play", level, program]
    with Terminal([*play, "--data-dir", folder]) as terminal:
        terminal.patience = 600
        terminal.wait_for("· applied")
        terminal.send("U", sees="Run until tick")
        terminal.send(f"{ticks}\r")
        terminal.wait_for(lambda: re.search(rf"tick {ticks}\b", terminal.text))
        for key in ("p", "p", "3", "\x1b"):
            terminal.send(key)
            terminal.wait_for_quiet(0.5)
        return memory_use(terminal.game, "VmHWM") // 1024**2


@pytest.mark.proof
@pytest.mark.parametrize(
    ("level", "what", "ticks"),
    [
        *(("01-first-steps", what, 100) for what in HUNGRY),
        *(("13-swarm", what, 25) for what in HUNGRY if what not in SLOW_FOR_MANY),
        *(("13-swarm", what, 8) for what in SLOW_FOR_MANY),
    ],
)
def test_hungry_programs_stay_in_600_mb(level: str, what: str, ticks: int, tmp_path: Path) -> None:
    assert played_on_screen(level, what, ticks, tmp_path) <= 600


@pytest.mark.proof
def test_the_largest_level_that_loads_takes_no_more_than_1_gb(tmp_path: Path) -> None:
    largest = halls(MOST_SIDE, MOST_SIDE, robots=MOST_OF_A_KIND, beacons=MOST_OF_A_KIND)
    path = tmp_path / "largest.toml"
    save_level(largest, path)
    assert played_on_screen(path, "empty records", 3, tmp_path) <= 1000
