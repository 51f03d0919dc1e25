"""Program texts and the files of a player: finding, loading, naming and saving them."""

from __future__ import annotations

import asyncio
import os
import re
import threading
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeVar

from logical_robots_tui.confinement import check_mine
from logical_robots_tui.errors import InputError
from logical_robots_tui.language.diagnostics import LevelNames, unknown_names
from logical_robots_tui.mind import Diagnostic, ProgramError
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.paths import (
    ARENAS,
    decoded,
    did_you_mean,
    is_file,
    is_folder,
    is_there,
    read_ordinary,
    real,
    shipped_folder,
    shipped_names,
    typed_path,
    write_atomically,
)

if TYPE_CHECKING:
    from logical_robots_tui.mind import Program, Report
    from logical_robots_tui.mind.program import Texts
    from logical_robots_tui.progress import Progress
    from logical_robots_tui.world import Level

DEFAULT_PROGRAM = "obstacle-avoider"
"""The program for levels that don't name a starter."""

T = TypeVar("T")

SUFFIX = ".l"
_STDIN = Path("/dev/stdin")
MAX_PROGRAM_BYTES = 1_000_000


_TEAM = "#team="


class ProgramSource(NamedTuple):
    """A program's text and its file, which must not be overwritten if it is shipped."""

    name: str
    text: str
    path: Path
    shipped: bool
    team: str = ""

    @property
    def draft(self) -> str:
        return f"{self.path}{_TEAM}{self.team}" if self.team else str(self.path)

    @classmethod
    def of_draft(cls, draft: str, name: str) -> ProgramSource:
        """Return the program that a draft belongs to, even if its file is gone."""
        path, _, team = draft.partition(_TEAM)
        try:
            source = load_program(path)
        except InputError:
            source = cls(name, "", Path(path), shipped=False)
        return source._replace(team=team)


def list_programs(own_folder: Path | None = None) -> list[str]:
    shipped = (*shipped_names("programs", SUFFIX), *shipped_names("programs", SUFFIX, ARENAS))
    names = [name for name in shipped if not is_hidden(name)]
    if own_folder is not None and is_folder(own_folder):
        names += sorted(p.stem for p in own_folder.glob(f"*{SUFFIX}") if p.stem not in names)
    return names


_hiding: list[Progress] = []


def hide_solutions(progress: Progress) -> None:
    """Hide the solution of each level that a player has not won, for the whole process."""
    _hiding.append(progress)


def is_hidden(name: str) -> bool:
    """Return whether a shipped program is a solution that the player must not read yet. Blocks."""
    return any(is_unsolved(name, progress) for progress in _hiding)


def is_unsolved(name: str, progress: Progress) -> bool:
    """Return whether a shipped program is a solution of a level that is not won. Blocks."""
    level = _solved_levels().get(name)
    return level is not None and progress.record(level).state != "won"


@lru_cache(maxsize=1)
def _solved_levels() -> Mapping[str, str]:
    from logical_robots_tui.world import list_shipped, load_level  # loads numpy

    return {
        program: name
        for name in list_shipped()
        for program in reference_names(load_level(name).solution)
    }


def reference_names(solution: str) -> list[str]:
    """Return the programs a level's results are compared with; its solution comes first."""
    if not solution:
        return []
    files = _folders()[1].glob(f"{solution}-*{SUFFIX}")
    return [solution, *sorted(file.stem for file in files)]


def _folders() -> tuple[Path, Path, Path]:
    folder = shipped_folder("programs")
    return folder, folder / "references", folder / ARENAS


def load_program(
    path_or_name: str | Path, own_folder: Path | None = None, *, pipes: bool = False
) -> ProgramSource:
    """Read a program by path, or by name from the player's own and the shipped ones.

    With `pipes` it may block, and "-" is standard input. Raises InputError unless it is a visible
    text that is not too long.
    """
    path = _STDIN if pipes and path_or_name == "-" else Path(path_or_name)
    try:
        check_mine(path)
        if path.exists():
            return _read(path, pipes=pipes)
    except OSError as error:
        raise InputError(f"can't be read: {error.strerror or error}", place=str(path)) from error
    if path.name == str(path_or_name):
        for folder in (own_folder, *_folders()):
            if folder is not None and is_file(file := folder / f"{path.name}{SUFFIX}"):
                return _read(file)
    names = list_programs(own_folder)
    hint = did_you_mean(path.stem, names) or f"There are {', '.join(names) or 'none'}."
    raise InputError("There is no such program", place=str(path_or_name), hint=hint)


def programs_for(
    level: Level,
    names: Sequence[str],
    by_team: Mapping[str, str],
    own_folder: Path | None = None,
    *,
    pipes: bool = False,
) -> dict[str, ProgramSource]:
    """Return the program of each team of a level, or of "" if it has no teams.

    `names` are by the order of the teams; the level names the others. If none is named, the
    first team is the player's and begins with the starter. Raises InputError.
    """
    usual = level.starter or DEFAULT_PROGRAM
    program_names = {team.name: team.program or usual for team in level.teams} or {"": usual}
    if level.starter and not (names or by_team):
        program_names[next(iter(program_names))] = level.starter
    if len(names) > len(program_names):
        teams = f"{len(level.teams)} teams" if level.teams else "no teams"
        raise InputError(f"{len(names)} programs are too many: {level.name} has {teams}.")
    for team in by_team:
        if team not in program_names or not team:
            hint = did_you_mean(team, program_names) or f"It has {', '.join(program_names)}."
            raise InputError(f"{level.name} has no team {team}.", hint=hint if level.teams else "")
    named_programs = dict(zip(program_names, names, strict=False))
    if duplicates := named_programs.keys() & by_team.keys():
        raise InputError(f"Two programs are named for {min(duplicates)}.")
    program_names |= named_programs | dict(by_team)
    return {
        team: load_program(name, own_folder, pipes=pipes)._replace(team=team)
        for team, name in program_names.items()
    }


@lru_cache(maxsize=1)
def shipped_texts() -> Mapping[str, str]:
    files = [file for folder in _folders() for file in sorted(folder.glob(f"*{SUFFIX}"))]
    return {file.stem: _text_of(file) for file in files}


def save_program(path: Path, text: str) -> None:
    """Write a program's text atomically, or raise InputError."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, text)
    except OSError as error:
        message = f"can't be written: {error.strerror or error}"
        hint = "Save it under another name or in another folder."
        raise InputError(message, place=str(path), hint=hint) from error


def _read(path: Path, *, pipes: bool = False) -> ProgramSource:
    file = real(path)
    shipped = file.parent in [folder.resolve() for folder in _folders()]
    if shipped and is_hidden(file.stem):
        from logical_robots_tui.world import list_arenas

        level = _solved_levels()[file.stem]
        why = "a solution of a level that you have not won yet"
        hint = f"Win {level}, and you can read it."
        if level in list_arenas():
            why = "an arena's solution, hidden here"
            hint = f"Beat the sparring partner of {level} without it."
        raise InputError(f"is {why}", place=path.stem, hint=hint)
    return ProgramSource(path.stem, _text_of(path, pipes=pipes), path, shipped)


def _text_of(path: Path, *, pipes: bool = False) -> str:
    place = str(path)
    if path.is_dir():
        raise InputError("is a folder, not a program", place=place, hint="Name a file in it.")
    if not pipes and path.exists() and not path.is_file():
        raise InputError("is not a regular file", place=place, hint="A program is a text file.")
    try:
        if pipes:
            # Where standard input is a socket, its name can't be opened.
            with os.fdopen(os.dup(0), "rb") if path == _STDIN else path.open("rb") as file:
                raw = file.read(MAX_PROGRAM_BYTES + 1)
        else:
            raw = read_ordinary(path, MAX_PROGRAM_BYTES + 1)
    except OSError as error:
        raise InputError(f"can't be read: {error.strerror or error}", place=place) from error
    if len(raw) > MAX_PROGRAM_BYTES:
        raise InputError("is larger than 1 MB", place=place, hint="A program is a short text.")
    try:
        text = decoded(raw)
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        place += f", line {line}"
        hint = "Check that it is a program, and save it as UTF-8."
        raise InputError("is not UTF-8 text", place=place, hint=hint) from error
    check_program(text, place)
    return text


def check_program(text: str, place: str) -> None:
    """Raise InputError for a text that is too long for a program, or no text."""
    if len(text) > (most := Limits().program_characters):
        message = f"has {len(text):,} characters, more than the {most:,} that a program may have"
        raise InputError(message, place=place, hint="A program is a short text.")
    if "\0" in text:
        raise InputError("is a binary file, not a program", place=place)


def target(
    name: str,
    own_folder: Path,
    *,
    folder: Literal["levels", "programs"] = "programs",
    suffixes: tuple[str, ...] = (SUFFIX,),
    usual: str = SUFFIX,
) -> Path:
    """Return the file for a name (a path, if it has a slash), or raise InputError.

    The ending `usual` is added to a name without one.
    """
    if not name:
        raise InputError(f"A {folder.removesuffix('s')} needs a name.")
    if "/" in name:
        path = typed_path(name)
        try:
            path = path.absolute()
        except OSError as error:
            message = "The current folder no longer exists"
            hint = "Use an absolute path such as /tmp/name."
            raise InputError(message, place=str(path), hint=hint) from error
        path = path if path.suffix or not path.name else path.with_suffix(usual)
    else:
        stem = name.removesuffix(usual)
        if not re.fullmatch(r"[\w][\w .+-]*", stem):
            message = "A name is made of letters, digits, spaces and _ - + ."
            raise InputError(message, hint="Put a slash in it to name a file anywhere.")
        shipped = (shipped_names(folder, suffix, w) for suffix in suffixes for w in ("", ARENAS))
        if any(stem in names for names in shipped):
            message = f"{stem} is part of the game and can't be changed."
            raise InputError(message, hint="Choose another name.")
        path = own_folder / f"{stem}{usual}"
    if is_folder(path):
        raise InputError("is a folder.", place=str(path), hint="Choose another name.")
    if is_there(path) and not is_file(path):
        raise InputError("is not a regular file.", place=str(path), hint="Choose another name.")
    if shipped_folder(folder).resolve() in real(path).parents:
        message = f"The {folder} of the game can't be changed."
        raise InputError(message, hint="Save it in another folder.")
    return path


async def compile_program(text: str | Texts, report: Report | None = None) -> Program:
    """Compile a program, or those of teams, without blocking the event loop.

    Cancelling the call ends the compilation. `report` is called on the event loop with the numbers
    of compiled predicates and of all. Raises ProgramError for a wrong program.
    """
    loop = asyncio.get_running_loop()

    def work(stop: threading.Event) -> Program:
        # A mind will be needed next.
        from logical_robots_tui.mind import Mind, Program  # noqa: F401 - to load it

        def report_soon(count: int, total: int) -> None:
            if report is not None and not stop.is_set():
                loop.call_soon_threadsafe(report, count, total)

        return Program.compile(text, stop=stop, report=report_soon)

    return await _in_thread(work)


def warnings_in(
    program: Program, level: Level | LevelNames | None, *, web: bool = False
) -> tuple[Diagnostic, ...]:
    """Return a program's warnings in text order.

    With a level also those about names that it does not have; perhaps those for the web platform.
    """
    warnings = [*program.warnings, *(program.web if web else ())]
    if level is not None:
        names = level if isinstance(level, LevelNames) else names_in(level)
        warnings += unknown_names(program.mentions, names)
    return tuple(sorted(warnings, key=lambda d: (d.line, d.column)))


def names_in(level: Level) -> LevelNames:
    solid = (area.name for area in level.areas if area.impenetrable)
    return LevelNames(
        frozenset(robot.name for robot in level.robots),
        frozenset([*(beacon.name for beacon in level.beacons), *solid]),
    )


async def mistake_in_question(program: Program, query: str) -> str:
    """Return what is wrong with a question about a program, or ""; cancellable."""
    try:
        await _in_thread(lambda stop: program.question(query, stop=stop))
    except ProgramError as error:
        first = error.first
        return f"{first.message}. {first.hint}".strip()
    return ""


async def _in_thread(work: Callable[[threading.Event], T]) -> T:
    """Run work in a thread; cancelling the call sets the event passed to the work."""
    stop = threading.Event()
    try:
        return await asyncio.to_thread(work, stop)
    except asyncio.CancelledError:
        stop.set()
        raise
