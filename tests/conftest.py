"""What many tests need: built files, an installed copy, the option to draw snapshots anew."""

import fcntl
import logging
import shutil
import sqlite3
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import date
from importlib import metadata
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from logical_robots_tui.caching import FOLDER_VARIABLE
from logical_robots_tui.game import measuring
from logical_robots_tui.mind import Decision, Notice
from logical_robots_tui.processes.helper import collect_seldom
from logical_robots_tui.progress import store
from tests import costs
from tests.installed import Installed, build, install

SHARE = 10
"""One of how many sampled cases a quick run takes."""

collect_seldom()

# The tests try the same examples in each run, so that none fails by chance; `make proof` looks for
# new ones, many at once. A machine may be slow.
for _profile, _examples in (("some", 5), ("all", 20), ("proof", 500)):
    settings.register_profile(
        _profile,
        derandomize=_profile != "proof",
        max_examples=_examples,
        deadline=None,
        suppress_health_check=[HealthCheck.too_slow],
    )


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-snapshots",
        action="store_true",
        help="accept what is on the screen now as what is meant to be there",
    )
    parser.addoption(
        "--all",
        action="store_true",
        help="run also the tests marked slow, every sampled case, and more random examples",
    )
    parser.addoption(
        "--quick",
        action="store_true",
        help="leave out slow tests and most sampled cases also in the files that are named",
    )
    parser.addoption(
        "--tenth",
        type=int,
        default=date.today().toordinal() % SHARE,
        choices=range(SHARE),
        help="which tenth of the sampled cases to run (default: another one each day)",
    )
    parser.addoption(
        "--built", metavar="FOLDER", help="check the wheel and sdist there instead of new ones"
    )


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config: pytest.Config) -> None:
    settings.load_profile("all" if config.option.all else "some")
    if not hasattr(config, "workerinput"):
        forget_earlier_runs(config)
        config.pluginmanager.register(_Sources(config))
    costs.register(config, is_quick=not (_is_whole(config) or _named_files(config)))


def forget_earlier_runs(config: pytest.Config) -> None:
    """Let runs be computed anew, and with ``--all`` programs and verdicts on levels as well."""
    place = _compiled(config)
    shutil.rmtree(place if config.option.all else place / "runs", ignore_errors=True)


def pytest_report_header(config: pytest.Config) -> str:
    textual = f"Textual {metadata.version('textual')}"
    if config.option.all:
        return textual
    tenth = config.option.tenth
    return f"{textual}; quick run: tenth {tenth} of the sampled cases, nothing slow; --all runs all"


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave to a whole run what is slow, and all but a tenth of the sampled cases of each test.

    A test is run whole if its file is named, or if tests are chosen by their names.
    """
    if _is_whole(config):
        return
    whole_files = _named_files(config)
    chances = [item for item in items if item.path not in whole_files]
    left_out = {item for item in chances if item.get_closest_marker("slow")}
    sampled = [
        item for item in chances if item not in left_out and item.get_closest_marker("sampled")
    ]
    cases = Counter(map(_test_of, sampled))
    numbers: Counter[str] = Counter()
    for item in sampled:
        test = _test_of(item)
        share = min(SHARE, cases[test])  # at least one case
        if numbers[test] % share != config.option.tenth % share:
            left_out.add(item)
        numbers[test] += 1
    if left_out:
        config.hook.pytest_deselected(items=list(left_out))
        items[:] = [item for item in items if item not in left_out]


def _is_whole(config: pytest.Config) -> bool:
    """Return whether every test that is selected is run with all its cases."""
    return config.option.all or (bool(config.option.keyword) and not config.option.quick)


def _test_of(item: pytest.Item) -> str:
    return item.nodeid.split("[")[0]


def _named_files(config: pytest.Config) -> set[Path]:
    """Return the files to be run whole: those that the command names, or names tests of."""
    if config.option.quick:
        return set()
    paths = (config.invocation_params.dir / name.split("::")[0] for name in config.args)
    return {path.resolve() for path in paths if path.suffix == ".py"}


class _Sources:
    """Ends a run whose sources are edited meanwhile: its failures would tell nothing."""

    def __init__(self, config: pytest.Config) -> None:
        self._config = config
        self._package = config.rootpath / "logical_robots_tui"
        self._times = self._read()

    def _read(self) -> dict[Path, int]:
        return {path: path.stat().st_mtime_ns for path in self._package.rglob("*.py")}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed and (edited := dict(self._read().items() ^ self._times.items())):
            names = ", ".join(sorted(str(path.relative_to(self._package)) for path in edited))
            message = f"{names}: edited while the tests ran; run them again"
            distributed = self._config.pluginmanager.getplugin("dsession")
            if distributed is None:
                pytest.exit(message, pytest.ExitCode.INTERRUPTED)
            distributed.shouldstop = message


def _compiled(config: pytest.Config) -> Path:
    return config.rootpath / ".pytest_cache" / f"compiled-{sys.implementation.cache_tag}"


def _shared(factory: pytest.TempPathFactory, worker_id: str) -> Path:
    folder = factory.getbasetemp()
    return folder if worker_id == "master" else folder.parent


@contextmanager
def _one_at_a_time(factory: pytest.TempPathFactory, worker_id: str) -> Iterator[Path]:
    """The folder of all workers, for one of them at a time."""
    folder = _shared(factory, worker_id)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield folder


@pytest.fixture(scope="session", autouse=True)
def compiled_programs(pytestconfig: pytest.Config) -> Iterator[None]:
    """Programs are compiled once until the compiler changes, apart from what players have compiled.

    An entry is named by its text and a digest of the compiler's code, in the game as in the tests.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(FOLDER_VARIABLE, str(_compiled(pytestconfig)))
        yield


@pytest.fixture(scope="session")
def dist(
    pytestconfig: pytest.Config, tmp_path_factory: pytest.TempPathFactory, worker_id: str
) -> Path:
    if pytestconfig.option.built:
        return Path(pytestconfig.option.built).absolute()
    with _one_at_a_time(tmp_path_factory, worker_id) as folder:
        if not list((folder / "dist").glob("*.whl")):
            build(folder / "dist")
        return folder / "dist"


@pytest.fixture(scope="session")
def wheel(dist: Path) -> Path:
    (found,) = dist.glob("*.whl")
    return found


@pytest.fixture(scope="session")
def sdist(dist: Path) -> Path:
    (found,) = dist.glob("*.tar.gz")
    return found


@pytest.fixture(scope="session")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory, worker_id: str) -> Installed:
    with _one_at_a_time(tmp_path_factory, worker_id) as folder:
        done = folder / "installed" / "elsewhere"
        if done.exists():
            return Installed(done.parent / "venv", done)
        return install(wheel, done.parent)


@pytest.fixture(autouse=True)
def _as_urgent_as_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """A trial of varied starts gets its share of a busy machine, for tests wait for it."""
    monkeypatch.setattr(measuring, "NICENESS", 0)


@pytest.fixture(autouse=True)
def _log_handlers_as_before() -> Iterator[None]:
    """The command sets up logging for the whole process; the next test is not to log there."""
    log = logging.getLogger("logical_robots_tui")
    before = list(log.handlers)
    yield
    log.handlers = before


@pytest.fixture(autouse=True)
def _progress_closed(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Close what a test leaves open.

    From Python 3.13 on, a connection that nobody closed is a warning when it is collected, in any
    later test, which then fails.
    """
    opened: list[sqlite3.Connection] = []
    connect = store._connect

    def noted(name: str, *, uri: bool = False) -> sqlite3.Connection:
        opened.append(connect(name, uri=uri))
        return opened[-1]

    monkeypatch.setattr(store, "_connect", noted)
    yield
    for connection in opened:
        connection.close()


@pytest.fixture
def late(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The clock ends the thought in tick 3, and no other test has computed that tick."""
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path / "cache"))
    from logical_robots_tui.mind.mind import Mind

    think = Mind.think

    def late_once(self: Mind, rows: list[object], *rest: object, **more: object) -> list[Decision]:
        decisions = think(self, rows, *rest, **more)  # type: ignore[arg-type]  # passed on as it is
        if rows[0]["sensor"]["clock"] != 3:  # type: ignore[index]  # a sensor row
            return decisions
        return [Decision(d.robot_name, None, d.memory, (Notice("late", "x"),)) for d in decisions]

    monkeypatch.setattr(Mind, "think", late_once)
