"""DuckDB for few robots too, and a count of what it was really asked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from logical_robots_tui.mind.duck import engine

if TYPE_CHECKING:
    from collections.abc import Callable


@pytest.fixture
def answered(monkeypatch: pytest.MonkeyPatch) -> Callable[[], int]:
    """Ask DuckDB whatever the number of robots; tells how many thoughts it has answered."""
    answers: list[Any] = []
    ask = engine.DuckTables.ask

    def counted(*arguments: Any) -> Any:
        answers.append(ask(*arguments))
        return answers[-1]

    monkeypatch.setattr(engine, "FEWEST", 1)
    monkeypatch.setattr(engine.DuckTables, "ask", counted)
    return lambda: len(answers)
