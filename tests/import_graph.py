"""Which modules of the checkout import which, wherever in a file they do.

Imports inside functions and those for type checkers count as well: who reads a file has to read
what it names.
"""

import ast
from collections.abc import Iterable, Iterator
from pathlib import Path

__all__ = ["imported_names", "module_of", "modules_imported"]


def module_of(path: Path, root: Path) -> str:
    """Return the dotted name of a file; a package has that of its folder."""
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported_names(tree: ast.AST, folder: str) -> Iterator[str]:
    """Yield the dotted names that a file imports; its folder is one, for relative imports."""
    for node in _statements(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            home = folder.rsplit(".", node.level - 1)[0] if node.level else ""
            source = ".".join(filter(None, (home, node.module)))
            yield from (f"{source}.{alias.name}" for alias in node.names)


def _statements(tree: ast.AST) -> Iterator[ast.AST]:
    nodes = [tree]
    for node in nodes:
        yield node
        for block in ("body", "orelse", "finalbody", "handlers", "cases"):
            nodes += getattr(node, block, ()) if not isinstance(node, ast.expr) else ()


def modules_imported(root: Path, folders: Iterable[str]) -> dict[str, set[str]]:
    """Return, by module of some folders of a checkout, the modules there that it imports."""
    paths = {
        module_of(path, root): path for folder in folders for path in (root / folder).rglob("*.py")
    }
    graph: dict[str, set[str]] = {}
    for module, path in paths.items():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        names = imported_names(tree, module_of(path.parent / "__init__.py", root))
        pairs = ((name, name.rpartition(".")[0]) for name in names)
        targets = (next((name for name in pair if name in paths), module) for pair in pairs)
        graph[module] = set(targets) - {module}
    return graph
