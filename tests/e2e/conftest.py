"""The installed game in a real tmux."""

import re
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import pytest

from tests.e2e.tmux import Tmux
from tests.installed import Installed
from tests.short import AHEAD, LEVEL

TYPED = "# an idea worth keeping"


@dataclass(frozen=True)
class Player:
    """Somebody at a terminal with the game, a level ``short.toml`` and a program ``ahead.l``."""

    tmux: Tmux
    command: Path
    folder: Path

    def play(self, *arguments: object) -> None:
        self.tmux.start(self.command, *arguments, "--data-dir", self.folder / "data")

    def play_short_way(self) -> None:
        self.play("play", "short.toml", "ahead.l")
        self.tmux.wait_for("tick 0", "· applied")

    def wait_for_tick(self, tick: int) -> str:
        return self.tmux.wait_until(lambda screen: tick_on(screen) == tick, f"tick {tick}")

    def type_an_idea(self) -> None:
        self.tmux.press("2")
        self.tmux.type(TYPED, sees=TYPED)
        self.tmux.press("Enter")

    def is_offered_the_idea(self, *others: str) -> None:
        """Start the game again, and accept the text that is offered first, and other things."""
        self.play("play", "short.toml", "ahead.l")
        for offer in ("unsaved", *others):
            self.tmux.wait_for(offer, "Yes, continue")
            self.tmux.press("Enter", sees_no=offer)
        self.tmux.press("2", sees=TYPED)


def tick_on(screen: str) -> int:
    found = re.search(r"\btick (\d+)", screen)
    return int(found[1]) if found else -1


Seat: TypeAlias = Callable[..., AbstractContextManager[Player]]


@pytest.fixture
def seat(installed: Installed, tmp_path: Path) -> Seat:
    """Gives a player a terminal of some size; the same player may sit down again."""
    (tmp_path / "short.toml").write_text(LEVEL)
    (tmp_path / "ahead.l").write_text(AHEAD)

    @contextmanager
    def sit_down(columns: int = 80, lines: int = 24) -> Iterator[Player]:
        with Tmux(tmp_path, columns, lines) as tmux:
            yield Player(tmux, installed.command, tmp_path)

    return sit_down


@pytest.fixture
def player(seat: Seat) -> Iterator[Player]:
    with seat() as player:
        yield player
