"""The tables that a mind reads: those that programs know, and tuned ones with the same content."""

from __future__ import annotations

from dataclasses import dataclass

from logical_robots_tui.mind.sqlite.allowed import TABLES
from logical_robots_tui.mind.sqlite.remembered import ITEM_FIELDS, MEMORY_FIELDS

__all__ = ["COLUMNS_LAYOUT", "CROWD_LAYOUT", "LISTS_LAYOUT", "PLAIN_LAYOUT", "Layout"]


@dataclass(frozen=True, slots=True)
class Layout:
    """The tables of a database.

    Attributes:
        script: SQL that creates them.
        readable: Lower-case names of everything that a query may read.
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
"""Numbered rows with sensor fields and radar rays as columns, and copies of the rays that end at
robots and beacons. For few robots: creating an index would take longer than it saves."""

LISTS_LAYOUT = Layout(
    f"{COLUMNS_LAYOUT.script} PRAGMA automatic_index = ON;", COLUMNS_LAYOUT.readable
)
"""For queries that decide themselves where few robots need no index."""

CROWD_LAYOUT = Layout(
    LISTS_LAYOUT.script
    + """
    CREATE INDEX SensorByName ON Sensor(robot_name);
    CREATE INDEX MemoryByName ON Memory(robot_name);
    """,
    COLUMNS_LAYOUT.readable,
)
"""For many robots."""
