"""Habits of the house that no linter knows."""

import ast
import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import pytest

from tests.installed import CHECKOUT

SOURCES = sorted(
    path
    for folder in ("logical_robots_tui", "tests", "benchmarks", "docs")
    for path in (CHECKOUT / folder).rglob("*.py")
)
MODULES = [path for path in SOURCES if path.is_relative_to(CHECKOUT / "logical_robots_tui")]
BENCHMARKS = [path for path in SOURCES if path.is_relative_to(CHECKOUT / "benchmarks")]
TESTS = [path for path in SOURCES if path.is_relative_to(CHECKOUT / "tests")]

SILENCED_WITHOUT_REASON = re.compile(r"# (?:noqa|type: ignore)(?!.*(?: # | - )\S+)[^()]*$")
ACTS = re.compile(r"\.(press|drag|click|hover|write|post_message|resize|resize_terminal)\(")
WAITS = re.compile(r"\b(until|sees|sees_no|tick|on)=")
CLOCKS = re.compile(r"\b(monotonic|perf_counter|process_time|thread_time)(_ns)?\(\) - ")
SLEEPS = re.compile(r"(\w+\.)*(sleep\((?!0\))|pause\((delay=)?[\d.])")


def nodes(path: Path, words: str) -> Iterator[ast.AST]:
    """What stands in a module in which some words occur, which saves reading most of them."""
    text = path.read_text(encoding="utf-8")
    if re.search(words, text):
        yield from ast.walk(ast.parse(text))


def place(path: Path, node: ast.expr | ast.stmt) -> str:
    return f"{path.relative_to(CHECKOUT)}:{node.lineno}: {ast.unparse(node)}"


def sleeps(path: Path) -> Iterator[str]:
    """Where a module sleeps for some time; sleeping 0 only makes room."""
    for node in nodes(path, r"(sleep|pause)\("):
        if isinstance(node, ast.Call) and SLEEPS.match(ast.unparse(node)):
            yield place(path, node)


def statements(body: Iterable[ast.AST]) -> Iterator[ast.stmt]:
    for node in body:
        inside = [
            child
            for child in ast.iter_child_nodes(node)
            if isinstance(child, ast.stmt | ast.ExceptHandler | ast.match_case)
        ]
        if isinstance(node, ast.stmt) and not inside:
            yield node
        elif not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield from statements(inside)


def hasty_asserts(path: Path) -> Iterator[str]:
    """Where a test asserts what an action has led to without having waited for it."""
    for function in nodes(path, ACTS.pattern):
        if not isinstance(function, ast.AsyncFunctionDef):
            continue
        has_acted = False
        for statement in statements(function.body):
            text = ast.unparse(statement)
            if ACTS.search(text):
                has_acted = not WAITS.search(text)
            elif any(isinstance(node, ast.Await) for node in ast.walk(statement)):
                has_acted = False
            elif has_acted and isinstance(statement, ast.Assert):
                yield place(path, statement)


def timed_asserts(path: Path) -> Iterator[str]:
    """Where a test asserts how long something took; to bound a wait is something else."""
    for node in nodes(path, CLOCKS.pattern):
        if isinstance(node, ast.Assert) and CLOCKS.search(ast.unparse(node.test)):
            yield place(path, node)


def waits(path: Path) -> Iterator[str]:
    """Where a test waits for a process or a thread without a bound; who awaits is bounded above."""
    inside = list(nodes(path, r"subprocess\.run|\.(wait|join|communicate)\(\s*\)"))
    awaited = {id(node.value) for node in inside if isinstance(node, ast.Await)}
    calls = [node for node in inside if isinstance(node, ast.Call)]
    awaited |= {
        id(argument)
        for call in calls
        if ast.unparse(call.func) == "asyncio.wait_for"
        for argument in call.args
    }
    for call in calls:
        name = ast.unparse(call.func)
        runs = name == "subprocess.run" and not any(k.arg == "timeout" for k in call.keywords)
        ends = re.search(r"\.(wait|join|communicate)$", name) and not (call.args or call.keywords)
        if (runs or ends) and id(call) not in awaited:
            yield place(path, call)


@pytest.mark.parametrize("habit", [timed_asserts, sleeps, hasty_asserts, waits])
def test_no_test_asserts_or_passes_a_time_looks_too_soon_or_waits_for_ever(
    habit: Callable[[Path], Iterator[str]],
) -> None:
    others = BENCHMARKS if habit is waits else []
    assert [told for path in (*TESTS, *others) for told in habit(path)] == []


def test_the_check_for_hasty_asserts_finds_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tests.house.test_habits.CHECKOUT", tmp_path)
    path = tmp_path / "test_it.py"
    act, wait, look = "  await game.press('n')", "  await game.settled()", "  assert game.tick"
    for lines, found in (
        ([act, look], 1),
        ([act, "  tick = 1", "  with game:", f"  {look}"], 1),
        ([act, wait, look, look], 0),
        ([act, "  assert await game.sees('x')", look], 0),
        (["  await game.press('n', sees='x')", look], 0),
        ([look], 0),
    ):
        path.write_text("\n".join(["async def test() -> None:", *lines]))
        assert len(list(hasty_asserts(path))) == found, lines


def test_a_checker_is_silenced_only_with_a_reason_beside_it() -> None:
    unreasoned = [
        f"{path.relative_to(CHECKOUT)}:{number}: {line.strip()}"
        for path in SOURCES
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if SILENCED_WITHOUT_REASON.search(line)
    ]
    assert unreasoned == []


def test_a_module_is_one_idea_and_says_which() -> None:
    for path in MODULES:
        text = path.read_text(encoding="utf-8")
        assert text.startswith('"""'), path


def test_a_room_is_on_the_map() -> None:
    package = CHECKOUT / "logical_robots_tui"
    folders = {path.parent for path in MODULES}
    map_ = (CHECKOUT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = set(re.findall(r"^\| `([a-z_/]+)/` \|", map_, re.MULTILINE))
    rooms = {str(folder.relative_to(package)) for folder in folders if folder != package}
    assert rooms <= named


def test_a_file_of_tests_can_be_read_in_one_go() -> None:
    long = {
        str(path.relative_to(CHECKOUT)): lines
        for path in TESTS
        if path.name.startswith("test_")
        and (lines := path.read_text(encoding="utf-8").count("\n")) > 400
    }
    assert not long


PACKAGE_KEYS = {
    *("aggregation", "combine", "conjunct", "conjunction", "disjunct", "disjunction", "element"),
    *("expression", "expression_heritage", "field_value", "full_text", "if_then", "implication"),
    *("inclusion", "left_hand_side", "literal", "otherwise", "predicate_name", "right_hand_side"),
    *("subscript", "the_bool", "the_list", "the_null", "the_number", "the_predicate"),
    *("the_string", "the_symbol", "unification", "var_name", "variable", "distinct_denoted"),
}
"""Keys of the nodes that the `logica` package parses."""


def keys_in(tree: ast.AST) -> Iterator[str]:
    """Texts that are looked up in something: ``x["a"]``, ``x.get("a")``, ``"a" in x``."""
    for node in ast.walk(tree):
        found: ast.AST | None = None
        if isinstance(node, ast.Subscript):
            found = node.slice
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.args:
            found = node.args[0] if node.func.attr in ("get", "pop", "setdefault") else None
        elif isinstance(node, ast.Compare) and isinstance(node.ops[0], ast.In | ast.NotIn):
            found = node.left
        if isinstance(found, ast.Constant) and isinstance(found.value, str):
            yield found.value


def test_only_the_adapter_knows_the_nodes_of_the_package() -> None:
    package = CHECKOUT / "logical_robots_tui"
    adapter = {package / "language" / name for name in ("adapter.py", "package_patches.py")}
    seen = {
        path: PACKAGE_KEYS.intersection(keys_in(ast.parse(path.read_text(encoding="utf-8"))))
        for part in ("language", "mind", "explain")
        for path in (package / part).rglob("*.py")
    }
    assert {path for path, keys in seen.items() if keys} == adapter


def test_the_tests_of_the_screen_have_its_rooms() -> None:
    rooms, tested = (
        {path.name for path in (CHECKOUT / folder).iterdir() if (path / "__init__.py").exists()}
        for folder in ("logical_robots_tui/tui", "tests/tui")
    )
    assert rooms == tested
