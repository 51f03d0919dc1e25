"""The command's first process: forks the rest, and restores the terminal in any case.

A call into C can hold the interpreter for hours, so that no key and no signal ends the
game. The game's event loop counts up a shared byte; when it stands still, the game is
ended. This process loads nothing else, never touches the player's files, and passes job
control through.
"""

from __future__ import annotations

import mmap
import os
import signal
import sys
import termios
from collections.abc import Iterable
from contextlib import suppress
from time import clock_gettime, monotonic
from typing import TYPE_CHECKING, Any

from logical_robots_tui.processes.lifeline import (
    AWAY,
    BEATS,
    HEARTBEAT_BYTES,
    LEFT,
    MOST_IN_A_CALL,
    bound_calls,
    share_heartbeat,
    signal_when_closed,
)

if TYPE_CHECKING:
    from logical_robots_tui.processes.hosted import HostedGame

STUCK = 70  # as for any other bug: EX_SOFTWARE in sysexits.h

_MOST_COMPUTED = 15.0  # processor seconds since the last heartbeat
_MOST_IDLE = 60.0  # seconds without a heartbeat in which the game computed nothing at all
_LOOK_SECONDS = 0.5
_LOOKS_TO_INTERRUPT = 4  # without a heartbeat, from which on ^C is a signal
_INTERRUPTS, _INTERRUPT_SECONDS = 3, 2.0
_TO_END = 2.5  # seconds that a game has to end after it was asked to
_COMPUTED_TO_END = 1.5  # processor seconds that it may take for that
_STARVED_TO_END = 15.0  # seconds where other processes leave it no processor
_IDLE = 0.01  # processor seconds between two looks; threads that only wait take half of it

_ENDS = frozenset((signal.SIGHUP, signal.SIGTERM))
_AWAITED = frozenset((*_ENDS, signal.SIGCHLD, signal.SIGCONT, signal.SIGINT, signal.SIGTSTP))
_BLOCKED = frozenset((*_AWAITED, signal.SIGTTOU))  # or setting the terminal would stop it
_PASSED_ON = frozenset((signal.SIGWINCH,))  # to a game that has no controlling terminal

_PLAIN_SCREEN = (
    "\x1b[?2026l"  # no synchronized output
    "\x1b[?1000l\x1b[?1002l\x1b[?1003l\x1b[?1006l\x1b[?1015l\x1b[?1016l"  # no mouse
    "\x1b[?1004l\x1b[?2004l\x1b[?2048l"  # no focus, pastes or sizes as sequences
    "{keys}\x1b[?1049l\x1b[0m\x1b[?7h\x1b[?25h"  # the shell's screen, colours, wrapping and cursor
)
_PLAIN_KEYS = "\x1b[<u"  # which a shell may have, too, so only after a screen was opened
_EXIT = b'{"type": "exit"}'
_FAULTS = {"SIGSEGV", "SIGBUS", "SIGILL", "SIGFPE", "SIGABRT", "SIGTRAP", "SIGSYS"}
_KEPT = "Unsaved text is kept. Start the game again to go on."
_ENDLESS_CALL = (
    f"The program computed for {MOST_IN_A_CALL:g} s in a single call, past all limits, "
    "and was ended."
)

_THINKING = frozenset(
    ["run", "trace", "query", "when", "why", "origin", "diagnose", "learn", "replay"]
)
"""Commands in whose own process programs think."""

_SENT_TO_ONE = 0  # at most this is the code of a signal that no terminal has sent to all


def main() -> int:
    """Run the command, supervising a game on screen; return the status or raise SystemExit."""
    words = sys.argv[1:]
    status = None
    if hasattr(signal, "sigtimedwait"):
        if _opens_screen(words):
            status = _supervise(words)
        elif words and words[0] in _THINKING:
            status = _run_bounded()
    if status is not None:
        return status
    from logical_robots_tui.cli.main import main as run

    return run()


def _opens_screen(words: list[str]) -> bool:
    if {"--plain", "-h", "--help", "--version"} & {*words}:
        return False
    if not os.isatty(0) and not os.environ.get("TEXTUAL_DRIVER"):
        return False
    if os.environ.get("SSH_ORIGINAL_COMMAND") == "plain":
        return False
    return words[:2] == ["replay", "play"] or not words or words[0].startswith(("-", "play"))


def _supervise(words: list[str]) -> int | None:
    """Fork, here or in a host; return None in the game, and its exit status in this process."""
    terminal: list[Any] | None = None
    with suppress(termios.error):
        terminal = termios.tcgetattr(0)  # before the game can change it
    if _is_restricted() and (folder := _host_folder(words)):
        from logical_robots_tui.processes.hosted import request_game

        previous_mask = signal.pthread_sigmask(signal.SIG_BLOCK, _BLOCKED | _PASSED_ON)
        encodings = [str(stream.encoding) for stream in (sys.stdin, sys.stdout, sys.stderr)]
        hosted = request_game(folder, words, encodings)
        if hosted is not None:
            return _Supervisor(hosted, hosted.heartbeat, terminal).run()
        signal.pthread_sigmask(signal.SIG_SETMASK, previous_mask)
    shared = mmap.mmap(-1, HEARTBEAT_BYTES)
    game = _fork(_BLOCKED, signal.SIGHUP)
    if game == 0:
        share_heartbeat(shared)
        return None
    return _Supervisor(_ForkedGame(game), shared, terminal).run()


def _host_folder(words: list[str]) -> str:
    """Return the value of --host, by default of its variable, or ""."""
    for word, value in zip(words, [*words[1:], ""], strict=True):
        name, equals, text = word.partition("=")
        if name == "--host":
            return text if equals else value
    return os.environ.get("LOGICAL_ROBOTS_HOST", "")


def _fork(blocked: Iterable[signal.Signals], end: signal.Signals) -> int:
    """Fork, and block signals in this process.

    Returns:
        The child's number; 0 in the child, which gets the signal `end` when this process is gone.
    """
    lifeline, write_end = os.pipe()
    previous_mask = signal.pthread_sigmask(signal.SIG_BLOCK, blocked)
    child = os.fork()
    if child == 0:
        os.close(write_end)
        signal_when_closed(lifeline, end)
        signal.pthread_sigmask(signal.SIG_SETMASK, previous_mask)
    else:
        os.close(lifeline)
    return child


def _run_bounded() -> int | None:
    """Fork; return None in the command, and its exit status in this process."""
    signals = {*_ENDS, signal.SIGCHLD, signal.SIGINT}
    command = _fork(signals, signal.SIGTERM)
    if command == 0:
        bound_calls()
        return None
    while True:
        event = signal.sigwaitinfo(signals)
        if event.si_signo != signal.SIGCHLD:
            if event.si_code <= _SENT_TO_ONE:
                os.kill(command, event.si_signo)
            continue
        pid, status = os.waitpid(command, os.WNOHANG)
        if not pid:  # it was only stopped or continued
            continue
        code = os.waitstatus_to_exitcode(status)
        if code == -signal.SIGPROF:
            words = " ".join(sys.argv[1:])
            os.write(2, f"logical-robots: {words}: {_ENDLESS_CALL}\n".encode())
            return STUCK
        return code if code >= 0 else 128 - code


class _ForkedGame:
    """A game that this process has forked."""

    def __init__(self, pid: int) -> None:
        self.pid = pid

    def status(self) -> int | None:
        """Return its exit status, None while it runs; suspend this process together with it."""
        pid, status = os.waitpid(self.pid, os.WNOHANG | os.WUNTRACED)
        if pid == 0:
            return None
        if os.WIFSTOPPED(status):
            os.kill(os.getpid(), signal.SIGSTOP)
            return None
        return os.waitstatus_to_exitcode(status)

    def wait(self) -> int:
        return os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])


class _Supervisor:
    """Waits for a game and for signals, and monitors the game's heartbeat."""

    def __init__(
        self, game: _ForkedGame | HostedGame, shared: mmap.mmap, terminal: list[Any] | None
    ) -> None:
        self._game = game
        self._awaited = _AWAITED | (_PASSED_ON if not isinstance(game, _ForkedGame) else set())
        self._shared = shared
        self._terminal = terminal
        self._raw: list[Any] | None = None  # the game's settings while ^C is a signal
        self._interrupts: list[float] = []
        self._has_begun = False
        self._beats = 0
        self._restart_timeout()

    def run(self) -> int:
        while True:
            event = signal.sigtimedwait(self._awaited, _LOOK_SECONDS)
            number = 0 if event is None else event.si_signo
            if number == signal.SIGCHLD or number == 0:
                status = self._game.status()
                if status is not None:
                    return self._exit_status(status)
            if number in _ENDS:
                self._end(signal.Signals(number))
                self._restore_terminal()
                return 128 + number
            if number == signal.SIGTSTP or number in _PASSED_ON:
                self._send(number)
            if number == signal.SIGCONT:
                self._continue()
            if number == signal.SIGINT and self._is_interrupted():
                return self._exit_status(self._end(signal.SIGKILL), "was stuck and was interrupted")
            if number == 0 and self._is_stuck():
                return self._exit_status(self._end(signal.SIGTERM), "was stuck and was ended")

    def _continue(self) -> None:
        """Continue the game, unless a shell continued both: it would take the terminal twice."""
        if _state(self._game.pid) == "T":
            self._send(signal.SIGCONT)
        self._restart_timeout()

    def _restart_timeout(self) -> None:
        """Restart the timeout: the game has shown that it is alive, or was suspended."""
        self._looks = self._idle_looks = 0
        self._computed = self._last_computed = _processor_seconds(self._game.pid)
        if self._raw is not None:
            self._set_terminal(self._raw)
            self._raw = None

    def _is_stuck(self) -> bool:
        beats, is_away = self._shared[BEATS], self._shared[AWAY]
        if is_away or beats != self._beats or not self._has_begun:
            self._beats, self._has_begun = beats, beats != 0
            self._restart_timeout()
            return False
        seconds = _processor_seconds(self._game.pid)
        self._looks += 1
        self._idle_looks = self._idle_looks + 1 if seconds - self._last_computed < _IDLE else 0
        self._last_computed = seconds
        if self._looks == _LOOKS_TO_INTERRUPT and not _is_restricted():
            self._let_interrupt()
        return (
            seconds - self._computed > _MOST_COMPUTED
            or self._idle_looks * _LOOK_SECONDS > _MOST_IDLE
        )

    def _let_interrupt(self) -> None:
        """Turn ^C into a signal, because the game could not read it as a key."""
        with suppress(termios.error):
            self._raw = termios.tcgetattr(0)
            interruptible = termios.tcgetattr(0)
            interruptible[3] |= termios.ISIG
            for key in (termios.VSUSP, termios.VQUIT):
                interruptible[6][key] = b"\0"
            self._set_terminal(interruptible)

    def _is_interrupted(self) -> bool:
        if self._raw is None:  # not from the keyboard, or the game is not there yet
            self._send(signal.SIGTERM if self._has_begun else signal.SIGINT)
            return False
        time = monotonic()
        recent = [press for press in self._interrupts if time - press < _INTERRUPT_SECONDS]
        self._interrupts = [*recent, time]
        return len(self._interrupts) >= _INTERRUPTS

    def _end(self, number: signal.Signals) -> int:
        """Ask the game to end, then kill it; return its exit status."""
        self._send(number)
        if _state(self._game.pid) in ("T", ""):
            self._send(signal.SIGCONT)
        start, computed = monotonic(), _processor_seconds(self._game.pid)
        while True:
            status = self._game.status()
            if status is not None:
                return status
            waited = monotonic() - start
            if _processor_seconds(self._game.pid) - computed > _COMPUTED_TO_END:
                break
            if waited > _STARVED_TO_END or (waited > _TO_END and not self._is_starved()):
                break
            signal.sigtimedwait({signal.SIGCHLD}, _LOOK_SECONDS / 5)
        self._send(signal.SIGKILL)
        return self._game.wait()

    def _is_starved(self) -> bool:
        threads: list[str] = []
        with suppress(OSError):
            threads = os.listdir(f"/proc/{self._game.pid}/task")  # noqa: PTH208 - pathlib takes a while to load
        return any(_state(int(thread)) in ("R", "D") for thread in threads)

    def _send(self, number: int) -> None:
        with suppress(ProcessLookupError):
            os.kill(self._game.pid, number)

    def _exit_status(self, status: int, reason: str = "") -> int:
        """Return the command's exit status; print the reason if the game did not end by itself."""
        if status >= 0 and not reason:
            return status
        self._restore_terminal()
        if not reason:
            name = signal.Signals(-status).name
            reason = f"was ended by {name}"
            if name == "SIGKILL":
                reason += ", perhaps because memory ran out"
            elif name in _FAULTS:
                reason += ", a fault in compiled code"
        with suppress(OSError):
            os.write(2, f"logical-robots: The game {reason}. {_KEPT}\n".encode())
        return STUCK if "stuck" in reason else 128 - status

    def _restore_terminal(self) -> None:
        """Leave the game's screen, restore the terminal settings, and discard pending input."""
        if self._terminal is None:
            self._close_web_page()
            return
        is_away = self._shared[AWAY]
        with suppress(termios.error, OSError):
            if is_away or not self._shared[LEFT]:
                # A write would block where nobody reads what the game has drawn.
                termios.tcflush(1, termios.TCOFLUSH)
                keys = _PLAIN_KEYS if self._shared[BEATS] and not is_away else ""
                os.write(1, _PLAIN_SCREEN.format(keys=keys).encode())
        self._set_terminal(self._terminal)
        with suppress(termios.error):
            termios.tcflush(0, termios.TCIFLUSH)

    def _close_web_page(self) -> None:
        """Tell a web server, in Textual's protocol, that the game has ended without a word."""
        if os.environ.get("TEXTUAL_DRIVER") and self._shared[BEATS] and not self._shared[LEFT]:
            with suppress(OSError):
                os.set_blocking(1, False)  # nobody may read
                os.write(1, b"M" + len(_EXIT).to_bytes(4, "big") + _EXIT)

    def _set_terminal(self, settings: list[Any]) -> None:
        with suppress(termios.error):
            termios.tcsetattr(0, termios.TCSANOW, settings)


def _state(process: int) -> str:
    with suppress(OSError), open(f"/proc/{process}/stat") as file:  # noqa: PTH123 - pathlib takes a while to load
        return file.read().rpartition(")")[2].split()[0]
    return ""


def _processor_seconds(process: int) -> float:
    """Return the processor seconds of a process, over all its threads."""
    try:
        return clock_gettime(~process << 3 | 2)  # CPUCLOCK_SCHED of a process, in Linux
    except OSError:
        return 0.0


def _is_restricted() -> bool:
    is_set = os.environ.get("LOGICAL_ROBOTS_RESTRICTED", "") not in ("", "0")
    return is_set or "--restricted" in sys.argv
