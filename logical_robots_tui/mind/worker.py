"""The compile process: a program per line in, its compiled form per line out.

It ends when its standard input is closed, even in the middle of a program.
"""

from __future__ import annotations

import json
import os
import queue
import resource
import sys
import threading
from dataclasses import asdict
from typing import IO

__all__ = ["main"]

_ADDRESS_SPACE = 2 * 1024**3  # bytes; a program that needs more to compile is refused


def main() -> None:
    """Serve compile requests until standard input ends."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    # The package prints; nothing of that may reach the player's screen or the answers.
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)
    os.dup2(silence, 2)
    resource.setrlimit(resource.RLIMIT_AS, (_ADDRESS_SPACE, _ADDRESS_SPACE))
    requests: queue.Queue[str] = queue.Queue()
    threading.Thread(target=_read, args=(sys.stdin, requests), daemon=True).start()
    while True:
        answer = _answer(json.loads(requests.get()))
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


def _read(lines: IO[str], requests: queue.Queue[str]) -> None:
    for line in lines:
        requests.put(line)
    os._exit(0)


def _answer(text: str) -> dict[str, object]:
    from logical_robots_tui.mind.compiler import compile_text
    from logical_robots_tui.mind.diagnostics import Diagnostic, ProgramError

    try:
        program = compile_text(text)
    except ProgramError as error:
        return {"diagnostics": [asdict(d) for d in error.diagnostics]}
    except MemoryError:
        too_large = Diagnostic(1, 1, "the program needs too much memory to compile", "Shorten it.")
        return {"diagnostics": [asdict(too_large)]}
    except RecursionError:
        too_deep = Diagnostic(
            1, 1, "the program is nested too deeply", "Give parts of it names of their own."
        )
        return {"diagnostics": [asdict(too_deep)]}
    return {"program": asdict(program)}


if __name__ == "__main__":
    main()
