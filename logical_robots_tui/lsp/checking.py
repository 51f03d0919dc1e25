"""Checking open programs in the background: at once while they are typed, whole once they rest."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import TypeAlias

from logical_robots_tui.game import warnings_in
from logical_robots_tui.language.diagnostics import Diagnostic, ProgramError
from logical_robots_tui.lsp.documents import Document
from logical_robots_tui.lsp.levels import LevelFacts, unknown_level
from logical_robots_tui.mind import Program
from logical_robots_tui.mind.compilation import (
    CompileProgram,
    check_text,
    find_result,
    stop_compiling,
)

_Work: TypeAlias = Callable[[str], Program | None]

_RESTING = 0.3  # seconds without a change after which a program is compiled


class Checker:
    """Works on one version of a program at a time; of those that wait, on the latest."""

    def __init__(
        self,
        facts: Callable[[Document], LevelFacts],
        publish: Callable[[Document, tuple[Diagnostic, ...]], None],
    ) -> None:
        """`facts` are those of a document's level; `publish` drops what is out of date."""
        self._facts, self._publish = facts, publish
        self._changed: dict[str, Document] = {}
        self._checked: dict[str, Document] = {}
        self._wake = asyncio.Event()

    def submit(self, document: Document) -> None:
        self.withdraw(document.uri)
        self._changed[document.uri] = document
        self._wake.set()

    def withdraw(self, uri: str) -> None:
        for queue in (self._changed, self._checked):
            queue.pop(uri, None)

    async def run(self) -> None:
        """Check what is submitted until cancelled; then end the compile process."""
        # The compile process starts while the first program may be found in the cache.
        start = asyncio.create_task(asyncio.to_thread(_attempt, Program.check, ""))
        try:
            while True:
                try:
                    await asyncio.wait_for(self._wake.wait(), _RESTING if self._checked else None)
                except TimeoutError:
                    if self._checked:
                        await self._publish_result(self._checked.popitem()[1], Program.compile)
                self._wake.clear()
                while self._changed:
                    await self._check(self._changed.popitem()[1])
        finally:
            start.cancel()
            stop_compiling()

    async def _check(self, document: Document) -> None:
        for work in (_stored, Program.check):
            result = await self._publish_result(document, work)
            if isinstance(result, Program) and not result.statements:
                self._checked[document.uri] = document
            if result is not None:
                return

    async def _publish_result(
        self, document: Document, work: _Work
    ) -> Program | ProgramError | None:
        result = await asyncio.to_thread(_attempt, work, document.text)
        if isinstance(result, ProgramError) and result.is_unfinished:  # it may have been killed
            result = await asyncio.to_thread(_attempt, work, document.text)
        if isinstance(result, Program) and result.statements:
            document.program = result
        if result is not None:
            self._publish(document, _diagnostics(document, result, self._facts(document)))
        return result


def _stored(text: str) -> Program | None:
    check_text(text, None)
    return find_result(CompileProgram(text), Program)


def _attempt(work: _Work, text: str) -> Program | ProgramError | None:
    try:
        return work(text)
    except ProgramError as error:
        return error


def _diagnostics(
    document: Document, result: Program | ProgramError, facts: LevelFacts
) -> tuple[Diagnostic, ...]:
    if isinstance(result, ProgramError):
        return result.diagnostics
    return (*warnings_in(result, facts.names), *unknown_level(document.text, facts))
