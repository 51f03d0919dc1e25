"""The recorded traces, and the scripts that drove the robots in them."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from logical_robots_tui.values import Desire, SensorRow

CONFORMANCE = Path(__file__).parent.parent / "conformance"
LEVELS = sorted((CONFORMANCE / "levels").glob("*.json"))
TRACES = sorted((CONFORMANCE / "traces").glob("*.jsonl"))

OBJECT_CODES = {"w": "wall", "r": "robot", "b": "beacon", "n": "none"}


@dataclass(frozen=True)
class Trace:
    header: dict[str, Any]
    start: dict[str, Any]
    ticks: dict[int, dict[str, Any]]
    events: list[list[Any]]

    @property
    def level_path(self) -> Path:
        name: str = self.header["level"]
        return CONFORMANCE / "levels" / name


def read_trace(path: Path) -> Trace:
    header, start, *ticks, events = map(json.loads, path.read_text("utf-8").splitlines())
    return Trace(header, start, {tick["t"]: tick for tick in ticks}, events["events"])


def scripted_desires(script: str, tick: int, rows: list[SensorRow]) -> dict[str, Desire]:
    """Return what every robot wants; ``rows`` are in file order."""
    return {
        row["robot_name"]: (_reactive(row["sensor"]) if script == "reactive" else _driven(i, tick))
        for i, row in enumerate(rows)
    }


def _reactive(sensor: dict[str, Any]) -> Desire:
    weighted = total = 0.0
    for ray in sensor["radar"]:
        weighted += ray["distance"] * ray["angle"]
        total += ray["distance"]
    f = weighted / total
    return Desire(0.6 - f + 0.1, 0.6 + f)


def _driven(robot: int, tick: int) -> Desire:
    k = (tick - 1) // 8
    return Desire(((k * 8 + robot * 13) % 29 - 11) / 10, ((k * 12 + robot * 5) % 29 - 11) / 10)
