"""``python -m tests.house.figures``: what a reader pays for, and modules and rooms to cut soon."""

import ast
import re
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

__all__ = ["VAGUE", "Figures", "figures_of"]

FEW_MODULES, FEW_LINES = 15, 500  # beyond which `make lint` warns
VAGUE = frozenset(
    re.findall(
        "[a-z_]+",
        """each found said told known given wanted mine others other shown asked taken kept made
        done reached seen heard held sure some rest what one own here there ones thing things stuff
        data info obj tmp res ret val out most least few way ways of at by before after past then
        now next_ more less else_ chosen left_out put gone come came meant due""",
    )
)
"""Names that do not say what is bound to them: participles, adverbs, prepositions."""


class Figures(NamedTuple):
    """Of a package.

    Attributes:
        lines: By module.
        modules: By room, besides `__init__`.
        bodies: Lines of the body of each function, without its docstring.
        vague: How often vague names are bound.
        ambiguous: Where classes of one name are defined, if that is in several places.
    """

    lines: dict[str, int]
    modules: Counter[str]
    bodies: list[int]
    vague: Counter[str]
    ambiguous: dict[str, list[str]]


def bound_names(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id
        elif isinstance(node, ast.arg):
            yield node.arg


def figures_of(package: Path) -> Figures:
    figures = Figures({}, Counter(), [], Counter(), {})
    classes = defaultdict(list)
    for path in sorted(package.rglob("*.py")):
        text, module = path.read_text("utf-8"), str(path.relative_to(package))
        tree = ast.parse(text)
        figures.lines[module] = text.count("\n")
        figures.modules[str(path.parent.relative_to(package))] += path.stem != "__init__"
        figures.vague.update(name for name in bound_names(tree) if name in VAGUE)
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                classes[node.name.strip("_")].append(f"{module}:{node.lineno}")
            elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                body = node.body[ast.get_docstring(node) is not None :]
                size = (body[-1].end_lineno or 0) - body[0].lineno + 1 if body else 0
                figures.bodies.append(size)
    figures.ambiguous.update((name, places) for name, places in classes.items() if places[1:])
    return figures


def main() -> None:
    figures = figures_of(Path(__file__).parents[2] / "logical_robots_tui")
    print(
        f"{sum(figures.lines.values()):,} lines, {len(figures.bodies):,} functions of "
        f"{sum(figures.bodies) / len(figures.bodies):.1f} lines, {figures.vague.total()} vague "
        f"names, {len(figures.ambiguous)} names of several classes"
    )
    for module, lines in figures.lines.items():
        if lines > FEW_LINES:
            print(f"warning: {module} has {lines} lines; cut it by ideas at {FEW_LINES}")
    for room, modules in figures.modules.items():
        if modules > FEW_MODULES:
            print(f"warning: {room} has {modules} modules; cut it by ideas at {FEW_MODULES}")


if __name__ == "__main__":
    main()
