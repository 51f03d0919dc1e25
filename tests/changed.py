"""The tests nearest to what a change touches, for `make test CHANGED=1`.

As a command, prints the files of tests to run, nearest first, until they are worth a minute of
processor time. Near are tests in the room of a changed module, and those from which few imports
lead to it. What the screen's tests open reaches every module, so that being reached says little:
the number of imports and the rooms in common order them.
"""

import json
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterable, Mapping
from collections.abc import Set as AbstractSet
from pathlib import Path

from tests.import_graph import module_of, modules_imported

ROOT = Path(__file__).parents[1]
PACKAGE = "logical_robots_tui"
CACHE_KEY = "logical-robots/costs"
"""Where pytest's cache has the processor seconds of each test."""

PROCESSOR_SECONDS = 60.0
"""What the chosen tests may cost together; on two cores they take little more than half of it."""

SECONDS_OF_A_TEST = 0.15
"""Assumed of each test function of a file that has not been measured in this checkout."""

FAR = 99
BY_A_STRING = 6
"""Imports that are assumed for a test in the same part from which none lead to a module: what the
compile process, commands and pages load is named in strings.
"""

OF_A_ROOM = 2
OF_A_NAME = 3
"""How many imports nearer a test is for each folder, or word of its name, that it shares."""

FOLDERS_OF_DATA = {
    "levels": "tests/levels",
    "programs": "tests/levels",
    "docs": "tests/house",
    "benchmarks": "tests/house",
    "requirements": "tests/house",
    ".ci": "tests/house",
    "tests/snapshots": "tests/snapshots",
    "tests/mind": "tests/mind",
    "tests/conformance": "tests/world",
    "tests/old": "tests/old",
}
"""Which tests look at files that are not modules; those at the root are the house's."""


def git(*arguments: str) -> str:
    done = subprocess.run(
        ["git", *arguments], cwd=ROOT, capture_output=True, text=True, timeout=60, check=False
    )
    if done.returncode:
        sys.exit(f"git {' '.join(arguments)}: {done.stderr.strip()}")
    return done.stdout


def changed_paths(base: str) -> list[str]:
    """Return what differs from where this branch left another one, committed or not.

    Raises:
        SystemExit: There is no such branch.
    """
    begin = git("merge-base", base, "HEAD").strip()
    untracked = git("ls-files", "--others", "--exclude-standard")
    return [*git("diff", "--name-only", begin).split(), *untracked.split()]


class Nearness:
    """How near the files of tests are to a module, in imports."""

    def __init__(self, root: Path = ROOT) -> None:
        self._root = root
        imports = modules_imported(root, [PACKAGE, "tests"])
        self._importers: dict[str, set[str]] = defaultdict(set)
        for module, targets in imports.items():
            for target in targets:
                self._importers[target].add(module)
        for conftest in (module for module in imports if module.endswith(".conftest")):
            package = conftest.removesuffix("conftest")
            self._importers[conftest] |= {name for name in imports if name.startswith(package)}
        self.tests = {
            module: str(path.relative_to(root))
            for path in sorted((root / "tests").rglob("test_*.py"))
            if (module := module_of(path, root)) in imports
        }

    def assumed_cost(self, test: str) -> float:
        """Return what a file of tests may cost that has not been measured, in processor seconds."""
        text = (self._root / test).read_text(encoding="utf-8")
        return SECONDS_OF_A_TEST * text.count("def test_")

    def of(self, path: str) -> dict[str, int]:
        """Return the distance of each file of tests that has to do with a changed file."""
        if path in self.tests.values():
            return {path: -FAR}
        if not path.endswith(".py") or not path.startswith((PACKAGE, "tests/")):
            folder = next((f for f in FOLDERS_OF_DATA if path.startswith(f"{f}/")), "")
            home = FOLDERS_OF_DATA.get(folder, "tests/house")
            return {test: 0 for test in self.tests.values() if test.startswith(f"{home}/")}
        module = module_of(self._root / path, self._root)
        distances = self._distances(module)
        rooms, words = _rooms(module), set(module.rpartition(".")[2].split("_"))
        return {
            test: distances.get(name, BY_A_STRING)
            - OF_A_ROOM * len(rooms & _rooms(name))
            - OF_A_NAME * len(words & set(name.rpartition(".test_")[2].split("_")))
            for name, test in self.tests.items()
            if name in distances or rooms & _rooms(name)
        }

    def _distances(self, module: str) -> dict[str, int]:
        distances = {module: 0}
        queue = [module]
        for name in queue:
            for importer in self._importers[name] - distances.keys():
                distances[importer] = distances[name] + 1
                queue.append(importer)
        return distances


def _rooms(module: str) -> AbstractSet[str]:
    return set(module.split(".")[1:-1])


def nearest(
    paths: Iterable[str], nearness: Nearness, costs: Mapping[str, float], most: float
) -> list[str]:
    """Return the tests nearest to changed files, at least one, up to so many processor seconds."""
    distances: dict[str, int] = {}
    for path in paths:
        for test, distance in nearness.of(path).items():
            distances[test] = min(distance, distances.get(test, FAR))
    seconds: dict[str, float] = defaultdict(float)
    for test, cost in costs.items():
        seconds[test.partition("::")[0]] += cost
    chosen: list[str] = []
    total = 0.0
    for test in sorted(distances, key=lambda test: (distances[test], test)):
        total += seconds.get(test) or nearness.assumed_cost(test)
        if chosen and total > most:
            break
        chosen.append(test)
    return chosen


def measured_costs() -> dict[str, float]:
    """Return the processor seconds of each test in earlier runs of this checkout."""
    try:
        text = (ROOT / ".pytest_cache" / "v" / CACHE_KEY).read_text(encoding="utf-8")
        costs: dict[str, float] = json.loads(text)
    except (OSError, ValueError):
        return {}
    return costs


def main() -> None:
    base = sys.argv[1] if len(sys.argv) > 1 else "main"
    paths = changed_paths(base)
    if not paths:
        sys.exit(f"nothing differs from {base}; name another branch or commit: CHANGED=BRANCH")
    print(*nearest(paths, Nearness(), measured_costs(), PROCESSOR_SECONDS), sep="\n")


if __name__ == "__main__":
    main()
