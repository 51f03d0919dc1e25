"""No two files of the package import each other, at first or second hand.

Imports inside functions and those for type checkers count as well: who reads a file has to read
what it names.
"""

from __future__ import annotations

import ast
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from collections.abc import Set as AbstractSet

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "logical_robots_tui"


def module_of(path: Path, root: Path) -> str:
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported(tree: ast.AST) -> Iterator[str]:
    """Dotted names that a file imports, wherever it does."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, "imports name the whole path"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def import_graph(package: Path, root: Path) -> dict[str, set[str]]:
    """By module of a package the modules of it that it imports."""
    trees = {
        module_of(path, root): ast.parse(path.read_text(encoding="utf-8"))
        for path in package.rglob("*.py")
    }
    graph: dict[str, set[str]] = {}
    for module, tree in trees.items():
        names = ((name, name.rpartition(".")[0]) for name in imported(tree))
        found = (next((name for name in pair if name in trees), module) for pair in names)
        graph[module] = set(found) - {module}
    return graph


def circles(graph: Mapping[str, AbstractSet[str]]) -> list[set[str]]:
    """The strongly connected components of more than one module (Tarjan's algorithm)."""
    order: dict[str, int] = {}
    lowest: dict[str, int] = {}
    stack: list[str] = []
    found: list[set[str]] = []

    def visit(module: str) -> None:
        order[module] = lowest[module] = len(order)
        stack.append(module)
        for other in graph[module]:
            if other not in order:
                visit(other)
                lowest[module] = min(lowest[module], lowest[other])
            elif other in stack:
                lowest[module] = min(lowest[module], order[other])
        if lowest[module] == order[module]:
            place = stack.index(module)
            if len(stack) - place > 1:
                found.append(set(stack[place:]))
            del stack[place:]

    for module in graph:
        if module not in order:
            visit(module)
    return found


def test_a_circle_is_found_wherever_the_imports_stand(tmp_path: Path) -> None:
    texts = {
        "__init__": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n  from p.a import f",
        "a": "import p.b",
        "b": "def g():\n  from p import c",
        "c": "if 0:\n  from p.a import f",
        "d": "import p.a, os",
    }
    package = tmp_path / "p"
    package.mkdir()
    for name, text in texts.items():
        (package / f"{name}.py").write_text(text, encoding="utf-8")
    assert circles(import_graph(package, tmp_path)) == [{"p.a", "p.b", "p.c"}]


def test_no_circle_of_files() -> None:
    assert circles(import_graph(PACKAGE, ROOT)) == []
