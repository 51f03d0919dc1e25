"""Lists that the web platform refuses, found by the package's own inference, which it runs.

It refuses an empty list whose elements have no known type, and a list of lists.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from logica.type_inference.research import infer, reference_algebra

from logical_robots_tui.language import error_messages, tree
from logical_robots_tui.language.adapter import types_on_duckdb
from logical_robots_tui.language.diagnostics import Diagnostic
from logical_robots_tui.language.source_text import Prepared, diagnostic_at
from logical_robots_tui.language.tree import Statement

_COLLECTING = frozenset({"Array", "List", "Set"})
_NESTED = "belongs to a list, but is implied to be"


def refused_lists(program: Sequence[Statement], source: Prepared) -> Iterator[Diagnostic]:
    """Yield a remark for each list of a program that the platform refuses."""
    rules = [each for each in program if isinstance(each, tree.Rule)]
    lists = [node for node in tree.walk(rules) if _is_list(node)]
    empty = {each.span for each in lists if isinstance(each, tree.List) and not each.elements}
    try:
        found = [*types_on_duckdb(rules, source)] if lists else []
    except (infer.TypeErrorCaughtException, *error_messages.COMPLAINTS):
        return  # such as rules of one predicate with different columns
    for span, kind in found:
        if isinstance(kind, reference_algebra.BadType):
            if _NESTED not in str(kind):
                continue
            message = "the web platform has no lists of lists"
            hint = "Put the inner list into a record: [{items: [1]}]."
        elif span in empty and not reference_algebra.IsFullyDefined(kind):
            message = "the web platform can't tell the type of the elements of []"
            hint = "Name the list and say its type: l = [], l ~ [Num]."
        else:
            continue
        length = span.stop - span.start
        yield diagnostic_at(source.original, span.start, length, message, hint, "warning")


def _is_list(node: tree.Node) -> bool:
    if isinstance(node, tree.Aggregate | tree.Aggregation):
        return node.operator in _COLLECTING
    return isinstance(node, tree.List)
