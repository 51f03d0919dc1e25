"""What the tests of levels share."""

from collections.abc import Iterator

import pytest

from logical_robots_tui.mind.compilation import stop_compiling


@pytest.fixture(scope="session", autouse=True)
def _no_compiler_left_behind() -> Iterator[None]:
    yield
    stop_compiling()
