"""A class at a glance: what went wrong with whom, similar programs, and how to play a run."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import combinations, groupby
from shlex import quote
from textwrap import wrap
from typing import NamedTuple

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.source import shipped_texts
from logical_robots_tui.lab.exporting import (
    Row,
    Table,
    as_code,
    as_percent,
    as_table,
    csv_of,
    done_runs,
    escaped,
    harmless_text,
)
from logical_robots_tui.lab.folder import Cell, Folder, Ledger, Manifest, Student
from logical_robots_tui.lab.grading import LevelGrade, duplicates, grades_of
from logical_robots_tui.lab.submissions import account_of
from logical_robots_tui.language.reference import REFERENCE
from logical_robots_tui.language.source_text import symbols_of
from logical_robots_tui.paths import did_you_mean
from logical_robots_tui.schema import INPUTS, MAIN, RECORDS
from logical_robots_tui.world.levels.load import read_level

ALIKE = 0.7
"""The score from which two programs are reported as similar."""

_GRAM = 4  # symbols in a row that are compared
_FEWEST = 12  # grams of one's own that make a program comparable
_LONGEST = 20_000  # characters of a program that are compared
_MOST_TEXTS = 20  # pairs whose texts are in the report


def student_of(manifest: Manifest, called: str) -> Student:
    """Return a student by id, name, submission or a part of the name, or raise InputError."""
    folded, everybody = called.casefold(), manifest.students
    found = [each for each in everybody if each.id == called] or [
        each for each in everybody if folded in (each.name.casefold(), each.submission.casefold())
    ]
    found = found or [each for each in everybody if folded in each.name.casefold()]
    if len(found) == 1:
        return found[0]
    if found:
        hint = f"Name one by the id: {', '.join(each.called for each in found[:10])}."
        raise InputError("Several students match", place=called, hint=hint)
    known = [name for each in everybody for name in (each.id, each.name, *each.name.split())]
    hint = did_you_mean(called, known) or "Name one by the id of the roster."
    raise InputError("No student matches", place=called, hint=hint)


def cell_of(manifest: Manifest, student: Student, level: str) -> Cell:
    """Return a student's program in a level, by its name or number, or raise InputError."""
    names = dict.fromkeys(each.level_name for each in manifest.cells)
    found = [name for name in names if level in (name, re.sub("^[0-9]+-", "", name))]
    if not found and level.isdecimal():
        found = [name for name in names if name.partition("-")[0].lstrip("0") == level.lstrip("0")]
    if len(found) != 1:
        hint = did_you_mean(level, names) or f"Levels: {', '.join(names)}."
        raise InputError("No program was run in this level", place=level, hint=hint)
    for cell in manifest.cells:
        if (cell.student, cell.level_name) == (student.id, found[0]):
            return cell
    why = f": {'; '.join(student.remarks)}" * bool(student.remarks)
    raise InputError(f"{student.called} has no program for {found[0]}{why}", place=level)


def play_command(folder: Folder, manifest: Manifest, cell: Cell, start: int = 0) -> str:
    """Return the short command that plays a student's program, typed where the folder is."""
    number = re.match("[0-9]+(?=-)", cell.level_name)
    others = {each.level_name for each in manifest.cells} - {cell.level_name}
    is_clear = number and not any(each.startswith(f"{number[0]}-") for each in others)
    level = number[0] if number and is_clear else quote(cell.level_name)
    name = quote(harmless_text(folder.path.resolve().name))
    command = f"logical-robots lab play {name} {quote(cell.student)} {level}"
    return command + (f" --start {start}" if start else "")


class Fault(NamedTuple):
    """What went wrong in a level, with the students and one of their cells, if any was run."""

    kind: str
    level: str
    why: str
    who: tuple[str, ...]
    cell: Cell | None
    start: int = 0


_KINDS = (
    "not graded yet",
    "no program",
    "does not compile",
    "too slow",
    "errors while running",
    "did not win",
    "did not win from every start",
)


def faults_of(manifest: Manifest, ledger: Ledger) -> list[Fault]:
    """Return what went wrong, by kind and level, what most students share first."""
    cells = {(cell.student, cell.level_name): cell for cell in manifest.cells}
    runs = {
        (each.cell.student, each.cell.level_name, each.start): each.result
        for each in done_runs(manifest, ledger)
    }
    found: dict[tuple[str, str, str], list[tuple[str, Cell | None, int]]] = defaultdict(list)
    for grade in grades_of(manifest, ledger):
        for level in grade.levels:
            key = grade.student.id, level.level
            kind, why = _fault(level)
            if kind:
                start = min(level.lost, default=0)
                if level.points is not None and level.lost:
                    lost = runs[*key, start]
                    why = lost.first[2] if lost.first else lost.outcome
                one = grade.student.called, cells.get(key), start
                found[kind, level.level, why].append(one)
    order = sorted(found, key=lambda key: (_KINDS.index(key[0]), key[1], -len(found[key]), key[2]))
    return [Fault(*key, tuple(who for who, *_ in found[key]), *found[key][0][1:]) for key in order]


def _fault(level: LevelGrade) -> tuple[str, str]:
    """Return the kind of what went wrong, or "", and why."""
    why = re.sub(r"^(line [\d,]+|tick [\d,]+, .*?): ", "", (*level.messages, level.outcome)[0])
    if level.points is None:
        return _KINDS[0], level.failure or level.outcome
    if level.is_missing:
        return _KINDS[1], level.outcome
    if level.outcome == "does not compile":
        return level.outcome, why
    if level.outcome.startswith(("too slow", "too many steps")):
        return "too slow", why
    if not level.won:
        return ("errors while running", why) if level.messages else ("did not win", why)
    return (_KINDS[-1], "") if level.lost else ("", "")


def fault_lines(manifest: Manifest, ledger: Ledger, width: int) -> list[str]:
    """Return what went wrong as lines for a terminal."""
    lines: list[str] = []
    for kind, faults in groupby(faults_of(manifest, ledger), key=lambda fault: fault.kind):
        lines.append(f"{kind}:")
        for fault in faults:
            said = f"{fault.level}: {', '.join(fault.who)}" + f": {fault.why}" * bool(fault.why)
            lines += wrap(said, width, initial_indent="  ", subsequent_indent="    ")
    return ["", "Common problems", *lines] if lines else []


def ungraded_lines(manifest: Manifest, ledger: Ledger) -> list[str]:
    """Return who is ungraded although all runs were tried, each with the reasons on a line."""
    lines = []
    for grade in grades_of(manifest, ledger):
        student, ungraded = grade.student, [each for each in grade.levels if each.points is None]
        why = [f"{each.level}: {each.failure}" for each in ungraded if each.failure]
        if ungraded and not student.submission:
            why = [ungraded[0].outcome]
        if why:
            lines.append(f"{student.called}: {'; '.join(why)}")
    return lines


class Alike(NamedTuple):
    """Two programs of a level that are similar; the score of equal ones is 1."""

    level: str
    score: float
    one: tuple[Cell, ...]
    other: tuple[Cell, ...]


def similar(folder: Folder, manifest: Manifest) -> list[Alike]:
    """Return programs whose `likeness` is at least `ALIKE`, the most similar first.

    What the level's starter has does not count. Raises InputError.
    """
    owners: dict[str, dict[str, list[Cell]]] = defaultdict(lambda: defaultdict(list))
    for cell in manifest.cells:
        owners[cell.level_name][cell.program].append(cell)
    shapes = {text: _shape(folder.text(text)) for texts in owners.values() for text in texts}
    found = []
    for level, texts in owners.items():
        given = _starter(folder, next(iter(texts.values()))[0])
        own = {text: shapes[text] - given for text in texts}
        for one, other in combinations(own, 2):
            score = _score(own[one], own[other])
            if score >= ALIKE:
                found.append(Alike(level, score, tuple(texts[one]), tuple(texts[other])))
    return sorted(found, key=lambda alike: -alike.score)


def likeness(one: str, other: str, given: str = "") -> float:
    """Return how alike two programs are, 0 to 1, without what they were given.

    The score is the share of symbols in a row that both have, in any order of statements: once
    with numbers and texts, once without. Own names of predicates, variables and fields do not
    count. Programs with too little of their own have 0.
    """
    return _score(_shape(one) - _shape(given), _shape(other) - _shape(given))


def _score(one: Counter[tuple[str, ...]], other: Counter[tuple[str, ...]]) -> float:
    least, most = sorted((one.total(), other.total()))
    if least < _FEWEST or 2 * least < ALIKE * (least + most):
        return 0.0  # it would be too little, too
    return 2 * (one & other).total() / (least + most)


def _starter(folder: Folder, cell: Cell) -> Counter[tuple[str, ...]]:
    level = read_level(folder.text(cell.level), cell.level_name)
    return _shape(shipped_texts().get(level.starter or "", ""))


@cache
def _names() -> frozenset[str]:
    """Return the names that are not a player's own, fields as in `symbols_of`."""
    fields = [name for names in INPUTS.values() for name in names]
    fields += ["desire", *(name for record in RECORDS for name in record.names)]
    names = [MAIN, *INPUTS, "if", "in", "true", "false", "null", *(each.name for each in REFERENCE)]
    return frozenset([*names, *(f".{name}" for name in fields), *(f"{name}:" for name in fields)])


def _shape(text: str) -> Counter[tuple[str, ...]]:
    """Return how often which symbols stand in a row, with own names replaced by their order."""
    found: Counter[tuple[str, ...]] = Counter()
    for symbols in symbols_of(text[:_LONGEST]):
        plain = ["#" if re.match(r"[\d\"'`]", each) else each for each in symbols]
        for each in (symbols, plain):
            for at in range(max(1, len(each) - _GRAM + 1)):
                found[_without_names(each[at : at + _GRAM])] += 1
    return found


def _without_names(symbols: Sequence[str]) -> tuple[str, ...]:
    order: dict[str, int] = {}
    return tuple(
        each
        if each in _names() or not (name := each.strip(".:")).isidentifier()
        else each.replace(name, f"{name[0].isupper()}{order.setdefault(name, len(order))}")
        for each in symbols
    )


def export_similar(folder: Folder, manifest: Manifest) -> list[str]:
    """Write similar programs as a table; return the names of what was written."""
    rows: list[Row] = []
    names = {student.id: student.name for student in manifest.students}
    for level, score, *both in similar(folder, manifest):
        whose = [[cell.student for cell in cells] for cells in both]
        who = [*map(", ".join, whose), *(", ".join(names[each] for each in ids) for ids in whose)]
        rows.append((level, round(score, 2), *who))
    table = Table(("level", "score", "one", "other", "one_name", "other_name"), rows)
    folder.put(folder.path / "similar.csv", csv_of(table))
    return ["similar.csv"]


def class_parts(folder: Folder, manifest: Manifest, ledger: Ledger) -> Iterator[str]:
    """Yield the parts of a report on a class as HTML."""
    grades = grades_of(manifest, ledger)
    levels = [level.level for level in grades[0].levels] if grades else []
    rows = [
        (
            grade.student.id,
            grade.student.name,
            grade.said if grade.points is None else grade.points,
            grade.most,
            grade.student.lateness,
            *("not graded yet" if level.points is None else level.points for level in grade.levels),
            "; ".join(grade.remarks),
        )
        for grade in grades
    ]
    yield "<h2>Submissions</h2>"
    yield from (f"<p>{escaped(line)}</p>" for line in account_of(manifest))
    head = ("id", "name", "points", "most", "late", *levels, "remarks")
    yield "<h2>Students</h2>" + as_table(head, rows)
    yield from _fault_parts(folder, manifest, ledger)
    names = {student.id: student.called for student in manifest.students}
    same = [
        (level, ", ".join(names[each] for each in ids)) for level, _, ids in duplicates(manifest)
    ]
    if same:
        yield "<h2>The same program</h2><p>Identical except for comments and whitespace.</p>"
        yield as_table(("level", "students"), same)
    yield from _similar_parts(folder, manifest, names)


def _fault_parts(folder: Folder, manifest: Manifest, ledger: Ledger) -> Iterator[str]:
    faults = groupby(faults_of(manifest, ledger), key=lambda fault: fault.kind)
    for number, (kind, group) in enumerate(faults):
        if not number:
            said = "The commands play one of these programs, typed where this folder is."
            yield f"<h2>Common problems</h2><p>{said}</p>"
        yield f"<h3>{kind.capitalize()}</h3><ul>"
        for fault in group:
            said = f"<b>{escaped(fault.level)}</b>: {escaped(', '.join(fault.who))}"
            said += f": {escaped(fault.why)}" * bool(fault.why)
            if fault.cell is not None:
                command = play_command(folder, manifest, fault.cell, fault.start)
                said += f"<br>{as_code(command)}"
            yield f"<li>{said}</li>"
        yield "</ul>"


def _similar_parts(folder: Folder, manifest: Manifest, names: Mapping[str, str]) -> Iterator[str]:
    found = similar(folder, manifest)
    if not found:
        return
    yield "<h2>Similar programs</h2><p>The share that is the same but for own names and the order"
    yield "of rules, without the level's starter. It is a reason to look, not a proof.</p>"
    who = [[", ".join(names[c.student] for c in side) for side in each[2:]] for each in found]
    rows = [(as_percent(a.score), a.level, *both) for a, both in zip(found, who, strict=True)]
    yield as_table(("alike", "level", "students", "and"), rows)
    for alike, both in list(zip(found, who, strict=True))[:_MOST_TEXTS]:
        said = f"{as_percent(alike.score)}, {alike.level}: {both[0]} and {both[1]}"
        yield f"<details><summary>{escaped(said)}</summary><div class=beside>"
        for cells, whose in zip(alike[2:], both, strict=True):
            text = folder.text(cells[0].own or cells[0].program)
            lines = "\n".join(map(escaped, text.splitlines()))
            yield f"<div><p>{escaped(whose)}</p><pre>{lines}</pre></div>"
        yield "</div></details>"
