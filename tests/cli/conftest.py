"""Small levels and programs to run, and the command in and without a terminal."""

from pathlib import Path

import pytest

from tests.cli.running import Ask, Command
from tests.lab.laboratory import write_files
from tests.short import AHEAD, LEVEL


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home of one's own, so that no test reads or writes the real one."""
    home = tmp_path / "home"
    home.mkdir()
    monkeypatch.setenv("HOME", str(home))
    for name in ("XDG_DATA_HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.delenv(name, raising=False)
    return home


@pytest.fixture
def level(tmp_path: Path) -> Path:
    return write_files(tmp_path, {"short.toml": LEVEL}) / "short.toml"


@pytest.fixture
def ahead(tmp_path: Path) -> Path:
    return write_files(tmp_path, {"ahead.l": AHEAD}) / "ahead.l"


@pytest.fixture
def still(tmp_path: Path) -> Path:
    return write_files(tmp_path, {"still.l": AHEAD.replace("0.5", "0")}) / "still.l"


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


@pytest.fixture
def short(command: Command, level: Path, ahead: Path) -> Ask:
    """Runs a command about the short level and the program that wins it."""
    return lambda name, *words: command(name, level, ahead, *words)
