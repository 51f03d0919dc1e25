"""The tables that a mind reads: those that programs know, and quicker ones that say the same."""

from __future__ import annotations

from dataclasses import dataclass

from logical_robots_tui.mind.sqlite.allowed import TABLES
from logical_robots_tui.mind.sqlite.remembered import ITEM_FIELDS, MEMORY_FIELDS

__all__ = ["COLUMNS_LAYOUT", "CROWD_LAYOUT", "LISTS_LAYOUT", "PLAIN_LAYOUT", "Layout"]


@dataclass(frozen=True, slots=True)
class Layout:
    """The tables of a database.

    Attributes:
        script: SQL that makes them.
        readable: Names in lower case of all that a query may read.
    """

    script: str
    readable: frozenset[str]


PLAIN_LAYOUT = Layout(
    "CREATE TABLE Sensor(robot_name, sensor); CREATE TABLE Memory(robot_name, memory);", TABLES
)
"""The tables as programs know them."""

COLUMNS_LAYOUT = Layout(
    f"""
    CREATE TABLE Sensor(
        id INTEGER PRIMARY KEY, robot_name, sensor, forward_distance, forward_object,
        forward_label, clock, can_charge, has_battery, battery_level, battery_capacity
    );
    CREATE TABLE Memory(id INTEGER PRIMARY KEY, robot_name, memory, {", ".join(MEMORY_FIELDS)});
    CREATE TABLE Item(id INTEGER PRIMARY KEY, {", ".join(ITEM_FIELDS)});
    CREATE TABLE Ray(id INTEGER PRIMARY KEY, angle, distance, object, label, value);
    CREATE TABLE RobotRay(id INTEGER PRIMARY KEY, angle, distance, object, label, value);
    CREATE TABLE BeaconRay(id INTEGER PRIMARY KEY, angle, distance, object, label, value);
    PRAGMA automatic_index = OFF;
    """,
    TABLES | {"item", "ray", "robotray", "beaconray"},
)
"""Numbered rows, with sensor fields and radar rays in columns of their own; the rays that end at
robots and at beacons once more. For few robots: to make an index would take longer than to do
without."""

LISTS_LAYOUT = Layout(
    f"{COLUMNS_LAYOUT.script} PRAGMA automatic_index = ON;", COLUMNS_LAYOUT.readable
)
"""The same for queries that say themselves where few robots do without an index."""

CROWD_LAYOUT = Layout(
    LISTS_LAYOUT.script
    + """
    CREATE INDEX SensorByName ON Sensor(robot_name);
    CREATE INDEX MemoryByName ON Memory(robot_name);
    """,
    COLUMNS_LAYOUT.readable,
)
"""The same for many robots."""
