"""Tournaments: matches on a real engine, killed and resumed, with players good, bad and broken."""

import io
import shlex
from collections.abc import Mapping
from contextlib import redirect_stdout
from pathlib import Path

import pytest

from logical_robots_tui.cli.main import main
from logical_robots_tui.errors import InputError
from logical_robots_tui.lab.competing import plan_tournament
from logical_robots_tui.lab.folder import Folder
from tests.cli.running import Command
from tests.lab.laboratory import ENDLESS, exported, killed, page_of, recorded, rows, write_files

HILL = Path(__file__).with_name("hill.txt").read_text("utf-8")
ROBOTS = {"red": (40, 20, 0), "blue": (160, 30, 180), "gold": (160, 20, 180), "green": (40, 30, 0)}
TEAM = Path(__file__).with_name("team.txt").read_text("utf-8")

ARENA = Path(__file__).with_name("arena.txt").read_text("utf-8")

DRIVE = """
Robot(robot_name:, desire: {{left_engine: {speed}, right_engine: {speed}}}, memory: "") :-
  Sensor(robot_name:);
"""
BROKEN = DRIVE.format(speed=1).replace("Sensor", "Snesor")

PLAYERS = {"fast": 1, "quick": 0.8, "slow": 0.6, "still": 0}


def drives(speed: float) -> str:
    return DRIVE.format(speed=speed)


def write_arena(
    folder: Path,
    players: Mapping[str, str] | None = None,
    *,
    starts: int = 1,
    more: str = "",
    ticks: int = 60,
    teams: tuple[str, ...] = ("red", "blue"),
) -> tuple[Path, Path]:
    """Write a tournament into a folder; return its file and the folder of its players."""
    listed = "".join(
        TEAM.format(team=team, x=x, y=y, heading=heading)
        for team in teams
        for x, y, heading in [ROBOTS[team]]
    )
    hill, arena = HILL.format(ticks=ticks, teams=listed), ARENA.format(starts=starts, more=more)
    write_files(folder, {"hill.toml": hill, "tournament.toml": arena})
    programs = players or {name: drives(speed) for name, speed in PLAYERS.items()}
    write_files(folder / "players", {f"{name}.l": text for name, text in programs.items()})
    return folder / "tournament.toml", folder / "players"


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The folder of a tournament, in which two play the same, and what was told of it."""
    folder = tmp_path_factory.mktemp("played")
    names = {"fast": 1, "=1+1": 0.8, "slow": 0.6, "still": 0, "<b>still": 0}
    arena, players = write_arena(folder, {name: drives(speed) for name, speed in names.items()})
    write_files(players, {"broken/hill.l": BROKEN})
    text = io.TextIOWrapper(bytes_ := io.BytesIO(), "utf-8", write_through=True)
    with redirect_stdout(text):
        assert main(["tournament", str(arena), str(players), "-o", str(folder / "out")]) == 0
    return folder / "out", bytes_.getvalue().decode()


def test_everybody_plays_everybody_from_both_seats_and_the_best_is_first(
    played: tuple[Path, str],
) -> None:
    out, told = played
    ranking = rows(out / "ranking.csv")
    names = [row["player"] for row in ranking]
    assert (names[:3], names[5:]) == (["fast", "'=1+1", "slow"], ["broken"])
    assert [row["best_rank"] for row in ranking] == ["1", "2", "3", "4", "4", "6"]
    assert [row["opponents"] for row in ranking] == ["5"] * 6
    assert ranking[-1]["share"] == "0.0"
    assert ranking[-1]["remark"].startswith("line 3: ")
    strengths = [float(row["strength"].strip("'")) for row in ranking]
    assert strengths == sorted(strengths, reverse=True)
    runs = rows(out / "runs.csv")
    assert len(runs) == 10 * 2 * 2, "who is broken does not play"
    assert recorded(out) == (6 * 2 + 1) * 2, "what is the same runs once"
    seats = {(row["red"], row["blue"], row["start"]) for row in runs}
    assert len(seats) == 40
    assert {(blue, red, start) for red, blue, start in seats} == seats
    fast = [row for row in runs if (row["red"], row["blue"]) == ("fast", "still")]
    assert [(row["points_blue"], row["outcome"]) for row in fast] == [("0.0", "played")] * 2
    assert "The row's share of the points" in told
    assert "fast" in told.split("rank  player")[1].splitlines()[1]


def test_between_equal_seats_players_take_turns_from_start_to_start(
    tmp_path: Path, command: Command
) -> None:
    arena, players = write_arena(tmp_path, {"ada": drives(1), "ben": drives(0.6)}, starts=3)
    hill = tmp_path / "hill.toml"
    text, _, _ = hill.read_text("utf-8").partition("[[beacons]]")
    hill.write_text(text, "utf-8")
    command("tournament", arena, players, "-o", tmp_path / "out")
    seats = sorted((row["start"], row["red"]) for row in rows(tmp_path / "out" / "runs.csv"))
    first, second = seats[0][1], seats[1][1]
    assert {first, second} == {"ada", "ben"}
    assert seats == [("0", first), ("1", second), ("2", first), ("3", second)]
    (ada, _) = rows(tmp_path / "out" / "ranking.csv")
    assert (ada["player"], ada["opponents"]) == ("ada", "1")


def test_the_same_program_under_two_names_is_as_good_as_itself(played: tuple[Path, str]) -> None:
    pairs = rows(played[0] / "pairs.csv")
    shares = {(row["player"], row["opponent"]): row["share"] for row in pairs}
    assert shares["still", "<b>still"] == "0.5"
    assert shares["still", "slow"] == shares["<b>still", "slow"]


def test_a_match_is_seen_again(played: tuple[Path, str], tmp_path: Path, command: Command) -> None:
    out, _ = played
    seats = ("fast", "slow", "1")
    (row,) = (r for r in rows(out / "runs.csv") if (r["red"], r["blue"], r["start"]) == seats)
    _, play, *match = shlex.split(row["replay"])
    assert (play, match[-2:]) == ("play", ["--start", "1"])
    match[:3] = [str(out / name) for name in match[:3]]
    scores = command("run", *match, "--json").data["scores"]
    points = {team: row[f"points_{team}"] for team in ("red", "blue")}
    assert {team: str(sum(parts)) for team, parts in scores.items()} == points
    file = tmp_path / "match.replay"
    assert command("replay", "record", *match, "-o", file).status == 0
    assert command("replay", "verify", file).status == 0
    called = [name.rpartition("/")[2].removesuffix(".l") for name in match[1:3]]
    shown = command("replay", "show", file, "--json").data["programs"]
    assert [program["name"] for program in shown] == ["-".join(called)] * 2
    assert row["program"] == " against ".join(called)


def test_the_report_is_one_page_without_links(played: tuple[Path, str], command: Command) -> None:
    out, _ = played
    assert command("lab", "report", out).status == 0
    page = page_of(out)
    for text in ("<h1>The hill</h1>", "&lt;b&gt;still", "logical-robots play inputs/"):
        assert text in page
    assert "<b>" not in page


@pytest.mark.slow
def test_a_new_player_plays_only_its_own_matches(tmp_path: Path, command: Command) -> None:
    arena, players = write_arena(tmp_path)
    out = tmp_path / "out"
    assert command("tournament", arena, players, "-o", out).status == 0
    assert recorded(out) == 24
    (players / "late.l").write_text(drives(0.7))
    assert "24 runs" not in command("tournament", arena, players, "-o", out).out
    assert recorded(out) == 24 + 4 * 2 * 2
    (players / "slow.l").unlink()
    assert command("tournament", arena, players, "-o", out).status == 0
    assert recorded(out) == 40
    names = [row["player"] for row in rows(out / "ranking.csv")]
    assert names == ["fast", "quick", "late", "still"]


@pytest.mark.slow
@pytest.mark.parametrize("form", ["swiss", "all"])
def test_a_killed_tournament_ends_the_same(tmp_path: Path, command: Command, form: str) -> None:
    names = {f"player {n}": drives(0.3 + n / 10) for n in range(7)}
    arena, players = write_arena(tmp_path, names, starts=0, more=f'format = "{form}"')
    once, often = tmp_path / "once", tmp_path / "often"
    assert command("tournament", arena, players, "-o", once).status == 0
    total = recorded(once)
    assert total == {"all": 21, "swiss": 5 * 3}[form] * 2
    assert killed(often, ("tournament", arena, players), workers=(2, 1, 2))[-1] < total
    assert "Go on with" in command("lab", "status", often, status=1).out
    assert command("lab", "resume", often, "--workers", 2).status == 0
    assert exported(often) == exported(once)
    assert recorded(often) == total


@pytest.mark.slow
def test_names_change_nothing_but_names(tmp_path: Path, command: Command) -> None:
    found = []
    for number, names in enumerate((("a", "b", "c", "d"), ("c", "a", "d", "b"))):
        folder = tmp_path / str(number)
        folder.mkdir()
        speeds = dict(zip(names, PLAYERS.values(), strict=True))
        arena, players = write_arena(folder, {n: drives(v) for n, v in speeds.items()})
        out = tmp_path / "out"  # the same ledger: not a match is played again
        assert command("tournament", arena, players, "-o", out).status == 0
        assert recorded(out) == 24
        back = dict(zip(names, PLAYERS, strict=True))
        ranking = [{**row, "player": back[row["player"]]} for row in rows(out / "ranking.csv")]
        pairs = [
            {**row, "player": back[row["player"]], "opponent": back[row["opponent"]]}
            for row in rows(out / "pairs.csv")
        ]
        found.append((ranking, pairs))
    assert found[0] == found[1]


def test_a_program_that_thinks_too_long_has_lost(tmp_path: Path, command: Command) -> None:
    arena, players = write_arena(tmp_path, {"endless": ENDLESS, "still": drives(0)}, starts=0)
    out = tmp_path / "out"
    assert command("tournament", arena, players, "-o", out).status == 0
    runs = rows(out / "runs.csv")
    assert [(row["outcome"], row["last_tick"]) for row in runs] == [("too many steps", "10")] * 2
    assert {row["forfeit"] for row in runs} == {"red", "blue"}
    shares = [(row["player"], row["share"]) for row in rows(out / "ranking.csv")]
    assert shares == [("still", "1.0"), ("endless", "0.0")]
    assert command("lab", "report", out).status == 0
    assert "thinking took more than 100,000 steps" in (out / "report.html").read_text("utf-8")


@pytest.mark.slow
def test_hostile_players_get_nothing_from_it(tmp_path: Path, command: Command) -> None:
    robot = (
        'Robot(robot_name: "of {}", desire: {{left_engine: -1, right_engine: -1}}, memory: "");\n'
    )
    texts = {
        "plain": drives(0.8),
        "names the others": robot.format("red") + robot.format("blue"),
        "looks like a match": '# teams: {"red": 1, "blue": 9}\n' + drives(0.6),
        "floods": drives(0).replace('memory: ""', "memory: Range(20000)"),
    }
    arena, players = write_arena(tmp_path, texts, starts=0, ticks=40)
    out = tmp_path / "out"
    assert command("tournament", arena, players, "-o", out).status == 0
    ranking = rows(out / "ranking.csv")
    assert [row["player"] for row in ranking[:2]] == ["plain", "looks like a match"]
    assert {row["remark"] for row in ranking} == {""}
    assert {row["forfeit"] for row in rows(out / "runs.csv")} == {""}


def test_a_match_that_ends_every_worker_is_left_out(tmp_path: Path, command: Command) -> None:
    programs = {name: drives(speed) for name, speed in PLAYERS.items()}
    programs["still"] += "# deadly from 1;\n"
    arena, players = write_arena(tmp_path, programs)
    out = tmp_path / "out"
    told = command("tournament", arena, players, "-o", out, status=1)
    assert "6 runs could not be done (infrastructure)" in told.out
    assert "  fast against still in hill, start 1: its worker process died\n" in told.out
    assert command("lab", "export", out).status == 1
    ranking = rows(out / "ranking.csv")
    assert [row["player"] for row in ranking] == ["fast", "quick", "slow", "still"]
    assert [row["opponents"] for row in ranking] == ["3"] * 4, "they have met from the given start"


def test_from_forty_players_on_it_is_swiss_and_one_is_not_enough(tmp_path: Path) -> None:
    arena, players = write_arena(tmp_path, {f"p{n}": drives(1) for n in range(40)})
    manifest, _ = plan_tournament(arena, players)
    assert (len(manifest.rounds), manifest.most_rounds) == (1, 8)
    assert len(manifest.rounds[0]) == 20
    (players / "p0.l").unlink()
    manifest, inputs = plan_tournament(arena, players)
    assert (manifest.most_rounds, len(manifest.rounds[0])) == (1, 39 * 38 / 2)
    assert len(inputs) == 2, "the level and the program"
    for number in range(2, 40):
        (players / f"p{number}.l").unlink()
    with pytest.raises(InputError, match="fewer than two players"):
        plan_tournament(arena, players)


@pytest.mark.slow
def test_with_four_teams_each_player_has_each_seat_once(tmp_path: Path, command: Command) -> None:
    teams = ("red", "blue", "gold", "green")
    arena, players = write_arena(tmp_path, teams=teams, starts=0)
    out = tmp_path / "out"
    assert command("tournament", arena, players, "-o", out).status == 0
    manifest = Folder(out).manifest()
    for pair in manifest.rounds[0]:
        names = {manifest.players[index].name for index in pair}
        seats = [cell.settings for cell in manifest.cells if set(cell.settings.values()) == names]
        assert len(seats) == 2
        for team in teams:
            assert {seat[team] for seat in seats} == names
    assert rows(out / "ranking.csv")[0]["player"] == "fast"
