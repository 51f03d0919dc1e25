"""Autosave: writes edited work to a draft soon after every change, and before the game ends."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeVar

from logical_robots_tui.player.drafts import Draft, Drafts, Key
from logical_robots_tui.wording import clip, one_line

if TYPE_CHECKING:
    from logical_robots_tui.game import Source
    from logical_robots_tui.player.session_state import Ui

State = TypeVar("State")


class UnsavedText(NamedTuple):
    """What is in the editor, and the key of its level."""

    source: Source
    text: str
    level: str


class Autosave(Generic[State]):
    """Keeps edited work safe; a hangup loses at most `delay` seconds of changes.

    `state` returns an immutable state, of which `draft`, in a thread, makes a draft or names
    one that is no longer needed.
    """

    def __init__(
        self,
        drafts: Drafts,
        *,
        delay: float = 0.25,
        state: Callable[[], State],
        draft: Callable[[State], Draft | Key],
        failed: Callable[[str], None],
        what: str,
    ) -> None:
        self._drafts = drafts
        self._delay = delay
        self._state = state
        self._draft = draft
        self._failed = failed
        self._what = what
        self._has_failed = False
        self._written: State | None = None
        self._written_turn = 0
        self._pending: asyncio.Task[None] | None = None

    def edited(self) -> None:
        """Write a draft soon, or delete it if nothing is unsaved any more."""
        if self._pending is None or self._pending.done():
            self._pending = asyncio.create_task(self._keep_soon())

    def flush(self) -> None:
        """Write the draft now. Safe in a signal handler; never raises."""
        try:
            self._keep(self._state(), self._drafts.next_turn())
        except OSError as error:
            self.report(error)

    def stop(self) -> None:
        if self._pending is not None:
            self._pending.cancel()
        self.flush()

    def drop(self, key: Key) -> None:
        if self._pending is not None:
            self._pending.cancel()
        self._written = None
        self._drafts.drop(key)

    def report(self, error: OSError) -> None:
        if not self._has_failed:
            self._has_failed = True
            reason = error.strerror or str(error)
            self._failed(f"{self._what} can't be kept on disk: {reason}. Save it elsewhere.")

    async def _keep_soon(self) -> None:
        state = self._written
        while self._state() != state:
            await asyncio.sleep(self._delay)
            state, turn = self._state(), self._drafts.next_turn()
            if state == self._written:
                return
            self._written = None  # until the thread is done, what is on disk is uncertain
            try:
                await asyncio.to_thread(self._keep, state, turn)
            except OSError as error:
                self.report(error)
                return

    def _keep(self, state: State, turn: int) -> None:
        if state == self._written:
            return
        draft = self._draft(state)
        if isinstance(draft, Draft):
            self._drafts.keep(draft, turn)
        else:
            self._drafts.drop(draft, turn)
        if turn > self._written_turn:
            self._written, self._written_turn = state, turn


def program_draft(unsaved: UnsavedText) -> Draft | Key:
    """Return a program's draft, or only its key if the text equals that of the file."""
    source, text, level = unsaved
    if text == source.text:
        return "program", source.draft
    return Draft("program", source.name, source.draft, text, level=level)


def leave(ui: Ui, end: Callable[[], None], drafts: Drafts, *flushes: Callable[[], None]) -> None:
    """End the game; ask first if unsaved work can't be kept."""
    for flush in flushes:
        flush()
    lost = drafts.unwritten()
    if lost:
        ui.spawn(partial(_ask, ui, end, *lost[0]), "leaving", exclusive=True)
    else:
        end()


async def _ask(ui: Ui, end: Callable[[], None], draft: Draft, error: OSError) -> None:
    question = (
        f"What you changed in “{clip(one_line(draft.name), 40)}” is not saved and can't be "
        f"kept for next time: {error.strerror or error}."
    )
    answers = [("stay", "Stay"), ("leave", "Leave without it")]
    if await ui.choose("Not saved", question, answers) == "leave":
        end()
