"""Asking why, for tests."""

from contextlib import closing
from typing import Any

from logical_robots_tui.explain import Ask, Explainer, Explanation, Proof, ProofNode
from logical_robots_tui.explain.why.explanation import RuleOutcome
from logical_robots_tui.mind import Mind, Program
from tests.mind.rows import row

REST = """
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "") :- Sensor(robot_name:);
"""
"""A rule that makes a program of any rules; `why` and `proof` add it where there is none."""


def _mind(text: str, **visibility: Any) -> closing[Mind]:
    text = text if "Robot(" in text else f"{text}{REST}"
    return closing(Mind(Program.compile(text), **visibility))


def why(
    text: str,
    predicate: str = "Robot",
    robot: str = "Ada",
    *,
    rows: list[Any] | None = None,
    memories: dict[str, Any] | None = None,
    given: dict[str, Any] | None = None,
    within: str = "",
    **visibility: Any,
) -> Explanation:
    with _mind(text, **visibility) as mind:
        explainer = Explainer(mind, robot, rows or [row("Ada")], memories or {})
        return explainer.why(Ask(predicate, given or {}, within))


def proof(text: str, predicate: str = "Robot", *, depth: int = 100, **given: Any) -> Proof:
    with _mind(text) as mind:
        return Explainer(mind, "Ada", [row("Ada")], {}).proof(Ask(predicate, given), depth=depth)


def the_rule(text: str, predicate: str = "Robot", **asked: Any) -> RuleOutcome:
    (rule,) = why(text, predicate, **asked).rules
    return rule


def stop(rule: RuleOutcome) -> ProofNode:
    assert rule.stopped_by is not None
    return rule.stopped_by


def asked(node: ProofNode) -> Ask:
    assert node.query is not None
    return node.query


def find(node: ProofNode, text: str) -> ProofNode:
    return next(each for _, each in node.walk() if each.text.startswith(text))


def texts(nodes: tuple[ProofNode, ...]) -> list[str]:
    return [node.text for node in nodes]


def below(node: ProofNode, kind: str) -> list[ProofNode]:
    return [each for _, each in node.walk() if each.kind == kind]
