"""Programs of teams, made by lot: other keys and other parts of the language than `generated` has.

Keys are texts and records, some values are null. Robots remember a phase, a number, a list and a
record, and read each other's. Each program comes with some ticks of its own run.
"""

import re
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from functools import cached_property
from random import Random
from typing import Any, Literal

from logical_robots_tui.mind import Limits, Mind, Program
from tests.mind.rows import row

ROBOTS = ("Ada", "Bo", "Cy")
_PHASES = ("out", "fetch", "home")
_TEXTS = ("a", "b", "out", "home", "Bo")
_MEMORIES: tuple[Literal["own", "seen", "all"], ...] = ("own", "seen", "all", "all")
_SENSORS: tuple[Literal["own", "all"], ...] = ("own", "all", "all")
_LABELS = ("Green", "Red", "Bo", "Cy")
_FUNCTIONS = """
Go() = {left_engine: 0.5, right_engine: 0.5};
Up(n) = n + 1;
Bend(n) = (if n > 2 then Up(n) else if n == 1 then null else n * 2);
Rename(t) = (if t == "a" then "b" else if t == "out" then "home" else t);
Pair(n, t) = {n:, t:};
IsBig(n) :- n > 1;
Follows(t, u) :- Plan(phase: t, next: u);
Cost(t) = Min{n :- Kind(key: t, n:)};
Near(radar, name) = ArgMin{ray.distance -> ray.angle :- ray in radar, ray.label == name};
"""
_RECURSIONS = (
    "Reach(from:, to:) distinct :- Link(from:, to:);\n"
    "Reach(from:, to:) distinct :- Reach(from:, to: mid), Link(from: mid, to:);",
    "@Recursive(Reach, 1);\n"
    "Reach(from:, to:) distinct :- Link(from:, to:);\n"
    "Reach(from:, to:) distinct :- Link(from:, to: mid), Reach(from: mid, to:);",
    "Reach(from:, to:) distinct :- Link(from:, to:);\n"
    "Reach(from:, to:) distinct :- Reach(from:, to: mid), Reach(from: mid, to:), from != to;",
    "Reach(from:, to:) distinct :- Odd(from:, to:);\n"
    "Odd(from:, to:) distinct :- Link(from:, to:);\n"
    "Odd(from:, to:) distinct :- Even(from:, to: mid), Link(from: mid, to:);\n"
    "Even(from:, to:) distinct :- Odd(from:, to: mid), Link(from: mid, to:);",
)
_DISTANCE = (
    'Far(key: "a", n? Min= 0) distinct;\n'
    "Far(key: to, n? Min= far + 1) distinct :- Far(key: from, n: far), Link(from:, to:), far < 5;"
)


@dataclass(frozen=True)
class Team:
    text: str
    memory: Literal["own", "seen", "all"]
    sensor: Literal["own", "all"]
    copies: dict[str, str]  # by predicate made with `:=`, what is filled in
    names: frozenset[str]  # of predicates that are more than facts
    clocks: tuple[int, ...]
    seed: int

    @cached_property
    def program(self) -> Program:
        return Program.compile(self.text)

    def mind(self) -> Mind:
        return Mind(
            self.program, memory=self.memory, sensor=self.sensor, limits=Limits(query_seconds=60)
        )

    def ticks(self) -> Iterator[tuple[list[Any], dict[str, Any]]]:
        """Sensor rows and memories of some ticks of the team's life."""
        lot = Random(self.seed)
        memories: dict[str, Any] = dict.fromkeys(ROBOTS, "")
        with closing(self.mind()) as mind:
            for clock in self.clocks:
                rows = [_sensed(name, clock, lot) for name in ROBOTS]
                yield rows, memories
                memories = {d.robot_name: d.memory for d in mind.think(rows, memories)}


def team(seed: int) -> Team:
    lot = Random(seed)
    made = _Program(lot)
    text = made.text()
    names = frozenset(re.findall(r"^([A-Z]\w*)\(.*:-", text, re.MULTILINE)) | made.copies.keys()
    memory, sensor = lot.choice(_MEMORIES), lot.choice(_SENSORS)
    clocks = tuple(range(1, lot.randint(3, 5)))
    return Team(text, memory, sensor, made.copies, names, clocks, seed)


def _sensed(name: str, clock: int, lot: Random) -> Any:
    others = [each for each in _LABELS if each != name]
    kinds = {label: "robot" if label in ROBOTS else "beacon" for label in others}
    seen = lot.sample(others, lot.randint(0, len(others)))
    sees = {lot.randrange(31): (lot.randint(5, 60), kinds[label], label) for label in seen}
    return row(name, clock=clock, sees=sees)


@dataclass(frozen=True)
class _Relation:
    name: str
    columns: dict[str, str]


_BASE = (
    _Relation("Kind", {"key": "text", "n": "number"}),
    _Relation("Link", {"from": "text", "to": "text"}),
    _Relation("Spot", {"at": "record", "n": "number"}),
    _Relation("Bag", {"key": "text", "items": "list"}),
    _Relation("Plan", {"phase": "text", "least": "number", "next": "text"}),
)


class _Program:
    def __init__(self, lot: Random) -> None:
        self._lot = lot
        self._known = list(_BASE)
        self._places = 0
        self.copies: dict[str, str] = {}

    def text(self) -> str:
        lot = self._lot
        text = [self._facts(), _FUNCTIONS]
        if lot.random() < 0.4:
            text.append(lot.choice(_RECURSIONS))
            self._known.append(_Relation("Reach", {"from": "text", "to": "text"}))
        if lot.random() < 0.3:
            text.append(_DISTANCE)
            self._known.append(_Relation("Far", {"key": "text", "n": "number"}))
        for place in range(lot.randint(1, 3)):
            name = f"P{place}"
            rules, columns = self._predicate(name)
            text += rules
            used = [each for each in ("Kind", "Link") if f"{each}(" in "".join(rules)]
            if used and lot.random() < 0.5:
                self.copies[f"Copy{place}"] = f"{used[0]}: Other{used[0]}"
                text.append(f"Copy{place} := {name}({used[0]}: Other{used[0]});")
                self._known.append(_Relation(f"Copy{place}", columns))
            self._known.append(_Relation(name, columns))
        return "\n".join([*text, self._robot()])

    def _facts(self) -> str:
        lot = self._lot

        def facts(name: str, number: int, columns: dict[str, str]) -> Iterator[str]:
            found = {", ".join(f"{c}: {self._literal(t)}" for c, t in columns.items())
                     for _ in range(number)}  # fmt: skip
            yield from (f"{name}({each});" for each in sorted(found))

        text = [each for base in _BASE[:-1] for each in facts(base.name, 4, base.columns)]
        text += facts("OtherKind", 2, _BASE[0].columns)
        text += facts("OtherLink", 2, _BASE[1].columns)
        for phase in _PHASES:
            least, following = lot.randint(0, 3), lot.choice(_PHASES)
            text.append(f'Plan(phase: "{phase}", least: {least}, next: "{following}");')
        return " ".join(text)

    def _literal(self, kind: str) -> str:
        lot = self._lot
        if lot.random() < 0.1 and kind != "list":
            return "null"
        match kind:
            case "number":
                return str(lot.randint(0, 4))
            case "text":
                return f'"{lot.choice(_TEXTS)}"'
            case "list":
                return str([lot.randint(0, 3) for _ in range(lot.randint(1, 3))])
        return f'{{n: {lot.randint(0, 2)}, t: "{lot.choice(_TEXTS[:3])}"}}'

    # -- bodies ----------------------------------------------------------------------------------

    def _new(self) -> str:
        self._places += 1
        return f"v{self._places}"

    def _call(self, scope: dict[str, str], *, bind: float = 0.7, new: bool = True) -> str:
        lot = self._lot
        relation = lot.choice(self._known)
        given: list[str] = []
        for column, kind in relation.columns.items():
            known = [name for name, its in scope.items() if its == kind]
            if lot.random() < bind or not known:
                if new:
                    name = self._new()
                    scope[name] = kind
                    given.append(f"{column}: {name}")
                elif not given:
                    given.append(f"{column}: {self._literal(kind)}")
            elif lot.random() < 0.8:
                given.append(f"{column}: {lot.choice(known)}")
            else:
                given.append(f"{column}: {self._literal(kind)}")
        return f"{relation.name}({', '.join(given)})"

    def _input(self, scope: dict[str, str]) -> str:
        lot = self._lot
        who, what = self._new(), self._new()
        scope[who] = "text"
        if lot.random() < 0.4:
            ray = self._new()
            scope |= {f"{ray}.label": "text", f"{ray}.distance": "number", f"{what}.radar": "radar"}
            return (f"Sensor(robot_name: {who}, sensor: {what}), {ray} in {what}.radar, "
                    f'{ray}.label != "nothing"')  # fmt: skip
        if lot.random() < 0.3:
            scope |= {f"{what}.clock": "number", f"{what}.radar": "radar"}
            return f"Sensor(robot_name: {who}, sensor: {what})"
        scope |= {f"{what}.phase": "text", f"{what}.n": "number"}
        scope |= {f"{what}.last": "record", f"{what}.seen": "list"}
        return f"Memory(robot_name: {who}, memory: {what})"

    def _expression(self, kind: str, scope: dict[str, str]) -> str:
        lot = self._lot
        known = [name for name, its in scope.items() if its == kind] or [self._literal(kind)]
        v, w = lot.choice(known), lot.choice(known)
        text = next((name for name, its in scope.items() if its == "text"), '"a"')
        if kind == "number":
            radar = next((name for name, its in scope.items() if its == "radar"), "")
            return lot.choice(
                [v, v, v, f"{v} + {w}", f"Up({v})", f"Bend({v})", f"Coalesce({v}, 7)",
                 f"(if {v} > {w} then {v} else Up({w}))", f"Cost({text})", self._aggregate(scope),
                 f"Least({v}, {w})", f"Size({self._expression('list', {})})",
                 f'Near({radar}, "Green")' if radar else "2"]
            )  # fmt: skip
        if kind == "text":
            return lot.choice(
                [v, v, v, f"Rename({v})", f'{v} ++ "!"', f'(if {v} == {w} then "same" else {v})',
                 f'Coalesce({v}, "none")']
            )  # fmt: skip
        if kind == "record":
            number = next((name for name, its in scope.items() if its == "number"), "1")
            return lot.choice([v, v, f"{{n: {number}, t: {text}}}", f"Pair({number}, {text})"])
        return v if kind == "list" else '"a"'

    def _aggregate(self, scope: dict[str, str]) -> str:
        """An aggregate of numbers in a body, over a predicate or over all that is remembered."""
        lot = self._lot
        inner: dict[str, str] = {}
        text = next((name for name, its in scope.items() if its == "text"), '"a"')
        if lot.random() < 0.4:
            who, what = self._new(), self._new()
            body = f"Memory(robot_name: {who}, memory: {what}), {who} != {text}"
            value, by = f"{what}.n", lot.choice([who, f"{what}.phase", f"{what}.last", f"{what}.n"])
        else:
            body = self._call(inner, bind=0.8)
            value = next((v for v, its in inner.items() if its == "number"), "1")
            by = lot.choice([*inner] or [value])
        operator = lot.choice(["Min", "Max", "Sum", "Count", "ArgMin", "ArgMax"])
        arrow = f" -> {by}" if operator.startswith("Arg") else ""
        return f"{operator}{{{value}{arrow} :- {body}}}"

    def _condition(self, scope: dict[str, str]) -> str:
        lot = self._lot
        kind = lot.choice([k for k in scope.values() if k in ("number", "text", "record")])
        v, w = self._expression(kind, scope), self._expression(kind, scope)
        number = self._expression("number", scope)
        text = self._expression("text", scope)
        call = self._call(dict(scope), bind=0.3, new=False)
        local = dict(scope)
        wide = self._call(local)
        return lot.choice(
            [f"{v} != {w}", f"{v} == {w}", f"{number} < 3", f"IsBig({number})", f"~{call}", call,
             f'({text} == "a" | {number} > 1)', f"({call} | {number} < 2, {text} is not null)",
             f"({text} != \"a\" || {number} == 0)", f"{v} is not null",
             f"~({wide}, {self._compared(local)})", f"({wide} => {self._compared(local)})",
             f'Follows({text}, "home")', f'{text} in ["a", "out", "Ada"]']
        )  # fmt: skip

    def _compared(self, scope: dict[str, str]) -> str:
        names = [name for name, its in scope.items() if its == "number"]
        return f"{self._lot.choice(names)} > 1" if names else "1 == 1"

    def _body(self) -> tuple[list[str], dict[str, str]]:
        lot = self._lot
        scope: dict[str, str] = {}
        parts = [self._input(scope) if lot.random() < 0.4 else self._call(scope, bind=1)]
        for _ in range(lot.randint(0, 2)):
            way = lot.random()
            if way < 0.4:
                parts.append(self._call(scope, bind=0.5))
            elif way < 0.6:
                parts.append(self._input(scope))
            elif way < 0.7:
                name = self._new()
                parts.append(f"({self._either(scope, name)} | {self._either(scope, name)})")
                scope[name] = "number"
            elif way < 0.8 and "list" in scope.values():
                name = self._new()
                parts.append(f"{name} in {self._expression('list', scope)}")
                scope[name] = "number"
            else:
                name, kind = self._new(), lot.choice(["number", "text", "record"])
                parts.append(f"{name} == {self._expression(kind, scope)}")
                scope[name] = kind
        conditions = [self._condition(scope) for _ in range(lot.randint(0, 2))]
        return ([*conditions, *parts] if lot.random() < 0.2 else [*parts, *conditions]), scope

    def _either(self, scope: dict[str, str], name: str) -> str:
        lot = self._lot
        if lot.random() < 0.5:
            key = next((n for n, its in scope.items() if its == "text"), '"a"')
            return f"Kind(key: {key}, n: {name})"
        return f"{name} == {self._expression('number', scope)}, {name} < {lot.randint(0, 4)}"

    # -- heads -----------------------------------------------------------------------------------

    def _predicate(self, name: str) -> tuple[list[str], dict[str, str]]:
        lot = self._lot
        key = lot.choice(["text", "text", "record", "number"])
        kind = lot.choice(["number", "number", "text"])
        operator = lot.choice(["Min", "Max", "+", "Count", "ArgMin", "ArgMax", "List"])
        form = lot.choice(["plain", "plain", "distinct", "aggregated"])
        rules = []
        for _ in range(lot.randint(1, 2)):
            parts, scope = self._body()
            first, second = self._expression(key, scope), self._expression(kind, scope)
            if form == "aggregated":
                if kind == "text" and operator == "+":
                    operator = "Max"
                arrow = f" -> {self._expression(lot.choice(['number', 'text']), scope)}"
                second += arrow if operator.startswith("Arg") else ""
                head = f"{name}(key: {first}, m? {operator}= {second}) distinct"
            else:
                head = f"{name}(key: {first}, m: {second}){' distinct' * (form == 'distinct')}"
            rules.append(f"{head} :- {', '.join(parts)};")
        if form == "aggregated" and operator in ("Count", "List"):
            kind = "number" if operator == "Count" else "other"
        return rules, {"key": key, "m": kind}

    def _robot(self) -> str:
        lot = self._lot
        scope = {"sensor.clock": "number", "memory.n": "number", "now": "text"}
        count = lot.choice(["Coalesce(memory.n, 0) + 1", "Bend(Coalesce(memory.n, 1))",
                            "Size(seen)", self._aggregate(scope)])  # fmt: skip
        return f"""
Robot(robot_name:, desire:, memory: {{phase:, n:, seen:, last:}}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:), desire == Go(),
  now == Coalesce(memory.phase, "out"), Plan(phase: now, least:, next:),
  phase == (if sensor.clock > least then next else now),
  seen == List{{ray.distance :- ray in sensor.radar, ray.label != "nothing"}},
  last == {{n: Coalesce(memory.n, 0), t: now}},
  n == {count};
"""
