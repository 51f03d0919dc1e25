"""Exports of learning platforms: whose a file is, and when it was handed in."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any, NamedTuple

from logical_robots_tui.errors import InputError, check_installed
from logical_robots_tui.game.source import SUFFIX
from logical_robots_tui.lab.platforms.archives import File, is_archive, stem_of
from logical_robots_tui.lab.platforms.dates import parse_date

METADATA = "submission_metadata.yml"
"""Where Gradescope says whose the submissions are."""

TIMESTAMP = "timestamp.txt"
"""Where nbgrader says when it collected a submission."""

_DEEPEST = 20  # mappings and lists in each other in Gradescope's metadata

FIELDS = {"name": r"[^/]+", "id": r"[^/_\s]+", "level": r"[^/]+"}
"""Fields that a pattern of names may have in braces."""

_EXPORTS = (
    # Moodle, with folders or without: Ada Lovelace_1234_assignsubmission_file_/program.l
    re.compile(r"(?P<name>.+)_(?P<id>\d+)_assignsubmission_[a-z]+_?(?P<rest>.*)", re.I),
    # Blackboard: Week 1_alove_attempt_2026-10-18-20-15-02_program.l
    re.compile(
        r"(?P<key>(?:.*_)?(?P<id>[^_]+))_attempt_(?P<time>\d{4}(?:-\d\d){5})(?:_(?P<rest>.+)|\.txt)"
    ),
    # Brightspace: 12345-67890 - Ada Lovelace - Nov 29, 2026 1159 PM/program.l
    re.compile(
        r"(?P<id>\d+)-\d+ - (?P<name>.+) - (?P<time>\w+ \d\d?, \d{4} \d{3,4} [AP]M)(?P<rest>)", re.I
    ),
    # Canvas: lovelaceada_LATE_12345_67890_program-1.l; without the name if it is anonymous
    re.compile(
        r"(?:(?P<name>.+?)_)??(?P<late>LATE_)?(?P<id>\d{2,}|anon_[^_]+)"
        r"_(?:\d{2,}_(?P<rest>.+)|(?:text|link)\.html)",
        re.I,
    ),
)


class Person(NamedTuple):
    name: str = ""
    id: str = ""


class FileOwner(NamedTuple):
    """The owner of a file, as far as its name and its platform's metadata tell.

    `is_late` is None if the platform says nothing of that; a `time` without a zone is local.
    """

    key: str
    people: tuple[Person, ...] = ()
    level: str = ""
    is_late: bool | None = None
    time: datetime | None = None


def is_of_platform(name: str) -> bool:
    return any(export.fullmatch(name) for export in _EXPORTS)


def pattern_problem(pattern: str) -> str:
    fields = re.findall(r"\{(.*?)\}", pattern)
    if unknown := set(fields) - FIELDS.keys():
        return f"{{{min(unknown)}}} can't be in a pattern; known are {{name}}, {{id}} and {{level}}"
    if len(fields) > len(set(fields)):
        return "The pattern has the same field twice"
    if pattern and not {"name", "id"} & {*fields}:
        return "A pattern needs {name} or {id}, such as {name}_{id}_{level}.l"
    return ""


def patterns_of(pattern: str, stems: Mapping[str, str]) -> list[re.Pattern[str]]:
    """Return a pattern as expressions: with the levels that there are, and with any."""
    if not pattern:
        return []
    levels = "|".join(r"[\W_]*".join(stem) for stem in sorted(stems, key=len, reverse=True))
    expressions = []
    for level in (levels, FIELDS["level"]):
        fields = FIELDS | {"level": level}
        pieces = re.split(r"\{(\w+)\}", stem_of(pattern, SUFFIX))
        texts = [
            f"(?P<{piece}>{fields[piece]})"
            if number % 2
            else re.escape(piece).replace(r"\*", "[^/]*")
            for number, piece in enumerate(pieces)
        ]
        expressions.append(re.compile("".join(texts), re.I))
    return expressions


def owner_of(
    parts: tuple[str, ...],
    patterns: Sequence[re.Pattern[str]],
    owners: Mapping[str, FileOwner],
) -> tuple[FileOwner, str]:
    """Return the owner of a file, and its name without the owner's."""
    top, name = parts[0], parts[-1]
    for pattern in patterns:
        for text in ("/".join(parts), name, top):
            if match := pattern.fullmatch(stem_of(text, SUFFIX)):
                fields = match.groupdict()
                is_program = text[-len(name) :] == name and name.casefold().endswith(SUFFIX)
                level = fields["level"] + SUFFIX if "level" in fields and is_program else ""
                return _owner(fields, level=level), name
    if top in owners:
        return owners[top], name
    for export in _EXPORTS:
        if match := export.fullmatch(top):
            fields = match.groupdict()
            is_late = bool(fields["late"]) if "late" in fields else None
            owner = _owner(fields, is_late=is_late, time=parse_date(fields.get("time") or ""))
            return owner, (fields["rest"] or "") if len(parts) == 1 else name
    return FileOwner(stem_of(top, SUFFIX) if len(parts) == 1 or is_archive(top) else top), name


def _owner(fields: Mapping[str, str | None], **facts: Any) -> FileOwner:
    person = Person(fields.get("name") or "", fields.get("id") or "")
    return FileOwner(fields.get("key") or "_".join(filter(None, person)), (person,), **facts)


def owners_of_gradescope(files: Sequence[File]) -> dict[str, FileOwner]:
    """Return owners by folder, from the metadata that Gradescope exports."""
    file = next((file for file in files if file.parts == (METADATA,)), None)
    if file and file.problem:
        raise InputError(f"can't be read: {file.problem}", place=METADATA)
    entries = _yaml(file.content) if file else {}
    owners: dict[str, FileOwner] = {}
    for folder, entry in entries.items() if isinstance(entries, dict) else ():
        submitters = entry.get(":submitters") if isinstance(entry, dict) else ()
        people = []
        for submitter in submitters if isinstance(submitters, list) else ():
            if isinstance(submitter, dict):
                texts = (submitter.get(f":{key}") for key in ("name", "sid"))
                people.append(Person(*(t.strip() if isinstance(t, str) else "" for t in texts)))
        people = [person for person in people if any(person)]
        if people:
            key = "_".join(filter(None, people[0])) if len(people) == 1 else folder
            time = entry.get(":created_at")
            time = parse_date(time) if isinstance(time, str) else None
            owners[folder] = FileOwner(key, tuple(people), time=time)
    return owners


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
            place=METADATA + (f", line {mark.line + 1}" if mark else ""),
            hint="Export the submissions again, or remove this file.",
        ) from error
    return next(iter(stack[0]), {})
