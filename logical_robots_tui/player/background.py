"""Background work of a player without a screen, as tasks of the event loop."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.player.session_state import Work


class Background:
    def __init__(self) -> None:
        self._tasks: dict[asyncio.Task[None], str] = {}

    def spawn(self, work: Work, group: str, *, exclusive: bool) -> None:
        """Start background work; exclusive work cancels the other work of its group."""
        for task, known in self._tasks.items():
            if exclusive and known == group:
                task.cancel()
        task = asyncio.ensure_future(work())
        self._tasks[task] = group
        task.add_done_callback(self._tasks.pop)

    async def done(self, *, but: str) -> None:
        """Wait until the work is done, but for groups that begin so; raise what it raises."""
        while tasks := [each for each, group in self._tasks.items() if not group.startswith(but)]:
            for task in (await asyncio.wait(tasks))[0]:
                if not task.cancelled():
                    task.result()

    async def close(self) -> None:
        """Cancel all work, and wait for its end."""
        tasks = [*self._tasks]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
