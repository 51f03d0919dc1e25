"""Names that a program compares with what robots sense, and which of them a level has.

A program is compiled without a level, so it tells what it mentions, and `unknown_names` compares
that with a level's names.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from logical_robots_tui.language.diagnostics import Diagnostic, most_similar, printable
from logical_robots_tui.language.types import SENSOR, Kind, ListOf, Plain, RecordOf, Word
from logical_robots_tui.schema import NO_LABEL, OBJECTS, WALL

ROBOT_NAME = Word("robot_name")
LABEL = Word("label")
OBJECT = Word("object")

_WORDS = {"object": OBJECT, "forward_object": OBJECT, "label": LABEL, "forward_label": LABEL}
_MOST_LISTED = 4
_LONGEST = 60  # characters of a name in a message


@dataclass(frozen=True, slots=True)
class Mention:
    """A name that a program compares with a label or with a robot's name.

    Attributes:
        text: The name.
        of: ``label`` or ``robot_name``.
        line: From 1, as in a diagnostic.
        column: From 1.
        excerpt: The text as it is written.
    """

    text: str
    of: str
    line: int
    column: int
    excerpt: str


@dataclass(frozen=True, slots=True)
class Names:
    """The names in a level.

    Attributes:
        robots: Those of its robots.
        others: Those of its beacons and of areas that can be solid.
    """

    robots: frozenset[str] = frozenset()
    others: frozenset[str] = frozenset()


def unknown_names(mentions: Iterable[Mention], names: Names) -> Iterator[Diagnostic]:
    """Yield a warning for each mentioned name that no robot of a level can sense."""
    for each in mentions:
        if each.of == "robot_name":
            known, what = names.robots, "no robot of this level"
        else:
            known = names.robots | names.others | {WALL, NO_LABEL}
            what = "no robot, beacon or solid area of this level"
        if each.text not in known:
            message = f'{what} is called "{printable(each.text[:_LONGEST])}"'
            hint = _hint(each.text, known)
            excerpt = printable(each.excerpt)
            yield Diagnostic(each.line, each.column, message, hint, excerpt, "warning")


def object_hint(text: str) -> str:
    """Return what to write instead of what no ray can hit."""
    return _hint(text, OBJECTS)


def _hint(text: str, known: Iterable[str]) -> str:
    close = most_similar(text, known)
    if close:
        return f'Did you mean "{printable(close[:_LONGEST])}"?'
    *others, last = sorted(f'"{printable(each)}"' for each in known) or [""]
    if not last or len(others) >= _MOST_LISTED or sum(map(len, known)) > _LONGEST:
        return "Compare it with the names in the labyrinth."
    return f"It can be {', '.join(others)} or {last}." if others else f"It can be {last}."


def with_words(kind: Kind) -> Kind:
    """Return a type of the schema with the texts told apart that are words."""
    if isinstance(kind, ListOf):
        return ListOf(with_words(kind.element), kind.title)
    if isinstance(kind, RecordOf):
        fields = (
            (n, _WORDS.get(n, k) if k is Plain.TEXT else with_words(k)) for n, k in kind.fields
        )
        return RecordOf(tuple(fields), kind.title, kind.names)
    return kind


SENSED = with_words(SENSOR)
"""A sensor whose objects and labels are words."""
