"""Restricted mode: whoever plays has a folder and the game, and nothing else of the machine."""

import os
import subprocess
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import pytest

from logical_robots_tui.cli.play import clear_environment
from logical_robots_tui.confinement import MOST_DEPTH, MOST_FILES
from logical_robots_tui.errors import InputError
from logical_robots_tui.player.drafts import release
from logical_robots_tui.player.recovery import MOST_GAMES, OpenGames
from tests.attempts import ATTEMPT
from tests.cli.running import Command, Told
from tests.terminal import Terminal
from tests.waiting import PATIENCE, until
from tests.web import WEB_DRIVER

ATTEMPTS = (
    ATTEMPT
    + """\
import ctypes, io, json, os, pathlib, shutil, socket, sqlite3, subprocess, sys
from logical_robots_tui.cli.play import restrict

secret, neighbour, own = map(pathlib.Path, sys.argv[1:])
own.mkdir(parents=True, exist_ok=True)
(own / "link.l").symlink_to(secret)
(own / "folder").symlink_to(neighbour)
restrict(own)
attempt("read", lambda: secret.read_text())
attempt("read by link", lambda: (own / "link.l").read_text())
attempt("read around a corner", lambda: open(f"{own}/../../{secret.name}"))
attempt("read by bytes", lambda: os.open(os.fsencode(secret), os.O_RDONLY))
attempt("read the system's settings", lambda: open("/etc/hostname"))
attempt("read a program of the system", lambda: open("/usr/bin/env", "rb"))
attempt("read what is shared", lambda: open("/usr/share/common-licenses/GPL-3"))
attempt("read what is installed besides", lambda: open("/usr/local/etc/anything"))
attempt("list what is installed", lambda: os.listdir("/usr"))
attempt("read a home", lambda: open("/etc/passwd"))
attempt("read memory", lambda: open("/proc/self/environ"))
attempt("write", lambda: secret.write_text("mine"))
attempt("write at a neighbour's", lambda: (own / "folder" / "x").write_text("mine"))
attempt("write into the game", lambda: open(sys.modules["logical_robots_tui"].__file__, "a"))
attempt("list", lambda: os.listdir(neighbour))
attempt("list by link", lambda: os.scandir(own / "folder"))
attempt("move", lambda: secret.rename(own / "mine"))
attempt("move away", lambda: (own / "link.l").rename(neighbour / "x"))
attempt("delete", lambda: secret.unlink())
attempt("link", lambda: (own / "more").symlink_to(secret))
attempt("hard link", lambda: os.link(secret, own / "more"))
attempt("make a folder", lambda: (neighbour / "x").mkdir())
attempt("attach", lambda: sqlite3.connect(neighbour / "x.db"))
attempt("attach by address", lambda: sqlite3.connect(f"file:{secret}?mode=ro", uri=True))
attempt("shell", lambda: os.system("true"))
attempt("run", lambda: subprocess.run(["true"]))
attempt("run python", lambda: subprocess.run([sys.executable, "-c", "pass"]))
attempt("become", lambda: os.execv("/bin/sh", ["sh"]))
attempt("fork", lambda: os.fork())
attempt("call", lambda: socket.create_connection(("127.0.0.1", 9)))
def send():
    with socket.socket(type=socket.SOCK_DGRAM) as wire:
        wire.sendmsg([b"x"], [], 0, ("127.0.0.1", 9))
attempt("send", send)
attempt("ask for an address", lambda: socket.getaddrinfo("localhost", 9))
attempt("ask for an address by name", lambda: socket.gethostbyname("localhost"))
attempt("load", lambda: ctypes.CDLL("libc.so.6"))
attempt("fill the disk", lambda: (own / "big").write_bytes(bytes(65 * 1024**2)))
attempt("fill memory", lambda: bytearray(3 * 1024**3))
from logical_robots_tui.paths import write_atomically
packages = own / ".local/lib/python3.11/site-packages"
attempt("own hidden folder", lambda: packages.mkdir(parents=True))
(own / ".local").mkdir(exist_ok=True)
attempt("write a module's path", lambda: (own / ".local" / "evil.pth").write_text("import evil"))
attempt("save a module's path", lambda: write_atomically(own / "evil.pth", "import evil"))
attempt("save a shell's settings", lambda: write_atomically(own / ".profile", "true"))
attempt("save a hidden program", lambda: write_atomically(own / ".mine.l", "true"))
attempt("save over the progress", lambda: write_atomically(own / "progress.sqlite", ""))
attempt("save", lambda: write_atomically(own / "mine.l", ""))
attempt("own file", lambda: (own / "mine.l").write_text("mine"))
attempt("own file read", lambda: (own / "mine.l").read_text())
attempt("own folder", lambda: list(own.iterdir()))
attempt("own database", lambda: sqlite3.connect(own / "mine.db").execute("create table t(a)"))
attempt("database in memory", lambda: sqlite3.connect(":memory:").execute("select 1"))

from logical_robots_tui import Program, load_level, list_levels
from logical_robots_tui.game import load_program
def said(work):
    try:
        work()
        return "nothing"
    except Exception as error:
        return getattr(error, "message", repr(error))
from logical_robots_tui.game.source import target
from logical_robots_tui.paths import typed_path
paths = [
    secret, secret.with_name("nothing.l"), neighbour, pathlib.Path(json.__file__), own / "link.l",
    neighbour / "a" / "b.l", pathlib.Path("/proc/self/environ"), pathlib.Path("/x"),
]
names = [*map(str, paths), "~root/x", "~nobody-knows/x"]
answers = {
    "program": {said(lambda: load_program(path)) for path in paths},
    "level": {said(lambda: load_level(path)) for path in paths},
    "typed": {said(lambda: typed_path(name)) for name in names},
    "target": {said(lambda: target(name, own)) for name in names},
}
found["answers"] = {name: sorted(told) for name, told in answers.items()}
attempt("a level", lambda: load_level(list_levels()[0]))
attempt("compile", lambda: Program.compile(load_program("first-steps").text))
print(json.dumps(found))
"""
)

ALLOWED = {
    *("save", "own file", "own file read", "own folder", "own database", "database in memory"),
    *("a level", "compile"),
}
REFUSALS = {"fill the disk": "OSError", "fill memory": "MemoryError", "link": "PermissionError"}


def test_a_restricted_process_reaches_its_own_folder_and_the_game_and_nothing_else(
    tmp_path: Path,
) -> None:
    secret = tmp_path / "secret.l"
    secret.write_text("nobody's business")
    neighbour = tmp_path / "players" / "ben"
    neighbour.mkdir(parents=True)
    own = tmp_path / "players" / "ada"
    found = finished([sys.executable, "-c", ATTEMPTS, secret, neighbour, own]).data
    for what, answers in found.pop("answers").items():
        assert len(answers) == 1, (what, answers)
        assert "restricted mode allows only your own files" in answers[0]
    expected = {n: "done" if n in ALLOWED else REFUSALS.get(n, "PermissionError") for n in found}
    assert found == expected
    assert set(found) > ALLOWED
    assert secret.read_text() == "nobody's business"
    assert not list(neighbour.iterdir())


@pytest.mark.parametrize(
    ("kept", "others"),
    [
        ({"TERM": "xterm"}, {"TEXTUAL_DRIVER": "os:system", "COLUMNS": "x"}),
        ({"TEXTUAL_DRIVER": WEB_DRIVER, "COLUMNS": "80", "ROWS": "24"}, {}),
    ],
    ids=["terminal", "browser"],
)
def test_a_restricted_game_takes_nothing_from_the_environment_or_a_home_but_what_it_needs(
    kept: dict[str, str], others: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = {**kept, "LC_ALL": "C.UTF-8", "HOME": "/home/ada"}
    others = {**others, "TEXTUAL_LOG": "x", "PYTHONPATH": "x", "EDITOR": "x"}
    monkeypatch.setattr(os, "environ", {**kept, **others})
    clear_environment()
    assert os.environ == kept
    monkeypatch.setattr("site.ENABLE_USER_SITE", True)
    with pytest.raises(InputError, match="loads no packages from home folders"):
        clear_environment()


@pytest.mark.parametrize("name", ["progress.sqlite", ".game-0"])
def test_a_link_in_place_of_a_file_of_the_game_leads_nowhere(tmp_path: Path, name: str) -> None:
    own, elsewhere = tmp_path / "players" / "ada", tmp_path / "elsewhere"
    own.mkdir(parents=True)
    (own / name).symlink_to(elsewhere)
    told = in_lines(tmp_path, "step\nquit\n", "02-open-space")
    assert told.status in (0, 2), told
    assert "can't be " in told.out + told.err
    assert not elsewhere.exists()


def game(folder: Path, *arguments: str) -> Sequence[object]:
    command = [sys.executable, "-m", "logical_robots_tui", "play", "--restricted"]
    return [*command, "--data-dir", folder, "--player", "ada", *arguments]


def opened(command: Sequence[object]) -> subprocess.Popen[str]:
    pipe = subprocess.PIPE
    return subprocess.Popen([*map(str, command)], stdin=pipe, stdout=pipe, stderr=pipe, text=True)


def finished(command: Sequence[object], typed: str = "") -> Told:
    with opened(command) as process:
        out, err = process.communicate(typed, PATIENCE)
    return Told(process.returncode, out, err)


def in_lines(folder: Path, script: str, *arguments: str) -> Told:
    return finished(game(folder, "--plain", *arguments), script)


@pytest.mark.slow
def test_a_restricted_game_says_what_is_off(tmp_path: Path) -> None:
    secret = tmp_path / "secret.l"
    secret.write_text("# nobody's business")
    with Terminal(game(tmp_path, "02-open-space"), size=(160, 40)) as terminal:
        terminal.wait_for("· applied")
        terminal.send("E")
        terminal.wait_for("External editors are disabled")
        terminal.send("\x1a")
        terminal.wait_for("no shell")
        for key, asks, path in (
            ("o", "type to filter", secret),
            ("s", "my-open-space", tmp_path / "stolen.l"),
        ):
            terminal.send(key)
            terminal.wait_for(asks)
            if key == "s":
                terminal.send("\x15")
                terminal.wait_for(lambda: "my-open-space" not in terminal.text)
            terminal.send(str(path))
            terminal.wait_for(path.name)
            terminal.send("\r")
            # Where the message is wrapped depends on how long the path is.
            terminal.wait_for(lambda: "restricted" in terminal.text.split())
            terminal.send("\x1b")
            terminal.wait_for(lambda: "restricted" not in terminal.text.split())
        terminal.send("q")
        assert terminal.finish() == 0
        assert "nobody" not in terminal.everything
        assert "\x1b]52" not in terminal.everything
    assert not (tmp_path / "stolen.l").exists()
    assert (tmp_path / "players" / "ada").is_dir()


@pytest.mark.parametrize("name", ["../ben", "", ".", "a/b", "x" * 40])
def test_a_players_name_is_not_a_path(name: str, command: Command) -> None:
    assert "is not a name" in command("play", "--player", name).refusal


@pytest.mark.slow
def test_nobody_gets_the_folders_of_all(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "logical_robots_tui", "play", "02-open-space", "--plain"]

    def played(*arguments: str) -> Told:
        return finished([*command, "--data-dir", tmp_path, *arguments])

    assert played("--restricted").status == 0
    assert played("--restricted", "--player", "ada").status == 0
    refusal = played("--restricted").refusal
    assert "No player is named" in refusal
    assert "LOGICAL_ROBOTS_PLAYER=NAME" in refusal
    assert played("--restricted", "--player", "ben").status == 0
    assert played().status == 0


def test_a_folder_that_cant_be_made_is_told_in_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "players").write_text("in the way")
    refusal = in_lines(tmp_path, "").refusal
    assert "The player's folder can't be used: " in refusal
    assert "mistake" not in refusal


def test_a_player_in_lines_is_told_of_another_game_and_can_end_it(tmp_path: Path) -> None:
    own = tmp_path / "players" / "ada"
    own.mkdir(parents=True)
    hung = OpenGames(own)
    with opened(game(tmp_path, "--plain", "02-open-space")) as second:
        assert second.stdin is not None
        second.stdin.write("yes\n")
        second.stdin.flush()
        until(lambda: hung.is_to_end)
        release(hung._handle)
        told, _ = second.communicate("step\n", PATIENCE)
    assert "Another game has been open since" in told
    assert "yes: Yes, end it" in told
    assert told.endswith("Tick 1.\n")
    games = [OpenGames(own) for _ in range(MOST_GAMES)]
    assert f"You have {MOST_GAMES} games open" in in_lines(tmp_path, "").refusal
    release(games.pop()._handle)
    assert in_lines(tmp_path, "quit\n").status == 0
    for other in games:
        release(other._handle)


@pytest.mark.slow
def test_a_player_is_told_of_another_game_and_can_end_it(tmp_path: Path) -> None:
    with Terminal(game(tmp_path, "02-open-space")) as hung, ExitStack() as later:
        hung.wait_for("· applied")
        hung.send("2hello")
        hung.wait_for("hello")
        second = later.enter_context(Terminal(game(tmp_path, "02-open-space")))
        second.wait_for("Another game has been open since")
        second.wait_for("Yes, end it")
        second.send("y")
        assert hung.finish() == 0  # a terminal that nobody reads would hold up its end
        second.wait_for("Continue with your unsaved text")
        second.wait_for("Yes, continue")
        second.send("y")
        second.wait_for("helloFreedom")
        second.send("q")
        assert second.finish() == 0


FILLS_CACHES = """if True:
    import os, sys
    from pathlib import Path

    from logical_robots_tui.confinement import MOST_BYTES, MOST_FILES, check_quota, confine
    from logical_robots_tui.game.history import recording
    from logical_robots_tui.mind import compilation

    own = Path(sys.argv[1])
    confine(own)
    folders = recording._folder(), compilation.compiled_programs()
    for folder, count in zip(folders, (20, 400)):
        for number in range(count):
            folder.keep(f"e{number}", [bytes(folder.most_bytes // count * 2)])
            os.utime(folder.place / f"e{number}{folder.suffix}", (number, number))
    found = [path.stat().st_size for path in own.rglob("*") if path.is_file()]
    assert len(found) < MOST_FILES / 4, len(found)
    assert MOST_BYTES / 20 < sum(found) < MOST_BYTES / 4, sum(found)
    check_quota(own / "mine.l", 100 * 2**20)
"""


@pytest.mark.slow
def test_caches_leave_players_much_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LOGICAL_ROBOTS_CACHE_DIR", str(tmp_path / "cache"))
    told = finished([sys.executable, "-c", FILLS_CACHES, tmp_path])
    assert told.status == 0, told.err


CHANGES_BESIDE = """if True:
    import subprocess, sys
    from pathlib import Path

    from logical_robots_tui import confinement
    from logical_robots_tui.confinement import MOST_BYTES, check_quota, confine

    own = Path(sys.argv[1])
    (own / "levels").mkdir()
    confine(own)

    def is_full():
        try:
            check_quota(own / "mine.l", 1)
        except OSError:
            return True
        return False

    def run(program):
        subprocess.run([sys.executable, "-c", program, own / "levels" / "x.toml"], check=True)

    write = f"import os, sys; os.truncate(os.open(sys.argv[1], os.O_CREAT | 2), {MOST_BYTES})"
    for nanoseconds in (confinement._SETTLED, 0):
        confinement._SETTLED = nanoseconds
        assert not is_full()
        run(write)
        assert is_full()
        run("import os, sys; os.unlink(sys.argv[1])")
        assert not is_full()
"""


def test_the_quota_counts_what_other_processes_write_and_remove(tmp_path: Path) -> None:
    told = finished([sys.executable, "-c", CHANGES_BESIDE, tmp_path])
    assert told.status == 0, told.err


def test_a_game_in_lines_is_fenced_in_and_a_full_folder_is_told_in_a_sentence(
    tmp_path: Path,
) -> None:
    programs = tmp_path / "players" / "ada" / "programs"
    programs.mkdir(parents=True)
    for number in range(MOST_FILES):
        (programs / f"p{number}.l").touch()
    script = "save mine\nsave ./0/mine.l\nstep\nopen /etc/passwd\nquit\n"
    told = in_lines(tmp_path, script, "02-open-space")
    assert (told.status, told.err) == (0, "")
    assert f"your folder is full: it holds {MOST_FILES:,} files and folders" in told.out
    assert "Tick 1." in told.out
    assert "restricted mode allows only your own files" in told.out
    assert len(list(programs.iterdir())) == MOST_FILES
    assert not [folder for folder in programs.parent.rglob("*") if folder.name in ("mine.l", "0")]


def test_folders_are_counted_and_not_deep(tmp_path: Path) -> None:
    own = tmp_path / "players" / "ada"
    own.mkdir(parents=True)
    for number in range(MOST_FILES - 30):  # files: a folder takes far longer to count
        (own / f"p{number}.l").touch()
    deep = "/".join("a" * MOST_DEPTH)
    saves = [f"./{deep}/a/mine.l", f"./{deep}/mine.l", *(f"./n{n}/mine.l" for n in range(15))]
    script = "".join(f"save {path}\n" for path in saves)
    told = in_lines(tmp_path, script + "quit\n", "02-open-space")
    assert (told.status, told.err) == (0, "")
    assert f"at most {MOST_DEPTH} folders can be in each other" in told.out
    assert told.out.count("Saved") == 1 + len(list(own.rglob("n*/mine.l"))), told.out
    assert f"it holds {MOST_FILES:,} files and folders" in told.out
    assert len(list(own.rglob("*"))) <= MOST_FILES + 10
