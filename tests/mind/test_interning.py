"""What nobody changes: records and lists stay the same objects, and that makes no difference."""

from contextlib import closing
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.mind import Mind, Program
from tests.mind.rows import ROBOT, row, slow
from tests.mind.test_tuning_memories import TOLD, odd, roads


@pytest.mark.parametrize("visible", ["seen", slow("all")])
def test_lists_that_stayed_the_same_objects_count_as_they_would_anew(visible: Any) -> None:
    program = Program.compile(TOLD)
    lasting, fresh = (Mind(program, memory=visible, frozen=frozen) for frozen in (True, False))
    robots = [row("Ada", sees={3: (40, "robot", "Cy")}), row("Bo"), row("Cy")]
    some = st.integers(0, 3)
    moments = st.lists(
        st.tuples(st.integers(1, 3), st.lists(st.tuples(some, some), min_size=3, max_size=3)),
        min_size=2,
        max_size=6,
    )

    @settings(max_examples=min(60, settings().max_examples), deadline=None)
    @given(st.lists(roads | roads | odd, min_size=4, max_size=4), moments)
    def same(lists: list[Any], moments: list[tuple[int, list[tuple[int, int]]]]) -> None:
        for count, chosen in moments:
            memories: dict[str, Any] = {
                name: {"report": lists[report], "roads": lists[roads]}
                for name, (report, roads) in zip(("Ada", "Bo", "Cy"), chosen, strict=True)
            }
            rows = robots[-count:]
            assert lasting.think(rows, memories) == fresh.think(rows, memories)

    with closing(lasting), closing(fresh):
        same()


def test_a_value_of_the_same_text_is_the_same_object_where_nobody_changes_it() -> None:
    program = Program.compile(f"{ROBOT} m = {{all: Range(60), n: sensor.clock}};")
    for frozen in (True, False):
        with closing(Mind(program, frozen=frozen)) as mind:
            found: list[Any] = [
                decision.memory
                for clock in (1, 2)
                for decision in mind.think([row("Ada", clock=clock), row("Bo", clock=clock)], {})
            ]
        assert [memory["n"] for memory in found] == [1, 1, 2, 2]
        assert all(memory["all"] == list(range(60)) for memory in found)
        assert (len({id(memory["all"]) for memory in found}) == 1) == frozen


def test_equal_numbers_in_memories_are_told_apart() -> None:
    program = Program.compile(f"{ROBOT} Memory(robot_name:, memory:), m = {{n: memory.n}};")
    with closing(Mind(program)) as mind:
        for n in (0, 0.0, -0.0, False, 0, 1, True, 1.0, None, "1", 1):
            rows, memories = [row("Ada")], {"Ada": {"n": n}}
            with closing(Mind(program)) as fresh:
                assert repr(mind.think(rows, memories)) == repr(fresh.think(rows, memories))
