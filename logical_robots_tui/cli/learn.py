"""``logical-robots learn``: a lesson, and its questions one by one."""

from __future__ import annotations

import argparse
import asyncio
import shutil
import sys
import textwrap
from collections.abc import Iterator
from contextlib import closing
from typing import TYPE_CHECKING

from logical_robots_tui import mind, world
from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import (
    BAD_INPUT,
    ProgramFileError,
    harmless,
    line_of_json,
    open_progress,
    progress_bar,
    say,
)
from logical_robots_tui.cli.query import table_lines
from logical_robots_tui.cli.run import BAR_DELAY
from logical_robots_tui.errors import InputError
from logical_robots_tui.game.level_questions import (
    Examiner,
    Verdict,
    mistake_lines,
    program_of,
    ticks_in_words,
)
from logical_robots_tui.game.victory import level_key
from logical_robots_tui.progress import Progress
from logical_robots_tui.world.level import LevelQuestion

if TYPE_CHECKING:
    from logical_robots_tui.player.learning import Learning

DONE, WRONG = 0, 1

_MOST_ROWS = 12  # of an answer


@command.declare(
    "learn",
    command.LEVEL,
    command.option("--question", "N", "only this question", type=command.number_from(1)),
    command.option("--answer", "QUERY", "check an answer to it"),
    command.JSON,
    command.DATA_DIR,
)
def learn(options: argparse.Namespace) -> int:
    """read a lesson and answer its questions

    Print what a level teaches, then ask its questions. Each is answered with one query
    in Logica, which has to be right at every tick named; an empty line goes on.

    examples:
      logical-robots learn 05                      read, and answer each question
      logical-robots learn 05 --question 2         answer one of them
      logical-robots learn 05 --question 2 --answer 'Light(robot_name:)'
                                                   check an answer

    exit status: 0 done, or right; 1 a wrong answer; 2 bad level, question or query
    """
    level = world.load_level(options.level)
    number = options.question
    if number is not None and number > len(level.questions):
        count = len(level.questions)
        raise InputError(f"There is no question {number}.", hint=f"{level.title} has {count}.")
    with (
        closing(open_progress(options)) as progress,
        closing(_Lesson(level, progress, is_silent=options.json)) as lesson,
    ):
        if options.answer is None:
            return lesson.present(number)
        if number is None and len(level.questions) != 1:
            raise InputError("Which question does it answer?", hint="Add --question N.")
        return lesson.grade(number or 1, options.answer)


class _Lesson:
    def __init__(self, level: world.Level, progress: Progress, *, is_silent: bool) -> None:
        self._level, self._progress, self._is_silent = level, progress, is_silent
        self._runner = asyncio.Runner()
        self._examiner = Examiner(level)

    def close(self) -> None:
        self._runner.run(self._examiner.close())
        self._runner.close()

    def present(self, number: int | None) -> int:
        """Print the lesson and ask its questions, or only one of them."""
        level = self._level
        if self._is_silent:
            answers = self._answers()
            questions = [
                {
                    "ask": question.ask,
                    "ticks": question.ticks,
                    "program": program_of(level, question),
                    "answered_by": answers.get(question.ask),
                }
                for question in level.questions
            ]
            document = {"level": level.name, "lesson": level.lesson, "questions": questions}
            print(line_of_json(document))
            return DONE
        if number is None:
            say(level.title)
            print()
            _print_lesson(level.lesson or "This level has no lesson.")
        for index, question in enumerate(level.questions, start=1):
            if number in (None, index) and not self._ask(index, question):
                break
        if level.questions:
            answers = self._answers()
            answer_count = sum(question.ask in answers for question in level.questions)
            say(f"\n{answer_count} of {len(level.questions)} answered.")
        return DONE

    def grade(self, number: int, query: str) -> int:
        question = self._level.questions[number - 1]
        try:
            verdict = self._check(question, query)
        except mind.ProgramError as error:
            if self._is_silent:
                raise ProgramFileError("answer", error) from error
            print(*map(harmless, mistake_lines(query, error)), sep="\n", file=sys.stderr)
            return BAD_INPUT
        if self._is_silent:
            table = verdict.table
            rows = {"columns": table.columns, "rows": table.rows} if table else {}
            report = {"right": verdict.is_right, "tick": verdict.tick, "verdict": verdict.words}
            print(line_of_json(report | rows))
        else:
            say(*_verdict(verdict))
        return DONE if verdict.is_right else WRONG

    def _ask(self, number: int, question: LevelQuestion) -> bool:
        """Ask a question until it is answered or skipped; return False at the end of the input."""
        old_answer = self._answers().get(question.ask)
        print()
        say(*_question(self._level, number, is_answered=old_answer is not None))
        names = [p.name for p in self._runner.run(self._examiner.predicates(question))]
        say(*_wrap(f"A query may use {', '.join(names)}. An empty line goes on."))
        while True:
            print("> ", end="", flush=True)
            line = sys.stdin.readline()
            if not line.strip():
                return bool(line)
            try:
                verdict = self._check(question, line.strip())
            except mind.ProgramError as error:
                say(*mistake_lines(line.strip(), error))
                continue
            say(*_verdict(verdict))
            if verdict.is_right:
                return True

    def _check(self, question: LevelQuestion, query: str) -> Verdict:
        with progress_bar(self._level.title, question.ticks[-1], delay=BAR_DELAY) as show:
            verdict = self._runner.run(self._examiner.check(question, query, show))
        if verdict.is_right:
            self._progress.answer(level_key(self._level), question.ask, query)
        return verdict

    def _answers(self) -> dict[str, str]:
        return dict(self._progress.record(level_key(self._level)).answers)


async def answer_in_game(level: world.Level, learning: Learning, number: int, query: str) -> None:
    """Check an answer in a game in lines; list the questions if there is none."""
    questions = level.questions
    if not query or not 0 < number <= len(questions):
        for index, question in enumerate(questions, start=1):
            say(*_question(level, index, is_answered=question.ask in learning.answers))
        say(f"{learning.answered} answered." if questions else "This level has no questions.")
        return
    examiner, question = Examiner(level), questions[number - 1]
    try:
        verdict = await examiner.check(question, query)
    except mind.ProgramError as error:
        say(*mistake_lines(query, error))
    else:
        if verdict.is_right:
            learning.answer(question, query)
        say(*_verdict(verdict))
    finally:
        await examiner.close()


def _question(level: world.Level, number: int, *, is_answered: bool) -> Iterator[str]:
    question = level.questions[number - 1]
    status = ", answered" if is_answered else ""
    yield from _wrap(f"Question {number} of {len(level.questions)}{status}: {question.ask}")
    prefix = f"At {ticks_in_words(question.ticks)} of {program_of(level, question)}"
    yield f"{prefix}, in the rows of all robots."


def _verdict(verdict: Verdict) -> Iterator[str]:
    """Yield the first rows of an answer, and the verdict."""
    if verdict.table is not None and verdict.table.rows:
        head, *rows = table_lines(verdict.table)
        yield from (head, *rows[:_MOST_ROWS], *["..."] * (len(rows) > _MOST_ROWS))
    yield from _wrap(verdict.words)


def _print_lesson(text: str) -> None:
    if not sys.stdout.isatty():
        say(text)
        return
    from rich.console import Console
    from rich.markdown import Markdown

    lines = "\n".join(map(harmless, text.splitlines()))
    Console().print(Markdown(lines, hyperlinks=False))


def _wrap(text: str) -> list[str]:
    """Break lines between words in a terminal, which would break them anywhere."""
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else len(text)
    return textwrap.wrap(text, max(width, 20)) or [""]
