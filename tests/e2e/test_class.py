"""The recipe of docs/ssh.md for a class, word for word, against a real sshd."""

import getpass
import json
import os
import re
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.attempts import ATTEMPT
from tests.crowd import Crowd
from tests.installed import CHECKOUT, Installed
from tests.processes import run_command
from tests.sshd import SSHD, Server, is_listening
from tests.terminal import Terminal
from tests.waiting import until

pytestmark = pytest.mark.skipif(
    SSHD is None and "CI" not in os.environ, reason="openssh-server is not installed"
)

PAGE = CHECKOUT / "docs/ssh.md"
NAMES = [f"player-{number}" for number in range(30)]


def recipe(kind: str) -> str:
    (block,) = re.findall(rf"```{kind}\n(.*?)```", PAGE.read_text(), re.DOTALL)
    return str(block)


@dataclass(frozen=True)
class School:
    server: Server
    players: Path

    def seat(self, name: str, *options: str) -> Terminal:
        return Terminal(self.server.client("-t", *options, player=name), size=(80, 24))

    def ssh(
        self,
        *options: str,
        words: tuple[str, ...] = (),
        typed: str = "",
        player: str = NAMES[0],
    ) -> subprocess.CompletedProcess[str]:
        return run_command([*self.server.client(*options, player=player), *words], input=typed)

    def scp(self, how: str, there: str, here: Path) -> subprocess.CompletedProcess[str]:
        *options, host = self.server.client(player=NAMES[0])[3:]
        options[0] = "-P"
        return run_command(
            ["scp", how, *options, "-F", "none", f"{host}:{there}", str(here)], input=""
        )


@contextmanager
def school_for(names: list[str], folder: Path, installed: Installed) -> Iterator[School]:
    """A machine on which the recipe was followed; the account is that of these tests."""
    config = recipe("sshd_config")
    for ours, theirs in (
        ("User robots", f"User {getpass.getuser()}"),
        ("/usr/local/bin/logical-robots", str(installed.command)),
        ("/srv/robots", str(folder / "srv")),
        ("/etc/ssh/robots.keys", str(folder / "keys")),
    ):
        assert ours in config
        config = config.replace(ours, theirs)
    line = recipe("authorized_keys").strip().replace("ada", "{name}", 1)
    keys = line.replace(line[line.index("ssh-ed25519") :], "{key}")
    with Server(folder, config, names, keys) as server:
        yield School(server, folder / "srv" / "players")


@pytest.fixture(scope="module")
def school(installed: Installed, tmp_path_factory: pytest.TempPathFactory) -> Iterator[School]:
    with school_for(NAMES[:2], tmp_path_factory.mktemp("school"), installed) as school:
        yield school


@pytest.mark.slow
def test_each_player_has_the_game_and_a_folder_by_the_name_of_their_key(school: School) -> None:
    with school.seat(NAMES[0]) as ada, school.seat(NAMES[1], "-o", "SendEnv=LOGICAL_*") as ben:
        for terminal in (ada, ben):
            terminal.wait_for("skip the tour")
            terminal.wait_for("· applied")
        ada.send("\x1b")
        ada.wait_for(lambda: "skip the tour" not in ada.text)
        ada.send("E")
        ada.wait_for("disabled here")
    assert {NAMES[0], NAMES[1]} <= {folder.name for folder in school.players.iterdir()}


def test_the_command_of_the_recipe_plays_in_lines_of_text(tmp_path: Path) -> None:
    (line,) = re.findall(r"ForceCommand \S+ (.*)", recipe("sshd_config"))
    arguments = line.replace("/srv/robots", str(tmp_path)).split()
    environment = {**os.environ, "LOGICAL_ROBOTS_PLAYER": NAMES[0], "SSH_ORIGINAL_COMMAND": "plain"}
    command = [sys.executable, "-m", "logical_robots_tui", *arguments]
    done = run_command(command, input="hint\nsave mine\n", env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    assert all(words in done.stdout for words in ("First steps", "Hint 1: ", "Saved as mine in"))
    assert (tmp_path / "players" / NAMES[0] / "programs" / "mine.l").exists()


@pytest.mark.slow
def test_a_player_learns_and_inspects_in_lines_of_text(school: School) -> None:
    typed = "hint\nlook\nstep 3\nwhy\norigin\nask Robot\ndiagnose\nline 1 #\napply\nsave mine\nnext"
    done = school.ssh(words=("plain",), typed=typed)
    assert (done.returncode, done.stderr) == (0, "")
    shown = """First steps; Hint 1: ; ahead: ; Robot for Ada at tick 3; 1. Ada's memory = ;
        IN THE MIND OF; Ticks 1 to 3, not won.; will use it; Saved as mine in; Open space"""
    for words in shown.split(";"):
        assert words.strip() in done.stdout
    assert (school.players / NAMES[0] / "programs" / "mine.l").read_text().startswith("#\n")


@pytest.mark.slow
def test_a_hostile_client_gets_no_shell_file_or_forwarding(school: School, tmp_path: Path) -> None:
    stolen = tmp_path / "stolen"
    for wish in ("sh -c 'echo pw$((1))ned'", "cat /etc/passwd", "scp -f /etc/passwd"):
        done = school.ssh(words=(wish,))
        assert done.returncode == 2
        assert "The game needs a terminal" in done.stderr
        assert "pw1ned" not in done.stdout
        assert "root:" not in done.stdout
    school.ssh(words=("touch", str(stolen)))
    assert not stolen.exists()
    assert school.ssh("-s", words=("sftp",)).returncode != 0

    for how, words in {"-O": "game needs a terminal", "-s": "Connection closed"}.items():
        assert words in PAGE.read_text()
        copied = tmp_path / "copied"
        done = school.scp(how, "/etc/passwd", copied)
        assert done.returncode != 0
        assert words in done.stderr
        assert not copied.exists()

    someone_else = "-o", "SetEnv=LOGICAL_ROBOTS_PLAYER=mallory"
    with school.seat(NAMES[0], *someone_else, "-o", "SetEnv=LD_PRELOAD=x.so") as terminal:
        terminal.wait_for("· applied")
    assert not (school.players / "mallory").exists()

    with socket.create_server(("127.0.0.1", 0)) as inside:
        port = inside.getsockname()[1]
        assert school.ssh("-W", f"127.0.0.1:{port}").returncode != 0
        inside.setblocking(False)
        with pytest.raises(BlockingIOError):
            inside.accept()
        back = school.ssh("-N", "-o", "ExitOnForwardFailure=yes", "-R", f"0:127.0.0.1:{port}")
        assert back.returncode != 0
    for way in (("-L", "{free}:127.0.0.1:{sshd}"), ("-D", "{free}")):
        assert not leads_anywhere(school, *way)


@pytest.mark.slow
@pytest.mark.proof
@pytest.mark.parametrize("count", [12, 30])
def test_a_class_plays_at_once(count: int, installed: Installed, tmp_path: Path) -> None:
    names = NAMES[:count]
    with school_for(names, tmp_path, installed) as school, ExitStack() as stack:
        crowd = Crowd([stack.enter_context(school.seat(name)) for name in names])
        crowd.play()
        crowd.edit()
        assert len(crowd.key_milliseconds(2 * len(names))) == 2 * len(names)


BREAKS_OUT = (
    ATTEMPT
    + """\
import fcntl, json, os, pathlib, pty, socket, subprocess, sys, termios
port, outside, neighbour, own = int(sys.argv[1]), *map(pathlib.Path, sys.argv[2:])
attempt("call", lambda: socket.create_connection(("127.0.0.1", port), 5))
attempt("write", lambda: (outside / "touched").write_text("x"))
attempt("fill memory", lambda: pathlib.Path("/dev/shm/x").write_text("x"))
attempt("write into the system", lambda: pathlib.Path("/usr/touched").write_text("x"))
attempt("read a neighbour's", lambda: neighbour.read_text())
attempt("mount", lambda: subprocess.run(["mount", "-t", "tmpfs", "x", "/usr"], check=True))
attempt("remount", lambda: subprocess.run(["mount", "-o", "remount,rw", "/"], check=True))
attempt("kill", lambda: os.kill(int((outside / "pid").read_text()), 0))
attempt("many processes", lambda: [subprocess.Popen(["sleep", "5"]) for _ in range(100)])
attempt("much memory", lambda: bytearray(3 * 1024**3))
attempt("read the accounts", lambda: pathlib.Path("/etc/passwd").read_text())
attempt("make users", lambda: subprocess.run(["unshare", "-Ur", "true"], check=True))
def type_into_the_terminal():
    child, _ = pty.fork()
    if child == 0:
        try:
            fcntl.ioctl(0, termios.TIOCSTI, b"x")
        finally:
            os._exit(1 if sys.exc_info()[0] else 0)
    if os.waitpid(child, 0)[1]:
        raise OSError
attempt("type into the terminal", type_into_the_terminal)
attempt("read the environment", lambda: os.environ["SECRET"])
attempt("own file", lambda: (own / "mine.l").write_text("x"))
found["processes"] = sum(name.isdecimal() for name in os.listdir("/proc")) < 90
print(json.dumps(found))
"""
)


def has_walls() -> str:
    """Why there can be no second wall on this machine, or ""."""
    bwrap = shutil.which("bwrap")
    if bwrap is None or shutil.which("prlimit") is None:
        return "bubblewrap is not installed"
    done = run_command([bwrap, "--unshare-all", "--ro-bind", "/", "/", "--proc", "/proc", "true"])
    return f"the kernel forbids namespaces: {done.stderr.strip()}" if done.returncode else ""


@pytest.fixture
def wall(tmp_path: Path, installed: Installed) -> Path:
    """The script of the recipe, for players in a folder of these tests."""
    if why := has_walls():
        pytest.skip(why)
    script, bpf = tmp_path / "robots-session", tmp_path / "robots-session.bpf"
    makes = recipe("robots-filter").replace("/usr/local/lib/robots-session.bpf", str(bpf))
    run_command(["sh", "-c", makes], check=True)
    text = recipe("robots-session").replace("/srv/robots", str(tmp_path / "srv"))
    text = text.replace("/usr/local/lib/robots-session.bpf", str(bpf))
    # These tests, and the Python that they run in, are not where the recipe puts the game.
    homes = [CHECKOUT, sys.prefix, os.path.realpath(sys.base_prefix), installed.root]
    homes += [tmp_path / name for name in ("breaks_out.py", "pid")]
    text = text.replace('needed="', f'needed="{" ".join(map(str, homes))} ')
    script.write_text(text)
    script.chmod(0o755)
    return script


def walled(folder: Path, command: str) -> Server:
    config = f"PermitUserEnvironment LOGICAL_ROBOTS_PLAYER\nForceCommand {command}\n"
    keys = 'restrict,pty,environment="LOGICAL_ROBOTS_PLAYER={name}" {key}'
    return Server(folder, config, NAMES[:2], keys)


@pytest.mark.slow
def test_behind_the_second_wall_the_game_is_played_and_kept(
    wall: Path, installed: Installed, tmp_path: Path
) -> None:
    folder = tmp_path / "sshd"
    folder.mkdir()
    play = f"{wall} {installed.command} play --restricted --data-dir {tmp_path / 'srv'}"
    with walled(folder, play) as server, School(server, tmp_path).seat(NAMES[0]) as terminal:
        terminal.wait_for("· applied")
        terminal.send("\x1b")
        terminal.wait_for(lambda: "skip the tour" not in terminal.text)
        terminal.send("n", sees="tick 1 ")
        terminal.send("q")
        assert terminal.finish() == 0
    assert (tmp_path / "srv" / "players" / NAMES[0] / "progress.sqlite").exists()


@pytest.mark.slow
def test_from_behind_the_second_wall_there_is_no_way_out(wall: Path, tmp_path: Path) -> None:
    folder = tmp_path / "sshd"
    folder.mkdir()
    players = tmp_path / "srv" / "players"
    (players / NAMES[1]).mkdir(parents=True)
    secret = players / NAMES[1] / "secret.l"
    secret.write_text("nobody's business")
    (tmp_path / "pid").write_text(str(os.getpid()))
    script = tmp_path / "breaks_out.py"
    script.write_text(BREAKS_OUT)
    with socket.create_server(("127.0.0.1", 0)) as inside:
        port = inside.getsockname()[1]
        tries = f"{sys.executable} {script} {port} {tmp_path} {secret} {players / NAMES[0]}"
        with walled(folder, f"{wall} {tries}") as server:
            done = School(server, players).ssh()
    found = json.loads(done.stdout.splitlines()[-1])
    if os.geteuid() == 0:  # whose processes nobody counts
        del found["many processes"], found["processes"]
        found["processes"] = True
    allowed = {name: outcome for name, outcome in found.items() if outcome in ("done", True)}
    assert allowed == {"own file": "done", "processes": True}, found
    assert (players / NAMES[0] / "mine.l").read_text() == "x"
    assert secret.read_text() == "nobody's business"
    assert not (tmp_path / "touched").exists()


@pytest.mark.slow
def test_players_share_a_board_and_one_in_the_sandbox_reads_no_other_s_program(
    wall: Path, installed: Installed, tmp_path: Path
) -> None:
    board, data = tmp_path / "srv-board", tmp_path / "srv"
    board.mkdir()
    play = (
        f"{installed.command} play 01-first-steps mine --restricted "
        f"--data-dir {data} --board {board} --class"
    )
    text = (CHECKOUT / "programs" / "first-steps.l").read_text("utf-8")
    for number, (name, command) in enumerate(zip(NAMES, (f"{wall} {play}", play), strict=False)):
        programs, folder = data / "players" / name / "programs", tmp_path / f"sshd-{number}"
        programs.mkdir(parents=True)
        folder.mkdir()
        (programs / "mine.l").write_text(f"{text}\n# of {name}\n", "utf-8")
        with walled(folder, command) as server:
            school = School(server, data)
            done = school.ssh(words=("plain",), typed=f"run\nboard {name}\nquit\n", player=name)
            assert (done.returncode, done.stderr) == (0, "")
            assert f"You are on the board as {name}." in done.stdout

    shown = run_command([str(installed.command), "board", "show", str(board)]).stdout
    assert all(name in shown for name in NAMES[:2])
    done = run_command([str(installed.command), "board", "check", str(board)])
    assert (done.returncode, done.stdout.splitlines()[-1]) == (0, "2 confirmed")

    theirs, folder = board / "programs" / NAMES[1], tmp_path / "sshd"
    folder.mkdir()
    (secret,) = theirs.glob("*.l")
    tries = f"ls {board}/programs; cat {secret}; touch {board}/programs/x; echo x >> {board}/x"
    with walled(folder, f"{wall} sh -c '{tries}'") as server:
        done = School(server, data).ssh()
    assert done.stdout.split() == [NAMES[0]]
    assert done.stderr.count("No such file") == 1
    assert done.stderr.count("Read-only file system") == 1
    assert (board / "x").exists()


def words_of(name: str) -> list[str]:
    """The command that the script of the recipe keeps by that name."""
    (found,) = re.findall(rf'^{name}="(.*) --"$', recipe("robots-session"), re.MULTILINE)
    return str(found).split()


@pytest.mark.parametrize("has_systemd", [pytest.param(True, marks=pytest.mark.slow), False])
def test_a_session_runs_in_systemd_s_scope(has_systemd: bool, wall: Path, tmp_path: Path) -> None:
    """Something in the place of systemd-run notes how it is called, or fails as that does."""
    notes = tmp_path / "notes"
    stand_in = tmp_path / "bin" / "systemd-run"
    stand_in.parent.mkdir()
    runs = 'while [ "$1" != -- ]; do shift; done; shift; exec "$@"' if has_systemd else "exit 1"
    stand_in.write_text(f'#!/bin/sh\necho "$@" >> {notes}\n{runs}\n')
    stand_in.chmod(0o755)
    path = f"{stand_in.parent}:{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "LOGICAL_ROBOTS_PLAYER": NAMES[0]}
    done = run_command([str(wall), "echo", "inside"], env=environment)
    assert (done.returncode, done.stdout) == (0, "inside\n")
    calls = notes.read_text().splitlines()
    assert len(calls) == (2 if has_systemd else 1)
    assert all(call.startswith(" ".join(words_of("scope")[1:])) for call in calls)
    assert not has_systemd or "-- bwrap --unshare-all" in calls[1]


def leads_anywhere(school: School, option: str, way: str) -> bool:
    """Whether a port that a client opens on its side leads to a server beyond the school's."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        free = probe.getsockname()[1]
    sshd = school.server.port
    ssh = school.server.client("-N", option, way.format(free=free, sshd=sshd), player=NAMES[0])
    target = b"\x05\x01\x00\x01\x7f\x00\x00\x01" + sshd.to_bytes(2, "big")
    with subprocess.Popen(ssh, stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as client:
        try:
            until(lambda: is_listening(free))
            with socket.create_connection(("127.0.0.1", free), 10) as end:
                if option == "-D":
                    end.sendall(b"\x05\x01\x00")  # a greeting
                    assert end.recv(2) == b"\x05\x00"
                    end.sendall(target)
                return b"SSH" in end.recv(64)
        except ConnectionError:
            return False
        finally:
            client.kill()  # ssh may overlook a wish to end until the server writes again
