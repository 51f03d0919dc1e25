"""The commands that run the robots, and those that move through time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.commands.command import Group

if TYPE_CHECKING:
    from logical_robots_tui.tui.app.main_screen import MainScreen

_LEAP = 10  # ticks

running = Group("Running")


@running.command("Run or pause", "space", "f5", bar="Run", place="anywhere")
def run(screen: MainScreen) -> None:
    """Run the robots or pause them; also cancels a computation under way."""
    screen.labyrinth.briefing.close()
    state = screen.session.state
    if screen.session.game is None and state.phase == "mistake":
        screen.warn(f"The program has a mistake in line {state.mistakes[0].line}.")
    screen.session.toggle_run()


@running.command("Step", "n", "full_stop", "f8", bar="Step")
def step(screen: MainScreen) -> None:
    """Compute one tick."""
    screen.labyrinth.briefing.close()
    screen.session.step()


@running.command("Step back", "p", "comma", bar="Back", spare=2)
def back(screen: MainScreen) -> None:
    """Go back one tick."""
    screen.session.back()


@running.command("Restart", "r", bar="Restart")
def restart(screen: MainScreen) -> None:
    """Start the level again at tick 0, with the same program."""
    screen.session.restart()


@running.command("Slower", "minus", bar="-", spare=3)
def slower(screen: MainScreen) -> None:
    """Choose the next lower speed."""
    screen.session.slower()


@running.command("Faster", "plus", "equals_sign", bar="Speed", spare=3)
def faster(screen: MainScreen) -> None:
    """Choose the next higher speed; the highest is unlimited."""
    screen.session.faster()


time = Group("Time")


@time.command("Ten steps", "N")
def step_ten(screen: MainScreen) -> None:
    """Go forward ten ticks."""
    screen.labyrinth.briefing.close()
    screen.session.step(_LEAP)


@time.command("Ten steps back", "P")
def back_ten(screen: MainScreen) -> None:
    """Go back ten ticks."""
    screen.session.back(_LEAP)


@time.command("First tick", "left_parenthesis")
def first(screen: MainScreen) -> None:
    """Go to the first tick, or the earliest that the history still holds."""
    screen.timeline_controller.first()


@time.command("Last tick", "right_parenthesis")
def last(screen: MainScreen) -> None:
    """Go to the last tick of the history."""
    screen.timeline_controller.last()


@time.command("Go to tick…", "g")
async def go_to(screen: MainScreen) -> None:
    """Go to any tick of the history."""
    await screen.timeline_controller.ask_for_tick()


@time.command("Run until tick…", "U")
async def run_until(screen: MainScreen) -> None:
    """Run at full speed to a tick, or to victory or a breakpoint if that comes first."""
    screen.labyrinth.briefing.close()
    await screen.timeline_controller.ask_how_far()


@time.command("Previous mark", "left_curly_bracket")
def previous_mark(screen: MainScreen) -> None:
    """Go back to the last event, which may be a change of the selected robot's memory."""
    screen.timeline_controller.to_mark(-1)


@time.command("Next mark", "right_curly_bracket")
def next_mark(screen: MainScreen) -> None:
    """Go forward to the next event in the history."""
    screen.timeline_controller.to_mark(1)


@time.command("Search ticks…", "Q", worker="seek")
async def search_ticks(screen: MainScreen) -> None:
    """Ask any question in Logica, and go to the next tick in which it holds."""
    await screen.search.ask()


@time.command("Next match", "semicolon", worker="seek")
async def next_match(screen: MainScreen) -> None:
    """Go to the next tick in which the question that was searched for holds."""
    await screen.search.go(1)


@time.command("Previous match", "colon", worker="seek")
async def previous_match(screen: MainScreen) -> None:
    """Go to the previous tick in which the question that was searched for holds."""
    await screen.search.go(-1)


@time.command("Breakpoints", "B")
def breakpoints(screen: MainScreen) -> None:
    """List, add, switch off or delete breakpoints: events and questions that end a run."""
    screen.timeline_controller.breakpoints()


@time.command("Other future", "F")
def other_future(screen: MainScreen) -> None:
    """Switch to the future that was left when the program changed, and to its program."""
    screen.timeline_controller.change_course()


@time.command("Compare futures", "C")
def compare(screen: MainScreen) -> None:
    """Go to the first tick in which the two futures differ, and show how and why."""
    screen.timeline_controller.compare()


@time.command("Save a replay", worker="replay")
async def save_replay(screen: MainScreen) -> None:
    """Save all ticks of the timeline in a file, to play again, to verify or to share."""
    await screen.replays.save()


@time.command("Timeline", "T")
def timeline(screen: MainScreen) -> None:
    """Focus the timeline; arrows, page up and down, home and end move along it."""
    screen.set_focus(screen.timeline)
