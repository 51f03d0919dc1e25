"""Between the typed tree and the nodes of the `logica` package; nothing else knows these nodes.

`parse` reads a program statement by statement, so that every error is found. `to_package` gives
back what the package's compiler takes, with the places that its messages need.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

from logica.parser_py import parse as parser
from logica.type_inference.research import infer, reference_algebra

from logical_robots_tui.language import error_messages, tree
from logical_robots_tui.language.diagnostics import MOST_DIAGNOSTICS, Diagnostic
from logical_robots_tui.language.package_patches import deep_copy
from logical_robots_tui.language.source_text import (
    Prepared,
    nesting,
    original_text,
    statements,
    with_whole_brackets,
)
from logical_robots_tui.language.tree import Name, Span, Statement
from logical_robots_tui.schema import VALUE

Raw: TypeAlias = dict[str, Any]
"""A node of the package."""

_NAME = re.compile(r"[A-Z]\w*")
_PREDICATE = re.compile(r"`[^`]*`|\w+")
_OPERATOR = re.compile(r"(?:^|;)\s*(?:-[-+*/%^]-|[\u25c7\u25cb\u2661\u2295\u2297])\s*\(")
_BESIDE_HEAD = re.compile(r"(?<=[\s)])(order_by|limit)\([^()]*\)")
_ANNOTATIONS = {"limit": "@Limit", "order_by": "@OrderBy"}
_MODALITIES = ("couldbe_denoted", "cantbe_denoted", "shouldbe_denoted")
_LITERALS = {
    "the_number": ("number", tree.Number),
    "the_string": ("the_string", tree.Text),
    "the_bool": ("the_bool", tree.Boolean),
    "the_null": ("the_null", tree.Null),
}
_KEYS = {kind: (outer, inner) for outer, (inner, kind) in _LITERALS.items()}


_NOWHERE = Prepared("", "", "", ())


@dataclass(frozen=True, slots=True)
class Parsed:
    """The parsed part of a program.

    Attributes:
        statements: As written, in the order of the text.
        problems: Errors in the statements that could not be parsed.
        doubtful: Names in those statements, about which nothing is known.
        source: The text that was parsed.
        excess: Errors that are not among the problems, because they are too many.
    """

    statements: list[Statement]
    problems: list[Diagnostic]
    doubtful: frozenset[str]
    source: Prepared
    excess: int


def parse(source: Prepared) -> Parsed:
    """Parse every statement that can be parsed."""
    # Certain words enable user-defined operators in the package, for the rest of the process.
    parser.TOO_MUCH = "fun" if _OPERATOR.search(source.skeleton) else "too much"
    parser.EnactIncantations(source.original)
    trees: list[Statement] = []
    problems, excess = list(source.problems), source.excess
    doubtful: set[str] = set()
    broken = sorted(source.broken)
    for start, end in statements(source):
        if bisect_left(broken, start) == bisect_left(broken, end):
            try:
                text, annotations = _take_head_annotations(source, start, end)
                trees += _parse_statement(source._replace(text=text), start, end)
                trees += [a for a in annotations if a not in trees]
                continue
            except error_messages.COMPLAINTS as error:
                if len(problems) < MOST_DIAGNOSTICS:
                    problems.append(error_messages.explain(error, source, (start, end)))
                else:
                    excess += 1
        doubtful.update(_NAME.findall(source.skeleton[start:end]))
    return Parsed(trees, problems, frozenset(doubtful), source, excess)


def parse_proposition(source: Prepared) -> tree.Proposition:
    """Parse a body; raise an exception of the package's if that fails."""
    text = parser.Strip(parser.HeritageAwareString(source.text))
    return _TreeReader(source).proposition(parser.ParseProposition(text))


def parse_expression(source: Prepared) -> tree.Expression:
    """Parse an expression; raise an exception of the package's if that fails."""
    text = parser.Strip(parser.HeritageAwareString(source.text))
    return _TreeReader(source).expression(parser.ParseExpression(text))


def parse_trusted(text: str) -> tuple[Statement, ...]:
    """Parse a text of our own, without places."""
    reader = _TreeReader(_NOWHERE)
    return tuple(map(reader.statement, parser.ParseFile(text)["rule"]))


def is_rule(source: Prepared) -> bool:
    """Return whether a text has the sign of a rule or of a functor outside of brackets."""
    text = parser.HeritageAwareString(source.text)
    return any(len(parser.Split(text, sign)) > 1 for sign in (":-", ":="))


def _take_head_annotations(source: Prepared, start: int, end: int) -> tuple[str, list[Statement]]:
    """Blank ``order_by(...)`` and ``limit(...)`` of a head; return the text and the annotations.

    These are ``@OrderBy(P, ...)`` and ``@Limit(P, ...)``.
    """
    text, annotations = source.text, list[tree.Statement]()
    rule = source.skeleton.find(":-", start, end)
    predicate = _PREDICATE.match(source.text, start)
    for word in _BESIDE_HEAD.finditer(source.skeleton, start, end if rule < 0 else rule):
        if predicate is None or nesting(source.skeleton[start : word.start()]):
            continue
        place, stop = word.span()
        argument_text = source.text[word.end(1) + 1 : stop - 1]
        annotation = f"{_ANNOTATIONS[word[1]]}({predicate.group()}, {argument_text})"
        reader = _TreeReader(_NOWHERE, whole=Span(place, stop))
        raw = parser.ParseRule(parser.HeritageAwareString(annotation))
        annotations.append(reader.statement(raw))
        text = f"{text[:place]}{' ' * (stop - place)}{text[stop:]}"
    return text, annotations


def _parse_statement(source: Prepared, start: int, end: int) -> Iterator[Statement]:
    statement = parser.HeritageAwareString(source.text[start:end])
    statement.start, statement.stop, statement.heritage = start, end, source.text
    if function := parser.ParseFunctionRule(statement):
        # The package reads ``head --> value`` as a text of its own, ``head = value``.
        head, value = parser.SplitRaw(statement, "-->")
        middle, shift = len(head), value.start - len(head) - len(" = ")
        rule = f"{head} = {value}"
        reader = _TreeReader(
            source._replace(text=rule),
            lambda offset: offset + (head.start if offset <= middle else shift),
            Span(start, end),
        )
        yield from map(reader.statement, function)
        return
    reader = _TreeReader(source)
    yield reader.statement(parser.ParseFunctorRule(statement) or parser.ParseRule(statement))


# -- from the package ----------------------------------------------------------------------------


class _TreeReader:
    """Makes typed nodes.

    Args:
        source: Its text is the one whose pieces the package's nodes are.
        place: The offset in the program of an offset in the text.
        whole: The span of the statement, if it is not a piece of the text.
    """

    def __init__(
        self, source: Prepared, place: Callable[[int], int] | None = None, whole: Span | None = None
    ) -> None:
        self._text, self._skeleton = source.text, source.skeleton
        self._place, self._whole = place, whole

    def statement(self, raw: Raw) -> Statement:
        head = raw["head"]
        name = self._name(head["predicate_name"])
        arguments = self._arguments(head["record"])
        span = self._span(raw["full_text"]) or self._whole
        if name == "@Make":
            copy, base, replacements = (argument.value for argument in arguments)
            assert isinstance(copy, tree.PredicateName)
            assert isinstance(base, tree.PredicateName)
            assert isinstance(replacements, tree.Record)
            return tree.Functor(copy.name, base.name, replacements.arguments, span=span)
        if name.startswith("@"):
            return tree.Annotation(name, arguments, span=span)
        return tree.Rule(
            tree.Head(name, arguments, span=self._joint_span([name], arguments)),
            self.proposition(raw["body"]) if "body" in raw else None,
            raw.get("distinct_denoted", False),
            tuple(modality for modality in _MODALITIES if raw.get(modality)),
            span=span,
        )

    def proposition(self, raw: Raw) -> tree.Proposition:
        if "conjunction" in raw:
            parts = map(self.proposition, raw["conjunction"]["conjunct"])
            # The package compiles no conjunction inside another in an aggregate.
            members = tuple(part for member in parts for part in tree.conjuncts(member))
            return tree.Conjunction(members, span=self._joint_span([], members))
        if "disjunction" in raw:
            members = tuple(map(self.proposition, raw["disjunction"]["disjunct"]))
            return tree.Disjunction(members, span=self._joint_span([], members))
        if "inclusion" in raw:
            collection = self.expression(raw["inclusion"]["list"])
            element = self.expression(raw["inclusion"]["element"])
            span = self._joint_span([], [collection, element])
            return tree.Membership(collection, element, span=span)
        if "unification" in raw:
            pair = raw["unification"]
            left = self.expression(pair["left_hand_side"])
            right = self.expression(pair["right_hand_side"])
            return tree.Equation(left, right, span=self._joint_span([], [left, right]))
        name = self._name(raw["predicate"]["predicate_name"])
        arguments = self._arguments(raw["predicate"]["record"])
        return tree.Atom(name, arguments, span=self._joint_span([name], arguments))

    def expression(self, raw: Raw) -> tree.Expression:
        span = self._span(raw.get("expression_heritage"))
        if "literal" in raw:
            return self._literal(raw["literal"], span)
        if "variable" in raw:
            return tree.Variable(self._name(raw["variable"]["var_name"]), span=span)
        if "call" in raw:
            name = self._name(raw["call"]["predicate_name"])
            arguments = self._arguments(raw["call"]["record"])
            return tree.Call(name, arguments, span=span or self._joint_span([name], arguments))
        if "subscript" in raw:
            record = self.expression(raw["subscript"]["record"])
            field = self._name(raw["subscript"]["subscript"]["literal"]["the_symbol"]["symbol"])
            return tree.FieldAccess(record, field, span=span)
        if "record" in raw:
            return tree.Record(self._arguments(raw["record"]), span=span)
        if "implication" in raw:
            pairs = raw["implication"]["if_then"]
            parts = ((branch["condition"], branch["consequence"]) for branch in pairs)
            branches = tuple(tree.Branch(*map(self.expression, pair)) for pair in parts)
            otherwise = self.expression(raw["implication"]["otherwise"])
            return tree.Choice(branches, otherwise, span=span)
        return self._aggregate(raw["combine"], span)

    def _aggregate(self, raw: Raw, span: Span | None) -> tree.Aggregate:
        aggregation = raw["head"]["record"]["field_value"][0]["value"]["aggregation"]
        argument = self.expression(aggregation["argument"])
        return tree.Aggregate(
            self._name(aggregation["operator"]),
            argument,
            self.proposition(raw["body"]) if "body" in raw else None,
            is_denial=isinstance(argument, tree.Number) and argument.span is None,
            span=span or self._span(raw["full_text"]),
        )

    def _literal(self, raw: Raw, span: Span | None) -> tree.Expression:
        ((key, inner),) = raw.items()
        if key == "the_list":
            return tree.List(tuple(map(self.expression, inner["element"])), span=span)
        if key == "the_predicate":
            return tree.PredicateName(self._name(inner["predicate_name"]), span=span)
        inner_key, kind = _LITERALS[key]
        return kind(original_text(str(inner[inner_key])), span=span)

    def _arguments(self, record: Raw) -> tuple[tree.Argument, ...]:
        arguments: list[tree.Argument] = []
        for raw in record["field_value"]:
            field = raw["field"] if isinstance(raw["field"], int) else self._name(raw["field"])
            value: tree.Expression | tree.Aggregation
            if "aggregation" in raw["value"]:
                aggregation = raw["value"]["aggregation"]
                operator = aggregation["operator"]
                argument = self.expression(aggregation["argument"])
                span = self._span(aggregation["expression_heritage"])
                value = tree.Aggregation(self._name(operator), argument, span=span)
            else:
                value = self.expression(raw["value"]["expression"])
            arguments.append(tree.Argument(field, value, span=self._joint_span([field], [value])))
        return tuple(arguments)

    def _name(self, piece: str) -> Name:
        span = self._span(piece)
        return Name(piece, -1 if span is None else span.start)

    def _span(self, piece: Any) -> Span | None:
        if type(piece) is not parser.HeritageAwareString or piece.heritage != self._text:
            return None
        if self._place is None:
            return Span(piece.start, piece.stop)
        return Span(self._place(piece.start), self._place(piece.stop))

    def _joint_span(self, names: Iterable[object], nodes: Iterable[tree.Node]) -> Span | None:
        """Return the span of names and the nodes beside them, with whole brackets."""
        spans = [Span(n.start, n.start + len(n)) for n in names if isinstance(n, Name)]
        spans = [span for span in spans if span.start >= 0]
        spans += [node.span for node in nodes if node.span]
        if not spans:
            return None
        start, stop = min(s.start for s in spans), max(s.stop for s in spans)
        return Span(*with_whole_brackets(self._skeleton, start, stop))


# -- to the package ------------------------------------------------------------------------------


def to_package(program: Iterable[Statement], source: Prepared) -> list[Raw]:
    """Return statements as the package compiles them, without disjunctions."""
    rules: Any = [*map(_Writer(source.text).statement, program)]
    rules = parser.DisjunctiveNormalForm.Rewrite(rules)
    rules = parser.MultiBodyAggregation.Rewrite(rules)
    nodes: list[Raw] = parser.AggergationsAsExpressions.Rewrite(rules)
    return nodes


class _Writer:
    """Makes nodes of the package; no two share a part."""

    def __init__(self, text: str) -> None:
        self._text = text

    def statement(self, node: Statement) -> Raw:
        text = self._piece(node.span)
        if isinstance(node, tree.Functor):
            name, base = tree.PredicateName(node.name), tree.PredicateName(node.base)
            replacements = tree.Record(node.arguments)
            return self._rule("@Make", tree.arguments({0: name, 1: base, 2: replacements}), text)
        if isinstance(node, tree.Annotation):
            return self._rule(node.name, node.arguments, text)
        rule = self._rule(
            node.name, node.head.columns, text or parser.HeritageAwareString(node.name)
        )
        if node.is_distinct:
            rule["distinct_denoted"] = True
        rule |= dict.fromkeys(node.modalities, True)
        if node.body is not None:
            rule["body"] = self._body(node.body)
        return rule

    def _rule(self, name: str, arguments: Iterable[tree.Argument], text: str) -> Raw:
        head = {"predicate_name": name, "record": self._record(arguments)}
        return {"head": head, "full_text": text}

    def _body(self, node: tree.Proposition) -> Raw:
        if isinstance(node, tree.Conjunction):
            return {"conjunction": {"conjunct": [*map(self._body, node.members)]}}
        if isinstance(node, tree.Disjunction):
            return {"disjunction": {"disjunct": [*map(self._body, node.alternatives)]}}
        if isinstance(node, tree.Membership):
            collection, element = map(self._expression, (node.collection, node.element))
            return {"inclusion": {"list": collection, "element": element}}
        if isinstance(node, tree.Equation):
            left, right = map(self._expression, (node.left, node.right))
            return {"unification": {"left_hand_side": left, "right_hand_side": right}}
        assert isinstance(node, tree.Atom)
        record = self._record(node.arguments)
        return {"predicate": {"predicate_name": node.name, "record": record}}

    def _expression(self, node: tree.Expression) -> Raw:
        return {**self._content(node), "expression_heritage": self._piece(node.span)}

    def _content(self, node: tree.Expression) -> Raw:
        if isinstance(node, tree.Literal):
            outer, inner = _KEYS[type(node)]
            return {"literal": {outer: {inner: node.value}}}
        if isinstance(node, tree.Variable):
            return {"variable": {"var_name": node.name}}
        if isinstance(node, tree.Call):
            record = self._record(node.arguments)
            return {"call": {"predicate_name": node.name, "record": record}}
        if isinstance(node, tree.FieldAccess):
            symbol = {"literal": {"the_symbol": {"symbol": node.field}}}
            return {"subscript": {"record": self._expression(node.record), "subscript": symbol}}
        if isinstance(node, tree.Record):
            return {"record": self._record(node.arguments)}
        if isinstance(node, tree.List):
            return {"literal": {"the_list": {"element": [*map(self._expression, node.elements)]}}}
        if isinstance(node, tree.PredicateName):
            return {"literal": {"the_predicate": {"predicate_name": node.name}}}
        if isinstance(node, tree.Choice):
            parts = [map(self._expression, (b.condition, b.value)) for b in node.branches]
            pairs = [{"condition": condition, "consequence": value} for condition, value in parts]
            otherwise = self._expression(node.otherwise)
            return {"implication": {"if_then": pairs, "otherwise": otherwise}}
        assert isinstance(node, tree.Aggregate)
        value = tree.Aggregation(node.operator, node.argument, span=node.span)
        combine = self._rule("Combine", [tree.Argument(VALUE, value)], self._piece(node.span))
        combine["distinct_denoted"] = True
        if node.body is not None:
            body = self._body(node.body)
            is_whole = isinstance(node.body, tree.Conjunction)
            combine["body"] = body if is_whole else {"conjunction": {"conjunct": [body]}}
        return {"combine": combine}

    def _record(self, arguments: Iterable[tree.Argument]) -> Raw:
        fields: list[Raw] = []
        for argument in arguments:
            field: Raw = {"field": argument.field, "value": self._value(argument.value)}
            if argument.field == tree.REST and fields:
                names = (raw["field"] for raw in fields)
                field["except"] = [f"col{n}" if isinstance(n, int) else n for n in names]
            fields.append(field)
        return {"field_value": fields}

    def _value(self, node: tree.Expression | tree.Aggregation) -> Raw:
        if isinstance(node, tree.Expression):
            return {"expression": self._expression(node)}
        argument, piece = self._expression(node.argument), self._piece(node.span)
        raw = {"operator": node.operator, "argument": argument, "expression_heritage": piece}
        return {"aggregation": raw}

    def _piece(self, span: Span | None) -> str:
        if span is None:
            return ""
        piece: Any = parser.HeritageAwareString(self._text[span.start : span.stop])
        piece.start, piece.stop, piece.heritage = *span, self._text
        text: str = piece
        return text


def types_on_duckdb(program: Iterable[Statement], source: Prepared) -> list[tuple[Span, Any]]:
    """Return the spans of expressions, with the types that the package infers for DuckDB.

    There are none if it gives up, as for rules of one predicate with different columns.
    """
    nodes: list[Raw] = []
    try:
        rules = to_package(program, source)
        engine = infer.TypesInferenceEngine(rules, "duckdb")
        target, operand = (reference_algebra.TypeReference("Any") for _ in range(2))
        engine.predicate_signature["TryCast"] = {0: operand, 1: target, VALUE: target}
        engine.InferTypes()
        infer.Walk(rules, nodes.append)
    except (infer.TypeErrorCaughtException, *error_messages.COMPLAINTS):
        return []
    typed = (node for node in nodes if "type" in node)
    places: Iterable[tuple[Any, Any]] = ((n.get("expression_heritage"), n["type"]) for n in typed)
    return [
        (Span(place.start, place.stop), reference_algebra.VeryConcreteType(kind["the_type"]))
        for place, kind in places
        if hasattr(place, "start")
    ]


# -- in the package's own compiler ---------------------------------------------------------------


def tie_pair(rule: Raw, variable: str) -> Raw | None:
    """Tie the pair that an aggregating rule collects to a subquery, side by side.

    Args:
        rule: What the package makes of an aggregate.
        variable: A variable that has the value 0 in the subquery only.

    Returns:
        Another rule, or None if this one does not collect ``argument -> value``.
    """
    rule = deep_copy(rule)
    value = rule["head"]["record"]["field_value"][0]["value"]
    argument = value["aggregation"]["expression"]["call"]["record"]["field_value"][0]["value"]
    pair = argument.get("expression", {}).get("call")
    if not pair or pair["predicate_name"] != "->":
        return None
    writer = _Writer("")
    tie = tree.Variable(variable)
    for side in pair["record"]["field_value"]:
        entangled = writer._expression(tree.call("MagicalEntangle", tie, tie))
        entangled["call"]["record"]["field_value"][0]["value"] = side["value"]
        side["value"] = {"expression": entangled}
    body = rule.setdefault("body", {"conjunction": {"conjunct": []}})
    zero = tree.Membership(tree.List((tree.Number("0"),)), tie)
    body["conjunction"]["conjunct"].append(writer._body(zero))
    return rule


def operator_name(operator: str) -> str:
    """Return the function that an aggregating operator stands for."""
    name: str = parser.AggergationsAsExpressions.AggregationOperator(operator)
    return name
