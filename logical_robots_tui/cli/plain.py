"""The game as lines of text, for screen readers and pipes: typed commands, printed events."""

from __future__ import annotations

import asyncio
import math
import signal
from collections.abc import Awaitable, Callable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

from logical_robots_tui.cli.command import ProgramFileError, columns, say
from logical_robots_tui.cli.line_ui import LineText, LineUi, with_words
from logical_robots_tui.errors import InputError, LogicalRobotsError
from logical_robots_tui.game import Breakpoint, Inquiry, goals, load_program, mistake_in_question
from logical_robots_tui.game.frame import events_between
from logical_robots_tui.game.history.marks import trouble
from logical_robots_tui.game.source import target
from logical_robots_tui.game.victory import Victory, brief, result_line, robustness_line
from logical_robots_tui.mind import ProgramError
from logical_robots_tui.paths import is_there
from logical_robots_tui.player.board import NO_BOARD, board_name
from logical_robots_tui.player.learning import version_name, version_result
from logical_robots_tui.player.opening import LocalPlayer, Opening
from logical_robots_tui.player.recorder import ProgressRecorder
from logical_robots_tui.player.session_state import SessionListener
from logical_robots_tui.player.standings import standing_rows
from logical_robots_tui.player.surroundings import surroundings
from logical_robots_tui.world import Level, list_shipped, load_level

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame, Game, Hit
    from logical_robots_tui.mind import Diagnostic, Program

MOST = 5000
"""The default tick limit of ``run``."""

_DEEPEST = 100  # predicates in a proof


class LineGame(SessionListener):
    """A player's session in lines; commands call its methods, which raise what can't be done."""

    def __init__(self, opening: Opening, recorder: ProgressRecorder) -> None:
        self._ui, self._text = LineUi(), LineText()
        self._has_own_text = opening.text is not None
        self.player = LocalPlayer(opening, recorder, self._ui, self._text, lambda: None, with_words)
        self.session, self._recorder = self.player.session, recorder
        self._text.load(self.player.first_text)
        self._last_frame = self.session.frame
        self._robot = ""
        self._inquiry: Inquiry | None = None
        self._victory: Victory | None = None
        self._reported_mistakes: tuple[Diagnostic, ...] = ()
        self._is_running = True
        recorder.attach(
            self._ui,
            on_change=lambda: None,
            on_measured=lambda level, measures, _: say(robustness_line(level, measures)),
        )
        self.session.listeners += [recorder, self]

    async def play(self) -> int:
        try:
            await self._begin()
            while self._is_running and (line := await self._ui.read()):
                await self._execute(line)
        finally:
            await self._ui.close()
            await self._forget_inquiry()
            await self.player.close()
        return 0

    async def _begin(self) -> None:
        if self._has_own_text and self.player.first_text != self.session.source.text:
            say("Loaded your last program for this level.")
        self.level_opened(self.session.level)
        self.player.start()
        await self._ui.drain(skip="measure")
        await self._settle()
        say("Type help for the commands.")
        for offering in self.player.offerings():
            await offering(self._ui)
            await self._settle()

    async def _execute(self, line: str) -> None:
        word, _, argument = line.strip().partition(" ")
        command = next((entry for entry in COMMANDS if entry.word == word), None)
        if command is None:
            if word:
                say(f"Unknown command {word}. Type help for a list.")
            return
        try:
            is_needed = command.argument and not command.argument.startswith("[")
            if (not argument and is_needed) or (argument and not command.argument):
                raise InputError(f"Type {command.usage}.")
            if (work := command.do(self, argument.strip())) is not None:
                await work
        except (ProgramError, ProgramFileError) as error:
            self._tell_mistakes(error.diagnostics)
        except LogicalRobotsError as error:
            say(str(error))
        await self._settle()

    async def _settle(self) -> None:
        """Wait for what the last command began, and say how it ended."""
        await self._ui.drain(skip="measure")
        self.player.autosave.flush()
        state = self.session.state
        if state.phase == "mistake" and state.mistakes is not self._reported_mistakes:
            self._reported_mistakes = state.mistakes
            self._tell_mistakes(state.mistakes)
        victory, self._victory = self._victory, None
        if victory is not None:
            self._tell_victory(victory)

    def _tell_mistakes(self, mistakes: Sequence[Diagnostic]) -> None:
        for mistake in mistakes:
            label = "Line" if mistake.severity == "error" else "Warning, line"
            say(f"{label} {mistake.line}: {mistake.message}. {mistake.hint}".rstrip())

    def _tell_victory(self, victory: Victory) -> None:
        if victory.verdict == "reference":
            say("Won by a reference program: not counted.")
        elif victory.refusal:
            say(victory.refusal)
        elif self._recorder.progress.is_kept:
            say("The victory is saved in your progress.")
        else:
            say("The victory only counts until you leave: nothing can be saved on this disk.")
        if victory.verdict == "counts" and victory.measures is not None:
            say(result_line(victory.level, victory.measures))
            say(*(f"Bonus goal reached: {goal}." for goal in victory.measures.goals))
        if self.player.board.must_ask:
            say(
                "The players of this server can see this result. Type board and a name, "
                "board anonymous, or board leave."
            )

    def level_opened(self, level: Level) -> None:
        self._last_frame, self._robot = self.session.frame, ""
        self._ui.spawn(self._forget_inquiry, "close", exclusive=False)
        say(level.title)
        self.brief("")
        self.where("")

    def program_used(self, program: Program) -> None:
        if self.session.game is not None:
            say("The robots will use it from the next tick.")
        self._tell_mistakes(self.session.state.warnings)

    def tick_shown(self, frame: Frame) -> None:
        if frame.tick == self._last_frame.tick + 1:
            for event in events_between(self.session.level, self._last_frame, frame):
                say(f"Tick {frame.tick}: {event}")
            marks = self._game.history.marks.marks_at(frame.tick)
            say(*(f"Tick {frame.tick}: {words}" for mark in marks if (words := trouble(mark))))
        self._last_frame = frame

    def won(self, victory: Victory) -> None:
        self._victory = victory

    def stopped(self, hits: tuple[Hit, ...]) -> None:
        for hit in hits:
            say(f"Stopped: {hit.breakpoint.words}. {hit.values}")

    async def go_on(self, ticks: int) -> None:
        """Run for some ticks; ^C ends it sooner."""
        loop, handler = asyncio.get_running_loop(), signal.getsignal(signal.SIGINT)
        loop.add_signal_handler(signal.SIGINT, self.session.pause)
        try:
            self.session.run_until(self._game.frame.tick + ticks)
            await self._settle()
        finally:
            loop.remove_signal_handler(signal.SIGINT)
            signal.signal(signal.SIGINT, handler)
        self._tell_tick()

    def move(self, action: Callable[..., None], *ticks: int) -> None:
        action(*ticks)
        self._tell_tick()

    def _tell_tick(self) -> None:
        say(f"Tick {self.session.frame.tick}.")

    async def stop_at(self, question: str) -> None:
        condition, breakpoints = Breakpoint("rows", question), self.session.breakpoints
        if condition in breakpoints:
            breakpoints.remove(condition)
            say(f"Runs no longer stop when {condition.words}.")
            return
        problem = self.session.problem_with(condition)
        if not (problem or condition.is_named):
            problem = await mistake_in_question(self._game.program, question)
        if not problem:
            breakpoints.add(condition)
        say(problem or f"Runs will stop when {condition.words}.")

    def brief(self, _: str) -> None:
        level = self.session.level
        goal_lines = (f"Bonus goal: {goal.words}." for goal in level.second_goals)
        terms = level.terms if level.briefing.strip() else ()
        say(level.briefing.strip(), *terms, *goal_lines)

    def where(self, _: str) -> None:
        level, state = self.session.level, self.session.frame.after
        for level_robot, robot in zip(level.robots, state.robots, strict=True):
            heading = f"{math.degrees(robot.angle) % 360:.0f} degrees"
            charge = f", battery {robot.battery_level:.0f}" if level_robot.has_battery else ""
            say(f"{robot.name}: at {robot.x:.0f}, {robot.y:.0f}, heading {heading}{charge}.")
        say(*(goal.words for goal in goals(level, state)))

    def look(self, name: str) -> None:
        lines = surroundings(self.session.level, self.session.frame.after, self._robot_name(name))
        say(f"Around {self._robot_name(name)}:", *lines)

    def choose_robot(self, name: str) -> None:
        self._robot = self._robot_name(name)
        say(f"The robot is {self._robot}.")

    def _robot_name(self, name: str) -> str:
        """Return the robot of that name, by default the one that was chosen, or the first."""
        from logical_robots_tui.cli.run import check_name

        sources, level = self.session.sources, self.session.level
        names = [robot.name for robot in level.robots]
        if name:
            check_name("robot", name, names)
        team_names = (robot.name for robot in level.robots if robot.team == sources.team)
        return name or self._robot or next(team_names, names[0])

    @property
    def _game(self) -> Game:
        if self.session.game is None:
            raise InputError("There is no program yet that can run.")
        return self.session.game

    def _thought_context(self) -> tuple[Inquiry, Program, str, Frame]:
        """Return the inquiry, the program, the robot that thinks with it, and the frame."""
        game, robot = self._game, self._robot_name("")
        if not game.frame.tick:
            raise InputError("No decision yet: run or step first.")
        program = game.program.for_team(game.level.team_of(robot))
        return self._open_inquiry(), program, robot, game.frame

    def _open_inquiry(self) -> Inquiry:
        self._inquiry = self._inquiry or Inquiry(self._game.level)
        return self._inquiry

    async def _forget_inquiry(self) -> None:
        inquiry, self._inquiry = self._inquiry, None
        if inquiry is not None:
            await inquiry.close()

    async def why(self, text: str) -> None:
        from logical_robots_tui.cli.why import answer_lines, explain_row, read_row
        from logical_robots_tui.explain.why.explanation import spell_call

        inquiry, program, robot, frame = self._thought_context()
        words = text.split(maxsplit=1)
        is_tree = words[:1] == ["tree"]
        question = read_row(program, (words[1:] or ["Robot"])[0] if is_tree else text or "Robot")
        depth = _DEEPEST if is_tree else 0
        answer = await explain_row(inquiry, program, robot, frame, question, depth)
        hint = f"For more, type why tree {'' if question.predicate == 'Robot' else text}".rstrip()
        say(
            *answer_lines(
                answer,
                program,
                frame.tick,
                hint=hint,
                command_of=lambda ask: f"why {spell_call(ask)}",
            )
        )

    async def ask(self, question: str) -> None:
        from logical_robots_tui.cli.query import table_lines

        game = self._game
        table = await self._open_inquiry().ask(game.program, question, game.frame)
        say(*(table_lines(table) if table.rows else ["No rows."]))

    async def origin(self, part: str) -> None:
        from logical_robots_tui.cli.why import origin_lines
        from logical_robots_tui.explain import Ask
        from logical_robots_tui.explain.why.explanation import Subject
        from logical_robots_tui.game import origin_in_game, read_part

        _, _, robot, _ = self._thought_context()
        try:
            subject = Subject(Ask(), *read_part(part or "memory"))
        except ValueError as error:
            raise InputError(f"{error}.") from None
        say(*origin_lines(await origin_in_game(self._game, robot, subject)))

    async def diagnose(self, _: str) -> None:
        from logical_robots_tui.cli.query import Printer
        from logical_robots_tui.game.diagnosing import diagnose

        printer = Printer(is_silent=False)
        printer.finish(await diagnose(self._game, show=printer.show))

    def show_program(self, _: str) -> None:
        lines = self._text.text.splitlines()
        say(*(f"{number}: {line}" for number, line in enumerate(lines, start=1)))

    async def save(self, name: str) -> None:
        library, source = self.player.library, self.session.source
        if not name and not source.shipped:
            await library.save_as(source.path)
            return
        path = target(name, library.programs)
        if is_there(path):
            raise InputError("already exists.", place=str(path), hint="Choose another name.")
        await library.save_as(path)
        say(f"Edit {path}, or use line and insert here; then type apply.")

    def edit(self, argument: str, count: int) -> None:
        """Put a line in place of as many; an empty one only deletes."""
        number, _, line = argument.partition(" ")
        lines = self._text.text.splitlines()
        index = _number(number) - 1
        if not 0 <= index <= len(lines) - count:
            raise InputError(f"There is no line {number}; the last one is {len(lines)}.")
        lines[index : index + count] = [line] if line else []
        self._text.put("\n".join([*lines, ""]))
        say("Type apply, and the robots will use it.")

    def apply(self, _: str) -> None:
        source = self.session.source
        if self._text.text != self.session.state.tried:
            self.session.apply(self._text.text)
            return
        if source.shipped:
            raise InputError("This program is not in a file of yours. Type save and a name first.")
        source = load_program(source.path)
        self.player.library.open_program(source, source.text)

    def open_program(self, name: str) -> None:
        library = self.player.library
        library.open_program(load_program(name, library.programs))

    async def open_level(self, name: str) -> None:
        if name:
            await self.player.library.open_level(load_level(name))
        else:
            say(*(f"{level_name}: {load_level(level_name).title}" for level_name in list_shipped()))

    def hint(self, _: str) -> None:
        learning = self.player.learning
        if learning.reveal_next():
            say(f"Hint {len(learning.revealed)}: {learning.revealed[-1]}")
        elif learning.revealed:
            say("There are no more.", *learning.revealed)

    def lesson(self, _: str) -> None:
        learning = self.player.learning
        say(learning.lesson())
        if learning.answered:
            say(f"Questions: {learning.answered} answered. Type answer for a list.")

    async def answer(self, argument: str) -> None:
        from logical_robots_tui.cli.learn import answer_in_game

        number, _, query = argument.partition(" ")
        await answer_in_game(self.session.level, self.player.learning, _number(number, 0), query)

    async def solution(self, _: str) -> None:
        say(await self.player.learning.solution())

    async def versions(self, number: str) -> None:
        learning = self.player.learning
        versions = await learning.versions()
        if not number:
            say(*(f"{version_name(version)}: {version_result(version)}" for version in versions))
            return
        for version in versions:
            if number == str(version.number):
                learning.restore(version)
                return
        raise InputError(f"There is no version {number}. Type versions for a list.")

    def results(self, _: str) -> None:
        bests = brief(self._recorder.record.bests)
        say(f"Yours: {bests}" if bests else "You have not won here yet.")
        say(*(f"{name}: {brief(best)}" for name, best in self._recorder.references.items()))

    async def board(self, name: str) -> None:
        from logical_robots_tui.progress.board import BoardMembership, shown_name

        board = self.player.board
        if not board.is_on:
            raise InputError(NO_BOARD)
        if name:
            if name == "leave":
                await board.join(BoardMembership(is_listed=False))
                say("You are not on the board. It has no entries of yours.")
                return
            membership = (board.membership or BoardMembership(True))._replace(is_listed=True)
            if name in ("share", "private"):
                membership = membership._replace(shares=name == "share")
            else:
                membership = membership._replace(name=board_name(name))
            await board.join(membership)
            shared = " Others may race your runs." if membership.shares else ""
            say(f"You are on the board as {shown_name(membership.name)}.{shared}")
        elif board.standings:
            say(*columns(standing_rows(board.standings)))
        else:
            say("Win this level first, then the board shows who else has.")

    async def ladder(self, argument: str) -> None:
        board = self.player.board
        if argument:
            await board.hand_in(self._text.text)
            say("Handed in. It plays in the background.")
        rows = [challenger.cells for challenger in await board.challengers()]
        say(*columns([("rank", "player", "share", "remark"), *rows]))

    async def ask_help(self, _: str) -> None:
        board = self.player.board
        await board.ask_for_help(self._text.text)
        say(
            "The teacher sees that you need help, and your program. Type teacher to end it."
            if board.asks_for_help
            else "You no longer ask for help."
        )

    def help(self, _: str) -> None:
        say(*columns([(entry.usage, entry.help) for entry in COMMANDS]))

    def quit(self, _: str) -> None:
        self._is_running = False


def _number(text: str, default: int = 1) -> int:
    if text and not (text.isdecimal() and len(text) < 10):
        raise InputError(f"{text} is not a number.")
    return int(text or default)


class LineCommand(NamedTuple):
    """A word to type and its action, which gets the argument, or "" if there is none."""

    word: str
    argument: str
    do: Callable[[LineGame, str], Awaitable[None] | None]
    help: str

    @property
    def usage(self) -> str:
        return f"{self.word} {self.argument}".rstrip()


# fmt: off
COMMANDS = (
    LineCommand("run", "[N]", lambda game, n: game.go_on(_number(n, MOST)),
        f"run until victory or a stop, for at most N ticks ({MOST:,} by default)"),
    LineCommand("step", "[N]", lambda game, n: game.go_on(_number(n)),
        "one tick forward, or N ticks"),
    LineCommand("back", "[N]", lambda game, n: game.move(game.session.back, _number(n)),
        "one tick back, or N ticks"),
    LineCommand("goto", "N", lambda game, n: game.move(game.session.go_to, _number(n)),
        "go to a tick of the past"),
    LineCommand("other", "", lambda game, _: game.move(game.session.change_branch),
        "switch to the branch that was left when the program changed"),
    LineCommand("restart", "", lambda game, _: game.move(game.session.restart),
        "start again at tick 0"),
    LineCommand("where", "", LineGame.where, "positions of the robots, and who is in a goal"),
    LineCommand("look", "[ROBOT]", LineGame.look,
        "walls, beacons, robots and areas by direction and distance from a robot"),
    LineCommand("robot", "NAME", LineGame.choose_robot,
        "choose the robot that look, why and origin are about"),
    LineCommand("stop", "QUERY", LineGame.stop_at,
        "stop runs when a predicate has rows, or a query holds; repeat to remove it"),
    LineCommand("why", "[tree] [P]", LineGame.why,
        "explain what the robot did in this tick, or a predicate; tree gives the whole proof"),
    LineCommand("ask", "QUERY", LineGame.ask, "answer a query in Logica about this tick"),
    LineCommand("origin", "[PART]", LineGame.origin,
        "trace back the robot's memory, or a part such as desire.left_engine"),
    LineCommand("diagnose", "", LineGame.diagnose, "scan the ticks so far for likely mistakes"),
    LineCommand("program", "", LineGame.show_program, "the program, with the numbers of its lines"),
    LineCommand("line", "N [TEXT]", lambda game, line: game.edit(line, 1),
        "replace line N of the program, or delete it"),
    LineCommand("insert", "N TEXT", lambda game, line: game.edit(line, 0),
        "insert a line before line N"),
    LineCommand("save", "[NAME]", LineGame.save,
        "save the program as a file of your own, which you can edit"),
    LineCommand("apply", "", LineGame.apply,
        "continue with the program as you changed it, here or in its file"),
    LineCommand("open", "PROGRAM", LineGame.open_program, "continue with another program"),
    LineCommand("versions", "[N]", LineGame.versions,
        "list your earlier programs for this level, or go back to one"),
    LineCommand("reset", "", lambda game, _: game.player.learning.reset(),
        "put the starter program back; yours becomes an earlier version"),
    LineCommand("briefing", "", LineGame.brief, "the task, and bonus goals"),
    LineCommand("hint", "", LineGame.hint, "reveal the next hint"),
    LineCommand("lesson", "", LineGame.lesson,
        "what the level teaches and, when you have won, what to try next"),
    LineCommand("answer", "[N QUERY]", LineGame.answer,
        "list the questions of the lesson, or answer question N with a query"),
    LineCommand("solution", "", LineGame.solution, "the reference programs"),
    LineCommand("results", "", LineGame.results, "your best results beside the reference programs"),
    LineCommand("board", "[NAME]", LineGame.board,
        "who has won this level and how well; or be there as NAME, anonymous, or leave; "
        "share lets others race your runs, private ends that"),
    LineCommand("ladder", "[hand in]", LineGame.ladder,
        "the ranks in this arena; with hand in your program plays there"),
    LineCommand("teacher", "", LineGame.ask_help,
        "ask the teacher of a class for help and show them your program, or stop that"),
    LineCommand("next", "", lambda game, _: game.player.library.next_level(),
        "open the next level"),
    LineCommand("level", "[NAME]", LineGame.open_level, "open a level, or list the levels"),
    LineCommand("daily", "", lambda game, _: game.player.library.open_daily(),
        "open the labyrinth of today"),
    LineCommand("help", "", LineGame.help, "this list"),
    LineCommand("quit", "", LineGame.quit, "leave; so does the end of the input"),
)
# fmt: on


def play(opening: Opening, recorder: ProgressRecorder) -> int:
    return asyncio.run(LineGame(opening, recorder).play())


def table() -> Iterator[str]:
    """Yield the commands as a table in Markdown."""
    yield from ("", "| type | what it does |", "|---|---|")
    for entry in COMMANDS:
        yield f"| `{entry.usage}` | {entry.help} |"
    yield ""
