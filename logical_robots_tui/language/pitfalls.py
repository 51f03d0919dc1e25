"""Code that compiles but means something else than it seems to say."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from logical_robots_tui.language import tree
from logical_robots_tui.language.definitions import (
    Model,
    calls,
    is_built_in,
    reach,
    rules_of,
)
from logical_robots_tui.language.diagnostics import (
    MULTIPLIES,
    Diagnostic,
    Proposal,
    distance,
)
from logical_robots_tui.language.error_messages import END_MISSING, NOT_IN_HEAD
from logical_robots_tui.language.source_text import with_whole_brackets
from logical_robots_tui.language.tree import Expression, Infix, Node, Span, infix_of
from logical_robots_tui.schema import INPUTS, VALUE

_CLOSED = re.compile(r"\s*\)")
_MOST_ALTERNATIVES = 64  # of a body
_LONGEST = 100  # characters of a piece of the program in a message or hint
_SENSED_TEXTS = frozenset({"forward_label", "forward_object", "label", "object"})
_UNEQUAL = ("/", "\\", "~")  # before a '=' in other languages
_OVER_ROWS = {"Avg": "Avg", "Count": "Count", "Max": "Max", "Min": "Min", "Sum": "Sum", "+": "Sum"}

CALLED_AGGREGATE = "(...) aggregates a single value"
"""The end of the message about an aggregate that is called; a condition can't compute it."""


def pitfalls(model: Model) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each such place.

    Above all, ``a = b < c`` is ``(a = b) < c``: of the operators, the parser reads `=` before
    comparisons, `&&`, `||` and `->`. The value of an equation is that of its right side.
    """
    finder = _Finder(model)
    for rule in model.rules:
        yield from finder.diagnose(rule)
    yield from _own_negations(model)
    yield from _growing_recursions(model)
    yield from _stops_with_limits(model)
    yield from _ignored_types(model)


class _Finder:
    def __init__(self, model: Model) -> None:
        self._model, self._text, self._skeleton = model, model.text, model.source.skeleton
        predicates = model.definitions
        self._truths = {name for name, rules in predicates.items() if all(map(_is_truth, rules))}
        self._columns: dict[str, Iterable[int | str]] = {
            **INPUTS,
            **{
                name: [c.field for r in rules_of(e) for c in r.head.columns]
                for name, e in predicates.items()
            },
        }

    def diagnose(self, rule: tree.Rule) -> Iterator[Diagnostic]:
        body_uses = _mentions(tree.conjuncts(rule.body))
        rule_uses = body_uses + _mentions(rule.head)
        for column in rule.head.columns if rule.body is not None else ():
            name = tree.variable_of(column.value)
            if name and rule_uses[name] == 1 and column.value.span is not None:
                message = f"No condition gives {name} a value, so every value matches"
                hint = f"Say what it is in the body, {name} = ..., or leave it out of the head."
                yield self._warning(column.value.span, message, hint)
        marked: set[int] = set()  # nodes that a diagnostic covers
        for node, is_test in _in_tests(rule):
            if id(node) in marked:
                continue
            infix = infix_of(node)
            if infix is not None and node.span is not None:
                loose = self._loose_nodes(node, "=", marked) if infix.operator != "=" else []
                if loose:
                    yield self._read_first(node, node.span, loose, is_test=is_test)
                elif infix.operator in tree.JUNCTIONS and (
                    pairs := self._loose_nodes(node, "->", marked)
                ):
                    yield self._read_first(node, node.span, pairs, is_test=False)
                elif infix.operator == "=" and is_test:
                    yield self._no_comparison(node.span, [node])
                elif infix.operator in ("=", "==", "!="):
                    yield from self._check_comparison(node, node.span, infix, body_uses, rule_uses)
            yield from self._named_with_equals(node)
            yield from self._unnamed_fields(node)
            yield from self._misused_values(node)
            yield from self._unknown_sign(node)
        for node in tree.walk(tree.conjuncts(rule.body)):
            yield from self._called_aggregate(node)

    # -- '=' and '->' beside operators that are read later -----------------------------------------

    def _loose_nodes(self, node: Node, operator: str, marked: set[int]) -> list[Node]:
        """Return the operations in a node that have no parentheses; mark them and their parents."""
        infix = infix_of(node)
        operations: list[Node] = []
        for side in infix.sides if infix else ():
            inner = infix_of(side)
            if inner is None or side.span is None or self._has_parentheses(side.span):
                continue
            is_loose = inner.operator == operator
            loose = [side] if is_loose else self._loose_nodes(side, operator, marked)
            if loose:
                marked.add(id(side))
            operations += loose
        return operations

    def _has_parentheses(self, span: Span) -> bool:
        offset = span.start - 1
        while offset > 0 and self._skeleton[offset].isspace():
            offset -= 1
        return (
            self._skeleton[offset] == "(" and _CLOSED.match(self._skeleton, span.stop) is not None
        )

    def _read_first(
        self, node: Node, span: Span, loose: Sequence[Node], *, is_test: bool
    ) -> Diagnostic:
        outer, inner = infix_of(node), infix_of(loose[0])
        assert outer is not None
        assert inner is not None
        operations = filter(None, map(infix_of, tree.walk(node)))
        parent = next(o for o in operations if any(side is loose[0] for side in o.sides))
        is_junction = outer.operator in tree.JUNCTIONS
        is_value = isinstance(inner.right, tree.Number | tree.Text) and (
            parent.operator in tree.JUNCTIONS
        )
        is_named = isinstance(inner.left, tree.Variable)
        is_first = loose[0].span is not None and loose[0].span.start <= span.start
        if inner.operator == "=" and (
            is_test or (is_junction and (len(loose) > 1 or is_value or not (is_named and is_first)))
        ):
            return self._no_comparison(span, loose)
        message = f"'{inner.operator}' is read before '{parent.operator}'"
        sides = [
            f"({self._source(side)})" if side is loose[0] else self._source(side)
            for side in parent.sides
        ]
        meaning = f" {parent.operator} ".join(sides)
        if len(meaning) <= _LONGEST:
            message += f": this means {meaning}"
        noun = "condition" if is_junction else "pair" if outer.operator == "->" else "comparison"
        if inner.operator == "->":
            noun = "second part"
        hint = f"Put the {noun} in parentheses"
        example = self._in_parentheses(span, inner, is_first=is_first)
        return self._warning(span, message, self._with_example(hint, example))

    def _in_parentheses(self, span: Span, inner: Infix, *, is_first: bool) -> str:
        """Return a piece of the text with the right parentheses around all beside an operator."""
        side = inner.right if is_first else inner.left
        assert side.span is not None
        if is_first:
            start, _ = with_whole_brackets(self._skeleton, side.span.start, span.stop)
            return f"{self._text[span.start : start]}({self._text[start : span.stop]})"
        _, stop = with_whole_brackets(self._skeleton, span.start, side.span.stop)
        return f"({self._text[span.start : stop]}){self._text[stop : span.stop]}"

    def _no_comparison(self, span: Span, equations: Sequence[Node]) -> Diagnostic:
        message = "'=' does not compare here: where the sides differ, there is no row at all"
        rewritten, offset = "", span.start
        for equation in equations:
            infix = infix_of(equation)
            if infix is not None and infix.left.span is not None:
                sign = self._skeleton.find("=", infix.left.span.stop, span.stop)
                rewritten += f"{self._text[offset:sign]}="
                offset = sign
        hint = self._with_example("Compare with '=='", rewritten + self._text[offset : span.stop])
        return self._warning(span, message, hint)

    # -- what is compared --------------------------------------------------------------------------

    def _check_comparison(
        self,
        node: Node,
        span: Span,
        infix: Infix,
        body_uses: Counter[str],
        rule_uses: Counter[str],
    ) -> Iterator[Diagnostic]:
        left, right = infix.sides
        message = hint = ""
        if isinstance(left, tree.Null) or isinstance(right, tree.Null):
            operand = right if isinstance(left, tree.Null) else left
            name = tree.variable_of(operand)
            is_bound = infix.operator != "=" and body_uses[name] > 1
            is_test = not name or isinstance(node, tree.Call) or is_bound
            if is_test and not isinstance(operand, tree.Literal):
                message = "A comparison with null never holds"
                word = "is not" if infix.operator == "!=" else "is"
                hint = self._with_example("Write", f"{self._source(operand)} {word} null", " ")
        elif infix.operator != "!=" and isinstance(node, tree.Atom | tree.Equation):
            name = tree.variable_of(left)
            if name and _is_shifted(right, name):
                message = "This never holds: a variable has one value"
                equation = f"new_{name} = {self._source(right)}"
                hint = self._with_example("Give the new value a name of its own", equation)
            name = tree.variable_of(right)
            is_text = isinstance(left, tree.FieldAccess) and left.field in _SENSED_TEXTS
            if (
                name
                and rule_uses[name] == 1
                and (is_text or tree.variable_of(left) == "robot_name")
            ):
                message = f"{name} is a new variable here, so this always holds"
                hint = f'A string is written in quotes: "{name}".'
        if message:
            yield replace(self._warning(span, message, hint), has_effect=False)

    def _named_with_equals(self, node: Node) -> Iterator[Diagnostic]:
        """Yield a warning for each ``name = value`` where a field or column is named with ``:``."""
        match node:
            case tree.Record():
                arguments, noun = node.arguments, "a field of a record"
            case tree.Head():
                arguments, noun = node.columns, "a column"
            case tree.Atom() | tree.Call():
                arguments, noun = node.arguments, "a column"
            case _:
                return
        for argument in arguments:
            infix = infix_of(argument.value) if isinstance(argument.field, int) else None
            if infix is None or infix.operator != "=" or argument.value.span is None:
                continue
            name = tree.variable_of(infix.left)
            is_known = not isinstance(node, tree.Atom | tree.Call) or (
                name in self._columns.get(node.name, ())
            )
            if name and is_known:
                hint = self._with_example("Write", f"{name}: {self._source(infix.right)}", " ")
                message = f"'=' does not name {noun}; this one has no name"
                yield self._warning(argument.value.span, message, hint)

    def _unnamed_fields(self, node: Node) -> Iterator[Diagnostic]:
        fields = node.arguments if isinstance(node, tree.Record) else ()
        values = [field.value for field in fields if isinstance(field.field, int)]
        if (
            not values
            or node.span is None
            or any(i and i.operator == "=" for i in map(infix_of, values))
        ):
            return
        texts = []
        for field in fields:
            name = field.field if isinstance(field.field, str) else tree.variable_of(field.value)
            name = name or getattr(field.value, "field", "name")
            is_short = name == tree.variable_of(field.value)
            texts.append(f"{name}:" if is_short else f"{name}: {self._source(field.value)}")
        hint = self._with_example("Write", f"{{{', '.join(texts)}}}", " ")
        yield self._warning(node.span, "Fields of this record have no names", hint)

    def _misused_values(self, node: Node) -> Iterator[Diagnostic]:
        if node.span is None:
            return
        message = hint = ""
        if isinstance(node, tree.Atom) and node.name in self._truths:
            if all(argument.column != VALUE for argument in node.arguments):
                message = f"{node.name} has a value; as a condition it always holds"
                hint = self._with_example("Look at its value", f"{self._source(node)} == true")
        elif isinstance(node, tree.Choice):
            values = [*(branch.value for branch in node.branches), node.otherwise]
            infix = next(
                (i for value in values if (i := infix_of(value)) and i.operator == "="), None
            )
            if infix is not None:
                message = "This '=' applies even when another branch is chosen"
                name = tree.variable_of(infix.left) or "x"
                hint = f"Give a name to all of it: {name} = (if a < b then c else d)."
        elif isinstance(node, tree.Aggregate) and node.body is None:
            function = _OVER_ROWS.get(node.operator, "")
            argument = self._source(node.argument)
            has_rows = any(not is_built_in(call.name) for call in calls(node.argument))
            if function and not has_rows and tree.variables(node.argument):
                message = f"This {function} has no body, so it aggregates a single value"
                hint = self._with_example("Put the body inside", f"{function}{{{argument} :- ...}}")
        if message:
            yield self._warning(node.span, message, hint)

    def _unknown_sign(self, node: Node) -> Iterator[Diagnostic]:
        """Yield a diagnostic for ``x /= 3``, which is an aggregate that does not exist."""
        if not isinstance(node, tree.Aggregate | tree.Aggregation):
            return
        sign, offset = node.operator, getattr(node.operator, "start", -1)
        is_own = {sign, f"`{sign}`"} & self._model.definitions.keys()
        if offset >= 0 and not (re.fullmatch(r"\w+", sign) or sign[0] in "`+" or is_own):
            message = f"There is no {sign}= in Logica"
            hint = "Write != where values must differ."
            if re.search(r"[\w\s,]", sign):
                message, hint = NOT_IN_HEAD, END_MISSING
            elif sign not in _UNEQUAL:
                hint = f"A variable has one value; give the new one a name: y = x {sign} 1."
            span = Span(offset, offset + len(sign) + 1)
            # Of these, the package compiles only "-".
            yield self._model.diagnostic(span, message, hint, "warning" if sign == "-" else "error")

    def _called_aggregate(self, node: Node) -> Iterator[Diagnostic]:
        name = node.name if isinstance(node, tree.Call) else ""
        if name in _OVER_ROWS and name.isalpha() and node.span is not None:
            message = f"{name}{CALLED_AGGREGATE}"
            hint = f"Aggregates have braces and a body: {name}{{x :- x in list}}."
            yield self._warning(node.span, message, hint)

    # -- texts -------------------------------------------------------------------------------------

    def _warning(self, span: Span, message: str, hint: str) -> Diagnostic:
        text = self._text[slice(*span)]
        if text != " ".join(text.split()):  # the example has lost lines or spaces
            hint = str(hint)
        return self._model.diagnostic(span, message, hint, "warning")

    def _source(self, node: Node) -> str:
        return " ".join(self._text[slice(*node.span)].split()) if node.span else "..."

    @staticmethod
    def _with_example(hint: str, example: str, between: str = ": ") -> str:
        example = " ".join(example.split())
        if len(example) > _LONGEST - len(hint) // 2:
            return f"{hint}."
        words = f"{hint}{between}{{}}."
        return words.format(example) if "..." in example else Proposal(example, words)


def _own_negations(model: Model) -> Iterator[Diagnostic]:
    """Yield a warning for each predicate that depends on its own negation."""
    for rule in model.rules:
        for call in _negated_calls(rule) if rule.name in model.reach(rule.name) else ():
            if call.name == rule.name or rule.name in model.reach(call.name):
                message = f"{rule.name} depends on its own negation, ~{call.name}"
                hint = (
                    "Its rows would exist only while they are missing. "
                    f"Negate only predicates that don't depend on {rule.name}."
                )
                yield model.diagnostic(call.name, message, hint, "warning")


def _growing_recursions(model: Model) -> Iterator[Diagnostic]:
    """Yield a warning for each recursion that may derive more and more copies of a row."""
    plural = {
        name: statements
        for name, statements in model.definitions.items()
        if name in model.reach(name) and not any(r.is_distinct for r in rules_of(statements))
    }
    reachable = {name: reach(statements, plural) for name, statements in plural.items()}
    for name in plural:
        circle = {n for n in reachable[name] if name in reachable.get(n, ())}
        if name in circle and any(
            _multiplies(rule.head, parts, circle, model)
            for rule in rules_of(plural[name])
            for parts, _ in tree.alternatives(tree.conjuncts(rule.body), _MOST_ALTERNATIVES)
        ):
            hint = "Write distinct in all of its heads."
            yield model.diagnostic(name, f"{name} {MULTIPLIES}", hint, "warning")


def _multiplies(head: tree.Head, parts: Sequence[Node], circle: set[str], model: Model) -> bool:
    """Return whether a clause joins a recursive premise and drops one of its variables.

    One that keeps them all derives a row once, as ``P(x + 1) :- P(x)`` does. `Sensor` and
    `Memory` don't multiply rows: they have one for each robot.
    """

    def is_premise(node: Node) -> bool:
        return isinstance(node, tree.Call | tree.Atom) and node.name in circle

    nodes = [*tree.walk([head, *parts], tree.is_aggregate)]
    premises = [*filter(is_premise, nodes)]
    predicates = model.definitions.keys() - circle
    joins = [
        node
        for node in nodes
        if isinstance(node, tree.Membership)
        or (isinstance(node, tree.Atom) and node.name in predicates)
    ]
    head_nodes = tree.walk(head, lambda node: is_premise(node) or tree.is_aggregate(node))
    head_names = {node.name for node in head_nodes if isinstance(node, tree.Variable)}
    return len(premises) + len(joins) > 1 and not tree.variables(premises) <= head_names


def _ignored_types(model: Model) -> Iterator[Diagnostic]:
    for assertion in model.calls:
        for node in tree.walk(assertion.arguments[1:]) if assertion.name == "~" else ():
            if isinstance(node, tree.PredicateName) and node.name not in _ASSERTED_TYPES:
                message = f"{node.name} is not a type that ~ knows, so it is ignored"
                hint = "Write Num, Str, Bool, [Num] or {count: Num}."
                yield model.diagnostic(node.name, message, hint, "warning")


_ASSERTED_TYPES = ("Bool", "Num", "Str", "Time")


def _stops_with_limits(model: Model) -> Iterator[Diagnostic]:
    limited = {a.subject for a in model.annotations if a.name == "@Limit"}
    for annotation in model.annotations:
        name = annotation.subject
        if name not in model.definitions or all(a.field != "stop" for a in annotation.arguments):
            continue
        circle = {name, *(n for n in model.reach(name) if name in model.reach(n))}
        if circle & limited:
            message = "A recursion with stop: can't have @Limit"
            hint = f"Limit a predicate that reads {name}."
            yield model.diagnostic(annotation.name, message, hint)


def _negated_calls(node: Node, *, is_odd: bool = False) -> Iterator[tree.Call | tree.Atom]:
    """Yield the calls within an odd number of negations."""
    if is_odd and isinstance(node, tree.Call | tree.Atom):
        yield node
    is_odd ^= isinstance(node, tree.Aggregate) and node.is_denial
    for child in tree.children(node):
        yield from _negated_calls(child, is_odd=is_odd)


def _in_tests(rule: Node) -> Iterator[tuple[Node, bool]]:
    """Yield all nodes, outer before inner, and whether each is tested by an ``if`` or a ``!``."""
    stack = [(rule, False)]
    while stack:
        node, is_test = stack.pop()
        yield node, is_test
        inner: list[tuple[Node, bool]] = []
        for child in tree.children(node):
            if isinstance(node, tree.Branch):
                inner.append((child, child is node.condition))
            else:
                is_operand = infix_of(node) is not None or isinstance(node, tree.Argument)
                is_negated = isinstance(node, tree.Call | tree.Atom) and node.name == "!"
                inner.append((child, is_negated or (is_test and is_operand)))
        stack += inner[::-1]


def _mentions(part: tree.Tree) -> Counter[str]:
    """Return how often each variable is mentioned."""
    nodes = tree.walk(part)
    return Counter(str(node.name) for node in nodes if isinstance(node, tree.Variable))


def _is_truth(rule: tree.Rule | tree.Functor) -> bool:
    """Return whether a rule is a function whose value is a Boolean."""
    if not isinstance(rule, tree.Rule) or rule.body is not None:
        return False
    return isinstance(rule.value, tree.Call) and rule.value.name in tree.TRUTHS


def _is_shifted(node: Expression, name: str) -> bool:
    """Return whether an expression is a variable plus or minus a number."""
    infix = infix_of(node)
    if infix is None or infix.operator not in ("+", "-"):
        return False
    number = infix.right if tree.variable_of(infix.left) == name else infix.left
    is_mentioned = name in map(tree.variable_of, infix.sides)
    return is_mentioned and isinstance(number, tree.Number) and float(number.value) != 0


_SHORTEST = 4  # letters in a word that can be recognised as misspelt
_LONG = 7  # letters in a word that may have two errors
_MOST_COMPARED = 200  # variables of a rule; nobody writes more by hand


def typos(model: Model) -> Iterator[Diagnostic]:
    for rule in model.rules:
        nodes = [*tree.walk(rule)]
        variables = [node.name for node in nodes if isinstance(node, tree.Variable)]
        # In `name:` a column and its variable are named at once.
        columns = (node for node in nodes if isinstance(node, tree.Argument))
        shorthand = {c.field for c in columns if tree.variable_of(c.value) == c.field}
        counts = Counter(map(str, variables))
        if len(counts) > _MOST_COMPARED:
            continue
        for index, name in enumerate(variables):
            if counts[name] > 1 or name in shorthand:
                continue
            earlier = dict.fromkeys(map(str, variables[:index]))
            candidates = (o for o in counts if o in earlier or counts[o] > 1)
            similar = next((o for o in candidates if o != name and _looks_like(name, o)), "")
            if similar:
                message = f"{name} is used only once; is it a misspelt {similar}?"
                hint = Proposal(similar, "Write {} if you mean the same.")
                problem = model.diagnostic(name, message, hint, "warning")
                yield replace(problem, has_effect=False)


def _looks_like(name: str, candidate: str) -> bool:
    left, right = name.split("_"), candidate.split("_")
    differences = [(a, b) for a, b in zip(left, right, strict=False) if a != b]
    if len(left) != len(right) or len(differences) != 1:
        return False
    ((a, b),) = differences
    shorter = min(len(a), len(b))
    if shorter < _SHORTEST or a.rstrip("s") == b.rstrip("s") or re.search(r"\d", a + b):
        return False
    return a[0] == b[0] and distance(a, b) <= (2 if shorter >= _LONG else 1)
