"""Every command of the game. To import it loads neither widgets nor the game."""

from __future__ import annotations

from logical_robots_tui.tui.commands.general import general, looking
from logical_robots_tui.tui.commands.levels import editing, levels
from logical_robots_tui.tui.commands.program import learning, program, writing
from logical_robots_tui.tui.commands.rows import rows
from logical_robots_tui.tui.commands.running import running, time

GROUPS = (running, time, program, learning, levels, editing, looking, rows, general, writing)
"""In the order of the help."""

COMMANDS = tuple(entry for group in GROUPS for entry in group.commands)
