"""Values and questions as Logica writes them."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from decimal import Decimal
from typing import TYPE_CHECKING

from logical_robots_tui.schema import VALUE
from logical_robots_tui.values import Value

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.explanation import Ask


def spell(value: Value) -> str:
    """Return a value as Logica writes it, in one line."""
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{name}: {spell(each)}' for name, each in value.items())}}}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(spell, value))}]"
    if isinstance(value, float) and math.isfinite(value):
        return f"{value:.0f}" if value.is_integer() else format(Decimal(repr(value)), "f")
    return json.dumps(value, ensure_ascii=False)


def spell_call(asked: Ask) -> str:
    """Return a question as a call: ``Speed(200)``, ``Kind(object: "wall")``, ``F(1) == 2``."""
    given = dict(asked.given)
    result = f" == {spell(given.pop(VALUE))}" if VALUE in given else ""
    arguments = []
    for place, (column, value) in enumerate(given.items()):
        is_in_place = column == f"col{place}"
        name = column.removeprefix("col") if column[3:].isdigit() else column
        arguments.append(spell(value) if is_in_place else f"{name}: {spell(value)}")
    return f"{asked.predicate}({', '.join(arguments)}){result}"
