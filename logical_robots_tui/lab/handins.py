"""Submissions in a folder or an archive: the student and the level of each file."""

from __future__ import annotations

import os
import re
import unicodedata
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from logical_robots_tui.errors import InputError, check_installed
from logical_robots_tui.game.source import SUFFIX
from logical_robots_tui.lab.archives import (
    MOST_PACKED,
    File,
    UnpackBudget,
    is_archive,
    is_hidden,
    stem_of,
    unpack,
)
from logical_robots_tui.language.diagnostics import printable
from logical_robots_tui.paths import decoded, is_folder, read_ordinary
from logical_robots_tui.wording import join_names

MOST_BYTES = 1_000_000
"""Bytes of a program or a table."""

_MOST_ARCHIVE = 20_000_000
_MOST_DEPTH = 8
_MOST_NAMED = 5
_LONGEST_NAME = 200
_MOST_WORDS = 10  # of a name of people, which may be in any order
_DEEPEST = 20  # mappings and lists in each other in Gradescope's metadata
_METADATA = "submission_metadata.yml"

FIELDS = {"name": r"[^/]+", "id": r"[^/_\s]+", "level": r"[^/]+"}
"""Fields that a pattern of names may have in braces."""

_EXPORTS = (
    # Moodle, with folders or without: Ada Lovelace_1234_assignsubmission_file_/program.l
    re.compile(r"(?P<name>.+)_(?P<id>\d+)_assignsubmission_[a-z]+_?(?P<rest>.*)", re.I),
    # Canvas: lovelaceada_LATE_12345_67890_program-1.l; without the name if it is anonymous
    re.compile(
        r"(?:(?P<name>.+?)_)?(?P<late>LATE_)?(?P<id>\d{2,})"
        r"_(?:\d{2,}_(?P<rest>.+)|(?:text|link)\.html)",
        re.I,
    ),
)
_LETTERS = str.maketrans(
    {
        "\N{LATIN SMALL LETTER DOTLESS I}": "i",
        "ł": "l",
        "ø": "o",
        "đ": "d",
        "ð": "d",
        "æ": "ae",
        "œ": "oe",
        "þ": "th",
    }
)
"""Letters of names that are not composed of others, and what is typed for them."""

_COPY = re.compile(r"[-_ ]*(?:\(\d+\)|\d+)$")  # what Canvas and browsers add to a name


class FileOwner(NamedTuple):
    """The owner of a file, as far as its name tells."""

    key: str
    name: str = ""
    id: str = ""
    level: str = ""
    is_late: bool = False


class Submission:
    """A submission: its texts by level's name ("" for all levels), with remarks on oddities."""

    def __init__(self, owner: FileOwner) -> None:
        self.owner = owner
        self.programs: dict[str, str] = {}
        self.remarks: list[str] = []
        self.mtime = 0.0
        self.is_late = False
        self.files: list[tuple[File, str]] = []  # each with the name that tells its level

    @property
    def tops(self) -> list[str]:
        """The names of its files and folders among the submissions."""
        return sorted({file.parts[0] for file, _ in self.files})

    @property
    def is_stray(self) -> bool:
        """Whether it is nothing but files that are neither programs nor archives."""
        return not self.programs and all(
            len(file.parts) == 1 and not file.problem and not is_archive(file.parts[0])
            for file, _ in self.files
        )

    def read(self, stems: Mapping[str, str]) -> None:
        """Find the program of each level among the files."""
        unnamed_programs: list[tuple[str, str, float]] = []
        other_files: list[str] = []
        paths: dict[str, str] = {}
        nearest = sorted(self.files, key=lambda entry: (len(entry[0].parts), -entry[0].mtime))
        for file, name in nearest:
            path = "/".join(file.parts[1:]) or file.parts[0]
            if file.problem:
                self.remarks.append(f"{path}: {file.problem}")
            elif not name.casefold().endswith(SUFFIX):
                other_files += [path] * bool(name)
            else:
                try:
                    text = _text(file.content)
                except ValueError as error:
                    self.remarks.append(f"{path}: {error}")
                    continue
                stem = stem_of(name, SUFFIX)
                level = stems.get(plain(stem)) or stems.get(plain(_COPY.sub("", stem)))
                if level in paths:
                    self.remarks.append(f"{path}: {paths[level]} is there for this level, too")
                elif level:
                    paths[level] = path
                    self._add_program(level, text, file.mtime)
                else:
                    unnamed_programs.append((path, text, file.mtime))
        if len(unnamed_programs) == 1 and not self.programs:
            self._add_program("", *unnamed_programs[0][1:])
        else:
            self.remarks += [f"{path} is not named after a level" for path, *_ in unnamed_programs]
        self.files = [(file._replace(content=b""), name) for file, name in self.files]
        if not self.programs and (other_files or not self.remarks):
            detail = f", only {join_names(other_files[:_MOST_NAMED])}" if other_files else ""
            self.remarks.append(f"there is no program (*{SUFFIX}) in it{detail}")

    def _add_program(self, level: str, text: str, mtime: float) -> None:
        self.programs[level] = text
        self.mtime = max(self.mtime, mtime)


def _text(content: bytes) -> str:
    try:
        text = decoded(content)
    except UnicodeDecodeError:
        raise ValueError("it is not UTF-8 text") from None
    if "\0" in text:
        raise ValueError("it is not text")
    return text


def plain(text: str) -> str:
    """Return a name as it is compared: letters and digits, without case and accents."""
    # One by one, because the time to put marks in order grows with the square of their number.
    parts = (unicodedata.normalize("NFKD", character) for character in text.casefold())
    text = "".join(parts).translate(_LETTERS)
    return "".join(character for character in text if character.isalnum())


def readable(name: str) -> str:
    return printable(os.fsencode(name).decode(errors="replace"))[:_LONGEST_NAME]


def stems_of(levels: Iterable[str]) -> dict[str, str]:
    """Return levels by the possible names of programs for them, with or without the number."""
    stems = {plain(name): name for name in levels}
    return {plain(n.partition("-")[2]): n for n in levels if n[:2].isdecimal()} | stems


def pattern_problem(pattern: str) -> str:
    fields = re.findall(r"\{(.*?)\}", pattern)
    if unknown := set(fields) - FIELDS.keys():
        return f"{{{min(unknown)}}} can't be in a pattern; known are {{name}}, {{id}} and {{level}}"
    if len(fields) > len(set(fields)):
        return "The pattern has the same field twice"
    if pattern and not {"name", "id"} & {*fields}:
        return "A pattern needs {name} or {id}, such as {name}_{id}_{level}.l"
    return ""


def entries_of(place: Path, stems: Mapping[str, str], pattern: str = "") -> dict[str, Submission]:
    """Return submissions by names to show, of a folder or an archive.

    `pattern` is how their names are made, such as ``{name}_{id}_{level}.l``; those of Moodle,
    Canvas and Gradescope are known. Raises InputError if unreadable or names are equal.
    """
    files = _unwrap(list(_files(place)), stems) if not is_folder(place) else list(_files(place))
    students = _students_of_gradescope(files)
    patterns = _patterns(pattern, stems)
    submissions: dict[str, Submission] = {}
    for file in files:
        if file.parts == (_METADATA,):
            continue
        owner, name = _owner(file.parts, patterns, students)
        entry = submissions.setdefault(owner.key, Submission(owner))
        entry.files.append((file, owner.level or name))
        entry.is_late |= owner.is_late
    entries: dict[str, Submission] = {}
    for key, entry in sorted(submissions.items()):
        if not entry.owner.id and not entry.owner.name and len(entry.tops) > 1:
            message = f"Several entries have this name: {', '.join(map(readable, entry.tops))}"
            raise InputError(message, place=str(place / key), hint="Keep one of them.")
        entry.read(stems)
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
    return MOST_BYTES if name.casefold().endswith(SUFFIX) or name == _METADATA else 0


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


def _unwrap(files: list[File], stems: Mapping[str, str]) -> list[File]:
    """Return files without the one folder that an archive of the class puts around them."""
    tops = {file.parts[0] for file in files}
    inner = {file.parts[1] for file in files if len(file.parts) > 1}
    levels = [name for name in inner if plain(stem_of(name, SUFFIX)) in stems]
    if len(tops) > 1 or len(inner) < 2 or levels or any(len(file.parts) < 2 for file in files):
        return files
    if any(pattern.fullmatch(top) for pattern in _EXPORTS for top in tops):
        return files
    return [file._replace(parts=file.parts[1:]) for file in files]


def _students_of_gradescope(files: list[File]) -> dict[str, tuple[str, str]]:
    """Return names and ids by folder, from the metadata that Gradescope exports."""
    file = next((file for file in files if file.parts == (_METADATA,)), None)
    if file and file.problem:
        raise InputError(f"can't be read: {file.problem}", place=_METADATA)
    entries = _yaml(file.content) if file else {}
    students: dict[str, tuple[str, str]] = {}
    for folder, entry in entries.items() if isinstance(entries, dict) else ():
        submitters = entry.get(":submitters") if isinstance(entry, dict) else ()
        first = submitters[0] if isinstance(submitters, list) and submitters else ()
        if isinstance(first, dict):
            texts = (first.get(f":{key}") for key in ("name", "sid"))
            name, student = (text.strip() if isinstance(text, str) else "" for text in texts)
            students[folder] = name, student
    return students


def _yaml(content: bytes) -> object:
    """Parse Gradescope's metadata, all scalars as text; raises InputError."""
    check_installed("yaml", "An export of Gradescope")
    import yaml

    stack: list[list[Any]] = [[]]
    try:
        for event in yaml.parse(content, getattr(yaml, "CBaseLoader", yaml.BaseLoader)):
            if isinstance(event, yaml.AliasEvent) or len(stack) > _DEEPEST:
                problem = "nested too deeply" if len(stack) > _DEEPEST else "an alias"
                raise yaml.MarkedYAMLError(problem=problem, problem_mark=event.start_mark)
            if isinstance(event, yaml.ScalarEvent):
                stack[-1].append(event.value)
            elif isinstance(event, yaml.CollectionStartEvent):
                stack.append([])
            elif isinstance(event, yaml.CollectionEndEvent):
                items = stack.pop()
                pairs = zip(items[::2], items[1::2], strict=False)
                is_list = isinstance(event, yaml.SequenceEndEvent)
                table = {key: value for key, value in pairs if not is_list and isinstance(key, str)}
                stack[-1].append(items if is_list else table)
    except (yaml.YAMLError, ValueError) as error:
        mark = getattr(error, "problem_mark", None)
        reason = getattr(error, "problem", None) or getattr(error, "reason", str(error))
        raise InputError(
            f"This YAML can't be read: {reason}",
            place=_METADATA + (f", line {mark.line + 1}" if mark else ""),
            hint="Export the submissions again, or remove this file.",
        ) from error
    return next(iter(stack[0]), {})


def _patterns(pattern: str, stems: Mapping[str, str]) -> list[re.Pattern[str]]:
    """Return a pattern as expressions: with the levels that there are, and with any."""
    if not pattern:
        return []
    levels = "|".join(r"[\W_]*".join(stem) for stem in sorted(stems, key=len, reverse=True))
    expressions = []
    for level in (levels, FIELDS["level"]):
        fields = FIELDS | {"level": level}
        pieces = re.split(r"\{(\w+)\}", stem_of(pattern, SUFFIX))
        texts = [
            f"(?P<{piece}>{fields[piece]})" if number % 2 else re.escape(piece)
            for number, piece in enumerate(pieces)
        ]
        expressions.append(re.compile("".join(texts), re.I))
    return expressions


def _owner(
    parts: tuple[str, ...],
    patterns: list[re.Pattern[str]],
    students: Mapping[str, tuple[str, str]],
) -> tuple[FileOwner, str]:
    """Return the owner of a file, and its name without the owner's."""
    top, name = parts[0], parts[-1]
    for pattern in patterns:
        for text in ("/".join(parts), name, top):
            if match := pattern.fullmatch(stem_of(text, SUFFIX)):
                fields = match.groupdict()
                is_program = text[-len(name) :] == name and name.casefold().endswith(SUFFIX)
                level = fields["level"] + SUFFIX if "level" in fields and is_program else ""
                return _person(fields.get("name", ""), fields.get("id", ""), level), name
    if top in students and any(students[top]):
        return _person(*students[top]), name
    for export in _EXPORTS:
        if match := export.fullmatch(top):
            is_late = "late" in export.groupindex and bool(match["late"])
            owner = _person(match["name"] or "", match["id"], is_late=is_late)
            return owner, (match["rest"] or "") if len(parts) == 1 else name
    return FileOwner(stem_of(top, SUFFIX) if len(parts) == 1 or is_archive(top) else top), name


def _person(name: str, student: str, level: str = "", *, is_late: bool = False) -> FileOwner:
    return FileOwner("_".join(filter(None, (name, student))), name, student, level, is_late)


def match_roster(
    roster: Iterable[Mapping[str, str]], entries: Mapping[str, Submission]
) -> dict[str, str]:
    """Return the entries of the students of a roster, by id.

    What a row names exactly is found first, for several rows if they name the same one; then what
    is the same but for case and accents, then names of people in any order of their words. Of
    several that are equally near none counts.
    """
    keys: dict[str, set[str]] = defaultdict(set)
    for name, entry in entries.items():
        owner = entry.owner
        names = {name, owner.key, *entry.tops, *(stem_of(top, SUFFIX) for top in entry.tops)}
        for key in names | {plain(alias) for alias in {*names, owner.id, owner.name}}:
            keys[key].add(name)
    matches: dict[str, str] = {}
    roster_keys = {row["id"]: _keys_of(row) for row in roster}
    for step in range(3):
        claims: dict[str, set[str]] = {}
        used_entries = set(matches.values()) if step else set()
        for student, steps in roster_keys.items():
            if student not in matches:
                candidates = {name for key in steps[step] if key for name in keys.get(key, ())}
                claims[student] = candidates - used_entries
        counts = Counter(name for candidates in claims.values() for name in candidates)
        for student, candidates in claims.items():
            if len(candidates) == 1 and (counts[min(candidates)] == 1 or not step):
                matches[student] = min(candidates)
    return matches


def _keys_of(row: Mapping[str, str]) -> tuple[list[str], list[str], list[str]]:
    """Return what a row names exactly, but for case and accents, and in other orders of words."""
    submission, student = row.get("submission") or "", plain(row["id"])
    exact_name = submission or row["id"]
    words = re.findall(r"\w+", row.get("name") or "")
    orders = range(len(words) if len(words) <= _MOST_WORDS else 1)
    return (
        [exact_name, stem_of(exact_name, SUFFIX)],
        # As Moodle's tables have it.
        [plain(stem_of(submission, SUFFIX)), student, student.removeprefix("participant")],
        [plain("".join(words[n:] + words[:n])) for n in orders],
    )
