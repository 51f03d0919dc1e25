"""Several moments in one query: each robot gets the rows that it gets at its own moment."""

from contextlib import closing
from functools import cache
from pathlib import Path
from typing import Literal

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.explain.diagnosis.sites import check_up
from logical_robots_tui.mind import Limits, Mind, Program
from logical_robots_tui.values import SensorRow, Value
from tests.mind.rows import VISIBILITIES, row

Rows = list[dict[str, Value]]

TEXT = Path(__file__).with_name("moments.l").read_text("utf-8")
ROBOTS = ("Ada", "Bo", "Cy")
SIGHTS = st.dictionaries(
    st.integers(0, 30),
    st.tuples(st.integers(1, 199), st.sampled_from(["robot", "beacon"]), st.sampled_from(ROBOTS)),
    max_size=3,
)
MEMORIES = st.one_of(
    st.just(""), st.none(), st.text(max_size=3), st.fixed_dictionaries({"n": st.integers(0, 4)})
)
MOMENTS = st.lists(
    st.tuples(
        st.tuples(
            *(
                st.builds(lambda name, sees: row(name, sees=sees), st.just(n), SIGHTS)
                for n in ROBOTS
            )
        ),
        st.fixed_dictionaries(dict.fromkeys(ROBOTS, MEMORIES)),
    ),
    min_size=1,
    max_size=15,
)


@cache
def probes() -> Program:
    return check_up(Program.compile(TEXT)).program


def in_any_order(views: list[Rows] | None) -> list[list[str]] | None:
    return None if views is None else [sorted(map(repr, rows)) for rows in views]


@pytest.mark.parametrize(("memory", "sensor"), VISIBILITIES)
@settings(deadline=None)
@given(moments=MOMENTS)
def test_the_rows_at_several_moments_are_those_at_each(
    memory: Literal["own", "seen", "all"],
    sensor: Literal["own", "all"],
    moments: list[tuple[tuple[SensorRow, ...], dict[str, Value]]],
) -> None:
    names = [*probes().statements]
    single: dict[tuple[str, int], list[Rows]] = {}
    with closing(Mind(probes(), memory, sensor)) as mind:
        for number, (rows, memories) in enumerate(moments):
            for name, views in mind.predicate_rows(names, rows, memories):
                assert views is not None
                single.setdefault((name, number), []).append(views)
        several = {
            (name, number): views for name, number, views in mind.predicate_rows_at(names, moments)
        }
    assert {key: in_any_order(views) for key, views in several.items()} == {
        key: in_any_order(views) for key, views in single.items()
    }


def test_a_predicate_that_fails_is_told_of_each_moment() -> None:
    moment = tuple(row(name) for name in ROBOTS), {name: {"n": 3} for name in ROBOTS}
    name = next(iter(probes().statements))
    with closing(Mind(probes(), limits=Limits(rows=0))) as mind:
        assert [*mind.predicate_rows_at([name], [moment] * 2)] == [(name, 0, None), (name, 1, None)]
