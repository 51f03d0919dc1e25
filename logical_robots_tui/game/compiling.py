"""Compiling off the event loop."""

from __future__ import annotations

import asyncio
import threading

from logical_robots_tui.mind import Program

__all__ = ["compile_program"]


async def compile_program(text: str) -> Program:
    """Compile Logica text without holding up the event loop.

    Cancelling the call ends the compilation.

    Raises:
        ProgramError: The program is wrong; holds diagnostics with line, column and hint.
    """
    stop = threading.Event()
    try:
        return await asyncio.to_thread(Program.compile, text, stop=stop)
    except asyncio.CancelledError:
        stop.set()
        raise
