"""The tabs of the program pane where several teams play, and whose mind is looked at."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from textual.content import Content
from textual.message import Message

from logical_robots_tui.tui.layout.command_bar import Labels
from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.world import Level

_LONGEST = 16


class TeamTabs(Labels):
    """The teams, above the program of one of them; hidden if there are no teams."""

    DEFAULT_CSS = """
    TeamTabs { height: 1; background: $surface; }
    """

    @dataclass
    class Chosen(Message):
        """A team was clicked; `robot_name` is its first robot."""

        robot_name: str

    def __init__(self) -> None:
        super().__init__("teams")
        self._robots: dict[str, str] = {}
        self._team = ""
        self.display = False

    def show(self, level: Level, team: str) -> None:
        robots = {robot.team: robot.name for robot in reversed(level.robots)} if team else {}
        robots = {each.name: robots[each.name] for each in level.teams if each.name in robots}
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

    def chosen(self, command_id: str) -> Message:
        return self.Chosen(command_id)


class TeamChoice:
    """Selects the team of the selected robot."""

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
        done = "hidden" if sources.hides_others else "shown again"
        self._tell(f"What the other teams think is {done}.")
