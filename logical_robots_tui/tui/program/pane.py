"""The program pane: the editor, the state of the program, and its errors."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from textual import on
from textual.content import Content
from textual.widgets import Static, TextArea

from logical_robots_tui.language.diagnostics import count_words, errors_in
from logical_robots_tui.language.services.completion import WordHelp, definitions, help_at
from logical_robots_tui.language.services.editing import follow_rows
from logical_robots_tui.tui.layout.arrangement import Pane
from logical_robots_tui.tui.layout.command_bar import Labels, RobotChosen
from logical_robots_tui.tui.program.editor import Editor
from logical_robots_tui.tui.program.mistakes import MistakeStrip, Underline, place_of, underline_of
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, one_line
from logical_robots_tui.world import Level

if TYPE_CHECKING:
    from logical_robots_tui.mind import Diagnostic
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.player.session_state import ProgramState


_LONGEST = 16


class TeamTabs(Labels):
    """The teams, above the program of one of them; hidden if there are no teams."""

    DEFAULT_CSS = """
    TeamTabs { height: 1; background: $surface; }
    """
    choice = RobotChosen

    def __init__(self) -> None:
        super().__init__("teams")
        self._robots: dict[str, str] = {}
        self._team = ""
        self.display = False

    def show(self, level: Level, team: str) -> None:
        robots = {robot.team: robot.name for robot in reversed(level.robots)} if team else {}
        names = (team.name for team in level.teams)
        robots = {name: robots[name] for name in names if name in robots}
        if (robots, team) != (self._robots, self._team):
            self._robots, self._team = robots, team
            self.display = bool(robots)
            self.refresh()

    def render(self) -> Content:
        styles = (INK.dim, f"bold {INK.title} on $tab-here")
        labels = [
            (
                Content.styled(f" {clip(one_line(team), _LONGEST)} ", styles[team == self._team]),
                robot,
            )
            for team, robot in self._robots.items()
        ]
        return self.line(labels, gap=1)


class TeamChoice:
    def __init__(
        self, session: Session, look_at: Callable[[str], None], tell: Callable[[str], None]
    ) -> None:
        self._session, self._look_at, self._tell = session, look_at, tell

    def follow(self, robot_name: str) -> bool:
        """Select a robot's team; return False if its program is hidden."""
        sources = self._session.sources
        team = self._session.level.team_of(robot_name)
        if team == sources.team or team not in sources.teams:
            return True
        if sources.hides_others:
            self._tell(f"What {clip(one_line(team), _LONGEST)} thinks is hidden.")
            return False
        self._look_at(team)
        return True

    def next_robot(self) -> str | None:
        sources, level = self._session.sources, self._session.level
        teams = sources.teams
        if sources.team not in teams:
            return None
        team = teams[(teams.index(sources.team) + 1) % len(teams)]
        return next((robot.name for robot in level.robots if robot.team == team), None)

    def toggle_others(self) -> None:
        sources = self._session.sources
        if not sources.teams:
            self._tell("This level has no teams.")
            return
        sources.hides_others = not sources.hides_others
        state = "hidden" if sources.hides_others else "shown again"
        self._tell(f"What the other teams think is {state}.")


class ProgramPane(Pane):
    command_id = "editor"

    DEFAULT_CSS = """
    ProgramPane #help-line {
        height: 1; padding: 0 1; background: $surface; color: $ink-dim;
        text-wrap: nowrap; text-overflow: ellipsis;
    }
    """

    def __init__(self) -> None:
        self.editor, self.teams = Editor(), TeamTabs()
        self._strip = MistakeStrip(self.go_to)
        self._state: ProgramState | None = None
        # Each error of the text that was tried, and the same in the current place of its line.
        self._mistakes: dict[Diagnostic, Diagnostic] = {}
        self._lines: list[str] = []
        self._tried: list[str] = []
        self._help = Static(id="help-line", markup=False)
        self._word: WordHelp | None = None
        parts = (self.teams, self.editor, self.editor.completion, self._help, self._strip)
        super().__init__(*parts, title="Program")

    @property
    def text(self) -> str:
        return self.editor.text

    def load(self, text: str) -> None:
        self.editor.load_text(text)

    def put(self, text: str) -> None:
        self.editor.put(text)

    def show(self, state: ProgramState, name: str, *, saved: bool) -> None:
        state = state.for_text(self.text)
        star = "" if saved else "*"
        self.note(f"{self._verdict(state)} · {clip(one_line(name), 24)}{star}")
        if state != self._state:
            self._state = state
            tried, mistakes = state.newest
            self._mistakes = {mistake: mistake for mistake in mistakes}
            self._tried = self._lines = tried.split("\n")
            self._follow_text(mistakes)

    @on(TextArea.Changed)
    def _text_changed(self) -> None:
        if self._state is not None and (mistakes := self._state.newest[1]):
            self._follow_text(mistakes)

    def _follow_text(self, mistakes: Iterable[Diagnostic]) -> None:
        """Show the errors where their lines are now; a changed line shows none."""
        lines = self.text.split("\n")
        if lines == self._tried:
            self._mistakes = {mistake: mistake for mistake in mistakes}
        else:
            rows = [mistake.line - 1 for mistake in self._mistakes.values()]
            rows_now = follow_rows(rows, self._lines, lines)
            self._mistakes = {
                mistake: replace(mistake, line=row + 1)
                for mistake, row in zip(self._mistakes, rows_now, strict=True)
                if row is not None
            }
        self._lines = lines
        underlines: dict[int, list[Underline]] = {}
        for mistake in self._untouched():
            row = mistake.line - 1
            underlines.setdefault(row, []).append(underline_of(mistake, lines[row]))
        self.editor.underline(underlines)
        self._show_help()

    def _untouched(self) -> tuple[Diagnostic, ...]:
        return tuple(
            mistake
            for original, mistake in self._mistakes.items()
            if self._lines[mistake.line - 1] == self._tried[original.line - 1]
        )

    def go_to_mistake(self) -> None:
        """Move to the next error, after the last one to the first."""
        places = sorted(map(place_of, self._mistakes.values()))
        cursor = self.editor.cursor_location
        if places:
            self.go_to(next((place for place in places if place > cursor), places[0]))
        self.enter()

    def go_to(self, place: tuple[int, int]) -> None:
        self.editor.move_cursor(place, center=True)
        self.enter()

    def show_place(self, start: int, stop: int) -> None:
        """Highlight a piece of the text between two offsets, and scroll to it."""
        places = []
        for offset in (start, stop):
            line_start = self.text.rfind("\n", 0, offset) + 1
            places.append((self.text.count("\n", 0, offset), offset - line_start))
        self.editor.point_out(*places)

    def go_to_definition(self) -> str:
        """Move to the definition of the predicate under the cursor, if any; return the word."""
        word = self.editor.word
        definition = definitions(self.text).get(word)
        if definition is not None:
            self.editor.move_cursor((definition.line, 0), center=True)
        self.enter()
        return word if definition is None else ""

    @on(TextArea.SelectionChanged)
    def _show_help(self) -> None:
        self._strip.show(self._untouched(), self.editor.cursor_location[0])
        word = help_at(self.text, self.editor.cursor_location)
        if word != self._word:
            self._word = word
            help_line = "" if word is None else f"{word.shape}  {word.meaning}"
            self._help.update(Content(one_line(help_line)), layout=False)

    def enter(self) -> None:
        self.screen.set_focus(self.editor)

    def _verdict(self, state: ProgramState) -> str:
        if state.phase in ("fresh", "compiling"):
            compiled, total = state.compiled
            return f"compiling… {compiled} of {total}" if total else "compiling…"
        text, (newest_text, diagnostics) = self.text, state.newest
        if text == newest_text and (errors := errors_in(diagnostics)):
            return count_words(errors)  # and no more, so that the program's name fits
        applied = "applied" if text == state.applied else "not applied"
        counts = count_words(diagnostics) if text == newest_text else ""
        return ", ".join(filter(None, [applied, counts]))
