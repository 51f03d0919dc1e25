"""The running simulation of a level, one tick at a time, and how it goes on in another level."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from numbers import Real
from typing import TypeAlias

from logical_robots_tui.confinement import check_room
from logical_robots_tui.paths import did_you_mean
from logical_robots_tui.values import Desire, SensorRow
from logical_robots_tui.world.dynamics import (
    AreaState,
    Mover,
    RobotState,
    WorldState,
    body_of,
    charging_sources,
    drive,
    is_inside,
    is_won,
    next_active,
    push_out,
    push_out_at_once,
    run_batteries,
    run_battery,
    start_tallies,
    tally_tick,
)
from logical_robots_tui.world.level import Area, Level
from logical_robots_tui.world.sensing import Senses

_ROOM = 32 * 1024**2  # bytes of address space that arrays of rays may take


class World:
    """The running simulation of a level.

    One tick is a ``sense`` followed by an ``act``. The world holds only the level, an immutable
    ``WorldState``, and the last reading of the robots; the same level and the same desires always
    give the same future.

    `like` is a world of a level with nearly the same walls, which makes this one faster to create.
    Raises ValueError if two robots have the same name.
    """

    def __init__(self, level: Level, *, like: World | None = None) -> None:
        self._names = [robot.name for robot in level.robots]
        if len(set(self._names)) < len(self._names):
            raise ValueError("Robots of one level need different names.")
        self._level = level
        self._senses: Senses = Senses(level, like=None if like is None else like._senses)
        self._state = start_state(level)
        self._rows: list[SensorRow] | None = None
        self._visible_beacons: frozenset[str] = frozenset()

    @property
    def level(self) -> Level:
        """The running level."""
        return self._level

    @property
    def tick(self) -> int:
        """The clock: the number of the current tick, or of the last finished one between ticks."""
        return self._state.tick + (self._rows is not None)

    @property
    def won(self) -> bool:
        """Whether a goal was reached, now or in an earlier tick."""
        return self._state.won_at is not None

    @property
    def won_at(self) -> int | None:
        """The tick in which a goal was first reached, or None."""
        return self._state.won_at

    @property
    def robots(self) -> tuple[RobotState, ...]:
        """The robots at the end of the last finished tick, in file order."""
        return self._state.robots

    @property
    def areas(self) -> tuple[AreaState, ...]:
        """The areas at the end of the last finished tick, in file order."""
        return self._state.areas

    def sense(self) -> list[SensorRow]:
        """Begin a tick: advance the clock and return what every robot senses.

        Until ``act`` finishes the tick, calling it again returns the same rows: one
        ``{"robot_name": ..., "sensor": {...}}`` per robot in file order, plain dicts, lists,
        numbers and text. Don't modify them: the next rows may share lists with them.
        """
        if self._rows is None:
            self._rows, self._visible_beacons = self._look(self._state.tick + 1)
        return self._rows

    def look(self) -> list[SensorRow]:
        """Return what the robots see right now, without advancing the clock.

        Don't modify the result, as with ``sense``.
        """
        rows, _ = self._look(self.tick)
        return rows

    def act(self, desires: Mapping[str, DesireLike]) -> None:
        """Finish the tick: batteries, driving, pushing out, switches, visits, victory.

        Begins the tick itself if ``sense`` didn't. A robot without a desire, by its name, stops;
        so does an engine whose power is not a finite number. Raises ValueError for an unknown
        name, or what is not a desire; nothing has changed then.
        """
        for name in sorted(desires.keys() - set(self._names)):
            hint = did_you_mean(name, self._names)
            raise ValueError(f'The level has no robot "{name}". {hint}'.rstrip())
        robot_desires = [
            desire if type(desire := desires.get(name)) is Desire else desire_of(name, desire)
            for name in self._names
        ]
        self.sense()
        old_state, level = self._state, self._level

        movers = [Mover(r.x, r.y, r.angle, r.battery_level) for r in old_state.robots]
        pairs = list(zip(level.areas, old_state.areas, strict=True))
        solid = [area for area, state in pairs if area.impenetrable and state.active]
        powers = [(_power(d.left_engine), _power(d.right_engine)) for d in robot_desires]
        sources = charging_sources(level, movers)
        is_divided = level.divided_charge or bool(level.teams)
        if is_divided:
            run_batteries(level.robots, movers, powers, sources)
        bodies = old_state.robots
        for robot, mover, body, (left, right) in zip(
            level.robots, movers, bodies, powers, strict=True
        ):
            if not is_divided:
                run_battery(robot, mover, left, right, sources)
            is_empty = robot.has_battery and mover.battery_level <= 0
            mover.dead = is_empty and robot.battery_consumption_rate > 0
            if mover.dead:
                left = right = 0.0
            blockers = [b for b in bodies if b is not body] if level.solid_robots else ()
            drive(mover, left, right, level, blockers)
            (push_out_at_once if level.teams else push_out)(mover, solid)

        robots = tuple(
            [RobotState(n, *body_of(m)) for n, m in zip(self._names, movers, strict=True)]
        )
        tick, won_at = old_state.tick + 1, old_state.won_at
        areas = tuple(
            AreaState(
                area.name,
                next_active(area, state.active, self._visible_beacons, tick),
                tuple([robot.name for robot in robots if is_inside(robot, area)]),
            )
            for area, state in pairs
        )
        if won_at is None and is_won(zip(level.areas, areas, strict=True), level.all_goals):
            won_at = tick
        tallies = old_state.tallies
        if tallies:
            tallies = tally_tick(level, tallies, tick, robots, areas, self.sense())
        self._state = WorldState(tick, robots, areas, won_at, tallies)
        self._rows = None

    def save(self) -> WorldState:
        """Return the world at the end of the last finished tick.

        A tick that has begun is not included; sensing again begins it in the same way.
        """
        return self._state

    def restore(self, state: WorldState) -> None:
        """Go back or forward to a saved state; the future from there is exactly reproducible.

        Raises ValueError unless ``save`` returned it for a world of the same level.
        """
        robots = [robot.name for robot in state.robots]
        areas = [area.name for area in state.areas]
        shape = [len(tallies) for tallies in state.tallies]
        if (
            robots != self._names
            or areas != [area.name for area in self._level.areas]
            or shape != [len(self._level.teams)] * len(self._level.scores)
        ):
            raise ValueError("This state belongs to another level.")
        self._state = state
        self._rows = None

    def _look(self, clock: int) -> tuple[list[SensorRow], frozenset[str]]:
        check_room(_ROOM)
        return self._senses.sense(self._state.robots, self._state.areas, clock)


DesireLike: TypeAlias = "Desire | Sequence[float]"
"""A desire, or a pair of engine powers, left first."""


_REST = Desire(0.0, 0.0)


def desire_of(robot: str, desire: DesireLike | None) -> Desire:
    """Return a robot's desire, engines off if it has none, or raise ValueError."""
    if desire is None or isinstance(desire, Desire):
        return desire or _REST
    try:
        left, right = desire
        return Desire(float(left), float(right))
    except (TypeError, ValueError):
        message = f"{desire!r} is not a desire of {robot}: give a pair of engine powers, left first"
        raise ValueError(f"{message}, such as (1, 0.5).") from None


def _power(engine: object) -> float:
    """Return an engine's power as a finite float, 0 for anything that isn't a number."""
    if type(engine) is float:
        return engine if math.isfinite(engine) else 0.0  # a fast path for the common case
    if not isinstance(engine, Real):
        return 0.0
    try:
        power = float(engine)
    except OverflowError:
        return 0.0
    return power if math.isfinite(power) else 0.0


Pose: TypeAlias = tuple[float, float, float]
"""Position in map units (x, y), and heading in radians."""


def start_state(level: Level) -> WorldState:
    """Return the world at tick 0, before anybody has sensed."""
    robots = tuple(
        RobotState(r.name, float(r.x), float(r.y), float(r.angle), float(r.battery_capacity))
        for r in level.robots
    )
    areas = tuple(AreaState(area.name, area.is_on(0)) for area in level.areas)
    return WorldState(0, robots, areas, tallies=start_tallies(level, robots, areas))


def change_state(
    state: WorldState, old: Level, new: Level, poses: Mapping[str, Pose]
) -> WorldState:
    """Return the state in which a world continues in a changed level, or raise ValueError.

    Robots keep position and charge; new ones are at their start, as are all at tick 0. Areas
    keep their state unless their switch changed, teams theirs unless the scoring did; visitors
    are recomputed. The poses are by the robots' names in the new level.
    """
    if unknown_names := poses.keys() - {robot.name for robot in new.robots}:
        raise ValueError(f"There are no robots {sorted(unknown_names)}.")
    start, robots = start_state(new), []
    old_robots = {robot.name: robot for robot in old.robots}
    bodies = {robot.name: robot for robot in state.robots}
    old_names = former_names(old, new) if state.tick else {}
    for robot, body_at_start in zip(new.robots, start.robots, strict=True):
        body = body_at_start
        if (name := old_names.get(robot.name)) is not None:
            charge = body_at_start.battery_level
            if old_robots[name].has_battery or not robot.has_battery:
                charge = min(bodies[name].battery_level, charge)
            body = replace(bodies[name], name=robot.name, battery_level=charge)
        if robot.name in poses:
            x, y, angle = poses[robot.name]
            angle = float(angle) % (2 * math.pi)
            body = replace(body, x=float(x), y=float(y), angle=angle)
        robots.append(body)
    if state.tick == 0:
        return replace(start, robots=tuple(robots))
    old_states: dict[tuple[object, ...], list[bool]] = {}
    for area, area_state in zip(old.areas, state.areas, strict=True):
        old_states.setdefault(_switch(area), []).append(area_state.active)
    area_states = []
    for area in new.areas:
        states = old_states.get(_switch(area))
        active = states.pop(0) if states else area.is_on(state.tick)
        visitors = tuple(robot.name for robot in robots if is_inside(robot, area))
        area_states.append(AreaState(area.name, active, visitors))
    scoring, new_scoring = (
        (level.scores, level.teams, [beacon.name for beacon in level.beacons])
        for level in (old, new)
    )
    tallies = state.tallies
    if scoring != new_scoring:
        tallies = start_tallies(new, robots, area_states)
    return WorldState(state.tick, tuple(robots), tuple(area_states), state.won_at, tallies)


def former_names(old: Level, new: Level) -> dict[str, str]:
    """Map names of robots to old ones; a single new name in a missing one's place is a renaming."""
    old_names, new_names = [r.name for r in old.robots], [r.name for r in new.robots]
    names = {name: name for name in new_names if name in set(old_names)}
    if len(old_names) == len(new_names):
        pairs = [(a, b) for a, b in zip(old_names, new_names, strict=True) if a != b]
        if len(pairs) == 1 and pairs[0][0] not in names:
            names[pairs[0][1]] = pairs[0][0]
    return names


def _switch(area: Area) -> tuple[object, ...]:
    return area.name, area.on_beacon, area.off_beacon, area.sticky_switch, area.cycle
