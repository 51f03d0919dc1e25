"""What the game has and promises is named and pictured where a reader looks for it.

Other tables are made from the code: of fields, settings and typed commands by ``docs.reference``,
of keys in ``test_readme``; `tests/lab/test_specification.py` compares the keys of an experiment.
"""

import re
from collections.abc import Sequence
from typing import get_args

import pytest

from docs.screenshot import DOCS, PICTURES
from logical_robots_tui.cli.play import LIMITS
from logical_robots_tui.lab.folder import BUILT_IN
from logical_robots_tui.lab.tasks import Outcome, Reduction
from logical_robots_tui.mind import Limits
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.inspector.register import PAGES
from tests.house.examples import commands
from tests.installed import CHECKOUT
from tests.mind.hostile.programs import PROGRAMS
from tests.world.hostile import FILES

EXPERIMENT, ENDS = "What an experiment can say", "How a run ends"
COMMAND_PAGES = {
    "level": "level-editor.md",
    "lab": "lab.md",
    "lab play": "grading.md",
    "grade kit": "autograders.md",
    "serve": "web.md",
}
"""Where commands with such a beginning are told of; the others are in commands.md."""


def section(page: str, heading: str = "") -> str:
    text = (CHECKOUT / "docs" / page).read_text("utf-8")
    return text.partition(f"\n## {heading}\n")[2].partition("\n## ")[0] if heading else text


def page_of(command: str) -> str:
    return COMMAND_PAGES.get(command, COMMAND_PAGES.get(command.split(" ")[0], "commands.md"))


CALLS = ("logical-robots {}", "`{}`")
NAMED = [
    # a page, a heading of it, what is named below it, and how it may be written there
    ("lab.md", EXPERIMENT, BUILT_IN, ("{}",)),
    ("lab.md", EXPERIMENT, get_args(Reduction), ("`{}`",)),
    ("lab.md", ENDS, get_args(Outcome), ("`{}`",)),
    (
        "playing.md",
        "Keys",
        [e.title for e in COMMANDS if not e.keys and e.needs != "browser"],
        ("{}",),
    ),
    ("web.md", "", [entry.title for entry in COMMANDS if entry.needs == "browser"], ("{}",)),
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


LARGEST = 300_000


def steady(picture: str) -> str:
    """The first frame of a picture without the rules for its motion; what others show varies."""
    first, _, _ = picture.partition('<g class="f1">')
    return re.sub(r"<style>.*</style>", "", first, flags=re.DOTALL)


@pytest.mark.slow
@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_shows_the_game_as_it_is(name: str) -> None:
    assert steady(PICTURES[name]()) == steady((DOCS / f"{name}.svg").read_text("utf-8"))


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_is_small(name: str) -> None:
    assert len((DOCS / f"{name}.svg").read_bytes()) < LARGEST


def test_the_picture_of_a_browser_is_small() -> None:
    assert (DOCS / "browser.png").stat().st_size < LARGEST / 2


PAGE = (CHECKOUT / "docs" / "security.md").read_text("utf-8")


def test_each_promise_names_a_test_that_is_there() -> None:
    named = re.findall(r"`(tests/[\w/]+\.py)`", PAGE)
    assert len(named) > 12
    assert [path for path in named if not (CHECKOUT / path).is_file()] == []


def test_the_numbers_of_hostile_programs_and_files_are_true() -> None:
    assert f"{len(PROGRAMS)} programs" in PAGE
    assert f"{len(FILES)} files" in PAGE


def test_the_table_of_limits_tells_them_all() -> None:
    for name in Limits.__dataclass_fields__:
        assert f"`{name}`" in PAGE, name
    for number in ("think_steps", "query_steps", "memory_weight", "think_weight"):
        assert f"{getattr(Limits(), number):,}" in PAGE, number
    assert LIMITS["RLIMIT_AS"] >= 2 * Limits().mind_bytes
