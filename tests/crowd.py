"""Many players at once, each at a terminal of their own."""

import select
from collections.abc import Callable, Sequence
from time import monotonic

from tests.terminal import Terminal
from tests.waiting import PATIENCE

__all__ = ["Crowd"]

_LETTERS = "αβγδεζηθικλμνξοπρστυφχψω"  # that nothing but a key puts on the screen
_SETTLED = 20  # frames after which robots run, and none is still being compiled


class Crowd:
    def __init__(self, terminals: Sequence[Terminal]) -> None:
        self._terminals = terminals

    def wait_for(self, condition: Callable[[], object], patience: float = PATIENCE) -> None:
        deadline = monotonic() + patience
        while not condition():
            assert monotonic() < deadline, f"not within {patience} s"
            for terminal in select.select(self._terminals, [], [], 0.05)[0]:
                assert terminal.receive(), f"a game ended; its screen:\n{terminal.text}"

    def everybody_sees(self, text: str, patience: float = PATIENCE) -> None:
        self.wait_for(
            lambda: all(terminal.has_received(text) for terminal in self._terminals), patience
        )

    def play(self) -> None:
        """Let robots run at each terminal in which the game was opened for the first time.

        The sixth level is in the middle of the game, and its robots never come to rest under the
        program that it begins with.
        """
        for shown in ("skip the tour", "applied"):
            self.everybody_sees(shown, patience=180)
        self._type("\x1b")
        self.wait_for(
            lambda: not any("skip the tour" in t.text for t in self._terminals), patience=60
        )
        to_the_sixth = 5 * "\x1b[C" + "\r"
        for keys, shown in (("l", "started"), (to_the_sixth, "linseed"), (" ", "RUNNING")):
            self._type(keys)
            self.everybody_sees(shown, patience=60)
        begun = {terminal: terminal.frames for terminal in self._terminals}
        self.wait_for(lambda: all(t.frames > begun[t] + _SETTLED for t in begun), patience=120)

    def edit(self) -> None:
        self._type("2")
        self.everybody_sees("Leave", patience=60)

    def frames_per_second(self, seconds: float) -> list[float]:
        before, began = [terminal.frames for terminal in self._terminals], monotonic()
        self.wait_for(lambda: monotonic() - began > seconds)
        took = monotonic() - began
        return [
            (terminal.frames - start) / took
            for terminal, start in zip(self._terminals, before, strict=True)
        ]

    def help_milliseconds(self) -> list[float]:
        """Milliseconds from `?` to the help, opened once at each terminal, in turn."""
        found = []
        for terminal in self._terminals:
            found.append(self._milliseconds(terminal, "?", "Single"))
            terminal.send("\x1b")
        self.wait_for(lambda: not any("Type to filter" in t.text for t in self._terminals))
        return found

    def key_milliseconds(self, presses: int) -> list[float]:
        """Milliseconds from a letter typed into the editor to its being shown, in turn."""
        found = []
        for number in range(presses):
            letter = _LETTERS[number % len(_LETTERS)]
            terminal = self._terminals[number % len(self._terminals)]
            found.append(self._milliseconds(terminal, letter, letter))
        return found

    def _milliseconds(self, terminal: Terminal, key: str, shown: str) -> float:
        """Milliseconds from a key, pressed after a pause, to a text that it brings."""
        pause = monotonic()
        self.wait_for(lambda: monotonic() - pause > 0.1)
        since, began = terminal.traffic, monotonic()
        terminal.send(key)
        self.wait_for(lambda: terminal.has_received(shown, since))
        return 1000 * (monotonic() - began)

    def _type(self, keys: str) -> None:
        for terminal in self._terminals:
            terminal.send(keys)
