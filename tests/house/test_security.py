"""What docs/security.md promises is held by tests that are there."""

import re

from logical_robots_tui.cli.play import LIMITS
from logical_robots_tui.mind import Limits
from tests.installed import CHECKOUT
from tests.mind.hostile.programs import PROGRAMS
from tests.world.hostile import FILES

PAGE = (CHECKOUT / "docs" / "security.md").read_text("utf-8")


def test_each_promise_names_a_test_that_is_there() -> None:
    named = re.findall(r"`(tests/[\w/]+\.py)`", PAGE)
    assert len(named) > 12
    assert [path for path in named if not (CHECKOUT / path).is_file()] == []


def test_the_numbers_of_hostile_programs_and_files_are_true() -> None:
    assert f"{len(PROGRAMS)} programs" in PAGE
    assert f"{len(FILES)} files" in PAGE


def test_the_table_of_limits_tells_them_all() -> None:
    for name in Limits.__dataclass_fields__:
        assert f"`{name}`" in PAGE, name
    for number in ("think_steps", "query_steps", "memory_weight", "think_weight"):
        assert f"{getattr(Limits(), number):,}" in PAGE, number
    assert LIMITS["RLIMIT_AS"] >= 2 * Limits().mind_bytes
