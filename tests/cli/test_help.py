"""``logical-robots help``: the functions of the language."""

import pytest

from logical_robots_tui.language.reference import REFERENCE
from tests.cli.running import Command


def test_without_a_name_everything_is_listed_in_lines_that_fit_a_terminal(command: Command) -> None:
    told = command("help").success
    listed = {line.split("  ")[1] for line in told.splitlines() if line.startswith("  ")}
    assert listed == {entry.name for entry in REFERENCE}
    assert max(map(len, told.splitlines())) <= 90


@pytest.mark.parametrize("name", ["ArgMin", "argmin"])
def test_a_function_is_explained_with_an_example(name: str, command: Command) -> None:
    assert command("help", name).success == (
        "ArgMin{x -> y :- P(x, y)}\n"
        "  the x of the smallest y (an aggregate)\n"
        "\n"
        "  ArgMin{x -> -x :- x in [1, 2]}\n"
        "  gives 2\n"
    )


def test_a_misspelt_name_gets_a_suggestion(command: Command) -> None:
    refusal = command("help", "Squrt").refusal
    assert refusal == "logical-robots: There is no function Squrt. Did you mean Sqrt?\n"
    assert "`logical-robots help` lists" in command("help", "Xyzzyx").err
