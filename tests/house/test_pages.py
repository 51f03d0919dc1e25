"""What the game has is named where a reader looks for it, on pages that are written by hand.

Other tables are made from the code: of fields, settings and typed commands by ``docs.reference``,
of keys in ``test_readme``; `tests/lab/test_specification.py` compares the keys of an experiment.
"""

import re
from collections.abc import Sequence
from typing import get_args

import pytest

from logical_robots_tui.lab.folder import BUILT_IN
from logical_robots_tui.lab.running import Outcome, Reduction
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.inspector.register import PAGES
from tests.house.examples import commands
from tests.installed import CHECKOUT

EXPERIMENT, ENDS = "What an experiment can say", "How a run ends"
COMMAND_PAGES = {"level": "level-editor.md", "lab": "lab.md", "lab play": "grading.md"}
"""Where commands with such a beginning are told of; the others are in commands.md."""


def section(page: str, heading: str = "") -> str:
    """The text below a heading of a page of docs, or the whole page."""
    text = (CHECKOUT / "docs" / page).read_text("utf-8")
    return text.partition(f"\n## {heading}\n")[2].partition("\n## ")[0] if heading else text


def page_of(command: str) -> str:
    fallback = COMMAND_PAGES.get(command.split(" ")[0], "commands.md")
    return COMMAND_PAGES.get(command, fallback)


CALLS = ("logical-robots {}", "`{}`")
NAMED = [
    # a page, a heading of it, what is named below it, and how it may be written there
    ("lab.md", EXPERIMENT, BUILT_IN, ("{}",)),
    ("lab.md", EXPERIMENT, get_args(Reduction), ("`{}`",)),
    ("lab.md", ENDS, get_args(Outcome), ("`{}`",)),
    ("playing.md", "Keys", [entry.title for entry in COMMANDS if not entry.keys], ("{}",)),
    *(
        (page, "", [name for name in commands() if name and page_of(name) == page], CALLS)
        for page in sorted(set(map(page_of, commands())))
    ),
]


@pytest.mark.parametrize(("page", "heading", "names", "forms"), NAMED)
def test_a_page_names_all_of_a_kind(
    page: str, heading: str, names: Sequence[str], forms: tuple[str, ...]
) -> None:
    text = section(page, heading)
    assert names
    patterns = {name: "|".join(re.escape(form.format(name)) for form in forms) for name in names}
    missing = [
        name for name, either in patterns.items() if not re.search(rf"({either})(?!\w)", text)
    ]
    assert not missing, f"docs/{page} does not name {', '.join(missing)}"


def test_the_inspector_has_the_pages_that_its_page_lists() -> None:
    rows = re.findall(r"^\| \[?(.*?)(?:\]\(.*?\))? \|", section("inspector.md", "Pages"), re.M)
    listed = rows[rows.index("page") : rows.index("key")]
    assert listed[1:] == [page.title or "a predicate" for page in PAGES], "docs/inspector.md"
