"""``logical-robots sweep``, ``grade``, ``tournament``, ``lab``: many runs, each computed once."""

from __future__ import annotations

import argparse
import re
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import drawn_bar, harmless
from logical_robots_tui.errors import InputError, is_installed
from logical_robots_tui.wording import count_of

if TYPE_CHECKING:
    from logical_robots_tui.lab.coordinating import Coordinator
    from logical_robots_tui.lab.exporting import RunRecords
    from logical_robots_tui.lab.folder import Folder, Manifest
    from logical_robots_tui.toml_files import TomlFileError

COMPLETE, INCOMPLETE, WRONG = 0, 1, 2


_ENGINE = (
    command.one_of(
        command.option(
            "--workers",
            "N",
            "processes on this computer (default: one per core)",
            type=command.number_from(1),
        ),
        command.option("--dask", "ADDRESS", "a Dask scheduler instead, such as tcp://HOST:8786"),
    ),
    command.flag("--mixed", "also use results of other versions"),
)


def _path(name: str, about: str) -> command.Part:
    return command.option(name, name.upper(), about, type=Path)


_OUTPUT = command.option(
    "-o --output", "FOLDER", "the folder for all results", type=Path, required=True
)


@command.declare("sweep", _path("experiment", "a TOML file"), _OUTPUT, *_ENGINE)
def _sweep(options: argparse.Namespace) -> int:
    """run an experiment: many programs, levels, starts and values

    Run an experiment from a file: vary, measure, and repeat from many starts.

    examples:
      logical-robots sweep experiment.toml -o out
      logical-robots sweep experiment.toml -o out --workers 1

    Finished runs are not repeated.

    exit status: 0 complete, 1 some runs are left or could not be done, 2 wrong input
    """
    from logical_robots_tui.lab.sweeping import plan_sweep

    return _plan(options, lambda: plan_sweep(options.experiment))


@command.declare(
    "grade",
    _path("assignment", "a TOML file"),
    _path("submissions", "a folder or an archive with one entry per student"),
    _OUTPUT,
    command.option(
        "--student",
        "STUDENT",
        "run only this one (an id, a name or a part), and print the feedback",
    ),
    command.flag("--file-times", "late by the times of files, where a platform says nothing"),
    command.flag("--late-anyway", "grade even if more than half are late"),
    *_ENGINE,
)
def _grade(options: argparse.Namespace) -> int:
    """grade the programs of a class

    Run the programs of a class and write a gradebook and feedback.

    examples:
      logical-robots grade assignment.toml submissions -o grades

    A submission is a folder or an archive with a program for each level, such as
    ada/01-first-steps.l, or one file for all levels, such as ada.l. Exports from Moodle, Canvas,
    Gradescope, Blackboard and others work unchanged.

    exit status: 0 complete, 1 some runs are left or could not be done, or fewer than half of the
    class can be graded, 2 wrong input
    """
    from logical_robots_tui.lab.submissions import plan_grading

    times = {"file_times": options.file_times, "late_anyway": options.late_anyway}
    return _plan(options, lambda: plan_grading(options.assignment, options.submissions, **times))


@command.declare(
    "grade kit",
    command.option(
        "platform", "PLATFORM", "gradescope or github", choices=("gradescope", "github")
    ),
    _path("assignment", "a TOML file"),
    command.option("-o --output", "PATH", "a zip archive or a folder", type=Path, required=True),
    command.FORCE,
)
def _kit(options: argparse.Namespace) -> int:
    """let a platform grade what is handed in

    Write what Gradescope or GitHub Classroom needs to grade each submission at once.

    examples:
      logical-robots grade kit gradescope assignment.toml -o autograder.zip
      logical-robots grade kit github assignment.toml -o template

    Gradescope takes the archive as an autograder. The folder for GitHub Classroom is
    the template of the students' repositories. Neither names any student.

    exit status: 0 written, 2 wrong input, or it can't be written
    """
    from logical_robots_tui.cli.level import refuse_existing, write
    from logical_robots_tui.lab.platforms.archives import is_script, pack
    from logical_robots_tui.lab.platforms.kits import kit_of
    from logical_robots_tui.toml_files import TomlFileError

    try:
        texts, omitted = kit_of(options.platform, options.assignment)
    except TomlFileError as error:
        return _refuse(error)
    is_archive = options.output.suffix.lower() == ".zip"
    files = {} if is_archive else {options.output / name: text for name, text in texts.items()}
    for path in files or [options.output]:
        refuse_existing(path, force=options.force)
    for path, text in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        write(path, text)
        if is_script(text):
            path.chmod(0o755)
    if is_archive:
        write(options.output, pack(texts))
    print(harmless(f"Written to {options.output}: {', '.join(texts)}"))
    if omitted:
        print(f"Not in it, because they are about single students: {', '.join(omitted)}")
    return COMPLETE


@command.declare(
    "tournament",
    _path("specification", "a TOML file"),
    _path("players", "a folder with one entry per player"),
    _OUTPUT,
    *_ENGINE,
)
def _tournament(options: argparse.Namespace) -> int:
    """let programs play against each other, and rank them

    Let all players play each other in a level with teams, and rank them.

    examples:
      logical-robots tournament tournament.toml players -o cup

    A player is a program such as ada.l, or a folder with one that is named like the level.
    With another player, only that player's matches are played.

    exit status: 0 complete, 1 some runs are left or could not be done, 2 wrong input
    """
    from logical_robots_tui.lab.competing import plan_tournament

    return _plan(options, lambda: plan_tournament(options.specification, options.players))


def _refuse(error: TomlFileError) -> int:
    print(*map(harmless, error.problems), sep="\n", file=sys.stderr)
    return WRONG


def _plan(options: argparse.Namespace, plan: Callable[[], tuple[Manifest, dict[str, str]]]) -> int:
    from logical_robots_tui.lab.folder import Folder
    from logical_robots_tui.toml_files import TomlFileError

    try:
        manifest, inputs = plan()
    except TomlFileError as error:
        return _refuse(error)
    if manifest.kind == "grade":
        from logical_robots_tui.lab.submissions import account_of

        print(*map(harmless, account_of(manifest)), sep="\n", flush=True)
    folder = Folder(options.output)
    with folder.lock():
        with folder.ledger(mixed=options.mixed):
            pass  # it can be used: otherwise the manifest beside it stays
        return _work(options, folder, folder.write(manifest, inputs))


command.group(
    "lab",
    "go on with a sweep, a grading or a tournament, export, report or play it",
    """\
  logical-robots lab status out
  logical-robots lab resume out
  logical-robots lab export out
  logical-robots lab report out
""",
)

_FOLDER = command.option(
    "folder", "FOLDER", "the folder of a sweep, grade or tournament", type=Path
)


@command.declare("lab status", _FOLDER, *_ENGINE)
def _status(options: argparse.Namespace) -> int:
    """say what is done and what is left

    Say what is done, what is left, and what could not be done.

    examples:
      logical-robots lab status out

    exit status: 0 complete, 1 some runs are left or could not be done, 2 wrong input
    """
    return _look(options, lambda *_: None)


@command.declare("lab resume", _FOLDER, *_ENGINE)
def _resume(options: argparse.Namespace) -> int:
    """pick up where it left off

    Do the runs that are left, and retry those that could not be done.

    examples:
      logical-robots lab resume out

    exit status: 0 complete, 1 some runs are left or could not be done, 2 wrong input
    """
    from logical_robots_tui.lab.folder import Folder

    folder = Folder(options.folder)
    manifest = folder.manifest()
    with folder.lock():
        return _work(options, folder, manifest)


@command.declare("lab export", _FOLDER, *_ENGINE)
def _export_all(options: argparse.Namespace) -> int:
    """write all tables again

    Write all tables, grades and feedback from the results that are there.

    examples:
      logical-robots lab export out

    exit status: 0 complete, 1 some runs are left or could not be done, 2 wrong input
    """
    return _look(options, _export)


@command.declare("lab report", _FOLDER, *_ENGINE)
def _report(options: argparse.Namespace) -> int:
    """write a report as a page of HTML

    Print a short report, and write a long one with plots into the folder, as report.html.

    examples:
      logical-robots lab report out

    exit status: 0 complete, 1 some runs are left or could not be done, 2 wrong input
    """

    def write(folder: Folder, records: RunRecords) -> None:
        from logical_robots_tui.lab.reporting import write_report

        _print_summary(records)
        print(harmless(f"Written: {write_report(folder, records)}"))

    return _look(options, write)


@command.declare(
    "lab play",
    _FOLDER,
    command.option("student", "STUDENT", "an id, a name or a part of it"),
    command.option("level", "LEVEL", "a level's name or number"),
    command.START,
    command.flag("--plain", "play in lines of text"),
)
def _play(options: argparse.Namespace) -> int:
    """play a student's program on the screen

    Play a student's program on the screen, as it was handed in.

    examples:
      logical-robots lab play grades 1001 01
      logical-robots lab play grades Ada first-steps --start 2

    Your changes are not saved in the folder.

    exit status: 0 after quitting, 2 if there is no such program
    """
    from tempfile import TemporaryDirectory

    from logical_robots_tui.cli.main import parser
    from logical_robots_tui.game.source import SUFFIX
    from logical_robots_tui.lab.classroom import cell_of, student_of
    from logical_robots_tui.lab.folder import Folder
    from logical_robots_tui.world.levels.load import NATIVE, WEB, is_of_web

    folder = Folder(options.folder)
    manifest = folder.manifest()
    if manifest.kind != "grade":
        hint = "The last column of runs.csv has commands that play its runs."
        raise InputError("This is not a graded class", place=str(folder.path), hint=hint)
    student = student_of(manifest, options.student)
    cell = cell_of(manifest, student, options.level)
    text, program = folder.text(cell.level), folder.text(cell.own or cell.program)
    with TemporaryDirectory(prefix="logical-robots-") as place:
        files = (
            Path(place, cell.level_name + (WEB if is_of_web(text) else NATIVE)),
            Path(place, re.sub(r"[^\w.-]+", "-", student.label)[:60].strip("-.") + SUFFIX),
        )
        for file, content in zip(files, (text, program), strict=True):
            file.write_text(content, "utf-8")
        words = ["play", *map(str, files), "--start", str(options.start_number)]
        play_options = parser("play").parse_args(words + ["--plain"] * options.plain)
        return int(play_options.start(play_options))


def _look(options: argparse.Namespace, write: Callable[[Folder, RunRecords], None]) -> int:
    """Say what is done and left, write something, and return the exit status."""
    from logical_robots_tui.lab.coordinating import Coordinator
    from logical_robots_tui.lab.exporting import RunRecords
    from logical_robots_tui.lab.folder import Folder

    folder = Folder(options.folder)
    manifest = folder.manifest()
    with folder.ledger(mixed=options.mixed) as ledger:
        records = RunRecords(manifest, ledger)
        status = _tell(folder, records, Coordinator(folder, manifest, ledger))
        write(folder, records)
    return status


def _print_summary(records: RunRecords) -> None:
    from logical_robots_tui.lab.reporting import lines_of

    print(*map(harmless, lines_of(records)), sep="\n")


def _work(options: argparse.Namespace, folder: Folder, first_manifest: Manifest) -> int:
    from msgspec.structs import replace

    from logical_robots_tui.lab import closing_engine, engine_for, rounds
    from logical_robots_tui.lab.classroom import student_of
    from logical_robots_tui.lab.exporting import RunRecords

    if name := getattr(options, "student", None):
        student = student_of(first_manifest, name)
        cells = tuple(cell for cell in first_manifest.cells if cell.student == student.id)
        first_manifest = replace(first_manifest, students=(student,), cells=cells)
    with folder.ledger(mixed=options.mixed) as ledger:
        ledger.forget_failures()
        work = rounds(folder, first_manifest, ledger)
        manifest, coordinator = first = next(work)
        with _interruptible() as is_stopped:
            engine = engine_for(
                options.workers, options.dask, lambda text: print(harmless(text), file=sys.stderr)
            )
            try:
                with closing_engine(engine):
                    for manifest, coordinator in chain([first], work):
                        with _progress(manifest, coordinator) as show:
                            coordinator.work(engine, is_stopped, show)
                        if is_stopped():
                            break
            except InputError as error:  # such as a full disk
                print(harmless(str(error)), file=sys.stderr)
                return INCOMPLETE
        records = RunRecords(manifest, ledger)
        status = _tell(folder, records, coordinator)
        if name:
            from logical_robots_tui.lab.feedback import feedback_of

            text = feedback_of(records, student.id)
            print("", *map(harmless, text.splitlines()), sep="\n")
        elif status == COMPLETE or manifest.kind == "grade":
            _export(folder, records)
            if manifest.kind == "tournament":
                _print_summary(records)
        return status


def _tell(folder: Folder, records: RunRecords, coordinator: Coordinator) -> int:
    from logical_robots_tui.lab import next_round
    from logical_robots_tui.lab.classroom import ungraded_lines
    from logical_robots_tui.lab.submissions import warning_of

    manifest, ledger = records.manifest, records.ledger
    tally, is_grading = coordinator.tally(), manifest.kind == "grade"
    seconds = f"{ledger.seconds():,.1f} s of processor time"
    print(harmless(f"{manifest.title}: {count_of(tally.done, 'run')} done, {seconds}"))
    if tally.failed:
        message = f"{count_of(tally.failed, 'run')} could not be done (infrastructure)"
        print(f"{message}." if is_grading else f"{message}, for example:")
    if tally.failed and not is_grading:
        for run in records.failed[:5]:
            print(harmless(f"  {manifest.label_of(run.cell)}, start {run.start}: {run.reason}"))
    if is_grading and (ungraded := ungraded_lines(records)):
        print("Ungraded:", *(harmless(f"  {line}") for line in ungraded), sep="\n")
    if tally.differing:
        print(
            "DEFECT: these runs gave different results when they were run twice. Please report it:"
        )
        print(*(f"  {run}" for run in ledger.differences()), sep="\n")
    is_next = next_round(manifest, ledger, coordinator) is not None
    if is_next or not tally.is_complete:
        verb = "is" if tally.due == 1 else "are"
        remark = f"{count_of(tally.due, 'run')} {verb} left. " if tally.due else ""
        remark += f"Round {len(manifest.rounds) + 1} is next. " * is_next
        print(f"{remark}Go on with: logical-robots lab resume {harmless(str(folder.path))}")
        return INCOMPLETE
    return INCOMPLETE if is_grading and warning_of(manifest) else COMPLETE


def _export(folder: Folder, records: RunRecords) -> None:
    from logical_robots_tui.lab.reporting import export
    from logical_robots_tui.tui.labyrinth.svg import svg

    file_names = export(folder, records, svg)
    print(harmless(f"Written to {folder.path}: {', '.join(file_names)}"))
    if not is_installed("pyarrow"):
        print("Parquet needs pyarrow: pip install 'logical-robots-tui[lab]'")


@contextmanager
def _interruptible() -> Iterator[Callable[[], bool]]:
    """Yield a test for interruption: the first ^C sets it, the second one exits at once."""
    stop_event = threading.Event()

    def stop(_signal: int, _frame: object) -> None:
        if stop_event.is_set():
            raise KeyboardInterrupt
        stop_event.set()
        print("Stopping after the runs at hand; ^C again stops at once.", file=sys.stderr)

    handlers = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stop_event.is_set
    except KeyboardInterrupt:
        stop_event.set()
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)


_LINE_SECONDS = 5.0


@contextmanager
def _progress(manifest: Manifest, coordinator: Coordinator) -> Iterator[Callable[[], None]]:
    from logical_robots_tui.lab.coordinating import WorkProgress

    if not coordinator.tally().due:
        yield lambda: None
        return
    pace, next_time = WorkProgress(manifest, coordinator), monotonic() + _LINE_SECONDS
    with drawn_bar(manifest.title) as draw:

        def show() -> None:
            nonlocal next_time
            part, total, count, details = pace.summary()
            draw(part, total, count, harmless(details))
            if not sys.stderr.isatty() and monotonic() >= next_time:
                next_time = monotonic() + _LINE_SECONDS
                print(harmless(f"{count}, {details}"), file=sys.stderr, flush=True)

        yield show
