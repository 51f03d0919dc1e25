"""The interface of a game in lines: messages, questions and the program's text."""

from __future__ import annotations

import asyncio
import re
import sys
from collections.abc import Awaitable, Callable, Sequence
from typing import TypeVar

from logical_robots_tui.cli.command import say
from logical_robots_tui.player.recovery import Offers
from logical_robots_tui.player.session_state import Background, Ui

T = TypeVar("T")


def with_words(text: str) -> str:
    """Spell out that commands in braces are typed."""
    return re.sub(r"\{(\w+)\}", r"type \1", text)


class LineUi(Background, Ui, Offers):
    """Questions are answered by the next line; any other line is a command, and no answer."""

    def __init__(self) -> None:
        super().__init__()
        self._unread: list[str] = []

    def tell(self, message: str) -> None:
        say(message)

    warn = tell

    async def read(self) -> str:
        return self._unread.pop() if self._unread else await asyncio.to_thread(sys.stdin.readline)

    async def choose(
        self, title: str, question: str, answers: Sequence[tuple[str, str]]
    ) -> str | None:
        choices = "; ".join(f"{name}: {words}" for name, words in answers)
        say(f"{title}. {question}", f"Type one of these. {choices}.")
        line = await self.read()
        if line.strip().lower() in dict(answers):
            return line.strip().lower()
        self._unread.append(line)
        return None

    async def at_hand(self, find: Callable[[], Awaitable[T]]) -> T:
        return await find()

    async def ask(
        self, title: str, question: str, answers: Sequence[tuple[str, str]], *, text: str = ""
    ) -> str | None:
        while (answer := await self.choose(title, question, answers)) == "show":
            say(text)
        return answer


class LineText:
    """The program's text, which is edited elsewhere."""

    text = ""

    def load(self, text: str) -> None:
        self.text = text

    put = load
