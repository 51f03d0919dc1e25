"""Checking answers to the questions of a level: queries at ticks of a run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import permutations
from typing import NamedTuple

from logical_robots_tui.game.debugging.inquiry import Inquiry
from logical_robots_tui.game.run import Run
from logical_robots_tui.game.source import DEFAULT_PROGRAM, compile_program, load_program
from logical_robots_tui.mind import Predicate, ProgramError, QueryError, ResultTable
from logical_robots_tui.values import Value, spell
from logical_robots_tui.wording import clip, count_of
from logical_robots_tui.world import Level, LevelError
from logical_robots_tui.world.level import LevelQuestion, Visibility

_ALL = Visibility(memory="all", sensor="all")
_ROBOT = "robot_name"
_MOST_COLUMNS = 5  # whose order is tried
_WIDEST_ROW = 60  # characters


class Verdict(NamedTuple):
    """What an answer is worth, and its rows at the tick that decides, or None if it failed."""

    is_right: bool
    tick: int
    words: str
    table: ResultTable | None = None


class Examiner:
    """Checks answers to the questions of a level; a query sees the rows of all robots."""

    def __init__(self, level: Level) -> None:
        self._level = level
        self._runs: dict[str, Run] = {}
        self._inquiry = Inquiry(replace(level, visibility=_ALL))

    async def predicates(self, question: LevelQuestion) -> list[Predicate]:
        """Return the predicates and functions that a query may use, or raise InputError."""
        program = (await self._run(question)).program
        return [predicate for predicate in program.predicates if predicate.is_listed]

    async def check(
        self,
        question: LevelQuestion,
        query: str,
        report: Callable[[int], object] = lambda _tick: None,
    ) -> Verdict:
        """Compare a query's rows with the right ones at each tick, up to the first difference.

        `report` gets the tick that the run has reached. Raises ProgramError for a wrong query, and
        InputError if the level's program or its own answer can't be used.
        """
        for tick in question.ticks:
            try:
                expected = await self.rows(question, question.answer, tick, report)
            except (ProgramError, QueryError) as error:
                message = f"The level's own answer can't be used: {error}"
                raise LevelError(message, place=self._level.source) from error
            try:
                answer = await self.rows(question, query, tick)
            except QueryError as error:
                verdict = Verdict(False, tick, f"it gives no rows. {error}")
            else:
                difference_words = difference(answer, expected)
                verdict = Verdict(not difference_words, tick, difference_words, answer)
            if not verdict.is_right:
                break
        earlier_ticks = [t for t in question.ticks if t < tick]
        if verdict.is_right:
            rows = f"; these rows are from tick {tick}" * bool(earlier_ticks)
            words = f"Right at {ticks_in_words(question.ticks)}{rows}."
        elif earlier_ticks:
            words = f"Right at {ticks_in_words(earlier_ticks)}, but at tick {tick} {verdict.words}"
        else:
            words = f"At tick {tick} {verdict.words}"
        return verdict._replace(words=words)

    async def rows(
        self,
        question: LevelQuestion,
        query: str,
        tick: int,
        report: Callable[[int], object] = lambda _tick: None,
    ) -> ResultTable:
        """Return a query's rows at a tick; raise as `check`, or QueryError if it failed."""
        run = await self._run(question)
        return await self._inquiry.ask(run.program, query, await run.frame(tick, report))

    async def close(self) -> None:
        await self._inquiry.close()
        for run in self._runs.values():
            await run.close()

    async def _run(self, question: LevelQuestion) -> Run:
        name = program_of(self._level, question)
        if name not in self._runs:
            program = await compile_program(load_program(name).text)
            self._runs[name] = Run(self._level, program)
        return self._runs[name]


def program_of(level: Level, question: LevelQuestion) -> str:
    """Return the name of the program that runs for a question."""
    return question.program or level.starter or DEFAULT_PROGRAM


def ticks_in_words(ticks: Sequence[int]) -> str:
    *first, last = map(str, ticks)
    return f"tick{'s' * bool(first)} {', '.join(first)}{' and ' * bool(first)}{last}"


def mistake_lines(query: str, error: ProgramError) -> list[str]:
    """Return the first error in a query: its line, a caret below the place, and what is wrong."""
    first = error.first
    line = (*query.splitlines(), *[""] * first.line)[first.line - 1]
    caret = " " * (first.column - 1) + "^" * max(1, len(first.excerpt))
    return [line, caret[: len(line) + 1], f"{first.message}. {first.hint}".rstrip()]


def difference(answer: ResultTable, expected: ResultTable) -> str:
    """Return in words how rows differ from the right ones, in any order, or "" if they don't.

    Columns are compared by name if both tables have the same names, and otherwise in the order in
    which they fit best.
    """
    if answer.truncated:
        return f"it gives more than {count_of(len(answer.rows), 'row')}."
    if answer.rows and len(answer.columns) != len(expected.columns):
        if (narrower := _without_robot(answer, expected)) is not None:
            return difference(narrower, expected)
        columns = count_of(len(answer.columns), "column")
        hint = " The head of a rule chooses them." * (len(answer.columns) > len(expected.columns))
        return f"its rows have {columns} instead of {len(expected.columns)}.{hint}"
    keys = [tuple(map(_key, row)) for row in answer.rows]
    expected_counts = Counter(tuple(map(_key, row)) for row in expected.rows)
    given_keys, missing, extra = min(
        (
            (given_keys, expected_counts - counted, counted - expected_counts)
            for order in _orders(answer, expected)
            for given_keys in [[tuple(key[place] for place in order) for key in keys]]
            for counted in [Counter(given_keys)]
        ),
        key=lambda parts: parts[1].total() + parts[2].total(),
    )
    missing_count, surplus = missing.total(), extra.total()
    if not missing_count and not surplus:
        return ""
    if missing_count == expected_counts.total():
        rows = ("it gives no rows", "your only row is wrong", f"all its {len(keys)} rows are wrong")
        return f"{rows[min(len(keys), 2)]}; {_are(missing_count)} expected."
    if not missing_count and extra.keys() <= expected_counts.keys():
        return f"the rows are right, but {_are(surplus)} repeated: add distinct."
    pairs = zip(answer.rows, given_keys, strict=True)
    extra_row = next((row for row, key in pairs if key in extra), ())
    example = clip(f"({', '.join(spell(v, is_rounded=True) for v in extra_row)})", _WIDEST_ROW)
    too_many = f"{_are(surplus)} too many, such as {example}"
    if not missing_count:
        return f"all the right rows are there, but {too_many}."
    shortage = f"{_are(missing_count)} missing"
    if not surplus:
        return f"its rows are right, but {shortage}."
    return f"{_are(len(keys) - surplus)} right, {too_many}, and {shortage}."


def _without_robot(answer: ResultTable, expected: ResultTable) -> ResultTable | None:
    """Return a table without the column that a query about a sensor gets by itself."""
    is_wider = len(answer.columns) > len(expected.columns)
    if not is_wider or _ROBOT not in answer.columns or _ROBOT in expected.columns:
        return None
    indices = [index for index, name in enumerate(answer.columns) if name != _ROBOT]
    rows = tuple(tuple(row[index] for index in indices) for row in answer.rows)
    return ResultTable(tuple(answer.columns[index] for index in indices), rows)


def _are(rows: int) -> str:
    return f"{count_of(rows, 'row')} {'is' if rows == 1 else 'are'}"


def _orders(answer: ResultTable, expected: ResultTable) -> Iterator[tuple[int, ...]]:
    if not answer.rows:
        yield ()
    elif sorted(answer.columns) == sorted(expected.columns):
        yield tuple(map(answer.columns.index, expected.columns))
    elif len(answer.columns) <= _MOST_COLUMNS:
        yield from permutations(range(len(answer.columns)))
    else:
        yield tuple(range(len(answer.columns)))


def _key(value: Value) -> Hashable:
    """Return what is equal for equal values, and for sums that were added in another order."""
    if isinstance(value, float):
        return round(float(f"{value:.9g}"), 9)
    if isinstance(value, Mapping):
        return tuple(sorted((name, _key(part)) for name, part in value.items()))
    if isinstance(value, list | tuple):
        return tuple(map(_key, value))
    return value
