"""Wheel and sdist are whole and say what is true; installed without a checkout, the game plays.

`make dist` runs all of it on the files that it has built.
"""

from __future__ import annotations

import json
import re
import zipfile
from pathlib import Path

import pytest

import logical_robots_tui
from tests.installed import CHECKOUT, Installed, clean_environment, install_from_lock
from tests.pythons import pythons
from tests.terminal import Terminal

PYTHONS = pythons()
WON_BY = ("01-first-steps", "first-steps")


def test_the_wheel_carries_every_level_and_program_and_the_licence(wheel: Path) -> None:
    carried = set(zipfile.ZipFile(wheel).namelist())
    shipped = {
        f"logical_robots_tui/{path.relative_to(CHECKOUT)}"
        for folder in ("levels", "programs")
        for path in (CHECKOUT / folder).rglob("*.*")
    }
    assert shipped
    assert shipped <= carried
    assert "logical_robots_tui/py.typed" in carried
    assert any(name.endswith("licenses/LICENSE") for name in carried)


def test_the_wheel_carries_nothing_but_the_package(wheel: Path) -> None:
    tops = {name.partition("/")[0] for name in zipfile.ZipFile(wheel).namelist()}
    version = logical_robots_tui.__version__
    assert tops == {"logical_robots_tui", f"logical_robots_tui-{version}.dist-info"}


def test_the_changelog_begins_with_this_version() -> None:
    newest = re.search(r"^## \[(.+?)\]", (CHECKOUT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert newest
    assert newest[1] == logical_robots_tui.__version__


def test_an_installed_copy_uses_its_own_code_and_levels(installed: Installed) -> None:
    done = installed.run(
        "python",
        "-c",
        "import logical_robots_tui as package; from logical_robots_tui import shipped;"
        "print(package.__file__, shipped.shipped_folder('levels'))",
    )
    code, levels = done.stdout.split()
    assert Path(code).is_relative_to(installed.root)
    assert Path(levels).is_relative_to(installed.root)


def test_an_installed_copy_knows_its_version(installed: Installed) -> None:
    done = installed.run("python", "-m", "logical_robots_tui", "--version")
    assert done.stdout == f"logical-robots {logical_robots_tui.__version__}\n"


def test_an_installed_copy_wins_a_level(installed: Installed) -> None:
    done = installed.run("logical-robots", "run", *WON_BY, "--json")
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["won"] is True


@pytest.mark.proof
@pytest.mark.parametrize("version", PYTHONS)
def test_the_wheel_plays_on_every_python_with_the_locked_dependencies(
    version: str, wheel: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    installed = install_from_lock(wheel, tmp_path, PYTHONS[version])
    monkeypatch.chdir(installed.elsewhere)
    monkeypatch.setenv("HOME", str(tmp_path))
    for folder in ("DATA", "STATE", "CACHE", "CONFIG"):
        monkeypatch.delenv(f"XDG_{folder}_HOME", raising=False)
    assert f" {version}." in installed.run("python", "--version").stdout
    for arguments in (("doctor",), ("run", *WON_BY)):
        done = installed.run("logical-robots", *arguments)
        assert done.returncode == 0, done.stdout + done.stderr
    with Terminal([installed.command], env=clean_environment()) as terminal:
        terminal.wait_for("· applied")
        assert "First steps" in terminal.text
        terminal.send("q")
        assert terminal.finish() == 0, terminal.everything
