"""Names that a program compares with labels and robots' names, and those that a level has."""

from logical_robots_tui.language import package_patches
from logical_robots_tui.language.adapter import parse
from logical_robots_tui.language.definitions import Model
from logical_robots_tui.language.diagnostics import Diagnostic, LevelNames, Mention, unknown_names
from logical_robots_tui.language.inference import Inference
from logical_robots_tui.language.source_text import prepare

package_patches.install()

NAMES = LevelNames(frozenset({"Ada", "Bo"}), frozenset({"Harbour", "Gate"}))
RAY = "Sensor(robot_name:, sensor:), ray in sensor.radar"


def mentioned(text: str) -> list[tuple[str, str]]:
    parsed = parse(prepare(text))
    found = Inference(Model(parsed.statements, parsed.source, parsed.doubtful)).mentions
    return [(mention.text, mention.field) for mention in found]


LABELS = [
    f'A(1) :- {RAY}, ray.label == "x";',
    f'A(1) :- {RAY}, "x" != ray.label;',
    f'A(1) :- {RAY}, ray.label in ["x"];',
    f'A(1) :- {RAY}, y == ray.label, y == "x";',
    f'A(1) :- {RAY}, y == "x", ray.label == y;',
    f'A(y) :- {RAY}, y = (if ray.label == "x" then 1 else 2);',
    'A(1) :- Sensor(sensor:), {label: "x"} in sensor.radar;',
    f'B(name: ray.label) :- {RAY}; A(1) :- B(name: "x");',
    f'F(y) = (if y == "x" then 1 else 2); A(F(ray.label)) :- {RAY};',
    'A(1) :- Sensor(sensor:), sensor.forward_label == "x";',
    f'A(y) :- y = Count{{ray.angle :- {RAY}, ray.label == "x"}};',
]
OTHER_TEXTS = [
    'A(1) :- Memory(memory:), memory == "x";',
    'A(1) :- Memory(memory:), memory.label == "x";',
    f'B(ray.label) :- {RAY}; B("y"); A(1) :- B("x");',
    f'A(1) :- {RAY}, Upper(ray.label) == "x";',
    f'A(y) :- {RAY}, y = ray.label ++ "x";',
    f'A(1) :- {RAY}, StartsWith(ray.label, "x");',
]


def test_a_label_is_recognised_wherever_it_comes_from_and_other_texts_are_not_names() -> None:
    assert {rules: mentioned(rules) for rules in [*LABELS, *OTHER_TEXTS]} == {
        **{rules: [("x", "label")] for rules in LABELS},
        **{rules: [] for rules in OTHER_TEXTS},
    }
    text = 'A(1) :- Sensor(robot_name: "x"); B(1) :- Memory(robot_name:), robot_name == "y";'
    assert mentioned(text) == [("x", "robot_name"), ("y", "robot_name")]


def told(text: str, of: str) -> list[tuple[str, str]]:
    found = unknown_names([Mention(text, of, Diagnostic(1, 1, ""), (0, 0))], NAMES)
    return [(remark.message, remark.hint) for remark in found]


def test_an_unknown_name_is_told_with_the_nearest_and_a_label_of_the_level_is_not() -> None:
    assert [told(name, "label") for name in ("Ada", "Harbour", "wall", "nothing")] == [[]] * 4
    nobody = "No robot, beacon or solid area of this level is called"
    assert told("harbor", "label") == [(f'{nobody} "harbor"', 'Did you mean "Harbour"?')]
    assert told("Add", "robot_name") == [
        ('No robot of this level is called "Add"', 'Did you mean "Ada"?')
    ]
    assert told("Harbour", "robot_name") == [
        ('No robot of this level is called "Harbour"', 'It can be "Ada" or "Bo".')
    ]
    assert all("\x1b" not in part for pair in told("\x1b[2J", "label") for part in pair)
