"""Reading a call as a player writes it to ask why. In the compile process."""

from __future__ import annotations

from logical_robots_tui.explain.why.probing import Called
from logical_robots_tui.language import error_messages, tree
from logical_robots_tui.language.adapter import parse_expression, parse_proposition
from logical_robots_tui.language.diagnostics import Diagnostic, ProgramError
from logical_robots_tui.language.source_text import Prepared, diagnostic_at, prepare
from logical_robots_tui.language.tree import Atom, Boolean, Expression, Null, Number, PredicateName
from logical_robots_tui.schema import VALUE
from logical_robots_tui.values import Value

_HINT = 'Ask for a predicate with values, such as Next(robot_name: "Crow") or Speed(200).'


def read_call(text: str) -> Called:
    """Read a predicate with values; arguments that are variables have none.

    Raises:
        ProgramError: It is something else.
    """
    source = prepare(text)
    if source.problems:
        raise ProgramError(source.problems)
    call_node, result = _sides(source)
    if (
        not isinstance(call_node, Atom | tree.Call | PredicateName)
        or not call_node.name[:1].isalpha()
    ):
        raise _refusal(source, call_node, "This is not a predicate with values")
    values = _fields(() if isinstance(call_node, PredicateName) else call_node.arguments, source)
    if result is not None:
        values[VALUE] = _value(result, source)
    return Called(str(call_node.name), values)


def _sides(source: Prepared) -> tuple[Expression | Atom, Expression | None]:
    """Return the call, and the value that it is compared with, if any."""
    if not source.text.strip():
        raise ProgramError((Diagnostic(1, 1, "The query is empty", _HINT),))
    try:
        body = parse_proposition(source)
    except error_messages.COMPLAINTS:
        try:
            return parse_expression(source), None
        except error_messages.COMPLAINTS as error:
            raise ProgramError((error_messages.explain(error, source),)) from None
    if (sides := tree.equation_sides(body)) is not None:
        return sides
    if isinstance(body, Atom):
        return body, None
    raise _refusal(source, None, "These are several conditions")


def _fields(arguments: tuple[tree.Argument, ...], source: Prepared) -> dict[str, Value]:
    return {
        argument.column: _value(argument.expression, source)
        for argument in arguments
        if argument.expression is not None and not isinstance(argument.expression, tree.Variable)
    }


def _value(node: Expression, source: Prepared) -> Value:
    """Return the value of a literal; raise ProgramError for anything else."""
    match node:
        case Number():
            is_whole = node.value.lstrip("-").isdigit()
            return int(node.value) if is_whole else float(node.value)
        case Boolean():
            return node.value == "true"
        case Null():
            return None
        case tree.Text():
            return node.value
        case tree.List():
            return [_value(element, source) for element in node.elements]
        case tree.Record():
            return {
                str(field.field): _value(field.expression, source)
                for field in node.arguments
                if field.expression is not None
            }
    hint = 'Values are numbers, "strings", true, false, null, [lists] and {of: records}.'
    raise _refusal(source, node, "This is not a value", hint)


def _refusal(
    source: Prepared, node: Expression | Atom | None, message: str, hint: str = _HINT
) -> ProgramError:
    start, stop = (node.span if node is not None else None) or (0, len(source.original))
    diagnostic = diagnostic_at(source.original, start, stop - start, message, hint)
    return ProgramError((diagnostic,))
