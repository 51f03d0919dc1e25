"""What one robot thinks at one moment, explained: rows, proofs, calls, sources of values."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.mind.diagnostics import QueryError
from logical_robots_tui.mind.failures import FailureError
from logical_robots_tui.mind.table import Table
from logical_robots_tui.mind.why.calling import calls_of
from logical_robots_tui.mind.why.derivations import Derivations
from logical_robots_tui.mind.why.deriving import shown
from logical_robots_tui.mind.why.nearest import Nearest
from logical_robots_tui.mind.why.proving import Prover
from logical_robots_tui.mind.why.sourcing import source_of
from logical_robots_tui.mind.why.unfolding import unfold

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.mind.limits import Limits
    from logical_robots_tui.mind.program import Program
    from logical_robots_tui.mind.sqlite.moment import Within
    from logical_robots_tui.mind.why.explanation import Explanation
    from logical_robots_tui.mind.why.nearest import Suggestion
    from logical_robots_tui.mind.why.probing import Probing, Span
    from logical_robots_tui.mind.why.relations import Relations
    from logical_robots_tui.mind.why.sourcing import Made, Path
    from logical_robots_tui.mind.why.unfolding import Proof
    from logical_robots_tui.values import Value

__all__ = ["Explainer"]


class Explainer:
    """Explains what one robot thinks at one moment.

    Every question may raise `Stopped`.

    Args:
        program: What it thinks.
        relations: The rows of predicates then.
        robot: Name of the robot.
        limits: Bounds on compiling and on results.
        within: The budget of each question; decomposing predicates does not count.
    """

    def __init__(
        self,
        program: Program,
        relations: Relations,
        robot: str,
        limits: Limits,
        within: Within,
    ) -> None:
        self._program, self._robot = program, robot
        self._limits, self._within = limits, within
        self._derivations = Derivations(relations, robot, self._decompose)
        self._prover = Prover(self._derivations)

    def why(
        self,
        predicate: str = "Robot",
        given: Mapping[str, Value] | None = None,
        within: str = "",
    ) -> Explanation:
        """Return why a predicate has the rows that it has, or none.

        Args:
            predicate: One of the program's own.
            given: Values of some of its columns, where only rows with these are meant; by default
                the robot's name where there is a column ``robot_name``.
            within: A predicate made with ``:=`` in whose copy of the rules it is asked, or "".

        Raises:
            QueryError: There is no such predicate or column, a function was asked without its
                arguments, or it failed.
        """
        return self._prover.explain(predicate, self._about(predicate, given, within), within)

    def proof(
        self,
        predicate: str = "Robot",
        given: Mapping[str, Value] | None = None,
        within: str = "",
        *,
        depth: int = 100,
        nodes: int = 10_000,
    ) -> Proof:
        """Return the whole proof of a row, down to what was sensed and remembered.

        Args:
            predicate: As for `why`.
            given: Values of some of its columns; the first row with these is proved.
            within: As for `why`.
            depth: How many predicates deep.
            nodes: Where unfolding ends.

        Raises:
            QueryError: As `why` does.
        """
        given = self._about(predicate, given, within)
        return unfold(self._prover, predicate, given, within, depth=depth, nodes=nodes)

    def nearest(self, predicate: str = "Robot") -> list[tuple[Span, Suggestion]]:
        """Return the single changes that would have given a rule a row.

        Args:
            predicate: One of the program's own.

        Returns:
            Pairs of a rule without a row and a change; the smallest change of a rule first.

        Raises:
            QueryError: As `why` does.
        """
        given = self._about(predicate, None, "")
        nearest = Nearest(self._program, self._derivations, given, self._limits)
        probing = self._decompose(predicate, "")
        return [(rule.span, each) for rule in probing.rules for each in nearest.of(probing, rule)]

    def calls(self, function: str) -> Table:
        """Return the calls of a function: arguments and results, each once.

        Args:
            function: A function of the program's own.

        Raises:
            QueryError: There is no such function, or a rule that calls it failed.
        """
        known = self._program.predicate(function)
        if known is None or not known.is_function:
            raise QueryError(f"{function} is not a function of this program.")
        self._within.renew()
        uses = self._program.uses
        callers = {
            name: [p for p, used in uses.items() if name in used and p != name] for name in uses
        }
        most = self._limits.rows
        try:
            columns, found = calls_of(function, callers, self._derivations, most + 1)
        except FailureError as failure:
            raise QueryError(f"The calls of {function} can't be told: {failure}.") from None
        return Table(tuple(map(shown, columns)), tuple(found[:most]), truncated=len(found) > most)

    def source(self, path: Path) -> Made:
        """Return where a part of the memory comes from that the robot has afterwards.

        Args:
            path: The part: names of fields and places in lists; () for the whole memory.

        Raises:
            QueryError: There is no such part, or how it came about can't be told.
        """
        self._within.renew()
        row = {"robot_name": self._robot}
        return source_of(self._derivations, "Robot", row, "memory", path)

    def _decompose(self, predicate: str, within: str) -> Probing:
        stop = self._within.stop
        return self._program.decompose(predicate, within, stop=stop, limits=self._limits)

    def _about(
        self, predicate: str, given: Mapping[str, Value] | None, within: str
    ) -> Mapping[str, Value]:
        """Return the given values, with the robot's name unless another one is given."""
        self._within.renew()
        probing = self._decompose(predicate, within)
        given = {} if given is None else given
        if "robot_name" in probing.columns and "robot_name" not in probing.given:
            return {"robot_name": self._robot, **given}
        return given
