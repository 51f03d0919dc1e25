"""Of a row with several derivations one is shown, and the others are counted."""

import pytest

from logical_robots_tui.mind import Limits
from tests.explain.asking import why

EDGES = "E(x, x + 1) :- x in [1, 2, 3, 4];"
AS_ALTERNATIVES = "Way(x, y) distinct :- E(x, y) | Way(x, z), Way(z, y);"
AS_RULES = "Way(x, y) distinct :- E(x, y); Way(x, y) distinct :- Way(x, z), Way(z, y);"


@pytest.mark.parametrize("rules", [AS_ALTERNATIVES, AS_RULES])
@pytest.mark.parametrize(
    ("end", "note"),
    # From rows of earlier steps: of 1 to 5 there is one, by two ways of the same length.
    [(2, None), (3, None), (4, "1 other derivation"), (5, None)],
)
def test_the_other_derivations_of_a_row_are_counted(rules: str, end: int, note: str | None) -> None:
    explanation = why(EDGES + rules, "Way", given={"x": 1, "y": end})
    (rule,) = (rule for rule in explanation.rules if rule.row is not None)
    notes = [node.text for _, node in rule.node.walk() if node.kind == "note"]
    assert notes == ([f"This row has {note} by this rule"] if note else [])


def test_derivations_that_take_long_to_count_are_not() -> None:
    """The steps for the rows, and as many again for a count, would be too many for a query."""
    text = "N(i) :- i in Range(70); S(s) distinct :- N(a), N(b), N(c), a + b == c * 138, s = 0;"
    (rule,) = why(text, "S", limits=Limits(query_steps=4_500_000)).rules
    assert rule.row is not None
    assert "note" not in [node.kind for _, node in rule.node.walk()]
