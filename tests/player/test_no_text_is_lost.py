"""Whatever sessions do, every text that stood for half a second can be had again."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any, cast

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import Bundle, RuleBasedStateMachine, consumes, rule

from logical_robots_tui.game import ProgramSource, level_key
from logical_robots_tui.player import drafts as drafts_module
from logical_robots_tui.player.drafts import Autosave, Drafts, UnsavedText, program_draft
from logical_robots_tui.player.library import Library
from logical_robots_tui.player.opening import initial_programs
from logical_robots_tui.player.recorder import ProgressRecorder
from logical_robots_tui.world import load_level

LEVEL = load_level("01-first-steps")
ANSWERS = st.lists(st.sampled_from(["yes", "no", None]), max_size=4)


class Editor:
    def __init__(self, source: ProgramSource, text: str) -> None:
        self.source, self.text = source, text
        self.level = LEVEL
        self.sources = self
        self.team, self.teams = "", ()

    def put(self, text: str) -> None:
        self.text = text

    load = put

    def open_program(self, source: ProgramSource, text: str) -> None:
        self.source, self.text = source, text


class Player:
    def __init__(self, answers: list[str | None]) -> None:
        self._answers = answers
        self.asked: list[tuple[str, str | None]] = []
        self._tasks: list[asyncio.Task[None]] = []

    def tell(self, _message: str) -> None:
        pass

    def warn(self, message: str) -> None:
        raise AssertionError(message)

    def spawn(self, work: Any, *_: Any, **__: Any) -> None:
        self._tasks.append(asyncio.create_task(work()))

    async def at_hand(self, find: Callable[[], Awaitable[Any]]) -> Any:
        return await find()

    async def ask(self, *_: object, text: str) -> str | None:
        answer = self._answers.pop() if self._answers else None
        self.asked.append((text, answer))
        return answer

    async def done(self) -> None:
        await asyncio.gather(*self._tasks)
        self._tasks.clear()


class Session:
    def __init__(self, folder: Path, *answers: str | None) -> None:
        self.drafts = Drafts(folder / "drafts")
        self.recorder = ProgressRecorder(folder / "progress.sqlite")
        self.player = Player([*answers])
        sources, text = initial_programs(self.recorder.progress, LEVEL, (), {}, folder)
        self.editor = Editor(sources[""], sources[""].text if text is None else text)
        self.autosave = Autosave(
            self.drafts,
            state=lambda: UnsavedText(self.editor.source, self.editor.text, level_key(LEVEL)),
            draft=program_draft,
            warn=self.player.warn,
            subject="Unsaved text",
        )
        screen, player = cast("Any", self.editor), cast("Any", self.player)
        parts = (self.recorder, self.drafts, self.autosave)
        self.library = Library(screen, player, *parts, screen, folder)

    async def begin(self) -> Session:
        nothing, player = cast("Any", lambda *_: None), cast("Any", self.player)
        self.recorder.attach(player, on_change=nothing, on_measured=nothing)
        self.recorder.level_opened(LEVEL)
        self.autosave.flush()
        await self.library.offer(player)
        self.autosave.flush()
        await self.player.done()
        return self

    def type(self, text: str) -> None:
        self.editor.put(self.editor.text + text)

    async def apply(self) -> None:
        self.recorder.keep(self.editor.text)
        await self.player.done()

    async def end(self, *, killed: bool = False) -> None:
        if not killed:
            self.autosave.stop()
            self.drafts.close()
        elif self.drafts._lock is not None:
            drafts_module.release(self.drafts._lock)
        await self.recorder.close()

    async def at_hand(self) -> set[str]:
        offered = {draft.text for draft in self.drafts.adopt("program")}
        versions = {version.text for version in await self.recorder.versions()}
        return {self.editor.text, self.editor.source.text} | offered | versions


class Sessions(RuleBasedStateMachine):
    """Several sessions of one player, some of which hang: they do nothing and hold their lock."""

    sessions: Bundle[Session] = Bundle("sessions")

    def __init__(self) -> None:
        super().__init__()
        self.runner = asyncio.Runner()
        self.folder = tempfile.TemporaryDirectory()
        self.wanted: set[str] = set()
        self.number = 0
        self.alive: list[Session] = []

    @rule(target=sessions, answers=ANSWERS)
    def open(self, answers: list[str | None]) -> Session:
        session = Session(Path(self.folder.name), *answers)
        shown = session.editor.text
        self.runner.run(session.begin())
        self.alive.append(session)
        self.wanted |= {shown, *(text for text, _ in session.player.asked)}
        if (session.editor.text, "yes") in session.player.asked:
            self.wanted.discard(session.editor.text)  # it stands in the editor now, and only there
        return session

    @rule(session=sessions)
    def type(self, session: Session) -> None:
        self.number += 1
        session.type(f"# {self.number}\n")
        session.autosave.flush()

    @rule(session=sessions)
    def take_back(self, session: Session) -> None:
        session.editor.put(session.editor.source.text)
        session.autosave.flush()

    @rule(session=sessions)
    def apply(self, session: Session) -> None:
        self.runner.run(session.apply())
        self.wanted.add(session.editor.text)

    @rule(session=consumes(sessions), killed=st.booleans())
    def end(self, session: Session, killed: bool) -> None:
        self.alive.remove(session)
        self.close(session, killed=killed)

    def close(self, session: Session, *, killed: bool) -> None:
        self.wanted.add(session.editor.text)
        self.runner.run(session.end(killed=killed))

    def teardown(self) -> None:
        for session in self.alive:
            self.close(session, killed=True)
        last = self.runner.run(Session(Path(self.folder.name)).begin())
        texts = self.runner.run(last.at_hand())
        self.runner.run(last.end())
        self.runner.close()
        self.folder.cleanup()
        assert self.wanted <= texts


Sessions.TestCase.settings = settings(
    max_examples=max(10, settings().max_examples // 4), stateful_step_count=12, deadline=None
)
TestNoTextIsLost = pytest.mark.sampled(Sessions.TestCase)


async def test_what_a_hung_session_left_is_offered_after_one_only_opened(tmp_path: Path) -> None:
    hung = await Session(tmp_path).begin()
    hung.type("# changed\n")
    await hung.apply()
    hung.type("# PRECIOUS WORK\n")
    hung.autosave.flush()
    second = await Session(tmp_path).begin()
    assert second.editor.text.endswith("# changed\n")
    await hung.end(killed=True)
    await second.end()
    third = await Session(tmp_path, "yes").begin()
    assert third.editor.text == hung.editor.text
    await third.end()


async def test_what_was_set_aside_is_a_version_and_not_what_to_go_on_with(tmp_path: Path) -> None:
    first = await Session(tmp_path).begin()
    first.type("# unwanted\n")
    await first.end()
    second = await Session(tmp_path, "no").begin()
    versions = [version.text for version in await second.recorder.versions()]
    assert versions == [second.editor.text, first.editor.text]
    await second.end()


async def test_two_texts_that_differ_are_both_offered(tmp_path: Path) -> None:
    both = [await Session(tmp_path).begin(), await Session(tmp_path).begin()]
    for number, session in enumerate(both):
        session.type(f"# {number}\n")
    for session in both:
        await session.end()
    third = await Session(tmp_path, "yes", "yes").begin()
    assert [text for text, _ in third.player.asked] == [s.editor.text for s in reversed(both)]
    assert third.editor.text == both[0].editor.text
    assert both[1].editor.text in [version.text for version in await third.recorder.versions()]
    await third.end()
