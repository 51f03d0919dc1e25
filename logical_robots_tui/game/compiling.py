"""Compiling programs and questions off the event loop."""

from __future__ import annotations

import asyncio
import threading
from typing import TYPE_CHECKING

from logical_robots_tui.mind import ProgramError

if TYPE_CHECKING:
    from logical_robots_tui.mind import Program, Report

__all__ = ["compile_program", "mistake_in_question"]


async def compile_program(text: str, report: Report | None = None) -> Program:
    """Compile Logica text without blocking the event loop.

    Cancelling the call ends the compilation.

    Args:
        text: The program.
        report: Called on the event loop with the numbers of compiled predicates and of all.

    Raises:
        ProgramError: The program is wrong; the error holds diagnostics with line, column and hint.
    """
    stop = threading.Event()
    loop = asyncio.get_running_loop()

    def pass_on(done: int, of_all: int) -> None:
        if report is not None and not stop.is_set():
            loop.call_soon_threadsafe(report, done, of_all)

    def work() -> Program:
        # A mind will be needed next.
        from logical_robots_tui.mind import Mind, Program  # noqa: F401 - to load it

        return Program.compile(text, stop=stop, report=pass_on)

    try:
        return await asyncio.to_thread(work)
    except asyncio.CancelledError:
        stop.set()
        raise


async def mistake_in_question(program: Program, query: str) -> str:
    """Return what is wrong with a question about a program, in words, or "".

    Cancelling the call ends the compilation.

    Args:
        program: The program.
        query: A call, an expression, conditions, or whole rules of which the last is evaluated.
    """
    stop = threading.Event()
    try:
        await asyncio.to_thread(program.question, query, stop=stop)
    except ProgramError as error:
        first = error.diagnostics[0]
        return f"{first.message}. {first.hint}".strip()
    except asyncio.CancelledError:
        stop.set()
        raise
    return ""
