"""One command plays, and says clearly what is missing if it can't."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.installed import CHECKOUT, clean_environment
from tests.processes import run_command


def make(
    *arguments: str, folder: Path = CHECKOUT, timeout: float = 60
) -> subprocess.CompletedProcess[str]:
    env = {k: v for k, v in clean_environment().items() if not k.startswith("MAKE")}
    return run_command(["make", *arguments], cwd=folder, env=env, timeout=timeout)


def pretend(folder: Path, *, answers: str) -> str:
    fake = folder / "fake-python"
    fake.write_text(f"#!/bin/sh\n{answers}\n")
    fake.chmod(0o755)
    return str(fake)


def test_help_lists_every_target() -> None:
    (phony,) = re.findall(r"^\.PHONY: (.*)$", (CHECKOUT / "Makefile").read_text(), re.MULTILINE)
    listed = re.findall(r"^  make (\w+)", make("help").stdout, re.MULTILINE)
    assert sorted(listed) == sorted(phony.split())


@pytest.mark.parametrize(
    ("answers", "told"),
    [
        (None, "needs Python 3.11 or newer; '{}' is missing or older"),
        ("exit 1", "needs Python 3.11 or newer; '{}' is missing or older"),
        ('case "$2" in *ensurepip*) exit 1;; esac', "apt install python3-venv"),
    ],
    ids=["missing", "too old", "without venv"],
)
def test_a_python_that_does_not_do_is_told_with_what_to_do(
    answers: str | None, told: str, tmp_path: Path
) -> None:
    python = pretend(tmp_path, answers=answers) if answers else "python-of-nowhere"
    done = make("play", f"VENV={tmp_path}/venv", f"PYTHON={python}")
    assert done.returncode != 0
    assert told.format(python) in done.stderr
    assert ("make play PYTHON=" in done.stderr) is ("needs" in told)
    assert not (tmp_path / "venv").exists()


def test_an_environment_is_made_from_nothing_until_it_has_pip(tmp_path: Path) -> None:
    environment, calls = tmp_path / "venv", tmp_path / "fake-python.calls"
    (environment / "bin").mkdir(parents=True)
    python = pretend(tmp_path, answers='[ "$2" != venv ] || echo "$@" >> "$0.calls"')
    target = (f"{environment}/.python", f"VENV={environment}", f"PYTHON={python}")
    assert make(*target).returncode == 0
    assert calls.read_text() == f"-m venv --clear {environment}\n"
    shutil.copy(python, environment / "bin" / "python")
    (environment / ".python").unlink()
    assert make(*target).returncode == 0
    assert calls.read_text().count("\n") == 1


@pytest.mark.slow
def test_an_environment_whose_making_was_interrupted_is_made_again(tmp_path: Path) -> None:
    environment = tmp_path / "venv"
    bare = [sys.executable, "-m", "venv", "--without-pip", str(environment)]
    subprocess.run(bare, check=True, timeout=60)
    done = make(f"{environment}/.python", f"VENV={environment}", f"PYTHON={sys.executable}")
    assert done.returncode == 0, done.stderr
    subprocess.run([environment / "bin/python", "-m", "pip", "--version"], check=True, timeout=60)


@pytest.mark.proof
def test_a_fresh_checkout_plays_with_one_command_and_then_at_once(tmp_path: Path) -> None:
    checkout = tmp_path / "checkout"
    ignored = shutil.ignore_patterns(".venv", ".git", "__pycache__", ".*_cache", ".hypothesis")
    shutil.copytree(CHECKOUT, checkout, ignore=ignored)

    first = make("play", "ARGS=run 01-first-steps first-steps", folder=checkout, timeout=600)
    assert "Installing what 'play' needs" in first.stdout
    assert first.returncode == 0, first.stderr
    assert (checkout / ".venv" / "bin" / "logical-robots").exists()

    second = make("play", "ARGS=--version", folder=checkout)
    assert (second.returncode, second.stdout.count("\n")) == (0, 1)
