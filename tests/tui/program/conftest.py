"""The program pane alone on a screen, for what concerns neither robots nor other panes."""

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass

from textual.app import ComposeResult
from textual.pilot import Pilot

from logical_robots_tui.tui.program.completion import Completion
from logical_robots_tui.tui.program.editor import Editor
from logical_robots_tui.tui.program.pane import ProgramPane
from logical_robots_tui.tui.terminal.crash_report import CrashSafeApp
from logical_robots_tui.tui.theme.themes import NIGHT, colours_in
from tests.tui.conftest import Opened, Size, key_event
from tests.virtual_time import later, until, virtual_loop


class PaneApp(CrashSafeApp):
    ENABLE_COMMAND_PALETTE = False

    def __init__(self) -> None:
        super().__init__()
        self.pane = ProgramPane()

    def get_theme_variable_defaults(self) -> dict[str, str]:
        return colours_in(NIGHT)

    def on_load(self) -> None:
        self.register_theme(NIGHT)
        self.theme = NIGHT.name

    def compose(self) -> ComposeResult:
        yield self.pane

    def on_mount(self) -> None:
        self.pane.enter()


@dataclass(frozen=True)
class Desk:
    app: PaneApp
    pilot: Pilot[None]

    @property
    def editor(self) -> Editor:
        return self.app.pane.editor

    @property
    def completion(self) -> Completion:
        return self.editor.completion

    async def load(self, text: str, row: int = 0, column: int = 0) -> None:
        self.editor.load_text(text)
        self.editor.move_cursor((row, column))
        await virtual_loop().settled()

    async def type(self, *keys: str) -> None:
        """Press keys so slowly that nobody takes them for a paste; each has been answered."""
        for key in keys:
            await later(0.1)
            await self.at_once(key)

    async def at_once(self, *keys: str) -> None:
        """Press keys without a pause between them, and wait until they have been answered."""
        for key in keys:
            self.app.post_message(key_event(key))
        await virtual_loop().handled()

    async def until(self, condition: Callable[[], object]) -> None:
        await until(condition, lambda: f"the text is\n{self.editor.text}")

    def screen(self) -> str:
        lines = self.app.screen._compositor.render_strips()
        return "\n".join("".join(segment.text for segment in line) for line in lines)


@asynccontextmanager
async def writing(text: str = "", size: Size = (80, 24)) -> AsyncIterator[Desk]:
    app = PaneApp()
    async with app.run_test(size=size) as pilot:
        desk = Desk(app, pilot)
        await desk.load(text)
        yield desk


def title(game: Opened) -> str:
    return game.main.program.label
