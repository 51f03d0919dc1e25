"""``logical-robots why`` and ``origin``: which rules made a decision, and where a value is from."""

from __future__ import annotations

import argparse
import asyncio
import shlex
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from logical_robots_tui import explain, game, mind, world
from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import cut, harmless
from logical_robots_tui.cli.run import (
    check_name,
    frame_at,
    mistakes_in,
    open_run,
    place_of,
    run_args,
    show,
    with_run,
)
from logical_robots_tui.values import Value, read_value, spell

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.explanation import Path
    from logical_robots_tui.explain.why.nearest import Suggestion

GAVE, GAVE_NOT = 0, 1
WIDEST = 100  # columns, of an explanation if the terminal's width is unknown
DEEPEST = 100  # predicates in a proof

_LONGEST = 150  # characters of a command that is proposed
_LONGEST_VALUE = 40
_LONGEST_ORIGIN = 60  # characters of a value that is traced back
_MOST_VALUES = 5  # in a line; --json has more


def _column_value(text: str) -> tuple[str, Any]:
    column, sign, value = text.partition("=")
    if not sign or not column:
        raise argparse.ArgumentTypeError(f"{text!r} is not COLUMN=VALUE")
    try:
        return column, read_value(value)
    except ValueError:
        return column, value


_ROW_ARGUMENTS = (
    run_args(first_tick=1, robot="the robot to ask", needs_robot=True),
    command.option(
        "--predicate",
        "P",
        "the predicate, or one with values as in Logica (default: %(default)s)",
        default="Robot",
    ),
    command.option(
        "--given",
        "COLUMN=VALUE",
        "only rows with this value, as JSON; for functions: an argument",
        type=_column_value,
        action="append",
        default=[],
    ),
    command.option("--within", "P", "within the rules of P, defined with ':='", default=""),
)


@command.declare(
    "why",
    *_ROW_ARGUMENTS,
    command.flag("--tree", "the whole proof, down to what was sensed"),
    command.option(
        "--depth",
        "N",
        "with --tree: the most nested predicates to show",
        type=command.number_from(1),
        default=DEEPEST,
    ),
)
def why(options: argparse.Namespace) -> int:
    """explain why a robot did what it did, or why not

    Run a program to a tick, then explain for each rule which parts of it held.

    examples:
      logical-robots why 06-breadcrumbs breadcrumbs --tick 300 --robot Crow
      logical-robots why 06-breadcrumbs breadcrumbs --tick 300 --robot Crow --tree
      logical-robots why 06-breadcrumbs breadcrumbs --tick 300 --robot Crow \\
        --predicate Next
      logical-robots why 06-breadcrumbs breadcrumbs --tick 3 --robot Crow \\
        --predicate 'Turn(0.5)'

    A row is explained by its first derivation, and others are named. For each rule
    without a row you see the first condition that failed, and a single change that
    would have produced a row. + holds, - does not. --tree follows every call of
    first derivations, down to what was sensed and remembered.

    exit status: 0 there is a row, 1 there is none, 2 bad level, program or name
    """
    level, program = open_run(options)
    question = read_row(program, options.predicate, dict(options.given), options.within)
    answer = asyncio.run(_ask(level, program, question, options))
    document = {
        **_data(answer.explanation, options.tick, program),
        "tree": [_node(node, program) for node in answer.nodes],
        "nearest": [
            {
                "rule": line,
                **place_of(suggestion.span),
                "change": suggestion.change,
                "said": suggestion.text,
            }
            for line, suggestion in answer.nearest
        ],
    }
    note = () if answer.complete else ("", "This is not complete; a larger --depth shows more.")
    show(options, document, (*answer_lines(answer, program, options.tick), *note))
    return GAVE if answer.explanation.rows else GAVE_NOT


def read_row(
    program: mind.Program, predicate: str, values: Mapping[str, Value] = {}, within: str = ""
) -> explain.Ask:
    """Return the question; raise InputError, ProgramFileError or QueryError."""
    from logical_robots_tui.explain.why.explainer import read_ask
    from logical_robots_tui.explain.why.probing import decompose

    names = [predicate.name for predicate in program.predicates if predicate.kind == "program"]
    name = predicate.partition("(")[0].strip()
    if program.predicate(name) is None:
        check_name("predicate", name, names)
    if name == predicate:
        decompose(program, name, within)  # refuses before the run
        return explain.Ask(name, values, within)
    with mistakes_in("predicate"):
        question = read_ask(program, predicate, within)
    return replace(question, given={**question.given, **values})


class WhyAnswer(NamedTuple):
    """An explanation with its nodes, or those of the whole proof, whether they are complete.

    `nearest` are suggestions with the lines of the rules.
    """

    explanation: explain.Explanation
    nodes: tuple[explain.ProofNode, ...]
    is_tree: bool = False
    complete: bool = True
    nearest: Sequence[tuple[int, Suggestion]] = ()


async def _ask(
    level: world.Level, program: mind.Program, question: explain.Ask, options: argparse.Namespace
) -> WhyAnswer:
    inquiry = game.Inquiry(level)
    try:
        frame, _ = await asyncio.gather(
            frame_at(level, program, options.tick), inquiry.prepare(program, question)
        )
        depth = options.depth if options.tree else 0
        return await explain_row(inquiry, program, options.robot, frame, question, depth)
    finally:
        await inquiry.close()


async def explain_row(
    inquiry: game.Inquiry,
    program: mind.Program,
    robot: str,
    frame: game.Frame,
    question: explain.Ask,
    depth: int = 0,
) -> WhyAnswer:
    """Explain a row, with a depth by its whole proof; raise QueryError."""
    proof = await inquiry.proof(program, robot, frame, question, depth=depth or 1)
    explanation = proof.explanation
    if depth:
        return WhyAnswer(explanation, proof.nodes, is_tree=True, complete=not proof.is_cut)
    nearest: Sequence[tuple[int, Suggestion]] = ()
    if any(rule.rows == 0 for rule in explanation.rules):
        nearest = await inquiry.nearest(program, robot, frame, question)
    return WhyAnswer(explanation, explanation.nodes, nearest=nearest)


def option_of(ask: explain.Ask) -> str:
    from logical_robots_tui.explain.why.explanation import spell_call

    within = f" --within {ask.within}" if ask.within else ""
    return f"--predicate {shlex.quote(spell_call(ask))}{within}"


def answer_lines(
    answer: WhyAnswer,
    program: mind.Program,
    tick: int,
    *,
    hint: str = "For more, add --tree",
    command_of: Callable[[explain.Ask], str] = option_of,
) -> Iterator[str]:
    """Yield an answer in lines; `hint` and `command_of` say how to see more of it."""
    width = shutil.get_terminal_size((WIDEST, 0)).columns
    explanation = answer.explanation
    yield f"{explanation.query.predicate} for {harmless(explanation.robot)} at tick {tick}"
    if explanation.made_from:
        yield f"  is made from {explanation.made_from}; these are its rules"
    lines = [line for node in answer.nodes for line in node.walk()]
    for depth, node in lines:
        yield _line(depth, node, width)
    if not answer.is_tree:
        questions = (_without_long_values(node.query, program) for _, node in lines if node.query)
        commands = dict.fromkeys(harmless(command_of(ask)) for ask in questions)
        short_lines = [f"  {text}" for text in commands if len(text) <= _LONGEST]
        if commands:
            yield from ("", f"{hint}{' or one of:' if short_lines else '.'}", *short_lines)
    for rule in dict.fromkeys(line for line, _ in answer.nearest):
        sentences = [suggestion.text for line, suggestion in answer.nearest if line == rule]
        subject = "This change" if len(sentences) == 1 else "Each of these changes"
        yield from ("", f"{subject} would give the rule in line {rule} a row:")
        yield from (harmless(f"  {sentence}") for sentence in sentences)


def _without_long_values(ask: explain.Ask, program: mind.Program) -> explain.Ask:
    """Return a question without its long values, unless they are required."""
    predicate = program.predicate(ask.predicate)
    if predicate is None or not predicate.has_rows:
        return ask
    short_values = {c: v for c, v in ask.given.items() if len(spell(v, _LONGEST)) <= _LONGEST_VALUE}
    return replace(ask, given=short_values)


def _line(depth: int, node: explain.ProofNode, width: int) -> str:
    mark = {True: "+", False: "-", None: " "}[node.holds]
    prefix = f"{'  ' * depth}{mark} "
    place = f"line {node.span.line}: " if node.is_rule and node.span is not None else ""
    remark = f"  ({node.remark})" if node.remark else ""
    first_values = node.values[:_MOST_VALUES]
    values = [*map(spell, first_values)]
    if excess := len(node.values) - len(first_values) + node.excess:
        values.append(f"{excess} more")
    suffix = f" = {' or '.join(values)}" if values else ""
    limit = max(20, width - len(prefix) - len(place) - len(remark) - min(len(suffix), width // 2))
    head, width = f"{prefix}{place}{cut(harmless(node.text), limit)}", max(width, 40)
    return cut(f"{head}{cut(suffix, width - len(head) - len(remark))}{remark}", width)


def _data(explanation: explain.Explanation, tick: int, program: mind.Program) -> dict[str, Any]:
    return {
        "tick": tick,
        "robot": explanation.robot,
        "predicate": explanation.query.predicate,
        "made_from": explanation.made_from or None,
        "rows": explanation.rows,
        "row": explanation.row and _relabel(explanation.query.predicate, explanation.row, program),
        "rules": [
            {
                **place_of(rule.span),
                "rows": rule.rows,
                "gives_row": rule.row is not None,
                "stopped_by": rule.stopped_by and rule.stopped_by.text,
                "stopped_at_line": rule.stopped_by and place_of(rule.stopped_by.span)["line"],
            }
            for rule in explanation.rules
        ],
    }


def _relabel(predicate: str, row: Mapping[str, Value], program: mind.Program) -> dict[str, Value]:
    labels = program.labels.get(predicate, {})
    return {labels.get(column, column): value for column, value in row.items()}


def _node(node: explain.ProofNode, program: mind.Program) -> dict[str, Any]:
    question = node.query and {
        "predicate": node.query.predicate,
        "given": _relabel(node.query.predicate, node.query.given, program),
        **({"within": node.query.within} if node.query.within else {}),
    }
    document = {
        "kind": node.kind,
        "text": node.text,
        "said": node.remark or None,
        "holds": node.holds,
        "values": node.values or None,
        "more": node.excess or None,
        "line": node.span and node.span.line,
        "robot": node.robot or None,
        "ray": node.ray,
        "asked": question,
        "children": [_node(child, program) for child in node.children] or None,
    }
    return {key: value for key, value in document.items() if value is not None}


def _part(text: str) -> tuple[str, Path]:
    try:
        return game.read_part(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


@command.declare(
    "origin",
    *_ROW_ARGUMENTS,
    command.option(
        "--value",
        "PART",
        "a column or a part of it, such as memory.plan.at, memory.seen[0] or "
        "desire.left_engine (default: the memory, or the only column)",
        type=_part,
    ),
)
def origin(options: argparse.Namespace) -> int:
    """trace a value back to the rules and readings that it comes from

    Run a program to a tick, then trace a value back to where it was made.

    examples:
      logical-robots origin 06-breadcrumbs breadcrumbs --tick 600 --robot Crow \\
        --value memory.visited
      logical-robots origin 06-breadcrumbs breadcrumbs --tick 600 --robot Crow \\
        --value 'memory.visited[0]'
      logical-robots origin 06-breadcrumbs breadcrumbs --tick 600 --robot Crow \\
        --value desire.left_engine
      logical-robots origin 06-breadcrumbs breadcrumbs --tick 380 --robot Crow \\
        --predicate Next --value ray.distance

    A value in a memory, as it is after the tick, comes from the tick of its last
    change; any other value of a predicate is made in the tick itself. The chain
    goes on with what it was made from, through rules, earlier ticks and the
    memories of other robots, to rays, sensor fields, facts or the start. Steps that
    only pass a value on are left out.

    exit status: 0 found, 2 bad level, program, robot or value
    """
    from logical_robots_tui.explain.why.explanation import Subject

    level, program = open_run(options)
    question = read_row(program, options.predicate, dict(options.given), options.within)
    default = "memory" if question.predicate == "Robot" else ""
    subject = Subject(question, *(options.value or (default, ())))
    robot, tick = options.robot, options.tick
    chain = asyncio.run(
        with_run(
            level,
            program,
            tick,
            lambda run, show: game.origin_in_run(run, robot, subject, tick, show),
        )
    )
    document = {"complete": chain.complete, "links": [*map(_link, chain.links)]}
    show(options, document, origin_lines(chain))
    return 0


def origin_lines(chain: game.Origin) -> Iterator[str]:
    from logical_robots_tui.game.debugging.origin import INCOMPLETE, link_lines

    for number, link in enumerate(chain.links):
        if number:
            yield ""
        yield harmless(f"{number + 1}. {link.name} = {_value_text(link.value)}")
        yield from (cut(harmless(f"   {line}"), WIDEST) for line in link_lines(link, _value_text))
    if not chain.complete:
        yield from ("", INCOMPLETE)


def _value_text(value: Value) -> str:
    return cut(spell(value, _LONGEST_ORIGIN, is_rounded=True), _LONGEST_ORIGIN)


def _link(link: game.Link) -> dict[str, Any]:
    from logical_robots_tui.game.debugging.inquiry import path_text

    source, steps = link.source, link.steps
    return {
        "robot": link.robot,
        "name": link.name,
        "part": path_text(link.path) if link.path is not None else None,
        "value": link.value,
        "tick": link.tick,
        "until": link.until,
        "rule_line": source.rule.line if source and source.rule else None,
        **place_of(source.span if source else None),
        "conditions": [
            {**place_of(condition.span), "holds": condition.holds}
            for condition in (source.conditions if source else ())
        ],
        "steps": steps
        and {
            "by": steps.increment,
            "since": steps.since,
            "times": steps.times,
            "from": steps.begin,
            "link": link.began,
        },
        "from": [
            {
                "name": path_text(read.path, read.kind) if (read := value.read) else value.name,
                "robot": read.robot if read else None,
                "value": read.value if read else value.value,
                "link": index,
            }
            for value, index in zip(link.inputs, link.input_links, strict=False)
        ],
        "more": source.excess if source else 0,
        "problem": link.problem or None,
    }
