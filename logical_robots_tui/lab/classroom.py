"""A class at a glance: faults of its programs, similar programs, and how to play a run."""

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
from logical_robots_tui.game.source import reference_names, shipped_texts
from logical_robots_tui.lab.exporting import (
    ResultTable,
    Row,
    RunRecords,
    as_code,
    as_percent,
    escape_html,
    harmless_text,
    table_section,
)
from logical_robots_tui.lab.folder import Cell, Folder, Manifest, Student
from logical_robots_tui.lab.grading import NOT_RUN, LevelGrade, duplicates, grades_of
from logical_robots_tui.lab.submissions import account_of
from logical_robots_tui.language.reference import REFERENCE
from logical_robots_tui.language.source_text import PUNCTUATION, lexemes_of
from logical_robots_tui.paths import did_you_mean
from logical_robots_tui.schema import INPUTS, MAIN, RECORDS
from logical_robots_tui.world.levels.load import read_level

ALIKE = 0.7
"""The score from which two programs are reported as similar."""

_GRAM = 4  # symbols in a row that are compared
_FEWEST = 6  # grams of one's own that make a program comparable
_MOST_INLINED = 20_000  # lexemes looked at or written where helpers are inlined
_MOST_HELPERS = 20  # within each other
_LONGEST = 20_000  # characters of a program that are compared
_MOST_TEXTS = 20  # pairs whose texts are in the report


def student_of(manifest: Manifest, query: str) -> Student:
    """Return a student by id, name, submission or a part of the id or name, or raise InputError."""
    folded, students = query.casefold(), manifest.students
    matches = [s for s in students if s.id == query] or [
        s for s in students if folded in (s.name.casefold(), s.submission.casefold())
    ]
    for parts in ("id", "name"):
        matches = matches or [s for s in students if folded in getattr(s, parts).casefold()]
    if len(matches) == 1:
        return matches[0]
    if matches:
        hint = f"Name one by the id: {', '.join(s.label for s in matches[:10])}."
        raise InputError("Several students match", place=query, hint=hint)
    names = [name for s in students for name in (s.id, s.name, *s.name.split())]
    hint = did_you_mean(query, names) or "Name one by the id of the roster."
    raise InputError("No student matches", place=query, hint=hint)


def cell_of(manifest: Manifest, student: Student, level: str) -> Cell:
    """Return a student's program in a level, by its name or number, or raise InputError."""
    names = dict.fromkeys(cell.level_name for cell in manifest.cells)
    levels = [name for name in names if level in (name, re.sub("^[0-9]+-", "", name))]
    if not levels and level.isdecimal():
        levels = [name for name in names if name.partition("-")[0].lstrip("0") == level.lstrip("0")]
    if len(levels) != 1:
        hint = did_you_mean(level, names) or f"Levels: {', '.join(names)}."
        raise InputError("No program was run in this level", place=level, hint=hint)
    for cell in manifest.cells:
        if (cell.student, cell.level_name) == (student.id, levels[0]):
            return cell
    reason = f": {'; '.join(student.remarks)}" * bool(student.remarks)
    raise InputError(f"{student.label} has no program for {levels[0]}{reason}", place=level)


def play_command(folder: Folder, manifest: Manifest, cell: Cell, start: int = 0) -> str:
    """Return the short command that plays a student's program, typed where the folder is."""
    number = re.match("[0-9]+(?=-)", cell.level_name)
    other_levels = {c.level_name for c in manifest.cells} - {cell.level_name}
    is_clear = number and not any(name.startswith(f"{number[0]}-") for name in other_levels)
    level = number[0] if number and is_clear else quote(cell.level_name)
    name = quote(harmless_text(folder.path.resolve().name))
    command = f"logical-robots lab play {name} {quote(cell.student)} {level}"
    return command + (f" --start {start}" if start else "")


class Fault(NamedTuple):
    """What went wrong in a level, with the students and one of their cells, if any was run."""

    kind: str
    level: str
    reason: str
    students: tuple[str, ...]
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


def faults_of(records: RunRecords) -> list[Fault]:
    """Return the faults of a class by kind and level, the most common first."""
    cells = {(cell.student, cell.level_name): cell for cell in records.manifest.cells}
    runs = {(run.cell.student, run.cell.level_name, run.start): run for run in records.finished}
    cases: dict[tuple[str, str, str], list[tuple[str, Cell | None, int]]] = defaultdict(list)
    for grade in grades_of(records):
        for level in grade.levels:
            key = grade.student.id, level.level
            kind, reason = _fault(level)
            if kind:
                start = min(level.lost, default=0)
                if level.points is not None and level.lost:
                    reason = runs[*key, start].reason or runs[*key, start].result.outcome
                case = grade.student.label, cells.get(key), start
                cases[kind, level.level, reason].append(case)
    order = sorted(cases, key=lambda key: (_KINDS.index(key[0]), key[1], -len(cases[key]), key[2]))
    return [
        Fault(*key, tuple(name for name, *_ in cases[key]), *cases[key][0][1:]) for key in order
    ]


def _fault(level: LevelGrade) -> tuple[str, str]:
    """Return the kind of a level's fault, or "", and the reason."""
    reason = re.sub(r"^(line [\d,]+|tick [\d,]+, .*?): ", "", (*level.messages, level.outcome)[0])
    if level.points is None:
        return _KINDS[0], level.failure or level.outcome
    if level.is_missing:
        return _KINDS[1], level.outcome
    if level.outcome == "does not compile":
        return level.outcome, reason
    if level.outcome.startswith(("too slow", "too many steps")):
        return "too slow", reason
    if not level.won:
        return ("errors while running", reason) if level.messages else ("did not win", reason)
    return (_KINDS[-1], "") if level.lost else ("", "")


def fault_lines(records: RunRecords, width: int) -> list[str]:
    lines: list[str] = []
    for kind, faults in groupby(faults_of(records), key=lambda fault: fault.kind):
        lines.append(f"{kind}:")
        for fault in faults:
            reason = f": {fault.reason}" * bool(fault.reason)
            line = f"{fault.level}: {', '.join(fault.students)}{reason}"
            lines += wrap(line, width, initial_indent="  ", subsequent_indent="    ")
    return ["", "Common problems", *lines] if lines else []


def ungraded_lines(records: RunRecords) -> list[str]:
    """Return a line for each student who is ungraded although all runs were tried."""
    lines = []
    for grade in grades_of(records):
        student, ungraded = grade.student, [level for level in grade.levels if level.points is None]
        failures = [(level.level, level.failure or level.outcome) for level in ungraded]
        reasons = [f"{name}: {why}" for name, why in failures if why != NOT_RUN]
        if ungraded and not student.submission:
            reasons = [ungraded[0].outcome]
        if reasons:
            lines.append(f"{student.label}: {'; '.join(reasons)}")
    return lines


class SimilarPair(NamedTuple):
    """Two programs of a level that are similar; the score of equal ones is 1.

    The other one is of students, or the game's `reference` program.
    """

    level: str
    score: float
    first: tuple[Cell, ...]
    second: tuple[Cell, ...] = ()
    reference: str = ""


def similar_pairs(folder: Folder, manifest: Manifest) -> list[SimilarPair]:
    """Return programs whose `likeness` is at least `ALIKE`, the most similar first.

    They are compared with each other and with the solution and the reference programs of the
    level. What its starter has does not count. Raises InputError.
    """
    owners: dict[str, dict[str, list[Cell]]] = defaultdict(lambda: defaultdict(list))
    for cell in manifest.cells:
        owners[cell.level_name][cell.program].append(cell)
    shapes = {text: _shape(folder.text(text)) for texts in owners.values() for text in texts}
    pairs = []
    for level, texts in owners.items():
        first_cell = next(iter(texts.values()))[0]
        parsed_level = read_level(folder.text(first_cell.level), level)
        starter_shape = _shape(shipped_texts().get(parsed_level.starter, ""))
        own_shapes = {text: shapes[text] - starter_shape for text in texts}
        for first, second in combinations(own_shapes, 2):
            score = _score(own_shapes[first], own_shapes[second])
            if score >= ALIKE:
                pairs.append(SimilarPair(level, score, tuple(texts[first]), tuple(texts[second])))
        for name in reference_names(parsed_level.solution):
            reference_shape = _shape(shipped_texts().get(name, "")) - starter_shape
            for text, shape in own_shapes.items():
                if (score := _score(shape, reference_shape)) >= ALIKE:
                    pairs.append(SimilarPair(level, score, tuple(texts[text]), reference=name))
    return sorted(pairs, key=lambda pair: -pair.score)


def likeness(first: str, second: str, starter: str = "") -> float:
    """Return how alike two programs are, 0 to 1, without the code of a starter.

    The score is the share of symbols in a row that both have, in any order of statements. Numbers,
    texts, and own names of predicates, variables and fields do not count, and helpers are
    inlined. Programs with too little of their own have 0.
    """
    return _score(_shape(first) - _shape(starter), _shape(second) - _shape(starter))


def _score(first: Counter[tuple[str, ...]], second: Counter[tuple[str, ...]]) -> float:
    smaller, larger = sorted((first.total(), second.total()))
    if smaller < _FEWEST or 2 * smaller < ALIKE * (smaller + larger):
        return 0.0  # it would be too little, too
    return 2 * (first & second).total() / (smaller + larger)


@cache
def _names() -> frozenset[str]:
    """Return the names of the language and of its inputs, fields as in `_symbols`."""
    fields = [name for names in INPUTS.values() for name in names]
    fields += ["desire", *(name for record in RECORDS for name in record.names)]
    names = [MAIN, *INPUTS, "if", "in", "true", "false", "null", *(f.name for f in REFERENCE)]
    return frozenset([*names, *(f".{name}" for name in fields), *(f"{name}:" for name in fields)])


def _shape(text: str) -> Counter[tuple[str, ...]]:
    """Count the sequences of symbols, with own names replaced by their order."""
    counts: Counter[tuple[str, ...]] = Counter()
    for statement in _inlined([*lexemes_of(text[:_LONGEST])]):
        symbols = _symbols(statement)
        for start in range(max(1, len(symbols) - _GRAM + 1)):
            counts[_without_names(symbols[start : start + _GRAM])] += 1
    return counts


def _symbols(lexemes: Sequence[str]) -> list[str]:
    """Return the symbols of a statement, fields as ``.x`` or ``x:``, literals as ``#``."""
    symbols = []
    for last, lexeme, follower in _neighbours(lexemes):
        if lexeme.isidentifier() and lexeme not in PUNCTUATION:
            symbols.append("." * (last == ".") + lexeme + ":" * (follower == ":"))
        elif lexeme not in PUNCTUATION:
            symbols.append("#" if re.match(r"[\d\"'`]", lexeme) else lexeme)
    return symbols


def _neighbours(lexemes: Sequence[str]) -> Iterator[tuple[str, str, str]]:
    """Return lexemes between the one to the left of each and the one to the right."""
    return zip(["", *lexemes], lexemes, [*lexemes[1:], ""], strict=False)


def _inlined(statements: Sequence[list[str]]) -> list[list[str]]:
    """Return a program's statements with predicates of one rule where they are called."""
    heads = Counter(lexemes[0] for lexemes in statements)
    helpers: dict[str, tuple[list[str], list[str]]] = {}
    for lexemes in statements:
        parameters, end = _arguments(lexemes, 1)
        is_rule = lexemes[end : end + 1] in ([":-"], ["="]) and heads[lexemes[0]] == 1
        is_plain = all(parameter[1:] in ([], [":"]) for parameter in parameters)
        if is_rule and is_plain and lexemes[0] != MAIN:
            helpers[lexemes[0]] = [parameter[0] for parameter in parameters], lexemes[end + 1 :]
    called: set[str] = set()
    budget = _MOST_INLINED

    def inline(lexemes: list[str], path: tuple[str, ...]) -> list[str]:
        nonlocal budget
        result, index = lexemes[:1], 1
        while index < len(lexemes):
            name = lexemes[index]
            result.append(name)
            index += 1
            if name not in helpers or name in path or len(path) > _MOST_HELPERS or budget < 0:
                continue
            arguments, end = _arguments(lexemes, index)
            parameters, body = helpers[name]
            values = dict(zip(parameters, arguments, strict=False))
            values |= {a[0]: a[2:] or a[:1] for a in arguments if a[1:2] == [":"]}
            budget -= end - index + sum(len(values.get(lexeme, "-")) for lexeme in body)
            if end == index or budget < 0:
                continue
            bound = [name]
            for last, lexeme, follower in _neighbours(body):
                is_field = last == "." or follower == ":"
                bound += [lexeme] if is_field else values.get(lexeme, [lexeme])
            called.add(name)
            result[-1:] = inline(bound, (*path, name))[1:]
            index = end
        return result

    results = [inline(lexemes, (lexemes[0],)) for lexemes in statements]
    return [lexemes for lexemes in results if lexemes[0] not in called]


def _arguments(lexemes: Sequence[str], start: int) -> tuple[list[list[str]], int]:
    """Return what is between commas in the bracket at an index, if there is one, and its end."""
    arguments: list[list[str]] = [[]]
    depth = 0
    for index in range(start, len(lexemes)):
        lexeme = lexemes[index]
        depth += (lexeme in "([{") - (lexeme in ")]}")
        if not depth:
            return [a for a in arguments if a], index + (index > start)
        if depth == 1 and lexeme == ",":
            arguments.append([])
        elif index > start:
            arguments[-1].append(lexeme)
    return [], len(lexemes)


def _without_names(symbols: Sequence[str]) -> tuple[str, ...]:
    order: dict[str, int] = {}
    return tuple(
        symbol
        if symbol in _names() or not (name := symbol.strip(".:")).isidentifier()
        else symbol.replace(name, f"{name[0].isupper()}{order.setdefault(name, len(order))}")
        for symbol in symbols
    )


_REFERENCE = "the game's program"


def similar_table(folder: Folder, manifest: Manifest) -> ResultTable:
    rows: list[Row] = []
    names = {student.id: student.name for student in manifest.students}
    for level, score, *pair, reference in similar_pairs(folder, manifest):
        sides = [[cell.student for cell in cells] for cells in pair]
        labels = [*map(", ".join, sides), *(", ".join(names[s] for s in side) for side in sides)]
        if reference:
            labels[1::2] = reference, _REFERENCE
        rows.append((level, round(score, 2), *labels))
    return ResultTable(("level", "score", "one", "other", "one_name", "other_name"), rows)


def class_parts(folder: Folder, records: RunRecords) -> Iterator[str]:
    manifest, grades = records.manifest, grades_of(records)
    levels = [level.level for level in grades[0].levels] if grades else []
    rows = [
        (
            grade.student.id,
            grade.student.name,
            grade.points_text if grade.points is None else grade.points,
            grade.most,
            grade.student.lateness,
            *("not graded yet" if level.points is None else level.points for level in grade.levels),
            "; ".join(grade.remarks),
        )
        for grade in grades
    ]
    yield "<h2>Submissions</h2>"
    yield from (f"<p>{escape_html(line)}</p>" for line in account_of(manifest))
    head = ("id", "name", "points", "most", "late", *levels, "remarks")
    yield table_section("Students", head, rows)
    yield from _fault_parts(folder, records)
    names = {student.id: student.label for student in manifest.students}
    duplicate_rows = [
        (level, ", ".join(names[s] for s in ids)) for level, _, ids in duplicates(manifest)
    ]
    if duplicate_rows:
        intro = "Identical except for comments and whitespace."
        yield table_section("The same program", ("level", "students"), duplicate_rows, intro)
    yield from _similar_parts(folder, manifest, names)


def _fault_parts(folder: Folder, records: RunRecords) -> Iterator[str]:
    faults = groupby(faults_of(records), key=lambda fault: fault.kind)
    for number, (kind, group) in enumerate(faults):
        if not number:
            intro = "The commands play one of these programs, typed where this folder is."
            yield f"<h2>Common problems</h2><p>{intro}</p>"
        yield f"<h3>{kind.capitalize()}</h3><ul>"
        for fault in group:
            entry = f"<b>{escape_html(fault.level)}</b>: {escape_html(', '.join(fault.students))}"
            entry += f": {escape_html(fault.reason)}" * bool(fault.reason)
            if fault.cell is not None:
                command = play_command(folder, records.manifest, fault.cell, fault.start)
                entry += f"<br>{as_code(command)}"
            yield f"<li>{entry}</li>"
        yield "</ul>"


def _similar_parts(folder: Folder, manifest: Manifest, names: Mapping[str, str]) -> Iterator[str]:
    pairs = similar_pairs(folder, manifest)
    if not pairs:
        return
    intro = (
        "The share that is the same but for own names, numbers, helpers and the order of rules, "
        "without the level's starter. It is a reason to look, not a proof."
    )
    labels = [
        [
            ", ".join(names[cell.student] for cell in side) or f"{_REFERENCE} {pair.reference}"
            for side in (pair.first, pair.second)
        ]
        for pair in pairs
    ]
    rows = [(as_percent(p.score), p.level, *sides) for p, sides in zip(pairs, labels, strict=True)]
    yield table_section("Similar programs", ("alike", "level", "students", "and"), rows, intro)
    for pair, sides in list(zip(pairs, labels, strict=True))[:_MOST_TEXTS]:
        title = f"{as_percent(pair.score)}, {pair.level}: {sides[0]} and {sides[1]}"
        yield f"<details><summary>{escape_html(title)}</summary><div class=beside>"
        for cells, label in zip((pair.first, pair.second), sides, strict=True):
            if not cells:
                continue  # a reference program is a secret
            text = folder.text(cells[0].own or cells[0].program)
            lines = "\n".join(map(escape_html, text.splitlines()))
            yield f"<div><p>{escape_html(label)}</p><pre>{lines}</pre></div>"
        yield "</div></details>"
