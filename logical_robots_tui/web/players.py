"""The players of a class: a file with a digest of each player's token.

A token has 192 random bits, so that a plain SHA-256 gives nobody a start in guessing it; slow
digests are for passwords, which people choose.
"""

from __future__ import annotations

import re
import secrets
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path

import tomlkit

from logical_robots_tui.errors import InputError, LogicalRobotsError
from logical_robots_tui.paths import PLAYER_NAME, is_there, write_atomically
from logical_robots_tui.toml_files import TomlFile

_TITLE = (
    "# The players of logical-robots serve --class. Their links can't be read from this file.\n"
)
_ADD = "Make a link: logical-robots serve --class {} --add {}"


@dataclass(frozen=True, slots=True)
class _Player:
    sha256: str
    since: datetime


def new_token() -> str:
    return secrets.token_urlsafe(24)


def digest_of(token: str) -> str:
    return sha256(token.encode("utf-8", "surrogateescape")).hexdigest()


class Players:
    """The players in a file, which is read again when it has changed.

    A file that was damaged meanwhile changes nothing; `report` gets the reason. Raises InputError
    or TomlFileError if it can't be used at first.
    """

    def __init__(self, file: Path, report: Callable[[str], None]) -> None:
        self._file, self._report = file, report
        self._version = self._current_version()
        self._digests = _digests_in(_read(file))
        if not self._digests:
            raise InputError("has no players", place=str(file), hint=_ADD.format(file, "NAME"))

    def digests(self) -> dict[str, str]:
        """Return the digest of each player's token, by name."""
        version = self._current_version()
        if version != self._version:
            self._version = version
            try:
                self._digests = _digests_in(_read(self._file))
            except (LogicalRobotsError, OSError) as error:
                self._report(f"{error}\nThe players stay as they were.")
        return self._digests

    def _current_version(self) -> tuple[int, ...]:
        try:
            status = self._file.stat()
        except OSError:
            return ()
        return status.st_ino, status.st_mtime_ns, status.st_size, status.st_mode


def change_player(file: Path, name: str, token: str | None) -> bool:
    """Give a player a token, or remove one for None; return whether the file had the player.

    Creates the file if missing; raises InputError, TomlFileError or OSError.
    """
    if token is not None and not is_there(file):
        file.touch(mode=0o600)
        file.write_text(_TITLE)
    content = _read(file)
    is_known = name in _digests_in(content)
    document = tomlkit.parse(content.text)
    if token is None:
        document.pop(name, None)
    else:
        since = datetime.now(UTC).replace(microsecond=0)
        document[name] = {"sha256": digest_of(token), "since": since}
    write_atomically(file, tomlkit.dumps(document))
    return is_known


def _read(file: Path) -> TomlFile:
    if not is_there(file):
        raise InputError("isn't there", place=str(file), hint=_ADD.format(file, "NAME"))
    if file.stat().st_mode & 0o007:
        message = "is open to everybody on this computer"
        raise InputError(message, place=str(file), hint=f"Run: chmod o= {file}")
    return TomlFile(file)


def _digests_in(content: TomlFile) -> dict[str, str]:
    """Return the digests by name; raises TomlFileError with all that is wrong."""
    entries = content.table(dict.fromkeys(content.data, _Player), content.data)
    for name, entry in entries.items():
        if not PLAYER_NAME.fullmatch(name):
            content.problem(
                (name,), f'"{name}" is not a name of at most 32 letters, digits and _ . -'
            )
        elif not re.fullmatch("[0-9a-f]{64}", entry.sha256):
            message = f"This is not a digest. {_ADD.format(content.file, name)}"
            content.problem((name, "sha256"), message)
    content.refuse()
    return {name: entry.sha256 for name, entry in entries.items()}
