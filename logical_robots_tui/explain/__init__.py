"""What a program did and why: proofs, refutations, nearest misses, origins, and diagnoses.

All of it is read from the clauses of the program: one for each choice of alternatives of a rule,
with one query, each row of which is one derivation.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.later import lazy_exports

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.explainer import Explainer
    from logical_robots_tui.explain.why.explanation import Ask, Explanation, Proof, ProofNode

__all__ = ["Ask", "Explainer", "Explanation", "Proof", "ProofNode"]

__getattr__ = lazy_exports(
    __name__,
    {"why.explainer": "Explainer", "why.explanation": "Ask Explanation Proof ProofNode"},
)
