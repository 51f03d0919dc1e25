"""A class at a glance: what went wrong with whom, similar programs, and playing one of them."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from logical_robots_tui.cli.main import main
from logical_robots_tui.lab.classroom import ALIKE, _inlined, likeness
from logical_robots_tui.lab.folder import Folder
from logical_robots_tui.language.source_text import lexemes_of
from logical_robots_tui.paths import shipped_folder
from tests.cli.running import Command
from tests.lab.laboratory import (
    FIRST_STEPS,
    SENSOR,
    STANDING,
    STILL,
    lane,
    program_text,
    rows,
    write_files,
)
from tests.short import AHEAD

ASSIGNMENT = Path(__file__).with_name("classroom.toml").read_text("utf-8")

PROGRAMS = shipped_folder("programs")

STUDENTS = [
    *("Ada Lovelace", "Ben Ary", "Cem <b>Demir</b>", "Dot Ary"),
    *("Eve Hacker", "Fay Slow", "Gus Still", "Hal Two"),
]

RENAMED = Path(__file__).with_name("renamed.l").read_text("utf-8")

SLOW = """
N(x) :- x in Range(150);
Robot(robot_name:, desire: {left_engine: Sum{x * y :- N(x), N(y)} * 0, right_engine: 0}, memory:)
  :- Sensor(robot_name:, sensor:), memory == sensor.clock;
"""

TWO = STANDING + STILL.format("1", '""', SENSOR)


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A graded class with each kind of fault, and a program that was handed in three times."""
    folder = tmp_path_factory.mktemp("class")
    lines = [f"{n},{name},{name.split()[0].lower()}" for n, name in enumerate(STUDENTS, 2017)]
    files = {
        "a.toml": ASSIGNMENT,
        "roster.csv": "id,name,submission\n" + "\n".join(lines),
        "01-first-steps.toml": 'solution = "first-steps"\n' + lane("First steps"),
        "02-open-space.toml": lane("Open space"),
        "all/ada/01-first-steps.l": FIRST_STEPS,
        "all/ada/02-open-space.l": FIRST_STEPS,
        "all/ben/01-first-steps.l": RENAMED,
        "all/ben/02-open-space.l": AHEAD.replace("0.5", "0.9"),
        "all/cem/01-first-steps.l": "Robot(robot_name:, desire: 1) :- Snesor(robot_name:);",
        "all/dot/01-first-steps.l": f"# {'again ' * 9}\n{FIRST_STEPS}",
        "all/eve/01-first-steps.l": TWO,
        "all/fay/01-first-steps.l": SLOW,
        "all/gus/01-first-steps.l": STANDING,
        "all/hal/01-first-steps.l": program_text("first-steps-starter"),
    }
    write_files(folder, files)
    out = folder / "grades"
    assert main(["grade", f"{folder}/a.toml", f"{folder}/all", "-o", str(out)]) == 0
    return out


def test_what_went_wrong_is_told_by_kind_and_names(out: Path, command: Command) -> None:
    _, _, faults = command("lab", "report", out).out.partition("Common problems\n")
    assert max(map(len, faults.splitlines())) <= max(80, len(str(out)) + 30)
    faults = " ".join(faults.split())
    assert "does not compile: 01-first-steps: Cem <b>Demir</b> (2019): Snesor" in faults
    assert "too slow: 01-first-steps: Fay Slow (2022): too slow" in faults
    assert "errors while running: 01-first-steps: Eve Hacker (2021): Robot has 2 rows" in faults
    assert "did not win: 01-first-steps: Gus Still (2023)" in faults
    assert "02-open-space: Cem <b>Demir</b> (2019), Dot Ary (2020)," in faults
    page = (out / "report.html").read_text("utf-8")
    assert "<h3>Does not compile</h3>" in page
    assert "Cem &lt;b&gt;Demir&lt;/b&gt; (2019)" in page
    assert "<code>logical-robots lab play grades 2019 01</code>" in page
    assert "<b>Demir" not in page
    assert not re.search("[0-9a-f]{64}", page)


def test_renamed_and_reordered_programs_are_found(out: Path, command: Command) -> None:
    assert command("lab", "export", out).status == 0
    pairs = rows(out / "similar.csv")
    assert {pair["level"] for pair in pairs} == {"01-first-steps"}
    both, one, other = sorted(
        (pair["one"], pair["other"], pair["one_name"], pair["other_name"]) for pair in pairs
    )
    assert both == ("2017, 2020", "2018", "Ada Lovelace, Dot Ary", "Ben Ary")
    assert one == ("2017, 2020", "first-steps", "Ada Lovelace, Dot Ary", "the game's program")
    assert other == ("2018", "first-steps", "Ben Ary", "the game's program")
    assert {pair["score"] for pair in pairs} == {"1.0"}
    command("lab", "report", out)
    page = (out / "report.html").read_text("utf-8")
    assert "the game&#x27;s program first-steps" in page
    texts = re.findall(r"<details>.*?</details>", page, re.DOTALL)
    assert [text.count("<pre>") for text in texts] == [2, 1, 1]
    assert "Drive(distance) = (" in texts[0]
    assert "/* all mine */ Move(d) = (" in texts[0]


def renumbered(text: str) -> str:
    number = r'(?<![\w"])\d+(\.\d+)?(?![\w"])'
    return re.sub(number, lambda match: f"{float(match[0]) * 1.17 + 1:.3g}", text)


def reordered(text: str) -> str:
    return ";\n".join([*text.split(";\n")[-2::-1], ""])


SOLUTIONS = [path.stem.removesuffix("-starter") for path in sorted(PROGRAMS.glob("*-starter.l"))]
SPIN, TURN = "{left_engine: 0.8, right_engine: -0.8}", "{left_engine: -0.5, right_engine: 0.5}"
WALL, RIGHT = "OnTheRight(ray)", "ray.angle < -0.6"
HOME = 'ray.object == "beacon", ray.label == "Home"'
MOORED = 'ray.label == "Harbour" && ray.distance < 40'
COPIES: list[tuple[str, Callable[[str], str], dict[str, str]]] = [
    *((name, change, {}) for name in SOLUTIONS for change in (renumbered, reordered)),
    ("first-steps", str, {"Drive": "Go", "distance <": "far <", "(distance)": "(far)"}),
    ("first-steps", str, {SPIN: "Spin()", "Robot": f"Spin() = {SPIN};\nRobot"}),
    ("the-long-hall", renumbered, {f"{WALL} :- {RIGHT};": "", WALL: RIGHT}),
    ("the-long-hall", reordered, {f"TurnLeft() = {TURN};": "", "TurnLeft()": TURN}),
    ("everybody-home", renumbered, {f"IsHome(ray) :- {HOME};": "", "IsHome(ray)": HOME}),
    ("lighthouse", str, {f"Moored(ray) = ({MOORED});": "", "Moored(ray)": MOORED}),
]


@pytest.mark.parametrize(("name", "change", "words"), COPIES)
def test_changed_copies_are_alike(
    name: str, change: Callable[[str], str], words: dict[str, str]
) -> None:
    copy = program_text(name)
    for word, other in words.items():
        copy = copy.replace(word, other)
    assert likeness(program_text(name), change(copy)) > 0.9


def test_other_designs_are_not_alike_and_a_starter_does_not_count() -> None:
    for name in SOLUTIONS:
        if (PROGRAMS / f"references/{name}-shortest.l").exists():
            own, other = program_text(name), program_text(f"references/{name}-shortest")
            assert likeness(own, other, program_text(f"{name}-starter")) < ALIKE
    starter = program_text("first-steps-starter")
    assert likeness(starter, f"{starter} Unused() = 1;", starter) == 0
    assert likeness("", "") == 0


@pytest.mark.parametrize(
    "text",
    [
        "F0() = 1;" + "".join(f"F{n + 1}() = F{n}() + F{n}();" for n in range(40)),
        "F(x) = " + "x + " * 4_000 + "x; G() = F(" + "1 + " * 4_000 + "1);",
        "F(x) = x; G() = " + "F(" * 6_000,
        "A(x) = B(x) + B(x); B(x) = A(x) + A(x) + C(x); C(x) = A(x) + B(x);",
    ],
)
def test_helpers_are_inlined_within_bounds(text: str) -> None:
    assert sum(map(len, _inlined([*lexemes_of(text)]))) < 50_000


def test_a_program_is_played_by_name_and_number_or_missed(out: Path, command: Command) -> None:
    for words in (("017", "02"), ("ada", "2"), ("lovelace", "open-space", "--start", 1)):
        told = command("lab", "play", out, *words, "--plain", typed=("quit",))
        assert (told.status, told.err) == (0, "")
        assert told.out.startswith("Open space"), told.out
    before = sorted(Folder(out).path.iterdir())
    for words, said in {
        ("Ary", "1"): "Several students match. Name one by the id: Ben Ary (2018), Dot",
        ("Lovelance", "1"): 'No student matches. Did you mean "Lovelace"?',
        ("2017", "7"): "No program was run in this level. Levels: 01-first-steps, 02-open-space",
        ("hal", "02"): "Hal Two (2024) has no program for 02-open-space",
    }.items():
        assert said in command("lab", "play", out, *words).refusal
    assert sorted(Folder(out).path.iterdir()) == before
