"""Helpers that no game has: one attempts what it must not, one never returns."""

import json
import os
import resource
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from logical_robots_tui.processes.helper import begin


def main() -> None:
    what, *arguments = begin(processor_seconds=1 if "bounded" in sys.argv else 600)
    if what == "attempt":
        say(json.dumps(attempts(Path(arguments[0]))))
    else:
        say("begun")
        if what == "in C":
            say(str(10**10**9))
        while True:
            pass


def say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def attempts(folder: Path) -> dict[str, str]:
    found = {
        "isolated": str(bool(sys.flags.isolated and sys.flags.no_site)),
        "home": str(Path.home()),
        "folder": str(Path.cwd()),
        "secret": os.environ.get("SOME_SECRET", ""),
        "seconds": str(resource.getrlimit(resource.RLIMIT_CPU)[0]),
    }

    def attempt(name: str, work: Callable[[], object]) -> None:
        try:
            work()
            found[name] = "done"
        except OSError as error:
            found[name] = type(error).__name__

    attempt("read the game", lambda: (Path(__file__).with_name("__init__.py")).read_text())
    attempt("read", lambda: (folder / "secret.l").read_text())
    attempt("list", lambda: list(folder.iterdir()))
    attempt("write", lambda: (folder / "more.l").write_text("x"))
    attempt("run", lambda: subprocess.run(["true"], check=False, timeout=60))
    attempt("call", lambda: socket.create_connection(("127.0.0.1", 9)))
    return found
