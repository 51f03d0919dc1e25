"""Kits with which Gradescope and GitHub Classroom grade each submission as it is handed in."""

from __future__ import annotations

from pathlib import Path

import tomlkit

from logical_robots_tui import __version__
from logical_robots_tui.lab.submissions import read_assignment, read_levels
from logical_robots_tui.toml_files import TomlFile

_TEMPLATES = Path(__file__).with_name("templates")
_FILES = {
    "gradescope": {name: name for name in ("setup.sh", "run_autograder")},
    "github": {
        "setup.sh": ".github/classroom/setup.sh",
        "run_autograder": ".github/classroom/run_autograder",
        "classroom.yml": ".github/workflows/classroom.yml",
    },
}
"""Where the templates go, by platform."""

_OF_A_CLASS = {
    "assignment": ("roster", "columns", "pattern", "by_hand"),
    "late": ("students", "extensions"),
}
"""Keys about the students of a class, whom a kit does not know and may not name."""


def kit_of(platform: str, file: Path) -> tuple[dict[str, str], list[str]]:
    """Return the texts of a kit by path, and the keys of the assignment that are not in it.

    Raises TomlFileError for a wrong assignment.
    """
    spec = TomlFile(file)
    assignment = read_assignment(spec)
    levels, _ = read_levels(spec, assignment)
    spec.refuse()
    paths = _FILES[platform]
    texts = {path: (_TEMPLATES / name).read_text("utf-8") for name, path in paths.items()}
    texts[paths["setup.sh"]] = texts[paths["setup.sh"]].replace("VERSION", __version__)
    folder = paths["setup.sh"].removesuffix("setup.sh")
    document = {**spec.data, "assignment": {"title": file.stem, **spec.data["assignment"]}}
    omitted = [
        f"{table}.{key}"
        for table, keys in _OF_A_CLASS.items()
        for key in keys
        if document.get(table, {}).pop(key, None)
    ]
    for level_table in document["level"]:
        path = Path(level_table["name"])
        if path.suffix or len(path.parts) > 1:
            level_table["name"] = f"levels/{path.name}"
            texts[folder + level_table["name"]] = levels[path.stem][0]
    texts[f"{folder}assignment.toml"] = tomlkit.dumps(document)
    return texts, omitted
