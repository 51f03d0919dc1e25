"""Draws a frame of a level into cells: the labyrinth, or what each robot senses of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.schema import SENSOR_RANGE
from logical_robots_tui.tui.labyrinth.drawing.cells import (
    BOLD,
    RGB,
    Cells,
    Palette,
    mix,
    pack,
    refit,
    rgb_number,
    split,
    text_id,
)
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Canvas, Highlight, Look
from logical_robots_tui.tui.labyrinth.drawing.ground import (
    ASCII_KINDS,
    Ground,
    WallTable,
    blend,
    draw_ground,
)
from logical_robots_tui.tui.labyrinth.drawing.lettering import (
    Faint,
    StaticLabels,
    draw_labels,
    fit_into,
    robot_colour,
    write,
)
from logical_robots_tui.tui.labyrinth.drawing.rays import (
    Fan,
    Traces,
    brightness_of,
    draw_ray,
    draw_rays,
    draw_ring,
    draw_trails,
    fans,
)
from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats, Raster, Viewport
from logical_robots_tui.world.dynamics import RobotState
from logical_robots_tui.world.level import Level
from logical_robots_tui.world.sensing import ROBOT_RADIUS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.game.frame import Frame

_STRENGTH, _SELECTED, _OTHERS = 0.34, 0.5, 0.2
"""Light of a fan: without a selection, of the selected robot, of the others then."""

_CROWD = 12  # robots per hurried picture that reuses the light of the one before
_UNSEEN = 12  # the error of a colour channel, of 255, that is tolerated in hurried pictures

_MOST_TRAILS = 30  # trails that are told apart; in a larger crowd only the selected robot has one

_THICK = 12.0  # map units between the ends of two rays that belong to one wall, at least
_LEAST = (24, 10)  # columns and rows that a picture of one robot needs

_KIND_IDS = np.array([text_id(char) for char in ASCII_KINDS], np.int64)
_LIT_ID = text_id(".")


@dataclass(frozen=True, eq=False)
class _Light:
    """The static layer lit by robots, reused for `left` more hurried pictures."""

    look: Look
    image: Floats
    lit: NDArray[np.bool_]
    fans: list[Fan]
    left: int


class Picture:
    """A labyrinth in cells, kept up to date frame by frame.

    The static layer is repainted only when view, look or an area changes; otherwise only cells
    whose dots have changed are fitted again.

    Attributes:
        image: The dots of the last picture that is not ASCII, (down, across, 3) from 0 to 255.
    """

    image: Floats

    def __init__(self) -> None:
        self.cells = Cells.blank(0, 0)
        self._level: Level | None = None
        self._ground_key: object = None
        self._dots: NDArray[np.uint8] | None = None
        self._light: _Light | None = None
        self._base = self.cells

    def draw(
        self,
        level: Level,
        frame: Frame,
        viewport: Viewport,
        look: Look,
        traces: Traces | None = None,
        *,
        ghosts: NDArray[np.float32] | None = None,
        hurried: bool = False,
    ) -> Cells:
        """Draw a frame into cells, with traces in trails and areas just switched.

        `ghosts` are x, y and heading of robots of another run, of shape (robots, 3).

        A hurried picture, which the next one follows at once, moves light only every second time or
        less, and its colours may be a little off.
        """
        if viewport.rows < 1 or viewport.columns < 1:
            self.cells = Cells.blank(max(viewport.rows, 0), max(viewport.columns, 0))
            self._ground_key = None
            return self.cells
        traces = traces or Traces()
        raster = Raster(viewport, *look.drawing.dots)
        self._update_ground(level, frame, traces, raster, look)
        colours = {robot.name: robot_colour(robot.color, look.palette) for robot in level.robots}
        dead = look.palette.dead
        immobile = {robot.name for robot in level.robots if robot.is_immobile}
        robots = [
            (robot, dead if robot.dead else colours.get(robot.name, dead))
            for state in frame.after.robots
            for robot in [replace(state, dead=False) if state.name in immobile else state]
        ]
        robots.sort(key=lambda pair: pair[0].name == look.selected)
        faint = [] if ghosts is None else _ghosts(ghosts, frame, level, colours, look.palette)
        light = self._lighting(frame, raster, look, colours, hurried=hurried)
        if look.is_plain:
            cells = _ascii_cells(self._ground, light.image, light.lit, look.palette)
        else:
            image = light.image.copy()
            for x, y, _, colour in faint:
                _paint_outline(image, raster, x, y, colour)
            for robot, colour in robots:
                _paint_robot(image, raster, robot, colour, look.palette)
            cells = self._fit_cells(image, raster, _UNSEEN if hurried else 0)
            self.image = image
        canvas = Canvas(cells, viewport, look)
        if look.trails:
            names = [robot.name for robot in level.robots]
            is_crowd = len(names) > _MOST_TRAILS
            trailing = [i for i, name in enumerate(names) if not is_crowd or name == look.selected]
            places, ages = traces.trails(frame.tick)
            if trailing and places.size:
                trail_colours = [colours[names[i]] for i in trailing]
                draw_trails(canvas, places[:, trailing], ages, trail_colours)
        if look.lines:
            for fan in light.fans:
                if fan.name == look.selected:
                    draw_rays(canvas, fan, colours[fan.name])
        undecided = frozenset(d.robot_name for d in frame.decisions if d.desire is None)
        draw_labels(canvas, self._lettering, robots, undecided, light.fans, faint)
        if look.highlight is not None:
            _draw_highlight(canvas, look.highlight, frame)
        self.cells = cells
        return cells

    def _update_ground(
        self, level: Level, frame: Frame, traces: Traces, raster: Raster, look: Look
    ) -> None:
        active = tuple(area.active for area in frame.after.areas)
        switched = traces.switched_areas(frame.tick)
        changed = self._take(level)
        key = active, switched, raster, look.drawing, look.palette, look.names
        paint = partial(draw_ground, level, self._walls, active, look.palette, switched)
        if key != self._ground_key:
            self._ground_key, self._light, self._ground = key, None, paint(raster)
            ground = self._ground.image
            self._lettering = StaticLabels(level, active, raster.viewport, look, ground)
        elif changed is not None:
            self._light = None
            window = self._ground.repaint(raster, changed, paint)
            if window is not None:
                self._lettering.follow_ground(look, self._ground.image, window)

    def _take(self, level: Level) -> tuple[int, int, int, int] | None:
        """Set the level; return the region of changed walls, if only a region changed."""
        old_level = self._level
        if level is old_level:
            return None
        self._level = level
        if old_level is None or old_level.walls.shape != level.walls.shape:
            self._walls, self._ground_key = WallTable(level.walls), None
            return None
        changed = self._walls.change(level.walls)
        if (old_level.areas, old_level.beacons) != (level.areas, level.beacons):
            self._ground_key = None
        return changed

    def _lighting(
        self, frame: Frame, raster: Raster, look: Look, colours: dict[str, RGB], *, hurried: bool
    ) -> _Light:
        """Return the ground in the robots' light; if hurried, perhaps that of an earlier frame."""
        if hurried and self._light and self._light.left and self._light.look == look:
            self._light = replace(self._light, left=self._light.left - 1)
            return self._light
        image, lit, left = self._ground.image, np.zeros(raster.shape, np.bool_), 0
        robot_fans = fans(frame) if look.rays or look.marks or look.lines else []
        if look.rays:
            image, left = image.copy(), 1 + len(robot_fans) // _CROWD
            for fan in robot_fans:
                colour = colours.get(fan.name, look.palette.dead)
                _add_light(image, lit, fan, colour, self._ground, raster, look)
        self._light = _Light(look, image, lit, robot_fans, left)
        return self._light

    def _fit_cells(self, image: Floats, raster: Raster, tolerance: int) -> Cells:
        # Steps of 4 keep faint changes of light from changing cells.
        coarse = np.clip(image, 0, 255, out=image).astype(np.uint8) & np.uint8(0xFC)
        dots = split(coarse, raster.across, raster.down)
        shape = raster.viewport.rows, raster.viewport.columns
        if self._dots is None or self._dots.shape != dots.shape or self._base.text.shape != shape:
            self._base = Cells.blank(*shape)
            self._dots = dots
            changed = np.arange(len(dots))
        else:
            apart = np.maximum(dots, self._dots) - np.minimum(dots, self._dots)
            changed = np.flatnonzero((apart > tolerance).any(axis=(1, 2)))
            self._dots[changed] = dots[changed]
        refit(self._base, dots, changed)
        return self._base.copy()


def _paint_robot(
    image: Floats, raster: Raster, robot: RobotState, colour: RGB, palette: Palette
) -> None:
    if not math.isfinite(robot.angle):
        return
    full = raster.viewport.shows_bodies
    radius = ROBOT_RADIUS if full else max(ROBOT_RADIUS, 0.9 * raster.dot)
    around = raster.vicinity(robot.x, robot.y, 1.5 * radius)
    if around is None:
        return
    window, dx, dy = around
    distance = np.hypot(dx, dy)
    dot = raster.dot
    body = np.clip((radius - distance) / dot + 0.5, 0, 1)
    if not full:
        blend(image, window, colour, body * 0.85)
        return

    shadow = np.clip((radius * 1.4 - distance) / (radius * 0.4), 0, 1)
    blend(image, window, palette.floor, shadow * 0.55)
    blend(image, window, mix(colour, (0, 0, 0), 0.45), body)
    inner = np.clip((radius - max(1.1 * dot, 1.2) - distance) / dot + 0.5, 0, 1)
    blend(image, window, colour, inner)
    cos, sin = math.cos(robot.angle), math.sin(robot.angle)
    ahead, aside = dx * cos + dy * sin, np.abs(dy * cos - dx * sin)
    if radius > 6 * dot:
        nose = np.minimum(ahead + 0.3 * radius, (1.15 * radius - ahead) * 0.33 - aside)
    else:  # Too few dots for a pointer.
        nose = 0.4 * radius - np.hypot(ahead - 0.68 * radius, aside)
    nose = np.clip(nose / dot + 0.5, 0, 1) * body
    blend(image, window, mix(colour, palette.bright, 0.72), nose)


def _ghosts(
    poses: NDArray[np.float32],
    frame: Frame,
    level: Level,
    colours: dict[str, RGB],
    palette: Palette,
) -> list[Faint]:
    """Return the ghosts whose middle no robot covers."""
    places = np.array([(robot.x, robot.y) for robot in frame.after.robots])
    away = np.hypot(*np.moveaxis(poses[:, None, :2] - places[None], 2, 0)).min(axis=1)
    return [
        Faint(x, y, angle, palette.faint(colours[robot.name]))
        for (x, y, angle), robot, free in zip(
            poses.tolist(), level.robots, away > ROBOT_RADIUS, strict=True
        )
        if free
    ]


def _paint_outline(image: Floats, raster: Raster, x: float, y: float, colour: RGB) -> None:
    around = raster.vicinity(x, y, 1.5 * ROBOT_RADIUS) if raster.viewport.shows_bodies else None
    if around is not None:
        window, dx, dy = around
        distance = np.abs(np.hypot(dx, dy) - ROBOT_RADIUS)
        blend(image, window, colour, np.clip(1 - distance / raster.dot, 0, 1))


def _draw_highlight(canvas: Canvas, highlight: Highlight, frame: Frame) -> None:
    """Draw a ray from where the robot sensed, or a ring around where it is afterwards."""
    if highlight.ray is not None:
        for fan in fans(frame):
            if fan.name == highlight.robot:
                draw_ray(canvas, fan, highlight.ray)
    else:
        for robot in frame.after.robots:
            if robot.name == highlight.robot:
                draw_ring(canvas, robot.x, robot.y)


def _add_light(
    image: Floats,
    lit: NDArray[np.bool_],
    fan: Fan,
    colour: RGB,
    ground: Ground,
    raster: Raster,
    look: Look,
) -> None:
    """Add a fan's light to an image, or darken it in light themes, and record where."""
    weights = brightness_of(fan, raster)
    if weights is None:
        return
    window, brightness = weights
    lit[window] |= brightness > 0
    strength = _STRENGTH
    if look.selected is not None:
        strength = _SELECTED if fan.name == look.selected else _OTHERS
    light = (brightness * ground.reflectance[window])[..., None]
    tint = np.array(colour, np.float32) * np.float32(strength)
    if look.palette.light:
        image[window] *= 1 - light * (np.float32(strength) - tint / 255)
    else:
        image[window] += light * tint


def _ascii_cells(ground: Ground, image: Floats, lit: NDArray[np.bool_], palette: Palette) -> Cells:
    text = _KIND_IDS[ground.kinds]
    text[lit & (ground.kinds == 0)] = _LIT_ID
    floor = np.array(palette.floor, np.float32)
    apart = image - floor
    apart *= 150 / np.maximum(np.abs(apart).max(axis=2, keepdims=True), 1)
    ink = pack(np.clip(floor + apart, 0, 252))
    paper = np.full(text.shape, rgb_number(palette.floor), np.int64)
    return Cells(text, ink << 24 | paper, paper)


def tiles(count: int, columns: int, rows: int) -> tuple[int, int]:
    """Return how many pictures stand side by side and above each other, as large as possible."""
    most_across, most_down = max(columns // _LEAST[0], 1), max(rows // _LEAST[1], 1)
    best, best_size = (most_across, most_down), 0.0
    for across in range(1, most_across + 1):
        down = min(math.ceil(count / across), most_down)
        if across * down < count and (across, down) != (most_across, most_down):
            continue
        size = min(columns / across / 2, 2 * (rows / down - 1) / 1.2)
        if size > best_size:
            best, best_size = (across, down), size
    return best


def draw_senses(level: Level, frame: Frame, columns: int, rows: int, look: Look) -> Cells:
    """Draw what robots sense, the selected one in any case."""
    cells = Cells.blank(rows, columns)
    cells.style[:] = rgb_number(look.palette.void)
    cells.tone[:] = rgb_number(look.palette.void)
    robot_fans = fans(frame)
    if not robot_fans or columns < 3 or rows < 3:
        return cells
    across, down = tiles(len(robot_fans), columns, rows)
    room, names = across * down, [fan.name for fan in robot_fans]
    first = names.index(look.selected) // room * room if look.selected in names else 0
    colours = {robot.name: robot_colour(robot.color, look.palette) for robot in level.robots}
    width, height = columns // across, rows // down
    for number, fan in enumerate(robot_fans[first : first + room]):
        tile = _tile(fan, colours.get(fan.name, look.palette.dead), width, height, look)
        left, top = number % across * width, number // across * height
        part = slice(top, top + height), slice(left, left + width)
        cells.text[part], cells.style[part] = tile.text, tile.style
        cells.tone[part] = tile.tone
    return cells


def _tile(fan: Fan, colour: RGB, columns: int, rows: int, look: Look) -> Cells:
    """Draw one robot's senses: up is ahead, and a frame separates tiles."""
    palette = look.palette
    middle = float(fan.headings[0] + fan.headings[-1]) / 2
    turn = middle + math.pi / 2
    turned_fan = replace(fan, x=0.0, y=0.0, headings=fan.headings - turn, ahead=fan.ahead - turn)
    # Less is behind the robot, where no ray goes.
    reach, behind = SENSOR_RANGE * 1.04, SENSOR_RANGE * 0.2
    view = Viewport.fit(2 * reach, reach + behind, columns, rows - 1)
    view = view.centred(0.0, (behind - reach) / 2)
    raster = Raster(view, *look.drawing.dots)
    image = np.empty((*raster.shape, 3), np.float32)
    image[:] = palette.floor
    dx, dy = np.meshgrid(raster.x, raster.y)
    away = np.hypot(dx, dy)
    ring = np.clip(1 - np.abs(away - SENSOR_RANGE) / raster.dot, 0, 1)
    blend(image, (slice(None), slice(None)), palette.rock, ring)
    lit = np.zeros(raster.shape, np.bool_)
    light = brightness_of(turned_fan, raster)
    if light is not None:
        window, brightness = light
        lit[window] = brightness > 0
        blend(image, window, colour, np.float32(0.6) * brightness)
    walls = _walls(turned_fan, raster)
    image[walls] = palette.rim
    cells = Cells.blank(rows - 1, columns)
    if look.is_plain:
        floor = rgb_number(palette.floor)
        cells.tone[:], cells.style[:] = floor, rgb_number(palette.dead) << 24 | floor
        for where, sign, ink in ((lit, ".", colour), (walls, "#", palette.rim)):
            cells.text[where], cells.style[where] = text_id(sign), rgb_number(ink) << 24 | floor
    else:
        coarse = np.clip(image, 0, 255).astype(np.uint8) & np.uint8(0xFC)
        dots = split(coarse, raster.across, raster.down)
        refit(cells, dots, np.arange(len(dots)))
    canvas = Canvas(cells, view, look)
    _put_ends(canvas, turned_fan)
    if look.highlight is not None and look.highlight.robot == fan.name:
        if look.highlight.ray is not None:
            draw_ray(canvas, turned_fan, look.highlight.ray)
        else:
            draw_ring(canvas, 0.0, 0.0)
    canvas.put(view.cell(0.0, 0.0), look.glyphs.heading(-math.pi / 2), colour)
    return _title(cells, fan.name, colour, look)


def _walls(fan: Fan, raster: Raster) -> NDArray[np.bool_]:
    """Return which dots show a sensed wall; fills gaps between rays that end close together."""
    mask = np.zeros(raster.shape, np.bool_)
    x, y = fan.points()
    is_wall = np.array([kind == "wall" for kind in fan.objects])
    gap = np.hypot(np.diff(x), np.diff(y))
    # Seen at a slant, rays that are neighbours end far apart on the same wall.
    joined = is_wall[1:] & is_wall[:-1] & (gap < 0.25 * fan.distances[1:] + _THICK)
    steps = np.linspace(0, 1, 32)
    along_x = x[:-1, None] + np.diff(x)[:, None] * steps
    along_y = y[:-1, None] + np.diff(y)[:, None] * steps
    every_x = np.concatenate([along_x[joined].ravel(), x[is_wall]])
    every_y = np.concatenate([along_y[joined].ravel(), y[is_wall]])
    rows = np.searchsorted(raster.y_edges, every_y) - 1
    columns = np.searchsorted(raster.x_edges, every_x) - 1
    inside = (rows >= 0) & (rows < mask.shape[0]) & (columns >= 0) & (columns < mask.shape[1])
    mask[rows[inside], columns[inside]] = True
    return mask


def _put_ends(canvas: Canvas, fan: Fan) -> None:
    cells, view, look = canvas
    palette, glyphs = look.palette, look.glyphs
    signs = {
        "beacon": (glyphs.beacon, palette.hit_beacon),
        "robot": (glyphs.hit_robot, palette.hit_robot),
    }
    x_ends, y_ends = (ends.tolist() for ends in fan.points())
    for kind, sign in signs.items():  # the most important last
        for x, y, hit in zip(x_ends, y_ends, fan.objects, strict=True):
            if hit == kind:
                canvas.put(view.cell(x, y), *sign)
    for x, y, kind, label in fan.sightings():
        cell = view.cell(x, y)
        if cell is None or not look.names:
            continue
        name = fit_into(label, view.columns // 2, look.drawing)
        row, first = cell[0] - 1, min(max(cell[1] - len(name) // 2, 0), view.columns - len(name))
        if row >= 0:
            style = rgb_number(signs[kind][1]) << 24 | rgb_number(palette.plate)
            write(cells, row, first, name, style)


def _title(cells: Cells, name: str, colour: RGB, look: Look) -> Cells:
    rows, columns = cells.text.shape
    titled = Cells.blank(rows + 1, columns)
    paper = rgb_number(mix(look.palette.plate, colour, 0.2))
    titled.style[0], titled.tone[0] = paper, paper
    titled.text[1:], titled.style[1:], titled.tone[1:] = cells.text, cells.style, cells.tone
    text = fit_into(name, columns - 2, look.drawing)
    write(titled, 0, 1, text, BOLD | rgb_number(look.palette.strong(colour)) << 24 | paper)
    return titled
