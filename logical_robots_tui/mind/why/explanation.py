"""The answer to "why?": what each part of each rule gave at one tick."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.mind.why.probing import Inside, Part, RuleParts, Side
    from logical_robots_tui.values import Value

__all__ = ["Ask", "Explanation", "InsideFound", "PartFound", "RuleFound"]


@dataclass(frozen=True, slots=True)
class Ask:
    """A predicate that a part asked, and with what: the question one step deeper.

    Attributes:
        predicate: Its name.
        given: The arguments that it was asked with, by the names of its columns.
        within: The predicate made with ``:=`` in whose rules it stands, or "".
    """

    predicate: str
    given: Mapping[str, Value]
    within: str = ""


@dataclass(frozen=True, slots=True)
class PartFound:
    """What a part of a rule gave.

    Attributes:
        part: The part.
        ways: In how many ways all parts up to this one hold; None if that could not be asked.
        elsewhere: In how many they hold for another robot or for other arguments, if in none here.
        sides: What it compares or asks with, and up to a few values of each.
        new: Values of the variables that it gives a value, in the first way.
        asked: The predicates of the program that it asked.
        inside: The parts within it.
        problem: Why it could not be asked, or "".
    """

    part: Part
    ways: int | None
    elsewhere: int = 0
    sides: tuple[tuple[Side, tuple[Value, ...]], ...] = ()
    new: Mapping[str, Value] = field(default_factory=dict)
    asked: tuple[Ask, ...] = ()
    inside: tuple[InsideFound, ...] = ()
    problem: str = ""

    @property
    def holds(self) -> bool:
        """Whether there is a way in which all parts up to this one hold."""
        return self.ways is None or self.ways > 0


@dataclass(frozen=True, slots=True)
class InsideFound:
    """What the parts within a part gave.

    Attributes:
        inside: The parts.
        found: What they gave, up to the first that does not hold.
    """

    inside: Inside
    found: tuple[PartFound, ...]

    @property
    def ways(self) -> int | None:
        """In how many ways all of them hold."""
        return self.found[-1].ways if self.found else None


@dataclass(frozen=True, slots=True)
class RuleFound:
    """What a rule gave.

    Attributes:
        rule: The rule.
        rows: How many rows, before those that are alike become one; None if it failed.
        examples: A few of them, by the names of the columns.
        found: What its parts gave, up to the first that does not hold.
        fixed: Fixed values of its head that are not those asked for, by the names of the columns:
            the rule is about something else.
        problem: Why it could not be asked, or "".
    """

    rule: RuleParts
    rows: int | None
    examples: tuple[Mapping[str, Value], ...] = ()
    found: tuple[PartFound, ...] = ()
    fixed: Mapping[str, Value] = field(default_factory=dict)
    problem: str = ""

    @property
    def stopped_by(self) -> PartFound | None:
        """The first part that does not hold, or None if the rule gave a row."""
        return next((each for each in self.found if not each.holds), None)


@dataclass(frozen=True, slots=True)
class Explanation:
    """Why a predicate has the rows that it has for a robot, or none.

    Attributes:
        predicate: Its name.
        robot: In whose reasoning.
        made_from: The predicate whose rules these are, or "".
        within: The predicate made with ``:=`` whose fillings-in hold here, or "".
        given: The arguments that were asked for, by the names of the columns.
        rules: What each rule gave, in the order of the text.
    """

    predicate: str
    robot: str
    made_from: str
    within: str
    given: Mapping[str, Value]
    rules: tuple[RuleFound, ...]
