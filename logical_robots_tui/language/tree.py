"""The syntax tree of a Logica program: frozen nodes, each with its span of the text.

Nodes are equal where they mean the same; spans don't count. `walk` visits a tree, and `rebuild`
makes another one with changed children.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, NamedTuple, TypeAlias, TypeVar

from logical_robots_tui.schema import VALUE

REST = "*"
"""The field of ``..r``, the rest of a row."""


class Span(NamedTuple):
    """Offsets of a piece of a program's text: its first character, and the one behind its last."""

    start: int
    stop: int


class Name(str):
    """A name as written; equal to any text with the same characters.

    Attributes:
        start: Its offset in the program's text, or -1 if it does not stand there.
    """

    __slots__ = ("start",)
    start: int

    def __new__(cls, text: str, start: int = -1) -> Name:
        name = super().__new__(cls, text)
        name.start = start
        return name


@dataclass(frozen=True, slots=True)
class Node:
    parts: ClassVar[tuple[str, ...]] = ()
    span: Span | None = field(default=None, compare=False, kw_only=True)


@dataclass(frozen=True, slots=True)
class Expression(Node):
    """A node that has a value."""


@dataclass(frozen=True, slots=True)
class Literal(Expression):
    """A constant as written."""

    value: str


class Number(Literal):
    """A number; `value` holds its digits."""

    __slots__ = ()


class Text(Literal):
    """A text, without its quotes."""

    __slots__ = ()


class Boolean(Literal):
    """``true`` or ``false``."""

    __slots__ = ()


class Null(Literal):
    """``null``."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class PredicateName(Expression):
    """A predicate named without arguments, such as the type in ``TryCast(x, Num)``."""

    name: str


@dataclass(frozen=True, slots=True)
class Variable(Expression):
    name: str


@dataclass(frozen=True, slots=True)
class List(Expression):
    parts: ClassVar = ("elements",)
    elements: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Argument(Node):
    """A column of a head, an argument of a call, or a field of a record.

    Attributes:
        field: Its place from 0, its name, or `REST`.
        value: The expression; in heads, it may be aggregated.
    """

    parts: ClassVar = ("value",)
    field: int | str
    value: Expression | Aggregation

    @property
    def expression(self) -> Expression | None:
        """The value, or None if it is aggregated."""
        return None if isinstance(self.value, Aggregation) else self.value

    @property
    def column(self) -> str:
        """The column in SQL; positional ones are col0, col1 ..."""
        return f"col{self.field}" if isinstance(self.field, int) else str(self.field)


@dataclass(frozen=True, slots=True)
class Aggregation(Node):
    """An aggregated column of a head: ``best? Max= value``."""

    parts: ClassVar = ("argument",)
    operator: str
    argument: Expression


@dataclass(frozen=True, slots=True)
class Record(Expression):
    """A record: ``{a: 1, b: x}``."""

    parts: ClassVar = ("arguments",)
    arguments: tuple[Argument, ...]


@dataclass(frozen=True, slots=True)
class FieldAccess(Expression):
    """A field read from a record: ``record.field``."""

    parts: ClassVar = ("record",)
    record: Expression
    field: str


@dataclass(frozen=True, slots=True)
class Call(Expression):
    """A function or an operator applied to arguments; those of operators are left and right."""

    parts: ClassVar = ("arguments",)
    name: str
    arguments: tuple[Argument, ...]


@dataclass(frozen=True, slots=True)
class Branch(Node):
    """One condition of an ``if``, and the value where it holds."""

    parts: ClassVar = ("condition", "value")
    condition: Expression
    value: Expression


@dataclass(frozen=True, slots=True)
class Choice(Expression):
    """``if a then b else c``."""

    parts: ClassVar = ("branches", "otherwise")
    branches: tuple[Branch, ...]
    otherwise: Expression


@dataclass(frozen=True, slots=True)
class Aggregate(Expression):
    """``Sum{x :- body}``; it has variables of its own.

    Attributes:
        body: Over which rows, or None.
        is_denial: Whether it stands for a negation, as the argument of ``IsNull``.
    """

    parts: ClassVar = ("argument", "body")
    operator: str
    argument: Expression
    body: Proposition | None = None
    is_denial: bool = False


@dataclass(frozen=True, slots=True)
class Proposition(Node):
    """A body or a part of one, which holds or not."""


@dataclass(frozen=True, slots=True)
class Conjunction(Proposition):
    parts: ClassVar = ("members",)
    members: tuple[Proposition, ...]


@dataclass(frozen=True, slots=True)
class Disjunction(Proposition):
    parts: ClassVar = ("alternatives",)
    alternatives: tuple[Proposition, ...]


@dataclass(frozen=True, slots=True)
class Equation(Proposition):
    """Two expressions have the same value; may give a variable its value."""

    parts: ClassVar = ("left", "right")
    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True)
class Membership(Proposition):
    """``element in collection``; may give the variables in `element` their values."""

    parts: ClassVar = ("collection", "element")
    collection: Expression
    element: Expression


@dataclass(frozen=True, slots=True)
class Atom(Proposition):
    """A predicate with arguments, or a comparison, that holds."""

    parts: ClassVar = ("arguments",)
    name: str
    arguments: tuple[Argument, ...]


@dataclass(frozen=True, slots=True)
class Head(Node):
    """The predicate that a rule defines, with its columns."""

    parts: ClassVar = ("columns",)
    name: str
    columns: tuple[Argument, ...]

    def column(self, name: str) -> Argument | None:
        return next((column for column in self.columns if column.column == name), None)


@dataclass(frozen=True, slots=True)
class Rule(Node):
    """A rule or a fact.

    Attributes:
        body: Under which conditions, or None for a fact.
        is_distinct: Whether equal rows are one, and columns may be aggregated.
        modalities: Denotations such as ``couldbe``.
    """

    parts: ClassVar = ("head", "body")
    head: Head
    body: Proposition | None = None
    is_distinct: bool = False
    modalities: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        return self.head.name

    @property
    def value(self) -> Expression | None:
        column = self.head.column(VALUE)
        return None if column is None else column.expression


@dataclass(frozen=True, slots=True)
class Annotation(Node):
    """``@Limit(P, 3);``."""

    parts: ClassVar = ("arguments",)
    name: str
    arguments: tuple[Argument, ...]

    @property
    def subject(self) -> str:
        first = self.arguments[0].value if self.arguments else None
        return first.name if isinstance(first, PredicateName) else ""

    @property
    def values(self) -> tuple[Expression, ...]:
        return operands(self.arguments[1:])


@dataclass(frozen=True, slots=True)
class Functor(Node):
    """``name := base(Parameter: Argument);``, a predicate made from another."""

    parts: ClassVar = ("arguments",)
    name: str
    base: str
    arguments: tuple[Argument, ...]

    @property
    def parameters(self) -> tuple[str, ...]:
        return tuple(str(argument.field) for argument in self.arguments)


Statement: TypeAlias = Rule | Annotation | Functor
Tree: TypeAlias = Node | Iterable[Node]
Columns: TypeAlias = (
    "Mapping[str, Expression] | Mapping[int, Expression] | Mapping[int | str, Expression]"
)

COMPARISONS = frozenset({"!=", "<", "<=", "==", ">", ">=", "in", "is", "is not"})
"""Operators that return a boolean from any operands."""

JUNCTIONS = frozenset({"&&", "||"})
"""Operators that return a boolean from booleans, except ``!``."""

CONDITIONS = COMPARISONS | JUNCTIONS | {"!", "IsNull"}
"""Expressions with a boolean value that can be used as a condition."""

TRUTHS = CONDITIONS | {"EndsWith", "Like", "StartsWith"}
"""All operators and functions with a boolean value."""

N = TypeVar("N", bound=Node)


def children(node: Node) -> Iterator[Node]:
    for part in node.parts:
        value = getattr(node, part)
        if type(value) is tuple:
            yield from value
        elif value is not None:
            yield value


def walk(tree: Tree, stop: Callable[[Node], object] | None = None) -> Iterator[Node]:
    """Yield all nodes of a tree, outer before inner, in text order.

    Args:
        tree: A node, or several.
        stop: Whether to leave out what is inside a node.
    """
    stack = [tree] if isinstance(tree, Node) else [*tree][::-1]
    while stack:
        node = stack.pop()
        yield node
        if node.parts and (stop is None or not stop(node)):
            stack += [*children(node)][::-1]


def rebuild(node: N, change: Callable[[Node], Node]) -> N:
    """Return a node whose children are changed; itself if none is."""
    changes: dict[str, Any] = {}
    for part in node.parts:
        old = getattr(node, part)
        if type(old) is tuple:
            new = tuple([change(child) for child in old])
            if any(a is not b for a, b in zip(old, new, strict=True)):
                changes[part] = new
        elif old is not None and (new_node := change(old)) is not old:
            changes[part] = new_node
    return replace(node, **changes) if changes else node


def is_aggregate(node: Node) -> bool:
    return isinstance(node, Aggregate)


def variables(tree: Tree, *, inside: bool = False) -> frozenset[str]:
    """Return the names of the variables in a tree, perhaps including those inside aggregates."""
    stop = None if inside else is_aggregate
    return frozenset(str(n.name) for n in walk(tree, stop) if isinstance(n, Variable))


def substitute(node: N, bindings: Mapping[str, Expression]) -> N:
    """Return a node with variables replaced by expressions."""

    def change(inner: Node) -> Node:
        if isinstance(inner, Variable):
            return bindings.get(inner.name, inner)
        return rebuild(inner, change)

    return change(node) if bindings else node  # type: ignore[return-value]  # a kind for its kind


def has_rows(tree: Tree) -> bool:
    """Return whether a tree passes on a whole row, ``..r``."""
    return any(isinstance(node, Argument) and node.field == REST for node in walk(tree))


def operands(arguments: Iterable[Argument]) -> tuple[Expression, ...]:
    """Return the values of arguments that are not aggregated."""
    return tuple(e for argument in arguments if (e := argument.expression) is not None)


def conjuncts(body: Proposition | None) -> list[Proposition]:
    if body is None:
        return []
    if not isinstance(body, Conjunction):
        return [body]
    return [part for member in body.members for part in conjuncts(member)]


def alternatives(
    body: Iterable[Proposition], limit: int
) -> list[tuple[list[Proposition], list[Proposition]]]:
    """Return each choice of a body's alternatives: the parts of the body, and the choice.

    Where there are more than `limit` choices, none is made.
    """
    body = list(body)
    choices: list[tuple[list[Proposition], list[Proposition]]] = [([], [])]
    for part in body:
        options: list[tuple[list[Proposition], list[Proposition]]] = [([part], [])]
        if isinstance(part, Disjunction):
            options = [
                (parts, [branch, *choice])
                for branch in part.alternatives
                for parts, choice in alternatives(conjuncts(branch), limit)
            ]
        if len(choices) * len(options) > limit:
            return [(body, [])]
        choices = [
            ([*parts, *new_parts], [*choice, *new_choice])
            for parts, choice in choices
            for new_parts, new_choice in options
        ]
    return choices


def equation_sides(part: Node) -> tuple[Expression, Expression] | None:
    if isinstance(part, Equation):
        return part.left, part.right
    if isinstance(part, Atom) and part.name == "=":
        left, right = operands(part.arguments)
        return left, right
    return None


class Infix(NamedTuple):
    """An operator between two expressions."""

    operator: str
    left: Expression
    right: Expression

    @property
    def sides(self) -> tuple[Expression, Expression]:
        return self.left, self.right


def infix_of(node: Node) -> Infix | None:
    """Return an expression or a part of a body as an operator and its sides, if it is one."""
    match node:
        case Equation():
            return Infix("==", node.left, node.right)
        case Membership():
            return Infix("in", node.element, node.collection)
        case Atom() | Call() if not node.name[:1].isupper():
            if [argument.field for argument in node.arguments] == ["left", "right"]:
                return Infix(str(node.name), *operands(node.arguments))
    return None


def variable_of(node: Node | None) -> str:
    """Return the name of a variable, or "" for any other node."""
    return node.name if isinstance(node, Variable) else ""


def text_of(node: Node | None) -> str | None:
    """Return the text of a literal, or None for any other node."""
    return node.value if isinstance(node, Text) else None


def call(name: str, *positional: Expression, **named: Expression) -> Call:
    return Call(name, (*arguments(dict(enumerate(positional))), *arguments(named)))


def arguments(values: Columns) -> tuple[Argument, ...]:
    return tuple(Argument(name, value) for name, value in values.items())


def span_of(tree: Tree) -> Span | None:
    """Return the least span that holds the spans of a tree, or None if it has none."""
    spans = [node.span for node in walk(tree, lambda node: node.span) if node.span]
    if not spans:
        return None
    return Span(min(span.start for span in spans), max(span.stop for span in spans))
