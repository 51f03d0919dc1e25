"""The session and those who listen to it, from opening a level to leaving, without a screen."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, closing
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from logical_robots_tui.editing.editor import LevelEditor, Tool
from logical_robots_tui.editing.strokes import Point
from logical_robots_tui.game import Frame, load_program
from logical_robots_tui.game.victory import Victory
from logical_robots_tui.mind import Program
from logical_robots_tui.player.drafts import Drafts
from logical_robots_tui.player.recorder import ProgressRecorder
from logical_robots_tui.player.session import Session
from logical_robots_tui.player.session_state import Background, SessionListener
from logical_robots_tui.progress import FILE_NAME, Progress
from logical_robots_tui.tui.app.ui import Dialogs
from logical_robots_tui.tui.level_editor.controller import LevelController
from logical_robots_tui.world import Level, load_level
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.levels.native import read_native
from tests.short import AHEAD, LEVEL
from tests.virtual_time import VirtualClock, until, virtual_loop

FAST = AHEAD.replace("0.5", "0.9")


class Screen(Background, Dialogs):
    def __init__(self) -> None:
        super().__init__()
        self.said: list[str] = []

    def tell(self, message: str) -> None:
        self.said.append(message)

    def show(self, *dialog: object) -> Any:
        raise AssertionError(dialog)

    async def ask(self, *dialog: object) -> Any:
        raise AssertionError(dialog)

    warn = withdraw = tell
    choose = ask  # type: ignore[assignment] # whatever it is asked


@dataclass
class Chronicle(SessionListener):
    ticks: list[int] = field(default_factory=list)
    victories: list[Victory] = field(default_factory=list)
    events: list[str] = field(default_factory=list)

    def level_opened(self, level: Level) -> None:
        self.events.append(f"opened {level.name}")

    def level_saved(self, level: Level) -> None:
        self.events.append(f"saved {level.name}")

    def level_changed(self) -> None:
        self.events.append("changed")

    def restarted(self) -> None:
        self.events.append("restarted")

    def program_rejected(self) -> None:
        self.events.append("rejected")

    def tick_shown(self, frame: Frame) -> None:
        self.ticks.append(frame.tick)

    def won(self, victory: Victory) -> None:
        self.victories.append(victory)


@dataclass
class Table:
    session: Session
    recorder: ProgressRecorder
    editing: LevelController
    chronicle: Chronicle
    ui: Screen
    drafts: Drafts
    data_dir: Path

    @property
    def editor(self) -> LevelEditor:
        return self.editing.editor

    async def until(self, condition: Callable[[], object]) -> None:
        await until(condition, lambda: repr((self.ui.said, self.chronicle)))

    async def apply(self, text: str) -> None:
        self.session.apply(text)
        await self.until(lambda: self.session.state.applied == text)

    async def win(self) -> int:
        self.session.run()
        await self.until(lambda: not self.session.busy)
        assert self.session.won_at == self.session.frame.tick
        return self.session.frame.tick

    def state_of(self, level: Path) -> str:
        with closing(Progress(self.data_dir / FILE_NAME)) as progress:
            return progress.record(str(level)).state

    async def edit(self, *points: Point) -> None:
        self.editing.open()
        self.paint(*points)
        await self.until(lambda: self.session.levels.shown is self.session.levels.edited)

    def paint(self, *points: Point) -> None:
        self.editor.settings = replace(self.editor.settings, tool=Tool.BRUSH)
        self.editor.press(*points[0], 1.0)
        for point in points[1:]:
            self.editor.drag(*point)
        self.editor.release()


@asynccontextmanager
async def table(tmp_path: Path, text: str = AHEAD) -> AsyncIterator[Table]:
    file, program = tmp_path / "short.toml", tmp_path / "mine.l"
    file.write_text(LEVEL, "utf-8")
    program.write_text(text, "utf-8")
    data_dir, ui, chronicle = tmp_path / "data", Screen(), Chronicle()
    recorder, drafts = ProgressRecorder(data_dir / FILE_NAME), Drafts(data_dir / "drafts")
    sources, clock = {"": load_program(program)}, VirtualClock()
    session = Session(
        load_level(file), sources, spawn=ui.spawn, on_change=lambda: None, clock=clock
    )

    async def open_level(level: Level) -> None:
        session.open_level(level, {"": session.source}, text)

    editing = LevelController(session, ui, data_dir / "levels", drafts, open_level, lambda: None)
    recorder.attach(ui, on_change=lambda: None, on_measured=lambda level, found, is_here: None)
    session.listeners += [editing, recorder, chronicle]
    session.pace.speed = None
    recorder.level_opened(session.opened)
    try:
        opened = Table(session, recorder, editing, chronicle, ui, drafts, data_dir)
        await opened.apply(text)
        yield opened
    finally:
        editing.close()
        drafts.close()
        await ui.close()
        await session.close()
        await recorder.close()


async def test_a_whole_game_is_played_without_a_screen(tmp_path: Path) -> None:
    async with table(tmp_path) as t:
        session, levels = t.session, t.session.levels
        won_at = await t.win()
        await t.until(lambda: t.recorder.record.state == "won")
        assert t.chronicle.ticks == list(range(1, won_at + 1))
        assert t.recorder.latest is not None
        assert t.recorder.latest.ticks == won_at

        session.go_to(3)
        t.editing.open()
        t.paint((30, 8), (30, 17))
        assert levels.edited.walls[12, 30]
        assert not levels.saved.walls[12, 30]
        await t.until(lambda: levels.shown is levels.edited)
        assert t.editing.level is levels.edited
        session.run_until(won_at)
        await t.until(lambda: not session.busy)
        assert session.frame.after.robots[0].blocked
        assert session.won_at is None

        session.go_to(1)
        assert not levels.edited.walls[12, 30]
        assert t.editor.edits.can_undo == "go to tick 1"
        t.editor.undo()
        await t.until(lambda: levels.shown.walls[12, 30])
        assert levels.has_changes
        t.editing.leave()
        assert t.editing.level is levels.shown

        await t.editing._open_level(load_level("01-first-steps"))
        assert not t.editing.has_begun
        assert session.levels is not levels
        assert session.frame.tick == 0
        await virtual_loop().settled()
        assert (t.recorder.record.state, t.recorder.record.versions) == ("started", 1)
        draft = t.drafts.get(("level", str(tmp_path / "short.toml")))
        assert draft is not None
        assert alike(read_native(draft.text, "short", ""), levels.edited)
    assert t.state_of(tmp_path / "short.toml") == "won"


async def test_a_victory_is_told_once_for_each_program_and_tick(tmp_path: Path) -> None:
    async with table(tmp_path) as t:
        victories = t.chronicle.victories
        first = await t.win()
        t.editing.open()
        t.editor.select_next(1)
        before = t.editor.selected, t.editor.edits.can_undo, list(t.chronicle.events)
        for _ in range(3):  # what is looked at does not change
            assert t.editor.entity is not None
            assert t.editing.level is t.session.levels.edited
            assert t.session.levels.is_saved
        assert before == (t.editor.selected, t.editor.edits.can_undo, t.chronicle.events)
        t.editing.leave()
        t.session.back(2)
        await t.win()
        assert [victory.tick for victory in victories] == [first]
        t.session.back(first - 2)
        await t.apply(FAST)
        second = await t.win()
        assert second < first
        assert [victory.tick for victory in victories] == [first, second]
        t.session.restart()
        third = await t.win()
        assert [victory.tick for victory in victories] == [first, second, third]
        assert [victory.verdict for victory in victories] == ["counts"] * 3
        assert victories[1].measures is None  # two programs have won it together
        assert victories[2].measures is not None


async def test_an_edited_level_is_won_for_nothing_until_it_is_saved(tmp_path: Path) -> None:
    async with table(tmp_path) as t:
        await t.edit((10, 8), (20, 8))
        await t.win()
        edited, levels = t.chronicle.victories[-1], t.session.levels
        assert edited.verdict == "edited"
        assert "not kept" in edited.refusal
        assert t.recorder.latest is None
        await t.until(lambda: t.recorder.record.state == "started")
        assert not levels.is_saved
        other = replace(levels.edited, name="other", source=str(tmp_path / "other.toml"))
        t.editing.saved(levels, str(tmp_path / "short.toml"), levels.edited, other)
        assert levels.is_saved
        assert t.session.opened is other
        assert t.chronicle.events.count("saved other") == 1
        t.session.restart()
        await t.win()
        assert [victory.verdict for victory in t.chronicle.victories] == ["edited", "counts"]
        await t.until(lambda: t.recorder.record.state == "won")
    assert t.state_of(tmp_path / "other.toml") == "won"
    assert t.state_of(tmp_path / "short.toml") == "started"


async def test_a_program_whose_first_line_looks_like_teams_is_one_program(tmp_path: Path) -> None:
    text = f'# teams: {{"red": 1, "blue": {AHEAD.count(chr(10)) + 1}}}\n\n{AHEAD}'
    async with table(tmp_path, text) as t:
        assert t.session.program is not None
        assert t.session.program.texts == {"": text}
        await t.win()
        await t.until(lambda: t.recorder.record.state == "won")
        assert [version.text for version in await t.recorder.versions()] == [text]


async def test_what_begins_while_a_program_is_compiled_waits_for_it(tmp_path: Path) -> None:
    async with table(tmp_path) as t:
        session = t.session
        until_3 = partial(session.run_until, 3)
        begins: list[Callable[[], None]] = [session.run, session.step, until_3]
        for number, begin in enumerate(begins):
            text = f"{FAST}# {number}\n"
            session.restart()
            session.apply(text)
            begin()
            assert session.awaits_program
            await t.until(lambda: not session.busy)
            assert session.history is not None
            programs = session.history.programs(session.frame.tick)
            assert {program.text for _, program in programs} == {text}
        session.apply(FAST)
        session.run()
        session.keep_program()
        assert (session.running, session.awaits_program) == (True, False)
        await t.until(lambda: not session.busy)
        assert session.state.applied == text
        session.restart()
        session.apply("Robot")
        session.run()
        await t.until(lambda: not session.busy)
        assert (session.frame.tick, t.chronicle.events[-1]) == (0, "rejected")


async def test_steps_owed_are_taken_under_any_program_until_a_pause(tmp_path: Path) -> None:
    async with table(tmp_path) as t:
        t.session.step()
        await virtual_loop().handled()
        t.session.use(await asyncio.to_thread(Program.compile, FAST))
        await t.until(lambda: not t.session.busy)
        assert (t.session.frame.tick, t.chronicle.ticks) == (1, [1])
        for _ in range(20):
            t.session.step()
        assert t.session.busy
        assert not t.session.running
        await t.until(lambda: not t.session.busy)
        assert 6 <= t.session.frame.tick <= 7
        t.session.step(3)
        t.session.pause()
        assert not t.session.busy
        t.session.run()
        assert t.session.running
        t.session.pause()
        assert not t.session.running
        tick = t.session.frame.tick
        await virtual_loop().settled()
        assert t.session.frame.tick == tick
