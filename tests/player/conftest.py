"""A player without a screen, in time that passes only while nothing else happens."""

from tests.tui.conftest import _no_trials
from tests.virtual_time import VirtualLoop

__all__ = ["_no_trials"]


def pytest_asyncio_loop_factories() -> dict[str, type[VirtualLoop]]:
    return {"virtual": VirtualLoop}
