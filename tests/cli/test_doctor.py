"""What the game finds and completes: doctor, config, and completion in the real shells."""

import os
import shutil
import sys
import tomllib
from pathlib import Path

import pytest

from logical_robots_tui.caching import FOLDER_VARIABLE
from tests.cli.running import Command, in_terminal
from tests.lab.laboratory import write_files
from tests.processes import run_command
from tests.terminal import Terminal

CONFIGURATION = ".config/logical-robots/config.toml"


def findings(command: Command) -> dict[str, str]:
    told = command("doctor", "--json", status=0)
    return {finding["name"]: finding["value"] for finding in told.data}


def test_it_tells_terminal_versions_places_and_an_sqlite_with_a_known_hole(
    command: Command, monkeypatch: pytest.MonkeyPatch, home: Path
) -> None:
    for name in ("NO_COLOR", "COLORTERM", "SSH_CONNECTION", "STY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.setenv("TMUX", "/tmp/tmux-0/default,1,0")
    found = findings(command)
    assert (found["name"], found["colours"], found["inside"]) == ("xterm-256color", "256", "tmux")
    assert found["data"].startswith(str(home))
    assert found["configuration"].endswith("config.toml (none)")
    assert {"python", "textual", "logica", "sqlite", "numpy", "cache"} <= found.keys()
    monkeypatch.setenv("NO_COLOR", "1")
    assert findings(command)["drawing"] == "ascii"
    for version, is_old in (((3, 40, 1), True), ((3, 50, 2), False)):
        monkeypatch.setattr("sqlite3.sqlite_version_info", version)
        assert ("CVE-2025-6965" in command("doctor").out) == is_old


def test_what_stands_in_the_way_is_marked(command: Command, tmp_path: Path, home: Path) -> None:
    write_files(home, {CONFIGURATION: "frames = 0"})
    (tmp_path / "file").write_text("", encoding="utf-8")
    told = command("doctor", "--data-dir", tmp_path / "file" / "data", status=1)
    assert "(not writable: your work can't be saved)" in told.out
    assert "(it has errors; run logical-robots config)" in told.out


def test_it_knows_the_size_of_its_terminal() -> None:
    with in_terminal("doctor") as shown:
        shown.wait_for("cache")
        assert "size           100x40" in shown.text
        assert "colours        16 million" in shown.text


def test_config_prints_a_file_that_sets_the_same(command: Command, home: Path) -> None:
    assert command("config", "--path").out == f"{home / CONFIGURATION}\n"
    write_files(home, {CONFIGURATION: 'theme = "nord"\n[keys]\nrun = "%"\nstep = "^B"\n'})
    told = command("config")
    assert told.status == 2
    assert "config.toml:4: keys.step: ^B can't be used: tmux uses it." in told.err
    found = tomllib.loads(told.out)
    assert (found["theme"], found["keys"]["run"]) == ("nord", ["%"])
    assert tomllib.loads(command("config", "--default").out)["keys"]["run"] == ["space", "F5"]


def test_a_home_that_is_out_of_reach_stops_nothing(
    command: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, level: Path, ahead: Path
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / ("x" * 300)))
    monkeypatch.delenv(FOLDER_VARIABLE, raising=False)
    assert "(it has errors; run logical-robots config)" in command("doctor", status=1).out
    assert "The file is ignored" in command("config").err
    assert command("check", ahead).status == 0
    assert command("run", level, ahead).status == 0
    said = command("play", level, ahead, "--plain", typed=("step", "save mine")).success
    assert "Tick 1." in said
    assert "can't be written" in said


PATH = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
SHELLS = {"bash": ["bash", "--norc", "--noprofile", "-i"], "zsh": ["zsh", "-f", "-i"]}
LOAD = {"bash": "source {}", "zsh": 'autoload -Uz compinit; compinit -u -D; eval "$(cat {})"'}


@pytest.fixture
def script(request: pytest.FixtureRequest, command: Command, tmp_path: Path) -> Path:
    if shutil.which(request.param) is None:
        pytest.skip(f"{request.param} is not installed")
    path = tmp_path / f"completion.{request.param}"
    path.write_text(command("completion", request.param).out, encoding="utf-8")
    return path


@pytest.mark.parametrize("script", SHELLS, indirect=True)
def test_a_shell_completes_commands_levels_programs_and_options(script: Path) -> None:
    shell = script.suffix[1:]
    with Terminal(SHELLS[shell], env={"PATH": PATH, "HOME": str(script.parent)}) as shown:
        # What is typed before the prompt stands there is echoed by the terminal as it is.
        shown.send(f"{LOAD[shell].format(script)}; PS1='rea''dy> '\r")
        shown.wait_for("\nready>")
        shown.send("logical-robots ru\t01-f\tfirst-steps-s\t--tic\t")
        shown.wait_for("logical-robots run 01-first-steps first-steps-starter --ticks")


@pytest.mark.parametrize("script", ["fish"], indirect=True)
def test_fish_completes_the_same(script: Path) -> None:
    asked = ("logical-robots run 01-f", "logical-robots run 01-first-steps first-steps-s")
    lines = "; ".join(f"complete -C '{line}'" for line in asked)
    command = ["fish", "--no-config", "-c", f"source {script}; {lines}"]
    told = run_command(command, env={**os.environ, "PATH": PATH}).stdout
    assert "01-first-steps" in told
    assert "first-steps-starter" in told


def test_names_are_printed_for_the_scripts(command: Command, home: Path) -> None:
    own = home / ".local" / "share" / "logical-robots" / "programs"
    own.mkdir(parents=True)
    (own / "mine.l").write_text("Robot();", encoding="utf-8")
    assert "01-first-steps" in command("completion", "levels").out.splitlines()
    assert {"mine", "first-steps"} <= set(command("completion", "programs").out.splitlines())
