"""Submissions in a folder or an archive: the student and the level of each file."""

from __future__ import annotations

import os
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import NamedTuple

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.source import SUFFIX, check_program
from logical_robots_tui.lab.platforms.archives import (
    MOST_PACKED,
    File,
    UnpackBudget,
    is_archive,
    is_hidden,
    stem_of,
    unpack,
)
from logical_robots_tui.lab.platforms.dates import parse_date
from logical_robots_tui.lab.platforms.exports import (
    METADATA,
    TIMESTAMP,
    FileOwner,
    is_of_platform,
    owner_of,
    owners_of_gradescope,
    patterns_of,
)
from logical_robots_tui.lab.platforms.matching import match_roster
from logical_robots_tui.lab.platforms.names import plain, text_of
from logical_robots_tui.lab.platforms.tables import StudentRow
from logical_robots_tui.language.diagnostics import printable
from logical_robots_tui.language.source_text import prepare
from logical_robots_tui.paths import is_folder, read_ordinary
from logical_robots_tui.wording import join_names
from logical_robots_tui.world.levels.load import list_shipped

MOST_BYTES = 1_000_000
"""Bytes of a program or a table."""

_MOST_ARCHIVE = 20_000_000
_MOST_DEPTH = 8
_MOST_NAMED = 5
_LONGEST_NAME = 200
_BY_NUMBER = 3  # how far a number is from a level's name
_TEST_STUDENT = "studenttest"  # in exports of Canvas, which alone marks what is late
_TEXT = ".txt"  # what some editors and platforms make of a program's name

_COPY = re.compile(r"[-_ ]*(?:\(\d+\)|\d+)$")  # what Canvas and browsers add to a name
_DOCUMENT = re.compile(r".*\.(?:docx?|odt|pages|pdf|rtf|html?)", re.I | re.S)


class _Candidate(NamedTuple):
    """A program that may be the one for a level, the best first."""

    rank: tuple[bool, int, int, float]
    path: str
    text: str
    mtime: float


class Submission:
    """A submission: its texts by level's name ("" for all levels), with remarks on oddities.

    It is `unclear` if it may hold a program that could not be read or assigned to a level.
    """

    def __init__(self, owner: FileOwner) -> None:
        self.owner = owner
        self.programs: dict[str, str] = {}
        self.remarks: list[str] = []
        self.mtime = 0.0
        self.time: datetime | None = None
        self.stamp: datetime | None = None  # what a file says
        self.is_late: bool | None = None
        self.is_unclear = False
        self.students: list[str] = []  # of the roster, by id
        self.ties: list[str] = []  # those whom it fits equally well
        self.files: list[tuple[File, str, FileOwner]] = []  # with the name that tells the level

    @property
    def tops(self) -> list[str]:
        """The names of its files and folders among the submissions."""
        return sorted({file.parts[0] for file, *_ in self.files})

    @property
    def names(self) -> list[frozenset[str]]:
        """What each of its people is called, the first one as all of it is."""
        aliases = {self.owner.key, *self.tops, *(stem_of(top, SUFFIX, _TEXT) for top in self.tops)}
        first, *members = self.owner.people or ((),)
        return [frozenset(aliases | {*first}) - {""}, *(frozenset(m) - {""} for m in members)]

    @property
    def is_stray(self) -> bool:
        """Whether it is nothing but files that are neither programs nor archives."""
        return not self.programs and all(
            len(file.parts) == 1 and not file.problem and not is_archive(file.parts[0])
            for file, *_ in self.files
        )

    def add(self, file: File, name: str, owner: FileOwner) -> None:
        self.files.append((file, name, owner))
        if owner.is_late is not None:
            self.is_late = bool(self.is_late) or owner.is_late

    def read(self, stems: Mapping[str, str], starters: Mapping[str, str]) -> None:
        """Find the program of each level among the files of the last attempt.

        `starters` are normalised texts by level.
        """
        levels, candidates = stems.values(), defaultdict[str, list[_Candidate]](list)
        unnamed: list[_Candidate] = []
        foreign: list[_Candidate] = []  # for other levels
        other_files: list[str] = []
        for file, name in self._last_attempt():
            path = "/".join(file.parts[1:]) or file.parts[0]
            is_text = name.casefold().endswith(_TEXT)
            level, rank = _level_of(_level_stem(name), stems)
            if name == TIMESTAMP:
                self.stamp = parse_date(text_of(file.content).strip())
            elif file.problem and not (is_text and not level):
                self.remarks.append(f"{path}: {file.problem}")
                self.is_unclear = True
            elif not name.casefold().endswith(SUFFIX) and not (is_text and level):
                other_files += [path] * bool(name)
                self.is_unclear |= bool(level and _DOCUMENT.fullmatch(name))
            else:
                text = text_of(file.content)
                try:
                    check_program(text, path)
                except InputError as error:
                    self.remarks.append(str(error))
                    self.is_unclear = True
                    continue
                is_starter = bool(level) and normalise(text) == starters.get(level)
                order = is_starter, rank + 10 * is_text, len(file.parts), -file.mtime
                candidate = _Candidate(order, path, text, file.mtime)
                is_foreign = name != file.parts[0] and _is_of_another_level(name)
                unplaced = foreign if is_foreign else unnamed
                (candidates[level] if level else unplaced).append(candidate)
        for level, programs in candidates.items():
            self._choose(level, programs, len(candidates) == 1 and not unnamed)
        if len(foreign) == 1 and not (candidates or unnamed) and not {*levels} <= {*list_shipped()}:
            unnamed, foreign = foreign, []  # levels of one's own may be like those of the game
        other_files += [program.path for program in foreign]
        open_levels = sorted({*levels} - self.programs.keys())
        if len(unnamed) == 1 and (not self.programs or len(open_levels) == 1):
            self._choose(open_levels[0] if self.programs else "", unnamed)
        elif unnamed:
            self.remarks += [f"{path} is not named after a level" for _, path, *_ in unnamed]
            self.is_unclear = True
        self.files = [(f._replace(content=b""), name, owner) for f, name, owner in self.files]
        if not self.programs and (other_files or not self.remarks):
            detail = f", only {join_names(other_files[:_MOST_NAMED])}" if other_files else ""
            self.remarks.append(f"there is no program (*{SUFFIX}) in it{detail}")
            self.is_unclear |= bool(other_files)

    def _last_attempt(self) -> list[tuple[File, str]]:
        times = {owner.time for *_, owner in self.files if owner.time}
        self.time = max(times, key=lambda time: time.replace(tzinfo=None), default=None)
        if len(times) > 1:
            self.remarks.append(f"of {len(times)} attempts the last one counts, of {self.time}")
        return [(file, name) for file, name, owner in self.files if owner.time in (None, self.time)]

    def _choose(self, level: str, programs: list[_Candidate], is_alone: bool = False) -> None:
        (is_starter, rank, *_), path, text, mtime = best = min(programs)
        # A number alone may be that of the assignment.
        self.programs["" if is_alone and rank % 10 == _BY_NUMBER else level] = text
        self.mtime = max(self.mtime, mtime)
        if is_starter:
            self.remarks.append(f"{path} is the level's starter, unchanged")
        for program in sorted(programs, key=lambda program: program.path):
            if program is not best and not program.rank[0]:
                self.remarks.append(f"{path} was graded, not {program.path}")


def _level_stem(name: str) -> str:
    return stem_of(name, SUFFIX + _TEXT, SUFFIX, _TEXT)


def _level_of(stem: str, stems: Mapping[str, str]) -> tuple[str, int]:
    """Return the level that a file's name tells, or "", and how far the name is from it."""
    for rank, name in enumerate((stem, _COPY.sub("", stem))):
        if level := stems.get(plain(name)):
            return level, rank
    within = sorted((key for key in stems if key in plain(stem)), key=len, reverse=True)
    levels = {stems[key] for key in within if not any(key in k and key != k for k in within)}
    numbers = {int(number) for number in re.findall(r"\d{1,9}", stem)}
    numbered = {n for n in stems.values() if n[:2].isdecimal() and int(n[:2]) in numbers}
    for rank, names in ((2, levels), (_BY_NUMBER, numbered)):
        if len(names) == 1:
            return min(names), rank
        if names:
            break
    return "", 0


def normalise(text: str) -> str:
    source = prepare(text)
    if source.problems or '"""' in source.text:
        return text
    characters: list[str] = []
    is_quoted = False
    for character, bare in zip(source.text, source.skeleton, strict=True):
        if character == '"' and bare == " ":
            is_quoted = not is_quoted
        if is_quoted or not character.isspace():
            characters.append(character)
        elif characters and characters[-1] != " ":
            characters.append(" ")
    return "".join(characters).strip()


def readable(name: str) -> str:
    return printable(os.fsencode(name).decode(errors="replace"))[:_LONGEST_NAME]


def stems_of(levels: Iterable[str]) -> dict[str, str]:
    """Return levels by the possible names of programs for them, with or without the number."""
    stems = {plain(name): name for name in levels}
    return {plain(n.partition("-")[2]): n for n in levels if n[:2].isdecimal()} | stems


def _is_of_another_level(name: str) -> bool:
    level, rank = _level_of(_level_stem(name), stems_of(list_shipped()))
    return bool(level) and rank != _BY_NUMBER


def entries_of(
    place: Path,
    stems: Mapping[str, str],
    pattern: str = "",
    starters: Mapping[str, str] | None = None,
    roster: Sequence[StudentRow] = (),
) -> dict[str, Submission]:
    """Return submissions by names to show, of a folder or an archive.

    `pattern` is how their names are made, such as ``{name}_{id}_{level}.l``; those of learning
    platforms are known. What a student of the roster handed in several times is one submission.
    Raises InputError if unreadable or names are equal.
    """
    layouts, patterns = [list(_files(place))], patterns_of(pattern, stems)
    while inner_files := _unwrapped(layouts[-1]):
        layouts.append(inner_files)
    usual = _is_wrapped(layouts, stems, is_folder(place))
    results = []
    for number in range(len(layouts)) if roster else [usual]:
        # An outer folder may have any name, but in it there are more students of the roster.
        entries = _grouped(layouts[number], patterns)
        matches = match_roster(roster, {name: entry.names for name, entry in entries.items()})
        results.append(((len(matches.submissions), number == usual), entries, matches))
    _, entries, matches = max(results, key=lambda result: result[0])
    for key, entry in entries.items():
        if not entry.owner.people and len(entry.tops) > 1:
            message = f"Several entries have this name: {', '.join(map(readable, entry.tops))}"
            raise InputError(message, place=str(place / key), hint="Keep one of them.")
    for student, (first, *later) in matches.submissions.items():
        for name in later:
            for file in entries.pop(name).files if name in entries else ():
                entries[first].add(*file)
        entries[first].students.append(student)
    for name, entry in entries.items():
        entry.ties = matches.ties.get(name, [])
        entry.read(stems, starters or {})
    if all(entry.stamp for entry in entries.values()):  # else one of a student's own
        for entry in entries.values():
            entry.time = entry.time or entry.stamp
    return entries


def _grouped(files: list[File], patterns: list[re.Pattern[str]]) -> dict[str, Submission]:
    owners = owners_of_gradescope(files)
    submissions: dict[str, Submission] = {}
    for file in files:
        if file.parts == (METADATA,):
            continue
        owner, name = owner_of(file.parts, patterns, owners)
        if owner.is_late is not None and owner.people[0].name == _TEST_STUDENT:
            continue
        submissions.setdefault(owner.key, Submission(owner)).add(file, owner.level or name, owner)
    entries: dict[str, Submission] = {}
    for key, entry in sorted(submissions.items()):
        name = readable(key)
        while name in entries:  # what can't be shown in them may be all that differs
            name += "'"
        entries[name] = entry
    return entries


def _files(place: Path) -> Iterator[File]:
    """Yield all files, in the order of their paths, those of archives too."""
    files: Iterable[File]
    if is_folder(place):
        files = _walk(place, ())
    elif is_archive(place.name):
        try:
            content = read_ordinary(place, MOST_PACKED + 1)
        except OSError as error:
            raise InputError(f"can't be read: {error.strerror}", place=str(place)) from error
        if len(content) > MOST_PACKED:
            hint = "Unpack it, and name the folder."
            raise InputError("This archive is too large", place=str(place), hint=hint)
        budget = UnpackBudget(100_000, MOST_PACKED)
        files = sorted(unpack(File((), content), budget, _size_limit))
        for file in files[:1]:
            if not file.parts:
                raise InputError(
                    f"can't be read: {file.problem}", place=str(place), hint="Unpack it by hand."
                )
    else:
        hint = "It has one folder, file or archive for each student or player."
        raise InputError("This is neither a folder nor an archive", place=str(place), hint=hint)
    budgets: dict[str, UnpackBudget] = defaultdict(UnpackBudget)
    for file in files:
        yield from _expand(file, budgets[file.parts[0]], 2)


def _walk(folder: Path, parts: tuple[str, ...]) -> Iterator[File]:
    for path in sorted(folder.iterdir()) if len(parts) < _MOST_DEPTH else ():
        file_parts, is_link = (*parts, path.name), path.is_symlink()
        if is_hidden(path.name):
            continue
        if path.is_dir() and not is_link:
            try:
                if not parts and not any(path.iterdir()):
                    yield File((*file_parts, ""))  # it is empty
                yield from _walk(path, file_parts)
            except OSError as error:
                yield File(file_parts, problem=error.strerror or str(error))
        elif limit := _size_limit(path.name) or (is_link and path.is_dir()):
            try:
                if is_link:
                    raise OSError(None, "it is a link")
                content = read_ordinary(path, limit + 1)
                if len(content) > limit:
                    raise OSError(None, f"it is larger than {limit // 10**6} MB")
                yield File(file_parts, content, path.stat().st_mtime)
            except OSError as error:
                yield File(file_parts, problem=error.strerror or str(error))
        else:
            yield File(file_parts)


def _size_limit(name: str) -> int:
    if is_archive(name):
        return _MOST_ARCHIVE
    is_read = name.casefold().endswith((SUFFIX, _TEXT)) or name == METADATA
    return MOST_BYTES if is_read else 0


def _expand(file: File, budget: UnpackBudget, depth: int) -> Iterator[File]:
    """Yield a file, or those of an archive, which are as old as it."""
    if file.problem or not is_archive(file.parts[-1]):
        yield file
    elif not depth:
        yield file._replace(problem="it is in an archive in an archive")
    else:
        is_empty = True
        for inner in unpack(file, budget, _size_limit):
            is_empty = False
            yield from _expand(inner._replace(mtime=file.mtime), budget, depth - 1)
        if is_empty:
            yield file._replace(problem="it is empty")


def _is_whole(name: str) -> bool:
    return is_archive(name) or name.casefold().endswith(SUFFIX)


def _unwrapped(files: list[File]) -> list[File]:
    """Return files without the one folder that is around all submissions; none if there is none."""
    folders = {file.parts[0] for file in files if len(file.parts) > 1}
    loose = [file.parts[0] for file in files if len(file.parts) == 1]
    if len(folders) != 1 or any(name == METADATA or _is_whole(name) for name in loose):
        return []
    return [file._replace(parts=file.parts[1:] or file.parts) for file in files]


def _is_wrapped(layouts: list[list[File]], stems: Mapping[str, str], is_unpacked: bool) -> bool:
    """Return whether the one outer folder is that of a class, without knowing its students."""
    if len(layouts) < 2 or any(is_of_platform(file.parts[0]) for file in layouts[0]):
        return False
    inner = {file.parts[0] for file in layouts[1]}
    is_of_one = any(plain(_level_stem(name)) in stems for name in inner)
    return len(inner) > 1 and not is_of_one and not (is_unpacked and any(map(_is_whole, inner)))
