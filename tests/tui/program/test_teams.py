"""Where several teams play: a tab for each program, and the mind of the robot looked at."""

from contextlib import AbstractAsyncContextManager
from pathlib import Path

from logical_robots_tui.player.drafts import Draft
from logical_robots_tui.player.opening import Opening
from logical_robots_tui.world import load_level
from tests.game.test_teams import MATCH
from tests.tui.conftest import Opened, Size, showing, source_of
from tests.virtual_time import VirtualClock

RED = """\
Ahead(x) :- x == 1;
Robot(robot_name:, desire: {left_engine: x, right_engine: x}, memory: "redly") :-
  Sensor(robot_name:), Ahead(x);
"""
BLUE = RED.replace("Ahead", "Backward").replace("x == 1", "x == -1").replace("redly", "bluely")
SCORE = '\n[[scores]]\nkind = "near"\narea = "Door"\npoints = 9\n'


def match(
    data_dir: Path, size: Size = (120, 40), text: str = MATCH, *, same: bool = False
) -> AbstractAsyncContextManager[Opened]:
    red = source_of(RED, data_dir / "programs", "redly")
    blue = red if same else source_of(BLUE, data_dir / "programs", "bluely")
    file = data_dir / "match.toml"
    file.write_text(text, "utf-8")
    sources = {"red": red, "blue": blue}
    return showing(Opening(load_level(file), sources, data_dir, clock=VirtualClock()), size)


async def test_a_chosen_robot_shows_its_program_until_the_match_is_over(data_dir: Path) -> None:
    async with match(data_dir, text="match = {ticks = 3}\n" + MATCH + SCORE) as game:
        await game.sees(" red   blue ", "applied · red: redly")
        assert game.editor.text == RED
        await game.press("n", "n")
        await game.settled()
        (_, start, _, robot) = game.main.program.teams.places[1]
        assert robot == "Bo"
        await game.click(game.main.program.teams, offset=(start, 0))
        await game.until(lambda: game.editor.text == BLUE)
        assert game.main.labyrinth.view.selected == "Bo"
        assert game.main.session.source.name == "bluely"
        for robot, program in [("Ada", RED), ("Bo", BLUE)]:
            game.main.select(robot)
            assert game.editor.text == program
        game.main.inspector.open("decision")
        await game.sees("Decision of Bo · tick 2", '"bluely"')
        await game.until(lambda: game.shows("Backward") and not game.shows("Ahead"))
        assert game.tick == 2
        await game.press("w", sees="Backward(x)")
        await game.press("escape", "space", sees="MATCH OVER")
        assert game.tick == 3
        await game.sees("The match is over: red ", "red 8.3, blue 7.1.")
        await game.press("n", until=lambda: game.tick == 4, sees="PAUSED")
        await game.press("p", sees="MATCH OVER")


async def test_each_team_has_a_text_of_its_own_that_may_be_unsaved(data_dir: Path) -> None:
    changed = BLUE.replace("-1", "0")
    async with match(data_dir) as game:
        game.editor.put(RED + "# mine\n")
        game.main.select("Bo")
        assert game.editor.text == BLUE
        game.editor.put(BLUE + "Wrong(x :- \n")
        game.main.select("Ada")
        assert game.editor.text == RED + "# mine\n"
        game.main.select("Bo")
        assert game.editor.text == BLUE + "Wrong(x :- \n"
        await game.press("f4", sees="1 error")
        game.main.select("Ada")
        await game.press("f4", until=lambda: game.main.session.state.phase == "applied")
        game.main.select("Bo")
        await game.write(changed, until=lambda: game.main.session.state.phase == "applied")
        program = game.main.session.program
        assert program is not None
        assert program.texts == {"red": RED + "# mine\n", "blue": changed}
        assert await game.main.recorder.newest(game.main.session.level) == RED + "# mine\n"
        await game.press("escape", "n", tick=1)
        ada, bo, _ = game.session.frame.after.robots
        assert (ada.x, bo.x) == (41, 40)
        blue, _ = game.main.session.sources.source_and_text("blue")
        draft = Draft("program", blue.name, blue.draft, BLUE + "# unsaved\n")
        game.main.select("Ada")
        game.main.library._continue_with(draft)
        assert game.main.session.sources.team == "blue"
        assert game.editor.text == BLUE + "# unsaved\n"
        game.main.select("Ada")
        assert game.editor.text == RED + "# mine\n"
        assert game.main.session.source.name == "redly"


async def test_in_a_small_terminal_tabs_fit_and_the_others_can_be_hidden(data_dir: Path) -> None:
    async with match(data_dir, size=(80, 24)) as game:
        await game.press("2", sees=" red   blue ")
        await game.command("next_team", sees=("Backward(x) :- x == -1;", "blue: bluely"))
        await game.command("next_team")
        await game.command("hide_teams", sees="What the other teams think is hidden.")
        game.main.select("Bo")
        await game.sees("What blue thinks is hidden.")
        assert (game.editor.text, game.main.inspector.robot) == (RED, "Ada")
        await game.command("hide_teams")
        await game.command("next_team")
        assert (game.editor.text, game.main.inspector.robot) == (BLUE, "Bo")


async def test_teams_with_one_file_have_texts_of_their_own(data_dir: Path) -> None:
    async with match(data_dir, same=True) as game:
        game.editor.put(RED + "# mine\n")
        game.main.select("Bo")
        assert game.editor.text == RED
        game.editor.put(RED + "# theirs\n")
        game.main.select("Ada")
        assert game.editor.text == RED + "# mine\n"
        game.main.player.autosave.flush()
        kept = {draft.path[-5:]: draft.text for draft in game.main.player.drafts._drafts.values()}
        assert kept["=blue"] == RED + "# theirs\n"
        assert kept["m=red"] == RED + "# mine\n"
