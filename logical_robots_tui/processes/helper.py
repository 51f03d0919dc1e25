"""Helper processes: the game's own modules, isolated from what a player has written.

A helper gets no variables, home folder or user site-packages of the player, gives up what
it does not need, has a bound of processor time, and ends with the game in any case.
"""

from __future__ import annotations

import contextlib
import gc
import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

from logical_robots_tui.processes.lifeline import signal_when_closed


def collect_seldom() -> None:
    """Run the cycle collector a thirtieth as often as by default.

    The search for cycles took a tenth of the time, although reference counting frees nearly
    everything. Only commands call this, because they own their process.
    """
    gc.set_threshold(20_000, 20, 20)
    gc.enable()


def collect_later() -> None:
    """Disable the collector until ``collect_seldom``: objects loaded at the start stay alive."""
    gc.disable()


_M_ARENA_MAX = -8  # of glibc's malloc.h


def share_heap() -> None:
    """Let all threads allocate from one heap, before there is a second thread.

    By default glibc has a heap for each thread and gives little of it back: after six levels a game
    held 10 MB more. Elsewhere nothing happens.
    """
    _call_glibc("mallopt", _M_ARENA_MAX, 1)


def give_back_memory() -> None:
    """Free what only cycles hold, 5 MB of a level that was left. Takes some 0.1 s."""
    gc.collect()
    _call_glibc("malloc_trim", 0)


def _call_glibc(function: str, *arguments: int) -> None:
    import ctypes  # as numpy does

    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None)[function](*arguments)


COMPILE_PROCESS = "logical_robots_tui.compile_process"
_MODULES = (
    "logical_robots_tui.game.measuring",
    "logical_robots_tui.game.diagnosing",
    COMPILE_PROCESS,
)
_FLAGS = ("-I", "-S", "-B", "-X", "utf8")
_BEGIN = (
    "import sys; sys.path[:] = sys.argv.pop(1).split(':'); "
    "from importlib import import_module; import_module(sys.argv.pop(1)).main()"
)
_INHERITED_VARIABLES = {"DYLD_LIBRARY_PATH", "LD_LIBRARY_PATH"}
"""Environment variables without which Python itself may not start."""


class Helper(subprocess.Popen[bytes]):
    """A process that runs a module's `main`, with pipes to it, or raises OSError.

    It finds `arguments` in `sys.argv`, after the number of the lifeline.
    """

    def __init__(self, module: str, *arguments: str) -> None:
        read_end, self._lifeline = os.pipe()
        try:
            super().__init__(
                helper_command(module, str(read_end), *arguments),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                cwd="/",
                env=helper_environment(),
                pass_fds=[read_end],
                start_new_session=True,  # a keyboard interrupt is for the game alone
            )
        except BaseException:
            os.close(self._lifeline)
            raise
        finally:
            os.close(read_end)

    def end(self) -> None:
        """Kill the process, wait for its end, and close the pipes."""
        self.kill()
        self.wait()
        for pipe in (self.stdin, self.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):
                    pipe.close()
        if self._lifeline >= 0:
            os.close(self._lifeline)
            self._lifeline = -1


def is_helper(executable: object, words: object) -> bool:
    if executable != sys.executable or not isinstance(words, list) or len(words) < len(_FLAGS) + 6:
        return False
    module, lifeline, *arguments = words[len(_FLAGS) + 4 :]
    return module in _MODULES and words == helper_command(module, lifeline, *arguments)


def helper_environment() -> dict[str, str]:
    inherited = {name: os.environ[name] for name in _INHERITED_VARIABLES & os.environ.keys()}
    return {
        "HOME": "/",
        "LOGICAL_ROBOTS_CACHE_DIR": "",
        "OPENBLAS_NUM_THREADS": "1",
        "PYTHONNOUSERSITE": "1",
        **inherited,
    }


def helper_command(module: str, *arguments: str) -> list[str]:
    home = str(Path(__file__).resolve().parents[2])
    paths = dict.fromkeys([home, *(str(Path(p).resolve()) for p in sys.path if p)])
    return [sys.executable, *_FLAGS, "-c", _BEGIN, os.pathsep.join(paths), module, *arguments]


def begin(processor_seconds: int | None) -> list[str]:
    """Give up permissions, as a helper's first call, and return its arguments."""
    from logical_robots_tui.processes.audit import allow_only

    signal_when_closed(int(sys.argv.pop(1)), signal.SIGKILL)
    if processor_seconds is not None:
        limit(resource.RLIMIT_CPU, processor_seconds)
    limit(resource.RLIMIT_CORE, 0)
    limit(resource.RLIMIT_FSIZE, 0)
    allow_only(None)
    return sys.argv[1:]


def limit(kind: int, amount: int) -> None:
    """Lower a limit of this process permanently, on systems that have the limit."""
    with contextlib.suppress(OSError, ValueError):
        resource.setrlimit(kind, (amount, amount))
