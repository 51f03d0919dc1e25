"""``logical-robots why``: which rule made a robot's decision, and what stopped the others."""

from __future__ import annotations

import argparse
import asyncio
import shlex
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from logical_robots_tui.cli.command import Commands, cut, harmless, number_from
from logical_robots_tui.cli.failure import ProgramFileError
from logical_robots_tui.cli.runs.common import check_name, frame_at, new_run_command, open_run, show
from logical_robots_tui.values import Value, read_value, spell

if TYPE_CHECKING:
    from logical_robots_tui.explain import Ask, Explanation, Node
    from logical_robots_tui.explain.why.nearest import Suggestion
    from logical_robots_tui.game import Frame, Inquiry
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

GAVE, GAVE_NOT = 0, 1
WIDEST = 100  # columns, if the terminal's width is unknown
DEEPEST = 100

_LONGEST = 150  # characters of a command that is proposed
_LONGEST_VALUE = 40
_MOST_VALUES = 5  # in a line; --json has more


def declare(commands: Commands) -> None:
    command = new_run_command(
        commands, "why", start, first_tick=1, robot="in whose mind", needs_robot=True
    )
    add_row(command)
    command.add_argument(
        "--tree", action="store_true", help="the whole proof, down to what was sensed"
    )
    command.add_argument(
        "--depth",
        type=number_from(1),
        default=DEEPEST,
        metavar="N",
        help="with --tree: the most nested predicates to show",
    )


def add_row(command: argparse.ArgumentParser) -> None:
    """Declare the options that name a row of a predicate."""
    command.add_argument(
        "--predicate",
        default="Robot",
        metavar="P",
        help="the predicate, or one with values as in Logica (default: %(default)s)",
    )
    command.add_argument(
        "--given",
        type=_column_value,
        action="append",
        default=[],
        metavar="COLUMN=VALUE",
        help="only rows with this value, as JSON; for functions: an argument",
    )
    command.add_argument(
        "--within", default="", metavar="P", help="within the rules of P, defined with ':='"
    )


def start(options: argparse.Namespace) -> int:
    """explain why a robot did what it did, or why not

    Run a program to a tick, then explain for each rule which parts of it held.

    examples:
      logical-robots why 06-breadcrumbs breadcrumbs --tick 300 --robot Crow
      logical-robots why 06-breadcrumbs breadcrumbs --tick 300 --robot Crow --tree
      logical-robots why 06-breadcrumbs breadcrumbs --tick 300 --robot Crow \\
        --predicate Next
      logical-robots why 06-breadcrumbs breadcrumbs --tick 3 --robot Crow \\
        --predicate 'Steer(0.5)'

    A row is explained by one derivation. For each rule without a row you see the
    first condition that failed, and a single change that would have produced a row.
    + holds, - does not. --tree follows every call, down to what was sensed and
    remembered.

    exit status: 0 there is a row, 1 there is none, 2 bad level, program or name
    """
    level, program = open_run(options)
    asked = read_row(program, options.predicate, dict(options.given), options.within)
    answer = asyncio.run(_ask(level, program, asked, options))
    data = {
        **_data(answer.explanation, options.tick, program),
        "tree": [_node(node, program) for node in answer.nodes],
        "nearest": [_suggestion(*each) for each in answer.nearest],
    }
    more = () if answer.complete else ("", "This is not complete; a larger --depth shows more.")
    show(options, data, (*answer_lines(answer, program, options.tick), *more))
    return GAVE if answer.explanation.rows else GAVE_NOT


def read_row(
    program: Program, predicate: str, given: Mapping[str, Value] = {}, within: str = ""
) -> Ask:
    """Return the question; raise InputError, ProgramFileError or QueryError."""
    from logical_robots_tui.explain import Ask
    from logical_robots_tui.explain.why.explainer import read_ask
    from logical_robots_tui.explain.why.probing import decompose
    from logical_robots_tui.mind import ProgramError

    own = [predicate.name for predicate in program.predicates if predicate.kind == "program"]
    name = predicate.partition("(")[0].strip()
    if program.predicate(name) is None:
        check_name("predicate", name, own)
    if name == predicate:
        decompose(program, name, within)  # refuses before the run
        return Ask(name, given, within)
    try:
        asked = read_ask(program, predicate, within)
    except ProgramError as error:
        raise ProgramFileError("predicate", error) from error
    return replace(asked, given={**asked.given, **given})


class Answer(NamedTuple):
    """An explanation with its nodes, or those of the whole proof, whether they are complete.

    `nearest` are suggestions with the lines of the rules.
    """

    explanation: Explanation
    nodes: tuple[Node, ...]
    is_tree: bool = False
    complete: bool = True
    nearest: Sequence[tuple[int, Suggestion]] = ()


async def _ask(level: Level, program: Program, asked: Ask, options: argparse.Namespace) -> Answer:
    from logical_robots_tui.game import Inquiry

    inquiry = Inquiry(level)
    try:
        frame, _ = await asyncio.gather(
            frame_at(level, program, options.tick), inquiry.prepare(program, asked)
        )
        depth = options.depth if options.tree else 0
        return await answer(inquiry, program, options.robot, frame, asked, depth)
    finally:
        await inquiry.close()


async def answer(
    inquiry: Inquiry, program: Program, robot: str, frame: Frame, asked: Ask, depth: int = 0
) -> Answer:
    """Explain a row, with a depth by its whole proof; raise QueryError."""
    if depth:
        proof = await inquiry.proof(program, robot, frame, asked, depth=depth)
        return Answer(proof.explanation, proof.nodes, is_tree=True, complete=not proof.is_cut)
    explanation = await inquiry.why(program, robot, frame, asked)
    nearest: Sequence[tuple[int, Suggestion]] = ()
    if any(rule.rows == 0 for rule in explanation.rules):
        nearest = await inquiry.nearest(program, robot, frame, asked)
    return Answer(explanation, explanation.nodes, nearest=nearest)


def option_of(ask: Ask) -> str:
    from logical_robots_tui.explain.why.explanation import spell_call

    within = f" --within {ask.within}" if ask.within else ""
    return f"--predicate {shlex.quote(spell_call(ask))}{within}"


def answer_lines(
    found: Answer,
    program: Program,
    tick: int,
    *,
    more: str = "For more, add --tree",
    command: Callable[[Ask], str] = option_of,
) -> Iterator[str]:
    """Yield an answer in lines; `more` and `command` say how to see more of it."""
    wide = shutil.get_terminal_size((WIDEST, 0)).columns
    explanation = found.explanation
    yield f"{explanation.asked.predicate} for {harmless(explanation.robot)} at tick {tick}"
    if explanation.made_from:
        yield f"  is made from {explanation.made_from}; these are its rules"
    lines = [line for node in found.nodes for line in node.walk()]
    for depth, node in lines:
        yield _line(depth, node, wide)
    if not found.is_tree:
        asked = (_without_long_values(node.asked, program) for _, node in lines if node.asked)
        deeper = dict.fromkeys(harmless(command(ask)) for ask in asked)
        short = [f"  {each}" for each in deeper if len(each) <= _LONGEST]
        if deeper:
            yield from ("", f"{more}{' or one of:' if short else '.'}", *short)
    yield from _nearest(found.nearest)


def _nearest(found: Sequence[tuple[int, Suggestion]]) -> Iterator[str]:
    for rule in dict.fromkeys(line for line, _ in found):
        sentences = [each.text for line, each in found if line == rule]
        what = "This change" if len(sentences) == 1 else "Each of these changes"
        yield from ("", f"{what} would give the rule in line {rule} a row:")
        yield from (harmless(f"  {sentence}") for sentence in sentences)


def _suggestion(rule: int, each: Suggestion) -> dict[str, Any]:
    return {
        "rule": rule,
        "line": each.span.line,
        "text": each.span.text,
        "change": each.change,
        "said": each.text,
    }


def _without_long_values(ask: Ask, program: Program) -> Ask:
    """Return a question without long values that need not be given."""
    known = program.predicate(ask.predicate)
    if known is None or not known.has_rows:
        return ask
    given = {c: v for c, v in ask.given.items() if len(spell(v, _LONGEST)) <= _LONGEST_VALUE}
    return replace(ask, given=given)


def _line(depth: int, node: Node, wide: int) -> str:
    mark = {True: "+", False: "-", None: " "}[node.holds]
    before = f"{'  ' * depth}{mark} "
    place = f"line {node.span.line}: " if node.kind == "rule" and node.span is not None else ""
    said = f"  ({node.said})" if node.said else ""
    shown = node.values[:_MOST_VALUES]
    values = [*map(spell, shown)]
    if more := len(node.values) - len(shown) + node.more:
        values.append(f"{more} more")
    told = f" = {' or '.join(values)}" if values else ""
    room = max(20, wide - len(before) - len(place) - len(said) - min(len(told), wide // 2))
    whole, wide = f"{before}{place}{cut(harmless(node.text), room)}", max(wide, 40)
    return cut(f"{whole}{cut(told, wide - len(whole) - len(said))}{said}", wide)


def _data(explanation: Explanation, tick: int, program: Program) -> dict[str, Any]:
    return {
        "tick": tick,
        "robot": explanation.robot,
        "predicate": explanation.asked.predicate,
        "made_from": explanation.made_from or None,
        "rows": explanation.rows,
        "row": explanation.row and _labelled(explanation.asked.predicate, explanation.row, program),
        "rules": [
            {
                "line": rule.span.line,
                "text": rule.span.text,
                "rows": rule.rows,
                "gives_row": rule.row is not None,
                "stopped_by": rule.stopped_by.text if rule.stopped_by else None,
                "stopped_at_line": rule.stopped_by.span.line
                if rule.stopped_by and rule.stopped_by.span
                else None,
            }
            for rule in explanation.rules
        ],
    }


def _labelled(predicate: str, row: Mapping[str, Value], program: Program) -> dict[str, Value]:
    labels = program.labels.get(predicate, {})
    return {labels.get(column, column): value for column, value in row.items()}


def _node(node: Node, program: Program) -> dict[str, Any]:
    data: dict[str, Any] = {"kind": node.kind, "text": node.text}
    if node.said:
        data["said"] = node.said
    if node.holds is not None:
        data["holds"] = node.holds
    if node.values:
        data["values"] = node.values
    if node.more:
        data["more"] = node.more
    if node.span is not None:
        data["line"] = node.span.line
    if node.robot:
        data["robot"] = node.robot
    if node.ray is not None:
        data["ray"] = node.ray
    if node.asked is not None:
        name = node.asked.predicate
        data["asked"] = {"predicate": name, "given": _labelled(name, node.asked.given, program)}
        if node.asked.within:
            data["asked"]["within"] = node.asked.within
    if node.children:
        data["children"] = [_node(child, program) for child in node.children]
    return data


def _column_value(text: str) -> tuple[str, Any]:
    column, sign, value = text.partition("=")
    if not sign or not column:
        raise argparse.ArgumentTypeError(f"{text!r} is not COLUMN=VALUE")
    try:
        return column, read_value(value)
    except ValueError:
        return column, value
