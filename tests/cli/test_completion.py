"""Shell completion, typed into the real shells."""

import os
import shutil
import sys
from pathlib import Path

import pytest

from tests.cli.running import Command
from tests.processes import run_command
from tests.terminal import Terminal

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
