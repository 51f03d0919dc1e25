"""What docs/ssh.md says of the account for a class, and of file transfers, is so."""

from __future__ import annotations

import os
import shutil
import subprocess
from typing import TYPE_CHECKING

import pytest

from tests.e2e.test_class import recipe
from tests.installed import CHECKOUT
from tests.sshd import SSHD, Server
from tests.waiting import PATIENCE

if TYPE_CHECKING:
    from pathlib import Path

    from tests.installed import Installed

pytestmark = pytest.mark.skipif(
    SSHD is None and "CI" not in os.environ, reason="openssh-server is not installed"
)


def run(command: list[str]) -> subprocess.CompletedProcess[str]:
    """Run a client without input."""
    return subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
    )


@pytest.mark.slow
def test_sshd_prints_nothing_when_the_account_logs_in_to_a_home_it_cannot_change(
    tmp_path: Path,
) -> None:
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
        done = run(server.client("-l", "robots"))
    assert (done.returncode, done.stdout, done.stderr) == (0, "/var/empty\n", "")


@pytest.mark.parametrize(
    ("how", "said"), [("-O", "game needs a terminal"), ("-s", "Connection closed")]
)
def test_scp_copies_nothing_and_prints_what_the_page_says(
    how: str, said: str, installed: Installed, tmp_path: Path
) -> None:
    assert said in (CHECKOUT / "docs/ssh.md").read_text()
    game = f"ForceCommand {installed.command} play --restricted --data-dir {tmp_path / 'srv'}"
    with Server(tmp_path, f"{game}\n") as server:
        *options, host = server.client()[3:]
        options[0] = "-P"
        copied = tmp_path / "copied"
        done = run(["scp", how, *options, "-F", "none", f"{host}:/etc/passwd", str(copied)])
    assert done.returncode != 0
    assert said in done.stderr
    assert not copied.exists()
