"""Wheel, sdist and locks are whole and true; installed without a checkout, the game plays.

`make dist` runs all of it on the files that it has built.
"""

import email
import json
import re
import sys
import tarfile
import tomllib
import zipfile
from email.message import Message
from pathlib import Path

import pytest
from markdown_it import MarkdownIt
from packaging.requirements import Requirement

import logical_robots_tui
from tests.house.examples import blocks
from tests.installed import CHECKOUT, Installed, clean_environment, install_from_lock
from tests.processes import run_command
from tests.pythons import pythons
from tests.terminal import Terminal

PYTHONS = pythons()
WON_BY = ("01-first-steps", "first-steps")


def metadata(wheel: Path) -> Message:
    (name,) = (n for n in zipfile.ZipFile(wheel).namelist() if n.endswith(".dist-info/METADATA"))
    return email.message_from_string(zipfile.ZipFile(wheel).read(name).decode())


def classified_pythons(wheel: Path) -> list[str]:
    classifiers = "\n".join(metadata(wheel).get_all("Classifier", []))
    return re.findall(r"^Programming Language :: Python :: (\d\.\d+)$", classifiers, re.MULTILINE)


def test_the_wheel_carries_the_package_with_levels_programs_and_licence_and_nothing_else(
    wheel: Path,
) -> None:
    carried = set(zipfile.ZipFile(wheel).namelist())
    shipped = {
        f"logical_robots_tui/{path.relative_to(CHECKOUT)}"
        for folder in ("levels", "programs")
        for path in (CHECKOUT / folder).rglob("*.*")
    }
    assert shipped
    assert shipped <= carried
    assert "logical_robots_tui/py.typed" in carried
    page = {Path(name).name for name in carried if "/web/static/" in name}
    assert {"page.html", "page.css", "page.js", "DejaVuSansMono.woff2", "LICENSE.txt"} <= page
    assert any(name.endswith("licenses/LICENSE") for name in carried)
    about = f"logical_robots_tui-{logical_robots_tui.__version__}.dist-info"
    assert {name.partition("/")[0] for name in carried} == {"logical_robots_tui", about}


def test_the_sdist_carries_what_pyproject_names_and_nothing_else(sdist: Path) -> None:
    pyproject = tomllib.loads((CHECKOUT / "pyproject.toml").read_text(encoding="utf-8"))
    included = pyproject["tool"]["hatch"]["build"]["targets"]["sdist"]["include"]
    paths = [CHECKOUT / name.removeprefix("/") for name in included]
    named = {
        path.relative_to(CHECKOUT).as_posix()
        for each in paths
        for path in (each.rglob("*") if each.is_dir() else [each])
        if path.is_file() and "__pycache__" not in path.parts
    }
    with tarfile.open(sdist) as archive:
        carried = {name.partition("/")[2] for name in archive.getnames()}
    assert carried - {"PKG-INFO", "pyproject.toml", ".gitignore"} == named  # hatchling adds these


def test_the_description_has_no_link_or_picture_that_an_index_lacks(wheel: Path) -> None:
    tokens = MarkdownIt().parse(str(metadata(wheel).get_payload()))
    targets = [
        str(child.attrGet("href") or child.attrGet("src"))
        for token in tokens
        for child in token.children or ()
        if child.type in {"link_open", "image"}
    ]
    assert "https://logica.dev" in targets
    assert [target for target in targets if not target.startswith("https://")] == []


def test_the_classifiers_name_every_python_from_the_lowest_on(wheel: Path) -> None:
    versions = classified_pythons(wheel)
    assert versions == [f"3.{11 + number}" for number in range(len(versions))]
    assert metadata(wheel)["Requires-Python"] == f">={versions[0]}"


def test_the_changelog_begins_with_this_version() -> None:
    newest = re.search(r"^## (\S+) ", (CHECKOUT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert newest
    assert newest[1] == logical_robots_tui.__version__


def test_an_installed_copy_uses_its_own_code_and_levels_and_wins_one(installed: Installed) -> None:
    done = installed.run(
        "python",
        "-c",
        "import logical_robots_tui as package; from logical_robots_tui import paths;"
        "print(package.__file__, package.__version__, paths.shipped_folder('levels'))",
    )
    code, version, levels = done.stdout.split()
    assert Path(code).is_relative_to(installed.root)
    assert Path(levels).is_relative_to(installed.root)
    assert version == logical_robots_tui.__version__
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


@pytest.mark.proof
def test_every_python_here_has_a_classifier(wheel: Path) -> None:
    assert set(PYTHONS) <= set(classified_pythons(wheel)), "or the game was not tested on it"


@pytest.mark.proof
def test_the_recipe_for_a_class_installs_the_game_from_a_checkout(tmp_path: Path) -> None:
    recipes = (block.text for block in blocks(CHECKOUT / "docs" / "ssh.md"))
    (recipe,) = (text for text in recipes if "play.lock" in text)
    (tmp_path / "bin").mkdir()
    for theirs, ours in (
        ("python3 -m venv", f"{sys.executable} -m venv"),
        ("/usr/local/bin", f"{tmp_path}/bin"),
        ("/opt", str(tmp_path)),
    ):
        assert theirs in recipe
        recipe = recipe.replace(theirs, ours)
    shell = ["sh", "-e", "-c", recipe]
    followed = run_command(shell, cwd=CHECKOUT, env=clean_environment(), timeout=600)
    assert followed.returncode == 0, followed.stdout + followed.stderr
    done = Installed(tmp_path, tmp_path).run("logical-robots", "run", *WON_BY)
    assert done.returncode == 0, done.stdout + done.stderr


LOCKS = {name: CHECKOUT / "requirements" / f"{name}.lock" for name in ("play", "dev")}
PROJECT = tomllib.loads((CHECKOUT / "pyproject.toml").read_text(encoding="utf-8"))


def entries(name: str) -> list[str]:
    text = LOCKS[name].read_text(encoding="utf-8").replace("\\\n", " ")
    return [line for line in text.splitlines() if line.strip() and not line.startswith("#")]


def pins(name: str) -> dict[str, set[str]]:
    """The locked versions of each package; several where they depend on the system."""
    found: dict[str, set[str]] = {}
    for entry in entries(name):
        requirement = Requirement(entry.partition("--hash")[0])
        found.setdefault(requirement.name, set()).add(str(requirement.specifier))
    return found


@pytest.mark.parametrize("name", LOCKS)
def test_every_entry_is_one_version_with_hashes_and_names_no_host_and_no_folder(name: str) -> None:
    assert entries(name)
    for entry in entries(name):
        assert re.fullmatch(r"[\w.-]+==[\w.+]+( ; [^#]+?)?( +--hash=sha256:[0-9a-f]{64})+", entry)
    assert not re.search(r"://|--(index|extra|find)|^[^#]*/", LOCKS[name].read_text(), re.MULTILINE)


@pytest.mark.parametrize(
    ("lock", "wanted"),
    [
        ("play", [*PROJECT["project"]["dependencies"], *PROJECT["build-system"]["requires"]]),
        ("dev", PROJECT["dependency-groups"]["dev"]),
    ],
)
def test_what_is_needed_is_locked_within_its_bounds(lock: str, wanted: list[str]) -> None:
    locked = pins(lock)
    for line in wanted:
        requirement = Requirement(line)
        assert requirement.name in locked, f"{requirement.name} is missing; run `make lock`"
        for version in locked[requirement.name]:
            assert requirement.specifier.contains(version.removeprefix("=="))


def test_developing_uses_the_versions_that_players_have() -> None:
    dev = pins("dev")
    assert {name: dev.get(name) for name in pins("play")} == pins("play")
