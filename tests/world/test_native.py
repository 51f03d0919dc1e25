"""The level format of this game."""

import math
from pathlib import Path

import numpy as np
import pytest

from logical_robots_tui.world import Area, Beacon, LevelError, Robot, Visibility, load_level
from logical_robots_tui.world.level import LevelQuestion

FULL = Path(__file__).with_name("full.toml")

SMALL = Path(__file__).with_name("small.toml").read_text("utf-8")


def write(folder: Path, text: str) -> Path:
    path = folder / "level.toml"
    path.write_text(text, "utf-8")
    return path


def refusal(folder: Path, text: str) -> LevelError:
    with pytest.raises(LevelError) as caught:
        load_level(write(folder, text))
    assert caught.value.message.endswith(".")
    assert caught.value.place.startswith(str(folder / "level.toml"))
    return caught.value


def place(error: LevelError) -> str:
    _, _, rest = error.place.partition("level.toml")
    return rest.removeprefix(":").removeprefix(",").strip()


def test_everything_that_a_level_can_say_is_read() -> None:
    level = load_level(FULL)
    walls = level.walls
    assert walls.shape == (40, 60)
    assert walls[:10].all()
    assert not walls[10:20, 10:50].any()
    assert walls[20:30, 20:40].all()
    assert np.count_nonzero(walls) == 18 * 100
    assert not walls.flags.writeable
    assert (level.name, level.title) == ("full", "Two gates")
    assert level.source == str(FULL)
    assert (level.width, level.height) == (60, 40)
    assert level.briefing == "Open the gate.\n\nThen leave."
    assert (level.hints, level.starter) == (("Look for the lamp.", "Turn\nleft."), "wander")
    assert level.visibility == Visibility(memory="seen", sensor="all")
    assert level.robots == (
        Robot("Ann", 15, 15.5, math.pi / 2, "orange", True, True, 100, 0.5),
        Robot("Bob", 40, 15),
    )
    assert level.beacons == (Beacon("lamp", 12, 25, True),)
    assert level.areas == (
        Area("home", 45, 25, 6.5, "#0f0", ("Ann", "Bob"), "lamp", "lamp", True, True),
    )


BATTERY = "battery = {capacity = 9, consumption = 1, charges_others = true, used = false}"


@pytest.mark.parametrize(
    ("more", "robot"),
    [
        ("", Robot("Ann", 15, 15)),
        ("angle = -20.1", Robot("Ann", 15, 15, -20.1)),  # in radians
        (BATTERY, Robot("Ann", 15, 15, battery_capacity=9, battery_consumption_rate=1)),
    ],
    ids=["nothing", "radians", "a battery that is only reported"],
)
def test_what_a_level_leaves_out_has_its_default(tmp_path: Path, more: str, robot: Robot) -> None:
    level = load_level(write(tmp_path, SMALL + more))
    assert level.robots == (robot,)
    assert (level.beacons, level.areas, level.hints) == ((), (), ())
    assert (level.briefing, level.starter) == ("", "")
    assert level.visibility == Visibility()


def test_a_file_of_another_system_with_its_line_ends_and_mark_is_read(tmp_path: Path) -> None:
    path = tmp_path / "level.toml"
    path.write_bytes(b"\xef\xbb\xbf" + SMALL.replace("\n", "\r\n").encode())
    assert load_level(path).walls.shape == (30, 40)


def test_rows_may_be_shortened(tmp_path: Path) -> None:
    drawing = "6#\n#..  #\n1# 1. 2#1. 1#\n6#"
    short = FULL.read_text("utf-8").replace("######\n#..  #\n#.##.#\n######", drawing)
    assert (load_level(write(tmp_path, short)).walls == load_level(FULL).walls).all()
    high = SMALL.replace("#..#", " 3*  1# 2. 1# ")
    assert load_level(write(tmp_path, high)).walls.shape == (50, 40)


def test_a_lenient_level_may_be_as_odd_as_one_of_the_web_platform(tmp_path: Path) -> None:
    area = ROUND + 'goal_for = ["Zoe"]\non_beacon = "b"\n'
    text = SMALL.replace("x = 15", "x = -5").replace("cell =", "lenient = true\ncell =") + area
    level = load_level(write(tmp_path, text))
    assert (level.robots[0].x, level.areas[0].victory_robots) == (-5, ("Zoe",))
    assert level.areas[0].on_beacon == "b"


def drawn(row: str) -> str:
    return SMALL.replace("#..#", row)


ROW = "row 2 of walls (line 5)"
TOO_LARGE = "The labyrinth is {} units; at most 4000 x 4000 is allowed."
NOT_TOML = "This is not valid TOML: "
AREA = '[[areas]]\nname = "a"\nx = 1\ny = 1\n'
ROUND = AREA + "radius = 5\n"
BAD_TEXTS = [
    # what is written, where it's wrong, how the message begins, what the hint says
    (drawn("#...#"), ROW, "This row has 5 characters, the first one has 4.", ""),
    (
        'briefing = """\nwalls = \'\'\'\n####\n"""\n' + drawn("#.."),
        *("row 2 of walls (line 9)", "This row has 3 ", ""),
    ),
    (
        'title = "A"\ncell = 1\nwalls = "##\\n#"\nrobots = [{name = "Ann", x = 0, y = 0}]\n',
        *("row 2 of walls", "This row has 1 ", ""),
    ),
    *(
        (
            drawn(f"#.{character}#"),
            *(ROW, f"Character 3 is {shown}, which is neither wall nor free."),
            "# and free cells as . or space",
        )
        for character, shown in (("X", '"X"'), ("\t", "U+0009"))
    ),
    *(
        (drawn(row), ROW, "This shortened row can't be read.", "6# 94. 6#")
        for row in ("1#2", "0* 4#", "2*", "4x", "12345#", "3 4#", "1# 2. 1# 2*", "٣#")
    ),
    (drawn("\n".join(["9999* 4#"] * 100)), "walls", TOO_LARGE.format("40 x 9999020"), ""),
    (SMALL.replace("####", "9999# 9999."), "walls", TOO_LARGE.format("199980 x 30"), ""),
    (drawn("#..#\n" * 4000), "walls", "The drawing has 4003 rows; at most 4000 are allowed.", ""),
    (SMALL.replace("cell = 10", "cell = = 10"), "line 2, column 8", NOT_TOML, ""),
    ("walls = '''\n###", "end of document", NOT_TOML, ""),
    (
        SMALL + ROUND + 'goal_for = ["ann"]\n',
        *("areas[0].goal_for", 'Area "a" is a goal for "ann", but there is no such robot.'),
        'Did you mean "Ann"?',
    ),
    (SMALL.replace("walls =", "wals ="), "wals", "", 'Did you mean "walls"?'),
    (
        SMALL + "battery = {capacity = 1, zzz = 1}\n",
        *("robots[0].battery.zzz", "", "Known keys: capacity, consumption, charges_others, used."),
    ),
    ('title = "A"\ncell = 10\n', "walls", "", "Draw walls as #"),
    ("title = 'A'\ncell = 10\nwalls = ''\n", "walls", "The first row of the drawing is empty.", ""),
]


@pytest.mark.parametrize(("text", "where", "message", "hint"), BAD_TEXTS, ids=range(len(BAD_TEXTS)))
def test_a_bad_text_is_refused_where_it_is_wrong_with_a_hint(
    tmp_path: Path, text: str, where: str, message: str, hint: str
) -> None:
    error = refusal(tmp_path, text)
    assert place(error) == where
    assert error.message.startswith(message)
    assert hint in error.hint


@pytest.mark.parametrize(
    ("value", "said"),
    [("9" * 5000, NOT_TOML), ("2024-02-31", NOT_TOML), ("[" * 100_000, "The file has ")],
    ids=["number", "date", "list"],
)
def test_toml_that_its_parser_chokes_on_is_refused(tmp_path: Path, value: str, said: str) -> None:
    assert refusal(tmp_path, f"title = {value}\n").message.startswith(said)


BAD_VALUES = [
    # what to write instead of what, where it's wrong, what the message says
    ('title = "Small"\n', "", "title", '"title" is missing.'),
    ('"Small"', "5", "title", '"title" must be text, not a number.'),
    ('"Small"', '""', "title", '"title" is empty.'),
    ("cell = 10\n", "", "cell", '"cell" is missing.'),
    ("cell = 10", "cell = 0", "cell", '"cell" must be 1 or more, not 0.'),
    ("cell = 10", "cell = 1.5", "cell", '"cell" must be a whole number, not 1.5.'),
    ("cell = 10", "cell = true", "cell", '"cell" must be a number, not true or false.'),
    ("cell = 10", "cell = 2000", "walls", "is 8000 x 6000 units; at most 4000 x 4000 is "),
    ("cell = 10", "cell = 10\nsize = 3", "size", '"size" is not a known key.'),
    ("cell = 10", "cell = 10\nhints = 3", "hints", '"hints" must be a list, not a number.'),
    ("cell = 10", "cell = 10\nhints = [3]", "hints[0]", "This must be text, not a number."),
    ("cell = 10", 'cell = 10\nbriefing = "\\u001b[2J"', "briefing", "can't be shown"),
    ("cell = 10", 'cell = 10\nhints = ["\\u0007"]', "hints[0]", "can't be shown"),
    ("cell = 10", "cell = 10\nvisibility = 3", "visibility", "must be a record, not a number."),
    *(
        ("cell = 10", f"cell = 10\nvisibility = {{{text}}}", f"visibility.{key}", message)
        for text, key, message in (
            ('memory = "none"', "memory", '"memory" must be "own" or "seen" or "all".'),
            ('sensor = "seen"', "sensor", '"sensor" must be "own" or "all".'),
            ("eyes = 2", "eyes", "is not a known key."),
        )
    ),
    *(
        ("cell = 10", f"cell = 10\nsensors = {{{text}}}", "sensors" + key, message)
        for text, key, message in (
            ("rays = 4", "", '"rays" must be an odd number, 3 to 361, not 4.'),
            ("view = 400", "", '"view" must be a number, 1 to 360, not 400.'),
            ("reach = 20.5", "", '"reach" must be a whole number, 10 to 200, not 20.5.'),
            ("noise = -1", "", '"noise" must be a number, 0 to 100, not -1.'),
            ('seed = "x"', ".seed", '"seed" must be a number, not text.'),
            ("eyes = 2", ".eyes", "is not a known key."),
        )
    ),
    ("[[robots]]", "[[beacons]]", "robots", "The level has no robots."),
    ("[[robots]]", "[robots]", "robots", '"robots" must be a list, not a record.'),
    ('name = "Ann"\n', "", "robots[0].name", '"name" is missing.'),
    ('"Ann"', '" "', "robots[0].name", '"name" is empty.'),
    ('"Ann"', '"' + "n" * 61 + '"', "robots[0].name", "longer than 60 characters"),
    ('"Ann"', '"\\u001b[31mAnn"', "robots[0].name", "can't be shown"),
    ('"Ann"', '"Ann\\nBob"', "robots[0].name", "can't be shown"),
    ('"Ann"', '"An\\u202en"', "robots[0].name", "can't be shown"),
    ("x = 15\n", "", "robots[0].x", '"x" is missing.'),
    ("x = 15", 'x = "15"', "robots[0].x", '"x" must be a number, not text.'),
    ("x = 15", "x = 2024-01-01", "robots[0].x", '"x" must be a number, not a date or time.'),
    ("x = 15", "x = nan", "robots[0].x", '"x" must be a finite number, not nan.'),
    ("x = 15", "x = -inf", "robots[0].x", '"x" must be a finite number, not -inf.'),
    ("cell = 10", "cell = -1" + "0" * 400, "cell", "too large; at most 1000000 is allowed."),
    ("x = 15", "x = 40", "robots[0]", 'Robot "Ann" is outside the labyrinth.'),
    ("y = 15", "y = -1", "robots[0]", 'Robot "Ann" is outside the labyrinth.'),
    ("y = 15", "y = 15\nage = 3", "robots[0].age", '"age" is not a known key.'),
    ("y = 15", "y = 15\nheading = 90\nangle = 3", "robots[0].angle", "say the same"),
    ("y = 15", 'y = 15\nheading = "up"', "robots[0].heading", "must be a number, not text."),
    ("y = 15", 'y = 15\ncolor = "#12345"', "robots[0].color", '"color" is not a colour.'),
    ("y = 15", "y = 15\ncolor = 12", "robots[0].color", '"color" must be text, not a number.'),
    ("y = 15", "y = 15\nbattery = 5", "robots[0].battery", "must be a record, not a number."),
    *(
        (
            "y = 15",
            f"y = 15\nbattery = {{{text}}}",
            f"robots[0].battery.{key}",
            f'"{key}" {message}',
        )
        for text, key, message in (
            ("", "capacity", "is missing."),
            ("capacity = -1", "capacity", "must be 0 or more, not -1."),
            (
                "capacity = 1, charges_others = 1",
                "charges_others",
                "must be true or false, not a number.",
            ),
            ("capacity = 1, drain = 1", "drain", "is not a known key."),
        )
    ),
]


@pytest.mark.parametrize(("old", "new", "where", "message"), BAD_VALUES)
def test_a_bad_value_is_refused_at_its_key(
    tmp_path: Path, old: str, new: str, where: str, message: str
) -> None:
    assert old in SMALL
    error = refusal(tmp_path, SMALL.replace(old, new, 1))
    assert place(error) == where
    assert message in error.message


NO_BEACON = 'Area "a" is switched by "lamp", but there is no such beacon.'
ORDER = '"last" must be at least "first" and at most "period".'
BAD_ADDITIONS = [
    ('[[robots]]\nname = "Ann"\nx = 2\ny = 1', "robots[1].name", 'Two robots are called "Ann".'),
    ('[[beacons]]\nname = "lamp"\nx = 20', "beacons[0].y", '"y" is missing.'),
    ("[[areas]]\nx = 20\ny = 15\nradius = 5", "areas[0].name", '"name" is missing.'),
    (AREA, "areas[0].radius", '"radius" is missing.'),
    (AREA + "radius = -2", "areas[0].radius", '"radius" must be 0 or more, not -2.'),
    (ROUND + 'on_beacon = "lamp"', "areas[0].on_beacon", NO_BEACON),
    (ROUND + 'off_beacon = "lamp"', "areas[0].off_beacon", NO_BEACON),
    (ROUND + 'goal_for = ""', "areas[0].goal_for", '"goal_for" must be a list, not text.'),
    *(
        (ROUND + f"cycle = {{{text}}}", "areas[0].cycle" + key, message)
        for text, key, message in (
            ("period = 9, first = 0, last = 2", ".first", '"first" must be 1 or more, not 0.'),
            ("period = 9, first = 2", ".last", '"last" is missing.'),
            ("period = 9, first = 3, last = 2", "", ORDER),
            ("period = 9, first = 3, last = 10", "", ORDER),
        )
    ),
    (
        ROUND + "sticky = true\ncycle = {period = 2, first = 1, last = 1}",
        *("areas[0].sticky", 'A cycle switches this area, so it can\'t have "sticky".'),
    ),
    (ROUND + 'solid = ""', "areas[0].solid", '"solid" must be true or false, not text.'),
    (
        "\n".join(f'[[beacons]]\nname = "b{i}"\nx = 1\ny = 1' for i in range(1001)),
        *("beacons", "There are 1001 beacons; at most 1000 are allowed."),
    ),
]


@pytest.mark.parametrize(("addition", "where", "message"), BAD_ADDITIONS)
def test_a_bad_addition_is_refused(tmp_path: Path, addition: str, where: str, message: str) -> None:
    error = refusal(tmp_path, f"{SMALL}\n{addition}\n")
    assert place(error) == where
    assert error.message == message


def test_questions_are_read(tmp_path: Path) -> None:
    asked = """
      {ask = "Who sees a lamp?", answer = '''
    Lit(robot_name:)
    ''', ticks = [120, 480]},
      {ask = "Where?", answer = "Here", ticks = [0], program = "wander"},
    """
    assert load_level(write(tmp_path, f"questions = [{asked}]\n{SMALL}")).questions == (
        LevelQuestion("Who sees a lamp?", "Lit(robot_name:)", (120, 480)),
        LevelQuestion("Where?", "Here", (0,), "wander"),
    )


@pytest.mark.parametrize(
    ("text", "key", "said"),
    [
        ('answer = "A"', ".ticks", '"ticks" must be ascending numbers up to 10000.'),
        ('answer = "A", ticks = [480, 120]', ".ticks", '"ticks" must be ascending numbers'),
        ('answer = "A", ticks = [1, 10001]', ".ticks", '"ticks" must be ascending numbers'),
        ('answer = "A", ticks = 120', ".ticks", '"ticks" must be a list, not a number.'),
        ('answer = "A", ticks = [1, "2"]', ".ticks[1]", '"ticks[1]" must be a number, not text.'),
        ('answer = "A", ticks = [-1]', ".ticks[0]", '"ticks[0]" must be 0 or more, not -1.'),
        ('answer = " ", ticks = [1]', ".answer", '"answer" is empty.'),
        ("ticks = [1]", ".answer", '"answer" is missing.'),
        ('answer = "A", ticks = [1], tick = 3', ".tick", '"tick" is not a known key.'),
    ],
)
def test_a_mistake_in_a_question_is_told(tmp_path: Path, text: str, key: str, said: str) -> None:
    error = refusal(tmp_path, f'questions = [{{ask = "Who?", {text}}}]\n{SMALL}')
    assert place(error) == f"questions[0]{key}"
    assert error.message.startswith(said)
