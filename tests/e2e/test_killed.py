"""Two games on one folder, killed at random moments: nothing that was acknowledged is lost."""

import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from random import Random

import pytest

from logical_robots_tui.player.drafts import Drafts
from logical_robots_tui.progress import FILE_NAME, Progress
from tests.short import AHEAD, LEVEL

KEEPS = """if True:
    import itertools, sys
    from pathlib import Path
    from logical_robots_tui.player.drafts import Draft, Drafts
    from logical_robots_tui.game.source import save_program
    from logical_robots_tui.progress import FILE_NAME, Progress

    folder, name = Path(sys.argv[1]), sys.argv[2]
    drafts, progress = Drafts(folder / "drafts"), Progress(folder / FILE_NAME)
    for number in itertools.count():
        text = f"{name} {number} " + "x" * (997 * number % 60_000)
        drafts.keep(Draft("program", name, f"/{name}.l", text))
        print("draft", number, flush=True)
        save_program(folder / "programs" / f"{name}.l", text)
        print("program", number, flush=True)
        progress.win(name, text)
        print("version", number, flush=True)
"""


def killed(commands: Sequence[Sequence[object]], chance: Random, typed: str = "") -> list[str]:
    """What several processes said until they were killed at a random moment, all at once."""
    processes = [
        subprocess.Popen(
            list(map(str, command)), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        for command in commands
    ]
    said = []
    for process in processes:
        assert process.stdin is not None
        process.stdin.write(typed)
        process.stdin.flush()
    for process in processes:
        assert process.stdout is not None
        lines = [process.stdout.readline() for _ in range(chance.randrange(1, 12))]
        said.append("".join(lines))
    for process in processes:
        process.kill()
    for number, process in enumerate(processes):
        with process:
            assert process.stdout is not None
            said[number] += process.stdout.read()
    return said


@pytest.mark.slow
@pytest.mark.parametrize("rounds", [8, pytest.param(20, marks=pytest.mark.proof)])
def test_drafts_programs_and_versions_outlive_many_kills(rounds: int, tmp_path: Path) -> None:
    chance = Random(19)
    for _ in range(rounds):
        commands = [[sys.executable, "-c", KEEPS, tmp_path, name] for name in ("ada", "ben")]
        said = killed(commands, chance)
        drafts = Drafts(tmp_path / "drafts")
        kept = {draft.name: draft.text for draft in reversed(drafts.adopt("program"))}
        drafts.close()
        progress = Progress(tmp_path / FILE_NAME, pytest.fail)
        for name, told in zip(("ada", "ben"), said, strict=True):
            last = {kind: int(number) for kind, number in re.findall(r"(\w+) (\d+)\n", told)}
            program = tmp_path / "programs" / f"{name}.l"
            for kind, text in (
                ("draft", kept.get(name, "")),
                ("program", program.read_text() if program.exists() else ""),
                ("version", progress.newest(name) or ""),
            ):
                if kind in last:
                    number = int(text.split()[1])
                    assert number in (last[kind], last[kind] + 1), (kind, told)
                    assert text == f"{name} {number} " + "x" * (997 * number % 60_000)
        progress.close()
    left = [path for path in (tmp_path / "programs").iterdir() if path.name.startswith(".")]
    assert len(left) <= 2  # of the last kill; the next save sweeps them


@pytest.mark.slow
@pytest.mark.parametrize("rounds", [2, pytest.param(20, marks=pytest.mark.proof)])
def test_what_two_games_said_to_have_kept_is_kept(rounds: int, tmp_path: Path) -> None:
    chance = Random(rounds)
    level, program = tmp_path / "short.toml", tmp_path / "ahead.l"
    level.write_text(LEVEL)
    program.write_text(AHEAD)
    play = [sys.executable, "-m", "logical_robots_tui", "play", level, program, "--plain"]
    data = tmp_path / "data"
    for number in range(rounds):
        typed = "".join(f"save {{}}{number}x{i}\nstep\n" for i in range(30)) + "restart\nrun\n" * 5
        both = [[*play, "--data-dir", data]] * 2
        told = "".join(killed(both, chance, typed.replace("{}", "n")))
        for path in map(Path, re.findall(r"Edit (.*?), or use line", told)):
            assert path.read_text() == AHEAD
        progress = Progress(data / FILE_NAME, pytest.fail)
        state = progress.record(str(level)).state
        progress.close()
        assert state == "won" or "victory is saved" not in told
        assert state != "new" or "Tick 1." not in told
