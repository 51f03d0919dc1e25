"""Does the suite notice if a correction of the past is undone?  `make mutants` tells.

Each correction in `corrections.txt` is undone alone in a copy of the checkout, and the tests run
until one fails: those nearest to the change (see `tests/changed.py`), the rest of the quick choice,
and with ``--all`` everything. What later commits have changed again stays as it is. This takes an
hour, and is no part of CI.
"""

import argparse
import os
import re
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.changed import PACKAGE, PROCESSOR_SECONDS, ROOT, Nearness, git, measured_costs, nearest
from tests.processes import run_command

LIST = Path(__file__).with_name("corrections.txt")
LONGEST = 3_600  # seconds of one run of tests
STAGES = ("nearest tests", "quick choice", "ALL=1")


@dataclass(frozen=True)
class Correction:
    """A commit that corrected something, with the texts of the modules without it."""

    commit: str
    subject: str
    undone: Mapping[str, str]


def corrections(commits: Sequence[str] = ()) -> Iterator[Correction]:
    """Yield the listed corrections of which something is left to undo, or only some of them.

    Raises:
        SystemExit: The history of this clone lacks a commit.
    """
    for line in LIST.read_text(encoding="utf-8").splitlines():
        commit, _, subject = line.partition(" ")
        if commits and commit not in commits:
            continue
        if undone := _undone(commit):
            yield Correction(commit, subject, undone)
        else:
            print(f"{commit} {subject}: nothing is left to undo")


def _undone(commit: str) -> dict[str, str]:
    names = git(
        *("diff-tree", "--no-commit-id", "--name-only", "--diff-filter=M", "-r"),
        commit,
        "--",
        PACKAGE,
    )
    texts = {}
    for name in names.split():
        if not name.endswith(".py") or not (ROOT / name).exists():
            continue
        before, after = (git("show", f"{at}:{name}") for at in (f"{commit}^", commit))
        today = (ROOT / name).read_text(encoding="utf-8")
        merged = _merged(today, after, before)
        if merged != today:
            texts[name] = merged
    return texts


def _merged(today: str, after: str, before: str) -> str:
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / name for name in ("today", "after", "before")]
        for path, text in zip(paths, (today, after, before), strict=True):
            path.write_text(text, encoding="utf-8")
        return git("merge-file", "-p", "--ours", *map(str, paths))


class Copy:
    """A copy of the checkout in which corrections are undone, one after the other."""

    def __init__(self, folder: Path, workers: int) -> None:
        self._folder = folder
        self._workers = workers
        for name in git("ls-files", "--cached", "--others", "--exclude-standard").splitlines():
            if (ROOT / name).is_file():
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, folder / name)
        self._nearness = Nearness(folder)
        self._costs = measured_costs()

    def notice(self, correction: Correction, *, whole: bool) -> tuple[str, str]:
        """Return the stage in which undoing a correction is noticed, and the test; or ""."""
        near = nearest(correction.undone, self._nearness, self._costs, PROCESSOR_SECONDS)
        runs = [["--quick", *near], ["--quick"], *([["--all"]] if whole else [])]
        for name, text in correction.undone.items():
            (self._folder / name).write_text(text, encoding="utf-8")
        try:
            for stage, arguments in zip(STAGES, runs, strict=False):
                if test := self._first_failure(arguments):
                    return stage, test
        finally:
            for name in correction.undone:
                shutil.copy2(ROOT / name, self._folder / name)
        return "", ""

    def _first_failure(self, arguments: Sequence[str]) -> str:
        command = [sys.executable, "-m", "pytest", "-q", "--tb=no", "--maxfail=1"]
        done = run_command(
            [*command, "-n", self._workers, "--dist", "worksteal", *arguments],
            cwd=self._folder,
            env={**os.environ, "PYTHONPATH": str(self._folder)},
            timeout=LONGEST,
        )
        if done.returncode == 0:
            return ""
        failed = re.search(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE)
        if failed is None:  # such as what can't even be imported without the correction
            print(f"    pytest ended with status {done.returncode}, which does not count")
        return failed[1] if failed else ""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("commits", nargs="*", help="only these of the list")
    parser.add_argument("--all", action="store_true", help="run all tests if the quick ones pass")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="of each run")
    options = parser.parse_args()
    stages: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        copy = Copy(Path(folder), options.workers)
        for correction in corrections(options.commits):
            stage, test = copy.notice(correction, whole=options.all)
            stages[stage] += 1
            outcome = f"noticed by the {stage}: {test}" if stage else "NOT NOTICED"
            print(f"{correction.commit} {correction.subject}\n    {outcome}", flush=True)
    total = sum(stages.values())
    for place, stage in enumerate(STAGES[: 3 if options.all else 2], 1):
        print(f"{sum(stages[name] for name in STAGES[:place])} of {total} by the {stage}")


if __name__ == "__main__":
    main()
