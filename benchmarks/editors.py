"""A player's own editor: time to what is wrong, and the memory of the language server."""

from __future__ import annotations

import asyncio
import os
import sys
import tempfile
from time import perf_counter
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_most, summed_up
from logical_robots_tui.caching import FOLDER_VARIABLE
from logical_robots_tui.game import load_program
from tests.lsp.editor import Editor
from tests.memory_use import memory_share
from tests.processes import run_command

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["editors"]

SMALL, LONG = "first-steps", "distributed-mapping"


def editors(effort: Effort) -> Iterator[Measurement]:
    """Measure milliseconds to diagnostics over the protocol, and megabytes of all processes."""
    with tempfile.TemporaryDirectory() as cache:
        words = (sys.executable, "-m", "logical_robots_tui", "check", LONG)
        run_command(words, env=os.environ | {FOLDER_VARIABLE: cache}, check=True)
        runs = [asyncio.run(_edit(cache, effort)) for _ in range(effort.repeats)]
    opened, small, long, memory = zip(*runs, strict=True)
    milliseconds = "diagnostics in an editor"
    yield summed_up(
        milliseconds, f"opening {LONG}, warm", "ms", opened, target=at_most(400), value=min
    )
    for name, times, target in ((SMALL, small, at_most(50)), (LONG, long, None)):
        keys = [time for run in times for time in run]
        yield summed_up(milliseconds, f"a key in {name}", "ms", keys, target=target)
    yield summed_up("memory of the language server", LONG, "MB", memory, target=at_most(90))


async def _edit(cache: str, effort: Effort) -> tuple[float, list[float], list[float], float]:
    """Return the times to open the long program and of keys in both, and the memory."""
    editor = Editor()
    await editor.start(**{FOLDER_VARIABLE: cache})
    text = load_program(LONG).text
    began = perf_counter()
    editor.open(text, "/nowhere/program.l")
    await editor.published()
    opened = 1000 * (perf_counter() - began)
    keys = {name: await _type(editor, load_program(name).text, effort) for name in (SMALL, LONG)}
    memory = sum(map(memory_share, (editor.pid, *editor.children()))) / 1e6
    await editor.stop()
    return opened, keys[SMALL], keys[LONG], memory


async def _type(editor: Editor, text: str, effort: Effort) -> list[float]:
    times = []
    for number in range(effort.repeats + 1):
        began = perf_counter()
        editor.type(f"{text}\nNew{id(editor)}(x) :- x == {number};")
        await editor.published()
        times.append(1000 * (perf_counter() - began))
    return times[1:]
