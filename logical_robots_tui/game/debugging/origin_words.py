"""An origin in words: the lines of a link, for the command and for the inspector."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from logical_robots_tui.game.debugging.pins import path_text

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.probing import Span
    from logical_robots_tui.explain.why.sources import Read, Source
    from logical_robots_tui.game.debugging.changes import Steps
    from logical_robots_tui.game.debugging.origin import Link
    from logical_robots_tui.values import Value

_SHOWN_INPUTS = 5
_SHOWN_CONDITIONS = 3

INCOMPLETE = "This is not all of it: some of the values that were read are not traced."


def link_lines(link: Link, written: Callable[[Value], str]) -> Iterator[str]:
    """Yield the lines below a link's value; `written` puts a value in a few words."""
    source = link.source
    if source is None:
        yield _without_source(link)
        return
    if link.path is not None:
        rule = f" by the rule in line {source.rule.line}" if source.rule is not None else ""
        since = f"the same since tick {link.tick}, set then"
        yield (since if link.until > link.tick else f"set in tick {link.tick}") + rule
    if source.span is not None:
        text = _text_of(source, source.span)
        yield (
            f"line {source.span.line}: {text}" if text != link.name else f"line {source.span.line}"
        )
    for condition in source.conditions[:_SHOWN_CONDITIONS]:
        holds = "holds" if condition.holds else "does not hold"
        yield f"as in line {condition.span.line} {holds}: {condition.span.text}"
    if link.steps is not None:
        began = f" ({link.began + 1}.)" if link.began is not None else ""
        yield f"{_steps(link.steps, link.tick)}, from {written(link.steps.begin)}{began}"
    verb = _verb(source)
    pairs = list(zip(link.inputs, link.before, strict=True))
    for each, number in pairs[:_SHOWN_INPUTS]:
        goes_on = f" ({number + 1}.)" if number is not None else ""
        yield f"{verb} {_input(each, written)}{goes_on}"
        verb = "from"
    if (more := len(pairs) - len(pairs[:_SHOWN_INPUTS]) + source.more) > 0:
        numbers = [f"{n + 1}." for _, n in pairs[_SHOWN_INPUTS:] if n is not None]
        goes_on = f" ({', '.join(numbers)})" if numbers else ""
        yield f"and from {more} more{goes_on}"


def _verb(source: Source) -> str:
    if source.read is None:
        return "from"
    return "copied from" if source.read.what == "memory" else "read from"


def _without_source(link: Link) -> str:
    if link.problem:
        return f"the same since tick {link.tick}; {link.problem}"
    if link.tick:
        return f"the same since tick {link.tick} or longer"
    return f"there from the start until tick {link.until}"


def _text_of(source: Source, span: Span) -> str:
    """Return the expression; of a constant in a fact, the fact."""
    rule = source.rule
    is_fact = source.is_constant and rule is not None and ":-" not in rule.text
    return rule.text if rule is not None and is_fact and rule.holds(span) else span.text


def _steps(steps: Steps, tick: int) -> str:
    since = f"since tick {steps.since}"
    if steps.by is None:
        return f"changes in each tick {since}"
    way = f"counts {'up' if steps.by > 0 else 'down'} by {abs(steps.by):.10g}"
    is_in_each_tick = steps.times == tick - steps.since + 1
    return f"{way} {since}" if is_in_each_tick else f"{way}, {steps.times} times {since}"


def _input(source: Source, written: Callable[[Value], str]) -> str:
    read = source.read
    if read is None:
        where = source.span if source.is_constant else None
        line = f" (line {where.line})" if where is not None else ""
        return f"{source.name} = {written(source.value)}{line}"
    if read.what == "sensor" and read.path[:1] == ("radar",) and len(read.path) == 2:
        return _ray(read)
    return f"{read.robot}'s {path_text(read.path, read.what)} = {written(read.value)}"


def _ray(read: Read) -> str:
    ray = read.value if isinstance(read.value, dict) else {}
    seen, label = ray.get("object"), ray.get("label")
    what = f"{seen}" if label in (seen, None) else f'{seen} "{label}"'
    angle = ray.get("angle")
    degrees = f"{math.degrees(angle):.0f}°" if isinstance(angle, int | float) else "?"
    return f"{read.robot}'s ray {read.path[1]} at {degrees}: {what}, distance {ray.get('distance')}"
