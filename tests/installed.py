"""An installed copy of the game that can't see the checkout."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
import venv
from dataclasses import dataclass
from pathlib import Path

__all__ = ["CHECKOUT", "Installed", "build_wheel", "install"]

CHECKOUT = Path(__file__).parents[1]


@dataclass(frozen=True)
class Installed:
    """A virtual environment with the wheel in it, and a folder to run it from."""

    root: Path
    elsewhere: Path

    @property
    def command(self) -> Path:
        """The installed ``logical-robots``."""
        return self.root / "bin" / "logical-robots"

    def run(self, name: str, *arguments: str) -> subprocess.CompletedProcess[str]:
        """Run something of its ``bin``."""
        return subprocess.run(
            [str(self.root / "bin" / name), *arguments],
            cwd=self.elsewhere,
            env=clean_environment(),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )


def clean_environment() -> dict[str, str]:
    """The environment without what points at the checkout, its terminal or earlier compilations."""
    unwanted = ("PYTHON", "PYTEST", "VIRTUAL", "COLUMNS", "LINES")
    kept = {k: v for k, v in os.environ.items() if not k.startswith(unwanted)}
    return {**kept, "LOGICAL_ROBOTS_CACHE_DIR": ""}


def build_wheel(folder: Path) -> Path:
    """Build the wheel into a folder."""
    subprocess.run(
        [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", folder, CHECKOUT],
        check=True,
        capture_output=True,
        timeout=120,
    )
    (built,) = folder.glob("*.whl")
    return built


def install(wheel: Path, folder: Path, *, lend_dependencies: bool = True) -> Installed:
    """Install a wheel in a new environment.

    Args:
        wheel: What to install.
        folder: Where to make the environment.
        lend_dependencies: Use the dependencies of the environment of these tests, which is quick
            and needs no network; otherwise pip installs them.
    """
    root = folder / "venv"
    venv.create(root, with_pip=False, symlinks=True)
    options = ["--no-deps", "--no-index"] if lend_dependencies else []
    subprocess.run(
        [sys.executable, "-m", "pip", "--python", root / "bin/python", "install", *options, wheel],
        check=True,
        capture_output=True,
        timeout=600,
    )
    if lend_dependencies:
        (site,) = root.glob("lib/python*/site-packages")
        # A .pth file in a folder that a .pth file names is not read: the checkout stays unseen.
        (site / "lent.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    elsewhere = folder / "elsewhere"
    elsewhere.mkdir()
    return Installed(root, elsewhere)
