"""Whatever is typed, pasted or opened, the event loop soon takes the next key."""

import gc
from asyncio import events as loop_events
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import product
from pathlib import Path
from time import thread_time

import pytest
from textual import events

from tests.growth import few_of
from tests.hostile_text import PROGRAMS, SIGNS
from tests.mind.hostile.bounds import bounded_memory
from tests.tui.conftest import key_event, opened
from tests.tui.program.conftest import writing
from tests.virtual_time import virtual_loop

pytestmark = pytest.mark.usefixtures("drawn_at_once")

MOST = 200_000  # characters
LONGEST_STEP = 0.05
"""Seconds of the processor that the loop may take for one callback."""

RENUMBERED = 100_000
"""Lines from which on a new one may take twice as long: Textual renumbers all below it."""

LONGEST_OPENING = 3.0
"""Seconds for the whole text at once: Textual wraps all its lines, twice if it has to scroll."""

LONGEST_LINE = 2_000
"""Longer ones take longer: of a line that wraps, Textual makes all rows anew to draw each."""

ATTEMPTS = 3
TEXTS = {name: family(MOST)[:MOST] for name, family in (SIGNS | PROGRAMS).items()}
IN_LINES = [name for name, text in TEXTS.items() if max(map(len, text.split("\n"))) < LONGEST_LINE]
ONE_LINE = [name for name in TEXTS if name not in IN_LINES]
LINES = ["ask", "find", "help", "palette", "level", "program", "search_ticks", "save_as"]
CHUNKS = 12


@contextmanager
def callbacks() -> Iterator[list[float]]:
    """Yield the processor time of each callback of the loop, in seconds, as they are run."""
    run, times = loop_events.Handle._run, list[float]()

    def timed(handle: loop_events.Handle) -> None:
        began = thread_time()
        run(handle)
        times.append(thread_time() - began)

    gc.collect()
    gc.disable()  # what it takes depends on all tests before
    loop_events.Handle._run = timed  # type: ignore[assignment, method-assign] # restored below
    try:
        yield times
    finally:
        loop_events.Handle._run = run  # type: ignore[method-assign] # as it was
        gc.enable()


@pytest.mark.parametrize("name", few_of((name,) for name in reversed(IN_LINES)))
async def test_a_key_in_a_long_program_takes_no_time(name: str) -> None:
    text = TEXTS[name][:-10]
    most = LONGEST_STEP * (1 + (text.count("\n") > RENUMBERED))
    for _ in range(ATTEMPTS):
        async with writing() as desk:
            with callbacks() as opening:
                desk.app.post_message(events.Paste(text))
                await virtual_loop().settled()
            await desk.type("ctrl+home")
            with callbacks() as steps:
                for key in ("x", "A", "enter", "up", "ctrl+end", "y", "tab", "pageup", "ctrl+z"):
                    await desk.type(key)
        if max(steps) < most:
            break
    assert max(steps) < most
    assert max(opening) < LONGEST_OPENING


@pytest.mark.slow
@pytest.mark.parametrize(("command", "chunk"), few_of(product(LINES, range(CHUNKS))))
async def test_a_long_text_in_a_line_takes_no_time(
    command: str, chunk: int, data_dir: Path
) -> None:
    async with opened(data_dir, ready=True) as game:
        for name in [*TEXTS][chunk::CHUNKS]:
            times = []
            for _ in range(ATTEMPTS):
                await game.command(command)
                await game.later(1.0)
                with callbacks() as steps:
                    game.app.post_message(events.Paste(TEXTS[name]))
                    for key in ("x", "home", "y", "backspace", "enter", "escape"):
                        game.app.post_message(key_event(key))
                        await game.handled()
                    await game.later(1.0)
                times.append(max(steps))
                while game.app.screen is not game.main:
                    await game.press("escape")
                    await game.later(1.0)
                if times[-1] < LONGEST_STEP:
                    break
            assert min(times) < LONGEST_STEP, name


@pytest.mark.parametrize("name", few_of((name,) for name in TEXTS))
async def test_the_longest_program_opens_within_its_memory(name: str) -> None:
    async with writing("A(1);\n") as desk:
        with bounded_memory(200 * 1024**2):  # all of the game takes a hundred before
            desk.editor.load_text(TEXTS[name])
            await virtual_loop().settled()
            desk.screen()
