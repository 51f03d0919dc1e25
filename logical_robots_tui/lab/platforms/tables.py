"""Tables of students as platforms and spreadsheets write them, in several languages."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from typing import NamedTuple

from logical_robots_tui.lab.platforms.names import encoding_of, plain, text_of
from logical_robots_tui.paths import did_you_mean

_MOST_COLUMNS = 100
_SHORTEST = 3  # letters and digits of an id by which a submission is known, too
_SEPARATORS = ",;\t"
_TEST_STUDENT = "Student, Test"  # in the gradebooks of Canvas
NO_TIME = "-"  # in Moodle's worksheet of somebody who has not submitted

HEADS = {
    "id": (
        "id identifier identifiant identificador identificativo identificatie identyfikator sid "
        "studentid matrikelnummer numeroetudiant numeroestudiante matricola numeroaluno "
        "studentnummer numeralbumu siskennung"
    ),
    "name": (
        "name fullname student studentname vollstandigername nomcomplet nombrecompleto "
        "nomecompleto nomeecognome nomecognome volledigenaam naam pelnanazwa imieinazwisko"
    ),
    "first": "firstname vorname prenom nombre nome voornaam imie",
    "last": "lastname surname nachname familienname nom apellidos cognome apelido sobrenome "
    "achternaam nazwisko",
    "points": "points grade bewertung note nota calificacion valutazione cijfer ocena",
    "group": "group gruppe groupe grupo gruppo groep grupa team",
    "time": (
        "lastmodifiedsubmission zuletztgeandertabgabe dernieremodificationtravailremis "
        "ultimamodificacionentrega ultimamodificaconsegna ultimamodificacaosubmissao "
        "ultimamodificacaoenvio laatstgewijzigdinzending ostatniamodyfikacjazadanie"
    ),
}
"""Heads of columns by what is in them, of English, German, French, Spanish, Italian, Portuguese,
Dutch and Polish, as `plain` has them."""


class StudentRow(NamedTuple):
    """A student in a table; `aliases` are other ids, user names and the like."""

    line: int
    id: str
    name: str = ""
    submission: str = ""
    group: str = ""
    time: str = ""
    aliases: tuple[str, ...] = ()
    cells: Mapping[str, str] = {}


class StudentTable(NamedTuple):
    """A table with the numbers of its columns by what is in them."""

    file: str
    rows: list[StudentRow]
    notes: list[str]
    text: str = ""
    encoding: str = "utf-8"
    separator: str = ","
    columns: Mapping[str, int] = {}


class TableError(ValueError):
    """A table of which the first line does not say what is needed."""


def read_table(
    file: str,
    content: bytes,
    required: Sequence[str],
    optional: Sequence[str],
    columns: Mapping[str, str] | None = None,
) -> StudentTable:
    """Return the rows of a table that have an id.

    `columns` are heads of a roster's columns that an assignment names; None for other tables,
    whose columns are not guessed from what is in them. Raises TableError, ValueError, csv.Error.
    """
    if "\0" in (text := text_of(content)):
        raise ValueError("it is not text")
    line, _, _ = text.partition("\n")
    separator = separator_line(text)[4:].strip("\n")[:1]
    separator = separator or max(_SEPARATORS, key=re.sub('"[^"]*"', "", line).count)
    all_lines = lines_of(text, separator)
    heads = [head.strip() for _, cells in islice(all_lines, 1) for head in cells]
    if len(heads) > _MOST_COLUMNS:
        raise ValueError(f"it has more than {_MOST_COLUMNS} columns")
    lines = dict(all_lines) if heads else {}
    for cells in lines.values():
        cells[:] = [cell.strip() for cell in cells] + [""] * (len(heads) - len(cells))
    roles = _roles(heads, columns or {}, {*required, *optional})
    table = StudentTable(file, [], [], text, encoding_of(content), separator, roles)
    if columns is not None and lines:
        guesses = _guesses(heads, [*lines.values()], roles)
        roles |= guesses  # also those of the table
        words = [f'"{heads[number]}" is taken for the {role}' for role, number in guesses.items()]
        hint = '; columns = {id = "...", name = "..."} says otherwise'
        table.notes.extend([", ".join(words) + hint] if words else [])
    for column in required if lines else ():
        if column not in roles:
            message = f'There is no column "{column}"; the first line names the columns: '
            raise TableError(message + ", ".join(head.casefold() for head in heads))
    unused = [column for column in optional if column not in roles]
    for number, head in enumerate(heads):
        if number not in roles.values() and (hint := did_you_mean(head.casefold(), unused)):
            table.notes.append(f'The column "{head}" is not known. {hint}')
    id_columns = [] if columns is None else _id_columns(heads, [*lines.values()], roles)
    table.rows.extend(_rows(lines, roles, id_columns))
    return table


def separator_line(text: str) -> str:
    """Return the line that names the separator, which a spreadsheet may write first, or ""."""
    line = text[: text.find("\n") + 1 or None]
    return line if line.casefold().startswith("sep=") else ""


def lines_of(text: str, separator: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the number of the line on which a row ends, and its cells; raises csv.Error."""
    prefix = separator_line(text)
    reader = csv.reader(io.StringIO(text[len(prefix) :], newline=""), delimiter=separator)
    for cells in reader:
        yield reader.line_num + bool(prefix), cells


def number_of(text: str) -> float:
    """Return a number with a decimal point or comma; raises ValueError if it is not finite."""
    if not math.isfinite(number := float(text if "." in text else text.replace(",", "."))):
        raise ValueError
    return number


def _roles(heads: list[str], columns: Mapping[str, str], names: set[str]) -> dict[str, int]:
    """Return the numbers of columns by what is in them, as far as their heads tell."""
    roles: dict[str, int] = {}
    plain_heads = [plain(head) for head in heads]
    for role in (*HEADS, *sorted(names - HEADS.keys())):
        words = [role, *HEADS.get(role, "").split()]
        if role in columns:
            words = [plain(columns[role])]
            if words[0] not in plain_heads:
                raise TableError(f'There is no column "{columns[role]}", named in columns')
        if matches := [plain_heads.index(word) for word in words if word in plain_heads]:
            roles[role] = matches[0]
    return roles


def _guesses(heads: list[str], lines: list[list[str]], roles: dict[str, int]) -> dict[str, int]:
    """Return columns for ids and names, by what is in them, if their heads are unknown."""
    guesses: dict[str, int] = {}
    cells_by_column = {
        number: [line[number] for line in lines]
        for number in range(len(heads))
        if number not in roles.values()
    }
    if not {"name", "first", "last"} & roles.keys():
        for number, cells in cells_by_column.items():
            digits = sum(bool(re.search(r"[@\d]", cell)) for cell in cells)
            are_words = all(len(cell.split()) > 1 for cell in cells) and 4 * digits < len(cells)
            if are_words and 2 * len({*cells}) > len(cells):
                guesses.setdefault("name", number)
    if "id" not in roles:
        ids = _id_columns(heads, lines, roles)
        ids += [n for n, cells in cells_by_column.items() if len({*cells}) == len(cells)]
        # A number before a user name, and names where nothing else differs.
        ids.sort(key=lambda n: not all(re.search(r"\d", cell) for cell in cells_by_column[n]))
        ids += [n for role, n in (roles | guesses).items() if role == "name"]
        guesses |= {"id": ids[0]} if ids else {}
    return guesses


def _id_columns(heads: list[str], lines: list[list[str]], roles: Mapping[str, int]) -> list[int]:
    """Return the other columns that identify students: unique words, such as user names."""
    numbers = []
    for number in set(range(len(heads))) - {*roles.values()}:
        words = [line[number] for line in lines if line[number]]
        is_word = all(" " not in word and len(plain(word)) >= _SHORTEST for word in words)
        if is_word and len({*words}) == len(words) >= max(1, len(lines) / 2):
            numbers.append(number)
    return numbers


def _rows(
    lines: Mapping[int, list[str]], roles: Mapping[str, int], id_columns: list[int]
) -> Iterator[StudentRow]:
    for number, line in lines.items():
        cells = {role: line[column] for role, column in roles.items()}
        full_name = " ".join(filter(None, (cells.get("first"), cells.get("last"))))
        name = cells.get("name") or full_name
        if cells["id"] and name != _TEST_STUDENT:
            ids = [line[column] for column in id_columns if line[column]]
            ids += [text.partition("@")[0] for text in ids]
            texts = {key: cells.get(key, "") for key in ("submission", "group", "time")}
            aliases = tuple(dict.fromkeys(ids))
            yield StudentRow(number, cells["id"], name, **texts, aliases=aliases, cells=cells)
