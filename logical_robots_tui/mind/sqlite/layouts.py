"""The plain and tuned tables of a mind's databases, and what a program's SQL may use."""

from __future__ import annotations

import re
from dataclasses import dataclass

from logical_robots_tui.schema import BEACON, RAY, ROBOT, SELF, SENSOR

TABLES = frozenset({"sensor", "memory", "json_each"})
"""Tables that may be read, in lower case."""

NAMED_QUERY = re.compile(r"t_\d+_\w+|the_last_step|WhyGiven")
"""Names of the named queries of a statement."""

_BUILT_IN = """
    abs acos acosh asin asinh atan atan2 atanh avg ceil ceiling char coalesce concat concat_ws
    cos cosh count cume_dist degrees dense_rank exp first_value floor format group_concat if
    ifnull iif instr json json_array json_array_length json_each json_extract json_group_array
    json_group_object json_object json_quote json_type json_valid lag last_value lead length
    like likelihood likely ln log log10 log2 lower ltrim max median min mod nth_value ntile
    nullif percent_rank percentile pi pow power printf quote radians rank replace round
    row_number rtrim sign sin sinh sqrt string_agg substr substring sum tan tanh total trim
    trunc typeof unicode unlikely upper
"""

BUILT_IN = frozenset(_BUILT_IN.split())
"""SQLite's own functions that may be called.

Excluded are functions that reach beyond the query (``load_extension``, ``readfile``), reveal the
machine (``random``, ``date``, ``sqlite_version``), or only create large values (``randomblob``,
``zeroblob``, ``hex``). Functions that can take very long in a single call are replaced by our
own.
"""


RAYS = 1000
"""Most rays of a radar; the rays of sensor row n have numbers from n * RAYS."""

WHOLE_RAY = "t_0_whole_ray"
"""The SQL function that returns the JSON text of a ray by its number."""

KINDS = {"RobotRay": ROBOT, "BeaconRay": BEACON}
"""Tables of rays that end at a kind of object; few rays do."""

MEMORY_FIELDS = tuple(f"field_{number}" for number in range(24))
"""Columns of ``Memory`` with one field each; each program chooses which."""

ITEM_FIELDS = tuple(f"item_{number}" for number in range(16))
"""Columns of ``Item`` with one field each of the records in lists of memories."""

ITEMS = 100_000
"""Most records of a list; those of field f of memory row n, of F fields, have numbers from
(n * F + f) * ITEMS."""


@dataclass(frozen=True, slots=True)
class Layout:
    """The SQL that creates tables, and the lower-case names that queries may read."""

    script: str
    readable: frozenset[str]


PLAIN_LAYOUT = Layout(
    "CREATE TABLE Sensor(robot_name, sensor); CREATE TABLE Memory(robot_name, memory);", TABLES
)
"""The tables as programs know them."""

COLUMNS_LAYOUT = Layout(
    f"""
    CREATE TABLE Sensor(
        id INTEGER PRIMARY KEY, robot_name, sensor, {", ".join(SENSOR.scalars + SELF.scalars)}
    );
    CREATE TABLE Memory(id INTEGER PRIMARY KEY, robot_name, memory, {", ".join(MEMORY_FIELDS)});
    CREATE TABLE Item(id INTEGER PRIMARY KEY, {", ".join(ITEM_FIELDS)});
    CREATE TABLE Ray(id INTEGER PRIMARY KEY, {", ".join(RAY.names)}, value);
    CREATE TABLE RobotRay(id INTEGER PRIMARY KEY, {", ".join(RAY.names)}, value);
    CREATE TABLE BeaconRay(id INTEGER PRIMARY KEY, {", ".join(RAY.names)}, value);
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
