"""An installed copy of the game that can't see the checkout."""

import os
import subprocess
import sys
import sysconfig
from dataclasses import dataclass
from pathlib import Path

from tests.processes import run_command

__all__ = ["CHECKOUT", "Installed", "build", "clean_environment", "install", "install_from_lock"]

CHECKOUT = Path(__file__).parents[1]


@dataclass(frozen=True)
class Installed:
    root: Path
    elsewhere: Path

    @property
    def command(self) -> Path:
        return self.root / "bin" / "logical-robots"

    def run(self, name: str, *arguments: str) -> subprocess.CompletedProcess[str]:
        words = [self.root / "bin" / name, *arguments]
        return run_command(words, cwd=self.elsewhere, env=clean_environment(), timeout=120)


def clean_environment() -> dict[str, str]:
    """The environment without what points at the checkout, its terminal or earlier compilations."""
    unwanted = ("PYTHON", "PYTEST", "VIRTUAL", "COLUMNS", "LINES")
    kept = {k: v for k, v in os.environ.items() if not k.startswith(unwanted)}
    return {**kept, "LOGICAL_ROBOTS_CACHE_DIR": ""}


def build(folder: Path) -> None:
    _run(sys.executable, "-m", "build", "--no-isolation", "--outdir", folder, CHECKOUT)


def install(wheel: Path, folder: Path) -> Installed:
    """Install a wheel in a new environment that borrows the dependencies of these tests.

    This is quick and needs no network.
    """
    root = _new_environment(folder, sys.executable)
    _pip(root, "--no-deps", "--no-index", wheel)
    (site,) = root.glob("lib/python*/site-packages")
    # A .pth file in a folder that a .pth file names is not read: the checkout stays unseen.
    (site / "lent.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    return _with_folder(root)


def install_from_lock(wheel: Path, folder: Path, python: str) -> Installed:
    """Install a wheel and its locked dependencies in a new environment of some Python."""
    root = _new_environment(folder, python)
    _pip(root, "--require-hashes", "--requirement", CHECKOUT / "requirements" / "play.lock")
    _pip(root, "--no-deps", "--no-index", wheel)
    return _with_folder(root)


def _new_environment(folder: Path, python: str) -> Path:
    root = folder / "venv"
    _run(python, "-m", "venv", "--without-pip", root)
    return root


def _with_folder(root: Path) -> Installed:
    """Make the folder last: other workers take it as the sign that all is installed."""
    elsewhere = root.parent / "elsewhere"
    elsewhere.mkdir()
    return Installed(root, elsewhere)


def _pip(root: Path, *arguments: str | Path) -> None:
    _run(sys.executable, "-m", "pip", "--python", root / "bin" / "python", "install", *arguments)


def _run(*command: str | Path) -> None:
    done = run_command(command, timeout=600)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
