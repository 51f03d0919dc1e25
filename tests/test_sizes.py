"""What is larger than docs/security.md lets in is refused by its size, before it is read."""

from collections.abc import Callable
from pathlib import Path

import pytest

from logical_robots_tui.cli.progress import read_claims
from logical_robots_tui.errors import LogicalRobotsError
from logical_robots_tui.game.replay import load_replay
from logical_robots_tui.game.source import load_program
from logical_robots_tui.lab.folder import Folder
from logical_robots_tui.lab.handins import entries_of
from logical_robots_tui.player.settings import write_setting
from logical_robots_tui.toml_files import TomlFile
from logical_robots_tui.world.levels.load import load_level
from tests.installed import CHECKOUT

MB = 1_000_000
SIZES: list[tuple[str, str, int, Callable[[Path], object]]] = [
    ("a level", "a.toml", 64 * MB, lambda file: load_level(str(file))),
    ("settings", "config.toml", MB, lambda file: write_setting(file, "frames", 20)),
    ("an assignment", "a.toml", MB, TomlFile),
    ("a program", "a.l", MB, lambda file: load_program(str(file))),
    ("a replay", "a.replay", 64 * MB, load_replay),
    ("a manifest", "manifest.json", 64 * MB, lambda file: Folder(file.parent).manifest()),
    ("exported progress", "export.json", 20 * MB, lambda file: list(read_claims(file))),
    (
        "Gradescope's metadata",
        "submission_metadata.yml",
        MB,
        lambda file: entries_of(file.parent, {"01-first-steps": "01-first-steps"}),
    ),
]
PAGE = (CHECKOUT / "docs" / "security.md").read_text("utf-8")
TABLE = PAGE.partition("## Sizes that are let in")[2].splitlines()


@pytest.mark.parametrize(("kind", "name", "size", "read"), SIZES, ids=[case[0] for case in SIZES])
def test_a_file_one_byte_too_large_is_refused(
    kind: str, name: str, size: int, read: Callable[[Path], object], tmp_path: Path
) -> None:
    row = next(line for line in TABLE if line.startswith("| ") and kind in line)
    assert f"{size // MB} MB" in row
    file = tmp_path / name
    with file.open("wb") as content:
        content.truncate(size + 1)
    with pytest.raises(LogicalRobotsError, match=r"large|MB|bytes"):
        read(file)
