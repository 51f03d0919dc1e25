"""A tournament: matches per second per core, and the same tables however often it is killed."""

from __future__ import annotations

import sqlite3
import subprocess
import sys
import tempfile
from contextlib import closing
from pathlib import Path
from time import sleep
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_least, summed_up
from logical_robots_tui.game import load_program
from logical_robots_tui.lab.folder import Folder
from logical_robots_tui.world import load_level

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["tournament"]

ARENA = "16-high-ground"
PLAYERS = 16
STARTS = 20
KILLS = 5
PATIENCE = 24 * 3600
"""Seconds after which a tournament that does not end is given up."""

_SPEED = "0.8"  # in the programs of the arena; no two players drive alike
_TABLES = ("ranking", "pairs", "cycles", "runs")


def tournament(effort: Effort) -> Iterator[Measurement]:
    """Measure a tournament of sixteen, and one that is killed five times."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if not effort.is_quick:
            seconds, matches, ticks = _held(_written(folder, PLAYERS, STARTS - 1, 0), "full")
            subject = f"{PLAYERS} players, both seats, {STARTS} starts"
            yield summed_up("tournament", f"{subject}, matches", "", [matches])
            yield summed_up("tournament", f"{subject}, per core", "/s", [matches / seconds])
            yield summed_up("tournament", f"{subject}, ticks per core", "/s", [ticks / seconds])
        players, ticks = (5, 40) if effort.is_quick else (PLAYERS, 600)
        folder = _written(folder, players, 0, ticks)
        _held(folder, "once")
        kills = _killed(folder, "often", KILLS)
        same = sum(
            (folder / "once" / f"{table}.csv").read_bytes()
            == (folder / "often" / f"{table}.csv").read_bytes()
            for table in _TABLES
        )
        subject = f"{players} players, killed {kills} times: tables that are the same"
        target = at_least(len(_TABLES))
        yield summed_up("tournament", subject, f"of {len(_TABLES)}", [same], target=target)


def _written(folder: Path, players: int, starts: int, ticks: int) -> Path:
    """Write a tournament of programs of the arena; return its folder."""
    level = load_level(ARENA)
    folder = folder / f"{players}-{starts}"
    (folder / "players").mkdir(parents=True)
    lines = f'[tournament]\nlevel = "{ARENA}"\nstarts = {starts}\nformat = "all"\n'
    (folder / "tournament.toml").write_text(lines + f"ticks = {ticks}\n" * bool(ticks))
    names = [level.solution, *dict.fromkeys(team.program for team in level.teams)]
    for number in range(players):
        text = load_program(names[number % len(names)]).text
        assert _SPEED in text
        text = text.replace(_SPEED, f"{0.5 + number / 40:.3f}")
        (folder / "players" / f"player-{number:02}.l").write_text(text)
    return folder


def _command(folder: Path, out: str) -> list[str]:
    files = [str(folder / name) for name in ("tournament.toml", "players", out)]
    command = [sys.executable, "-m", "logical_robots_tui", "tournament", *files[:2]]
    return [*command, "-o", files[2], "--workers", "1"]


def _held(folder: Path, out: str) -> tuple[float, int, int]:
    """Hold a tournament with one worker; return its processor seconds, matches and ticks."""
    subprocess.run(_command(folder, out), check=True, capture_output=True, timeout=PATIENCE)
    with Folder(folder / out).ledger() as ledger:
        results = ledger.results().values()
        return ledger.seconds(), len(results), sum(result.ticks for result in results)


def _killed(folder: Path, out: str, kills: int) -> int:
    """Hold it, but kill it again and again after some more matches; return how often it was."""
    total = _recorded(folder / "once")
    for number in range(1, kills + 1):
        process = subprocess.Popen(
            _command(folder, out), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        while process.poll() is None and _recorded(folder / out) < total * number / (kills + 1):
            sleep(0.01)
        if process.poll() is not None:
            return number - 1
        process.kill()
        process.wait(timeout=PATIENCE)
    _held(folder, out)
    return kills


def _recorded(out: Path) -> int:
    """Return the number of results in a ledger, which another process may be writing."""
    try:
        with closing(sqlite3.connect(f"file:{out}/ledger.db?mode=ro", uri=True)) as ledger:
            return int(ledger.execute("SELECT count(*) FROM results").fetchone()[0])
    except sqlite3.Error:
        return 0
