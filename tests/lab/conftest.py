"""Runs of the laboratory in this process, and the command."""

from collections.abc import Iterator

import pytest

from logical_robots_tui.lab import engines
from tests.cli.running import Command
from tests.lab.laboratory import InlineEngine

LocalEngine = engines.LocalEngine


@pytest.fixture(scope="module", autouse=True)
def _inline() -> Iterator[None]:
    """Runs are computed in this process, for a process of their own takes longer to start."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(engines, "LocalEngine", InlineEngine)
        yield


@pytest.fixture
def workers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs are computed by processes of their own, as they are for players."""
    monkeypatch.setattr(engines, "LocalEngine", LocalEngine)


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)
