"""The locked dependencies are complete, exact, and say nothing of where they were made."""

import re
import tomllib

import pytest
from packaging.requirements import Requirement

from tests.installed import CHECKOUT

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
