"""No two files of the package import each other, at first or second hand."""

from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from tests.import_graph import modules_imported
from tests.installed import CHECKOUT


def test_a_circle_is_found_wherever_the_imports_stand(tmp_path: Path) -> None:
    texts = {
        "__init__": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n  from p.a import f",
        "a": "import p.b",
        "b": "def g():\n  from p import c",
        "c": "if 0:\n  from p.a import f",
        "d": "import p.a, os",
    }
    (tmp_path / "p").mkdir()
    for name, text in texts.items():
        (tmp_path / "p" / f"{name}.py").write_text(text, encoding="utf-8")
    with pytest.raises(CycleError) as error:
        TopologicalSorter(modules_imported(tmp_path, ["p"])).prepare()
    assert set(error.value.args[1]) == {"p.a", "p.b", "p.c"}


def test_no_circle_of_files() -> None:
    TopologicalSorter(modules_imported(CHECKOUT, ["logical_robots_tui"])).prepare()
