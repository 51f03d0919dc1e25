"""What older versions wrote: programs of teams in one text, which is read and never written."""

import json
import shutil
import sqlite3
from collections.abc import Mapping
from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.game.replay import NO_PROGRAM, load_replay
from logical_robots_tui.progress import Progress
from logical_robots_tui.progress.old_texts import texts_of
from tests.cli.running import Command
from tests.game.playing import BACKWARDS, COUNTER

HERE = Path(__file__).parent
TEAMS = {"red": COUNTER, "blue": BACKWARDS}


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


def joined(texts: Mapping[str, str]) -> str:
    lines = {team: text.count("\n") + 1 for team, text in texts.items()}
    return "\n".join(["# teams: " + json.dumps(lines), *texts.values()])


programs = st.text(st.sampled_from('ab#\n{}": 1') | st.characters(codec="utf-8"), max_size=30)
teams = st.dictionaries(st.text(min_size=1, max_size=5), programs, min_size=1, max_size=4)


@given(teams, programs)
def test_each_team_gets_its_own_text(parts: dict[str, str], text: str) -> None:
    """A part that pretends to be several teams stays one part."""
    nested = {**parts, "mine": joined({**parts, "other": text})}
    assert list(texts_of(joined(nested)).items()) == list(nested.items())


@pytest.mark.parametrize(
    "text",
    [
        *("", COUNTER, '{"red": 1}\none', "# teams: ", "# teams: {}", "# teams: []\n"),
        *('# teams: {"red": 2}\none\ntwo\nthree', '# teams: {"red": 1}\none\ntwo'),
        *('# teams: {"red": "1"}\none', "# teams: {nonsense", "# teams: " + "[" * 50_000),
        '# teams: {"' + "a" * 100_000 + '": 1}\none',
    ],
)
def test_any_other_text_is_one_program(text: str) -> None:
    assert texts_of(text) == {"": text}


@pytest.mark.parametrize(("name", "texts"), [("match", TEAMS), ("match-without", {"": NO_PROGRAM})])
def test_a_replay_is_read_and_shown(name: str, texts: dict[str, str], command: Command) -> None:
    file = HERE / f"{name}.replay"
    assert load_replay(file).programs == {1: texts}
    told = command("replay", "verify", file, "--json").data
    assert (told["same"], told["ticks"], told["programs"]) == (True, 20, name == "match")
    shown = command("replay", "show", file, "--json").data["programs"]
    assert {program["team"]: program["text"] or NO_PROGRAM for program in shown} == texts


def test_a_replay_without_teams_has_one_program() -> None:
    (texts,) = load_replay(HERE / "one.replay").programs.values()
    assert list(texts) == [""]
    assert "Robot(" in texts[""]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return shutil.copytree(HERE / "tournament", tmp_path / "tournament")


def test_a_tournament_has_its_results(folder: Path, command: Command) -> None:
    assert command("lab", "status", folder, "--mixed").out.startswith("The hill: 4 runs done")


@pytest.mark.slow
def test_a_tournament_goes_on_with_the_same_results(folder: Path, command: Command) -> None:
    with closing(sqlite3.connect(folder / "ledger.db")) as ledger, ledger:
        jobs = set(ledger.execute("SELECT job FROM results"))
        (job,) = ledger.execute("SELECT min(job) FROM results").fetchone()
        ledger.execute("DELETE FROM results WHERE job = ?", (job,))
    for name in ("ranking", "pairs"):
        (folder / f"{name}.csv").unlink()
    told = command("lab", "resume", folder, "--mixed", "--workers", 1)
    assert told.status == 0, told.err
    with closing(sqlite3.connect(folder / "ledger.db")) as ledger:
        assert set(ledger.execute("SELECT job FROM results")) == jobs
    for name in ("ranking", "pairs"):
        old = (HERE / "tournament" / f"{name}.csv").read_bytes()
        assert (folder / f"{name}.csv").read_bytes() == old


def test_a_victory_with_teams_is_that_of_the_player_s_own_program(tmp_path: Path) -> None:
    """It was kept with the programs of all teams in one text."""
    file = tmp_path / "progress.sqlite"
    with closing(sqlite3.connect(file)) as connection:
        connection.executescript((HERE / "progress.sql").read_text("utf-8"))
    progress = Progress(file, pytest.fail)
    record = progress.record("match")
    assert (record.state, record.versions, record.bests.ticks) == ("won", 2, 43)
    mine, other = progress.versions("match")
    assert other.text == f"# mine\n{mine.text}"
    assert (mine.won, other.won) == (True, False)
    assert mine.text == progress.newest("match")
    assert progress.measures("match", mine.text) == mine.measures
