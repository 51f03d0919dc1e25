"""What docs/ssh.md says of the account for a class, and of its bounds, is so."""

import os
import shutil
import signal
import subprocess
from pathlib import Path

import pytest

from tests.e2e.test_class import recipe, words_of
from tests.processes import run_command
from tests.sshd import SSHD, Server


@pytest.mark.slow
@pytest.mark.skipif(
    SSHD is None and "CI" not in os.environ, reason="openssh-server is not installed"
)
def test_sshd_prints_nothing_at_a_login_to_a_home_that_cannot_be_changed(tmp_path: Path) -> None:
    if os.geteuid() != 0 or not all(map(shutil.which, ("useradd", "unshare"))):
        pytest.skip("nobody but root can make an account")
    own = tmp_path / "etc"  # a copy, which only this sshd sees
    shutil.copytree("/etc", own, symlinks=True)
    mounts = f"mount --bind {own} /etc; mount -t tmpfs x /srv; mount -t tmpfs x /var"
    keys = f"cp {tmp_path / 'keys'} /srv; chmod 755 /srv; chmod 644 /srv/keys"
    makes = f'set -e; {mounts}\n{recipe("account")}\n{keys}; exec "$@"'
    command = "cd && pwd && ! touch here 2>/dev/null"
    config = f"Match User robots\nAuthorizedKeysFile /srv/keys\nForceCommand {command}\n"
    inside = ("unshare", "-m", "sh", "-c", makes, "sh")
    with Server(tmp_path, config, inside=inside) as server:
        done = run_command(server.client("-l", "robots"), stdin=subprocess.DEVNULL)
    assert (done.returncode, done.stdout, done.stderr) == (0, "/var/empty\n", "")


def test_for_an_account_that_is_not_root_the_recipe_bounds_processes() -> None:
    setpriv = shutil.which("setpriv")
    if os.geteuid() != 0:
        pytest.skip("the attempt to break out looks at it, for this account")
    if setpriv is None or shutil.which("prlimit") is None:
        pytest.skip("there is no setpriv or no prlimit, so root can't become somebody else")
    nobody = [setpriv, "--reuid=64999", "--regid=64999", "--clear-groups"]
    many = "i=0; while [ $i -lt 100 ]; do sleep 60 & i=$((i+1)); done; echo all"
    with subprocess.Popen(
        [*nobody, *words_of("bounds"), "--", "sh", "-c", many],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    ) as shell:
        assert shell.wait(30) != 0
        os.killpg(shell.pid, signal.SIGKILL)
        assert shell.stdout is not None
        assert "all" not in shell.stdout.read()


@pytest.mark.slow
def test_systemd_bounds_the_processes_of_a_scope() -> None:
    scope = words_of("scope")
    if shutil.which(scope[0]) is None:
        pytest.skip("there is no systemd-run")
    asks = "cat /sys/fs/cgroup$(cut -d: -f3 /proc/self/cgroup)/pids.max"
    done = run_command([*scope, "--", "sh", "-c", asks])
    if done.returncode:
        pytest.skip(f"no systemd runs for this user: {done.stderr.strip()}")
    assert done.stdout == "64\n"
