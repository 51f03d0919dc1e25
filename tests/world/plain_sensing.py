"""A slow caster of rays that is written straight from the rules, to judge the fast one by."""

import math
from typing import Any

from logical_robots_tui.world import World


def plain_look(world: World) -> list[dict[str, Any]]:
    rows = []
    for robot, state in zip(world.level.robots, world.robots, strict=True):
        rays, span = world.level.sensors.rays, world.level.sensors.view * math.pi / 180
        forward = _cast(world, state.name, state.angle)
        radar = []
        for i in range(rays):
            heading = (state.angle - span / 2) + i * (span / (rays - 1))
            distance, kind, label = _cast(world, state.name, heading)
            angle = -(heading - state.angle)
            radar.append({"angle": angle, "distance": distance, "object": kind, "label": label})
        sensor = {
            "forward_distance": forward[0],
            "forward_object": forward[1],
            "forward_label": forward[2],
            "radar": radar,
            "self": {
                "can_charge": robot.can_charge,
                "has_battery": robot.has_battery,
                "battery_level": state.battery_level,
                "battery_capacity": robot.battery_capacity,
            },
            "clock": world.tick,
        }
        rows.append({"robot_name": state.name, "sensor": sensor})
    return rows


def _cast(world: World, looker: str, heading: float) -> tuple[int, str, str]:
    level = world.level
    (here,) = (robot for robot in world.robots if robot.name == looker)
    for d in range(1, level.sensors.reach):
        px = here.x + math.cos(heading) * d
        py = here.y + math.sin(heading) * d
        column, row = math.floor(px), math.floor(py)
        is_inside = 0 <= column < level.width and 0 <= row < level.height
        if not is_inside or level.walls[row, column]:
            return d, "wall", "wall"
        for robot in world.robots:
            if robot.name != looker and math.hypot(px - robot.x, py - robot.y) < 9:
                return d, "robot", robot.name
        for beacon in level.beacons:
            if math.hypot(px - beacon.x, py - beacon.y) < 8:
                return d, "beacon", beacon.name
        for area, state in zip(level.areas, world.areas, strict=True):
            is_solid = area.impenetrable and state.active
            if is_solid and math.hypot(px - area.x, py - area.y) < area.radius:
                return d, "wall", area.name
    return level.sensors.reach, "none", "nothing"
