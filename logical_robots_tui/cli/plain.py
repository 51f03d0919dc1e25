"""The game as lines of text, for screen readers and pipes: typed commands, printed events."""

from __future__ import annotations

import asyncio
import math
import signal
from collections.abc import Awaitable, Callable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

from logical_robots_tui.cli.command import ProgramFileError, columns, say
from logical_robots_tui.cli.line_ui import LineUi, Text, with_words
from logical_robots_tui.errors import InputError, LogicalRobotsError
from logical_robots_tui.game import Breakpoint, Inquiry, goals, load_program, mistake_in_question
from logical_robots_tui.game.frame import events_between
from logical_robots_tui.game.history.marks import trouble
from logical_robots_tui.game.source import target
from logical_robots_tui.game.victory import Victory, brief, result_line, robustness_line
from logical_robots_tui.mind import ProgramError
from logical_robots_tui.paths import is_there
from logical_robots_tui.player.learning import version_name, version_result
from logical_robots_tui.player.opening import LocalPlayer, Opening
from logical_robots_tui.player.recorder import ProgressRecorder
from logical_robots_tui.player.session_state import SessionListener
from logical_robots_tui.player.surroundings import surroundings
from logical_robots_tui.progress import Measures
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
        self._ui, self._text = LineUi(), Text()
        self._has_own_text = opening.text is not None
        self.player = LocalPlayer(opening, recorder, self._ui, self._text, lambda: None, with_words)
        self.session, self._recorder = self.player.session, recorder
        self._text.load(self.player.first_text)
        self._past = self.session.frame
        self._robot = ""
        self._inquiry: Inquiry | None = None
        self._victory: Victory | None = None
        self._told: tuple[Diagnostic, ...] = ()
        self._goes_on = True
        recorder.attach(self._ui, on_change=lambda: None, on_measured=self._measured)
        self.session.listeners += [recorder, self]

    async def play(self) -> int:
        try:
            await self._begin()
            while self._goes_on and (line := await self._ui.read()):
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
        await self._settled()
        say("Type help for the commands.")
        for each in self.player.offerings():
            await each.offer(self._ui)
            await self._settled()

    async def _execute(self, line: str) -> None:
        word, _, argument = line.strip().partition(" ")
        command = next((each for each in COMMANDS if each.word == word), None)
        if command is None:
            if word:
                say(f"Unknown command {word}. Type help for a list.")
            return
        try:
            is_needed = command.argument and not command.argument.startswith("[")
            if (not argument and is_needed) or (argument and not command.argument):
                raise InputError(f"Type {command.typed}.")
            if (work := command.do(self, argument.strip())) is not None:
                await work
        except (ProgramError, ProgramFileError) as error:
            self._tell_mistakes(error.diagnostics)
        except LogicalRobotsError as error:
            say(str(error))
        await self._settled()

    async def _settled(self) -> None:
        """Wait for what the last command began, and say how it ended."""
        await self._ui.drain(skip="measure")
        self.player.autosave.flush()
        state = self.session.state
        if state.phase == "mistake" and state.mistakes is not self._told:
            self._told = state.mistakes
            self._tell_mistakes(state.mistakes)
        victory, self._victory = self._victory, None
        if victory is not None:
            self._tell_victory(victory)

    def _tell_mistakes(self, mistakes: Sequence[Diagnostic], what: str = "Line") -> None:
        for found in mistakes:
            say(f"{what} {found.line}: {found.message}. {found.hint}".rstrip())

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

    def level_opened(self, level: Level) -> None:
        self._past, self._robot = self.session.frame, ""
        self._ui.spawn(self._forget_inquiry, "close", exclusive=False)
        say(level.title)
        self.brief("")
        self.where("")

    def program_used(self, program: Program) -> None:
        if self.session.game is not None:
            say("The robots will use it from the next tick.")
        self._tell_mistakes(self.session.state.warnings, "Warning, line")

    def tick_shown(self, frame: Frame) -> None:
        if frame.tick == self._past.tick + 1:
            for event in events_between(self.session.level, self._past, frame):
                say(f"Tick {frame.tick}: {event}")
            marks = self._game.history.marks.marks_at(frame.tick)
            say(*(f"Tick {frame.tick}: {words}" for mark in marks if (words := trouble(mark))))
        self._past = frame

    def won(self, victory: Victory) -> None:
        self._victory = victory

    def stopped(self, hits: tuple[Hit, ...]) -> None:
        for hit in hits:
            say(f"Stopped: {hit.breakpoint.words}. {hit.values}")

    def _measured(self, level: Level, found: Measures, _is_here: bool) -> None:
        say(robustness_line(level, found))

    async def go_on(self, ticks: int) -> None:
        """Run for some ticks; ^C ends it sooner."""
        loop = asyncio.get_running_loop()
        loop.add_signal_handler(signal.SIGINT, self.session.pause)
        try:
            self.session.run_until(self._game.frame.tick + ticks)
            await self._settled()
        finally:
            loop.remove_signal_handler(signal.SIGINT)
        self._tell_tick()

    def move(self, how: Callable[..., None], *ticks: int) -> None:
        how(*ticks)
        self._tell_tick()

    def _tell_tick(self) -> None:
        say(f"Tick {self.session.frame.tick}.")

    async def stop_at(self, question: str) -> None:
        wanted, breakpoints = Breakpoint("rows", question), self.session.breakpoints
        if wanted in breakpoints:
            breakpoints.remove(wanted)
            say(f"Runs no longer stop when {wanted.words}.")
            return
        problem = self.session.problem_with(wanted)
        if not (problem or wanted.is_named):
            problem = await mistake_in_question(self._game.program, question)
        if not problem:
            breakpoints.add(wanted)
        say(problem or f"Runs will stop when {wanted.words}.")

    def brief(self, _: str) -> None:
        level = self.session.level
        say(level.briefing.strip(), *(f"Bonus goal: {goal.words}." for goal in level.second_goals))

    def where(self, _: str) -> None:
        level, state = self.session.level, self.session.frame.after
        for given, robot in zip(level.robots, state.robots, strict=True):
            heading = f"{math.degrees(robot.angle) % 360:.0f} degrees"
            charge = f", battery {robot.battery_level:.0f}" if given.has_battery else ""
            say(f"{robot.name}: at {robot.x:.0f}, {robot.y:.0f}, heading {heading}{charge}.")
        say(*(goal.words for goal in goals(level, state)))

    def look(self, name: str) -> None:
        around = surroundings(self.session.level, self.session.frame.after, self._named(name))
        say(f"Around {self._named(name)}:", *around)

    def choose_robot(self, name: str) -> None:
        self._robot = self._named(name)
        say(f"The robot is {self._robot}.")

    def _named(self, name: str) -> str:
        """Return the robot of that name, by default the one that was chosen, or the first."""
        from logical_robots_tui.cli.run import check_name

        sources, level = self.session.sources, self.session.level
        names = [each.name for each in level.robots]
        if name:
            check_name("robot", name, names)
        mine = (each.name for each in level.robots if each.team == sources.team)
        return name or self._robot or next(mine, names[0])

    @property
    def _game(self) -> Game:
        if self.session.game is None:
            raise InputError("There is no program yet that can run.")
        return self.session.game

    def _thought(self) -> tuple[Inquiry, Program, str, Frame]:
        """Return whom to ask, a program, a robot that thinks with it, and the tick."""
        game, robot = self._game, self._named("")
        if not game.frame.tick:
            raise InputError("No decision yet: run or step first.")
        return self._asked(), game.program.for_team(game.level.team_of(robot)), robot, game.frame

    def _asked(self) -> Inquiry:
        self._inquiry = self._inquiry or Inquiry(self._game.level)
        return self._inquiry

    async def _forget_inquiry(self) -> None:
        inquiry, self._inquiry = self._inquiry, None
        if inquiry is not None:
            await inquiry.close()

    async def why(self, text: str) -> None:
        from logical_robots_tui.cli.why import answer, answer_lines, read_row
        from logical_robots_tui.explain.why.explanation import spell_call

        inquiry, program, robot, frame = self._thought()
        words = text.split(maxsplit=1)
        is_tree = words[:1] == ["tree"]
        asked = read_row(program, (words[1:] or ["Robot"])[0] if is_tree else text or "Robot")
        depth = _DEEPEST if is_tree else 0
        found = await answer(inquiry, program, robot, frame, asked, depth)
        more = f"For more, type why tree {'' if asked.predicate == 'Robot' else text}".rstrip()
        say(
            *answer_lines(
                found,
                program,
                frame.tick,
                more=more,
                command=lambda ask: f"why {spell_call(ask)}",
            )
        )

    async def ask(self, question: str) -> None:
        from logical_robots_tui.cli.query import table_lines

        game = self._game
        table = await self._asked().ask(game.program, question, game.frame)
        say(*(table_lines(table) if table.rows else ["No rows."]))

    async def origin(self, part: str) -> None:
        from logical_robots_tui.cli.why import origin_lines
        from logical_robots_tui.explain import Ask
        from logical_robots_tui.explain.why.explanation import Subject
        from logical_robots_tui.game import origin_in_game, read_part

        _, _, robot, _ = self._thought()
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
        library, former = self.player.library, self.session.source
        if not name and not former.shipped:
            await library.save()
            return
        path = target(name, library.programs)
        if is_there(path):
            raise InputError("already exists.", place=str(path), hint="Choose another name.")
        await library.save_as(path)
        say(f"Edit {path}, or use line and insert here; then type apply.")

    def edit(self, argument: str, replaced: int) -> None:
        """Put a line in place of as many; an empty one only deletes."""
        number, _, line = argument.partition(" ")
        lines = self._text.text.splitlines()
        at = _number(number) - 1
        if not 0 <= at <= len(lines) - replaced:
            raise InputError(f"There is no line {number}; the last one is {len(lines)}.")
        lines[at : at + replaced] = [line] if line else []
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
            say(*(f"{each}: {load_level(each).title}" for each in list_shipped()))

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
            say(*(f"{version_name(each)}: {version_result(each)}" for each in versions))
            return
        for each in versions:
            if number == str(each.number):
                learning.restore(each)
                return
        raise InputError(f"There is no version {number}. Type versions for a list.")

    def results(self, _: str) -> None:
        mine = brief(self._recorder.record.bests)
        say(f"Yours: {mine}" if mine else "You have not won here yet.")
        references = self._recorder.references.items()
        say(*(f"{name}: {brief(measures)}" for name, measures in references))

    def help(self, _: str) -> None:
        say(*columns([(each.typed, each.help) for each in COMMANDS]))

    def quit(self, _: str) -> None:
        self._goes_on = False


def _number(text: str, usual: int = 1) -> int:
    if text and not (text.isdecimal() and len(text) < 10):
        raise InputError(f"{text} is not a number.")
    return int(text or usual)


class Command(NamedTuple):
    """What is typed, and what it does with the argument, "" if there is none."""

    word: str
    argument: str
    do: Callable[[LineGame, str], Awaitable[None] | None]
    help: str

    @property
    def typed(self) -> str:
        return f"{self.word} {self.argument}".rstrip()


# fmt: off
COMMANDS = (
    Command("run", "[N]", lambda game, n: game.go_on(_number(n, MOST)),
        f"run until victory or a stop, for at most N ticks ({MOST:,} by default)"),
    Command("step", "[N]", lambda game, n: game.go_on(_number(n)),
        "one tick forward, or N ticks"),
    Command("back", "[N]", lambda game, n: game.move(game.session.back, _number(n)),
        "one tick back, or N ticks"),
    Command("goto", "N", lambda game, n: game.move(game.session.go_to, _number(n)),
        "go to a tick of the past"),
    Command("other", "", lambda game, _: game.move(game.session.change_branch),
        "switch to the branch that was left when the program changed"),
    Command("restart", "", lambda game, _: game.move(game.session.restart),
        "start again at tick 0"),
    Command("where", "", LineGame.where, "positions of the robots, and who is in a goal"),
    Command("look", "[ROBOT]", LineGame.look,
        "walls, beacons, robots and areas by direction and distance from a robot"),
    Command("robot", "NAME", LineGame.choose_robot,
        "choose the robot that look, why and origin are about"),
    Command("stop", "QUERY", LineGame.stop_at,
        "stop runs when a predicate has rows, or a query holds; repeat to remove it"),
    Command("why", "[tree] [P]", LineGame.why,
        "explain what the robot did in this tick, or a predicate; tree gives the whole proof"),
    Command("ask", "QUERY", LineGame.ask, "answer a query in Logica about this tick"),
    Command("origin", "[PART]", LineGame.origin,
        "trace back the robot's memory, or a part such as desire.left_engine"),
    Command("diagnose", "", LineGame.diagnose, "scan the ticks so far for likely mistakes"),
    Command("program", "", LineGame.show_program, "the program, with the numbers of its lines"),
    Command("line", "N [TEXT]", lambda game, line: game.edit(line, 1),
        "replace line N of the program, or delete it"),
    Command("insert", "N TEXT", lambda game, line: game.edit(line, 0),
        "insert a line before line N"),
    Command("save", "[NAME]", LineGame.save,
        "save the program as a file of your own, which you can edit"),
    Command("apply", "", LineGame.apply,
        "continue with the program as you changed it, here or in its file"),
    Command("open", "PROGRAM", LineGame.open_program, "continue with another program"),
    Command("versions", "[N]", LineGame.versions,
        "list your earlier programs for this level, or go back to one"),
    Command("reset", "", lambda game, _: game.player.learning.reset(),
        "put the starter program back; yours becomes an earlier version"),
    Command("briefing", "", LineGame.brief, "the task, and bonus goals"),
    Command("hint", "", LineGame.hint, "reveal the next hint"),
    Command("lesson", "", LineGame.lesson,
        "what the level teaches and, when you have won, what to try next"),
    Command("answer", "[N QUERY]", LineGame.answer,
        "list the questions of the lesson, or answer question N with a query"),
    Command("solution", "", LineGame.solution, "the reference programs"),
    Command("results", "", LineGame.results, "your best results beside the reference programs"),
    Command("next", "", lambda game, _: game.player.library.next_level(),
        "open the next level"),
    Command("level", "[NAME]", LineGame.open_level, "open a level, or list the levels"),
    Command("daily", "", lambda game, _: game.player.library.open_daily(),
        "open the labyrinth of today"),
    Command("help", "", LineGame.help, "this list"),
    Command("quit", "", LineGame.quit, "leave; so does the end of the input"),
)
# fmt: on


def play(opening: Opening, recorder: ProgressRecorder) -> int:
    """Play in lines of text until the player leaves; return the exit status."""
    return asyncio.run(LineGame(opening, recorder).play())


def table() -> Iterator[str]:
    """Yield the commands as a table in Markdown."""
    yield from ("", "| type | what it does |", "|---|---|")
    for each in COMMANDS:
        yield f"| `{each.typed}` | {each.help} |"
    yield ""
