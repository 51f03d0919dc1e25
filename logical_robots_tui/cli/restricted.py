"""Restricted mode for shared or public machines, enforced by an audit hook.

It refuses files outside the player's folder, connections, and programs other than the
game's own helpers.
"""

from __future__ import annotations

import os
import resource
import site
from pathlib import Path

from logical_robots_tui.confinement import confine
from logical_robots_tui.errors import InputError
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.player.open_games import OpenGames
from logical_robots_tui.processes.audit import refuse_all_but
from logical_robots_tui.processes.helper import is_helper

LIMITS = {
    "RLIMIT_AS": 2 * 1024**3,  # bytes of address space; the game needs half of that
    "RLIMIT_CPU": 3 * 3600,  # seconds
    "RLIMIT_FSIZE": 64 * 1024**2,  # bytes of one file
    "RLIMIT_NOFILE": 256,
    "RLIMIT_NPROC": 1024,  # processes and threads of the account
    "RLIMIT_CORE": 0,
}
"""Limits for each process of the game, by their names in Python's module ``resource``."""

_KEPT = frozenset(
    (
        *("COLORTERM", "HOME", "LANG", "LANGUAGE", "NO_COLOR", "PATH", "SSH_CONNECTION", "STY"),
        *("TERM", "TMUX", "TZ", "XDG_DATA_HOME", "OPENBLAS_NUM_THREADS"),
        *("DYLD_LIBRARY_PATH", "LD_LIBRARY_PATH"),
    )
)
"""Environment variables that are left, beside those of the language."""

_GRACE = 5  # processor seconds that a game over its limit has for a clean exit


def clear_environment() -> None:
    """Remove variables that affect Python, Textual or an editor, before they are loaded.

    Raises InputError if Python would load modules from the player's home folder.
    """
    if site.ENABLE_USER_SITE:
        raise InputError(
            "restricted mode needs a Python that loads no packages from home folders",
            hint="Install the game in a virtual environment, or set PYTHONNOUSERSITE=1.",
        )
    for name in [*os.environ]:
        if name not in _KEPT and not name.startswith("LC_"):
            del os.environ[name]


def restrict(own: Path) -> OpenGames:
    """Confine this process and its children to a folder and to `LIMITS`, permanently.

    The folder becomes the home directory, and is created if missing. Returns the player's open
    games; raises InputError if there are too many, or the folder can't be used.
    """
    try:
        own.mkdir(mode=0o700, parents=True, exist_ok=True)
        own = own.resolve()
        games = OpenGames(own)
    except OSError as error:
        reason = error.strerror or str(error)
        hint = "Tell the administrator of this machine."
        said = f"the player's folder can't be used: {reason}"
        raise InputError(said, place=str(own), hint=hint) from None
    os.environ.pop("XDG_DATA_HOME", None)
    os.environ["HOME"] = str(own)
    os.chdir(own)
    for name, bound in LIMITS.items():
        _limit(getattr(resource, name), bound, grace=_GRACE if name == "RLIMIT_CPU" else 0)
    confine(own, shipped_folder("levels"), shipped_folder("programs"))
    refuse_all_but(own, is_helper)
    return games


def _limit(which: int, bound: int, grace: int) -> None:
    """Lower the soft and hard limit, unless they are already lower."""
    _, hard = resource.getrlimit(which)
    last = bound + grace if hard == resource.RLIM_INFINITY else min(bound + grace, hard)
    resource.setrlimit(which, (min(bound, last), last))
