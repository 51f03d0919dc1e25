"""A private tmux with a shell in it, driven as a player would."""

import os
import shlex
import shutil
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Self

from tests.installed import clean_environment
from tests.processes import is_running
from tests.waiting import PATIENCE, until

__all__ = ["PROMPT", "Tmux", "place_of"]

PROMPT = "at-the-shell$ "

_SETTINGS = """\
set -g default-terminal "tmux-256color"
set -ga terminal-features ",*:RGB"
set -g status off
set -g escape-time 10
set -g mouse on
"""


class Tmux:
    """A tmux server of its own with one window, in which a shell waits in a folder."""

    def __init__(self, folder: Path, columns: int = 80, lines: int = 24) -> None:
        self.folder = folder
        self._size = (columns, lines)
        self._pid_file = folder / "pid"

    def __enter__(self) -> Self:
        assert shutil.which("tmux"), "these tests drive a real tmux: please install it"
        settings = self.folder / "tmux.conf"
        settings.write_text(_SETTINGS)
        columns, lines = self._size
        greeting = self.folder / "shrc"
        greeting.write_text(f"PS1='{PROMPT}'\n")
        environment = {**clean_environment(), "ENV": str(greeting), "HOME": str(self.folder)}
        environment.pop("TMUX", None)
        subprocess.run(
            [
                *("tmux", "-S", str(self.folder / "socket"), "-f", str(settings)),
                *("new-session", "-d", "-x", str(columns), "-y", str(lines), "sh"),
            ],
            cwd=self.folder,
            env=environment,
            check=True,
            timeout=PATIENCE,
        )
        self.wait_for(PROMPT.strip())
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the server, as when the connection breaks; what runs in it is hung up on."""
        self._tmux("kill-server", check=False)

    def start(self, *command: object) -> None:
        """Type a command at the prompt; `pid` is known when it runs."""
        self._pid_file.unlink(missing_ok=True)
        typed = shlex.join(str(word) for word in command)
        script = f"echo $$ > {shlex.quote(str(self._pid_file))}; exec {typed}"
        self.type(f"sh -c {shlex.quote(script)}")
        self.press("Enter")
        until(lambda: self._pid_file.exists() and self._pid_file.read_text().strip())

    @property
    def pid(self) -> int:
        return int(self._pid_file.read_text())

    @property
    def game(self) -> int:
        (found,) = Path(f"/proc/{self.pid}/task/{self.pid}/children").read_text().split()
        return int(found)

    @property
    def is_running(self) -> bool:
        return is_running(self.pid)

    def hang_up(self) -> None:
        os.kill(self.pid, signal.SIGHUP)

    def press(self, *keys: str, sees: str = "", sees_no: str | None = None) -> None:
        """Press keys by tmux's names for them, and wait for one text and for the end of another."""
        self._tmux("send-keys", *keys)
        if sees:
            self.wait_for(sees)
        if sees_no is not None:
            self.wait_for_no(sees_no)

    def type(self, text: str, *, sees: str = "", sees_no: str | None = None) -> None:
        self.press("-l", text, sees=sees, sees_no=sees_no)

    def mend(self) -> None:
        """Make a terminal usable that a process left in disorder, as a player would."""
        self.press("C-j")
        self.type("stty sane; tput rmcup; clear")
        self.press("C-j")
        self.wait_until(lambda screen: screen.strip() == PROMPT.strip(), "an empty screen")

    def paste(self, text: str) -> None:
        self._tmux("load-buffer", "-", text=text)
        self._tmux("paste-buffer", "-p")

    def click(self, text: str) -> None:
        x, y = place_of(text, self.wait_for(text))
        self.type(f"\x1b[<0;{x};{y}M\x1b[<0;{x};{y}m")

    def drag(self, start: tuple[int, int], end: tuple[int, int]) -> None:
        """Drag with the left button from one place to another, each a column and a line from 1."""
        self.type(f"\x1b[<0;{start[0]};{start[1]}M\x1b[<32;{end[0]};{end[1]}M")
        self.type(f"\x1b[<0;{end[0]};{end[1]}m")

    def resize(self, columns: int, lines: int) -> None:
        self._tmux("resize-window", "-x", str(columns), "-y", str(lines))

    @property
    def screen(self) -> str:
        return self._tmux("capture-pane", "-p")

    def wait_for(self, *texts: str) -> str:
        return self.wait_until(
            lambda screen: all(text in screen for text in texts),
            f"{' and '.join(map(repr, texts))} on the screen",
        )

    def wait_for_no(self, text: str) -> str:
        return self.wait_until(lambda screen: text not in screen, f"no {text!r}")

    def wait_until(self, condition: Callable[[str], object], what: str = "that") -> str:
        screen = ""

        def holds() -> object:
            nonlocal screen
            screen = self.screen
            return condition(screen)

        until(holds, lambda: f"{what}; instead:\n{screen}")
        return screen

    def _tmux(self, *arguments: str, text: str | None = None, check: bool = True) -> str:
        done = subprocess.run(
            ["tmux", "-S", str(self.folder / "socket"), *arguments],
            input=text,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
            timeout=PATIENCE,
        )
        assert not check or done.returncode == 0, f"tmux {arguments[0]}: {done.stdout}"
        return done.stdout


def place_of(text: str, screen: str) -> tuple[int, int]:
    """The column and the line, from 1, of the first place where a text stands."""
    y, line = next((y, line) for y, line in enumerate(screen.splitlines(), 1) if text in line)
    return line.index(text) + 1, y
