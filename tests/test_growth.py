"""Reading a text that is twice as large takes about twice as long, whatever is in it."""

import hashlib
import json
import lzma
import sqlite3
from collections.abc import Callable
from contextlib import closing
from itertools import product
from pathlib import Path
from typing import Any

import msgspec
import pytest

from logical_robots_tui.cli.progress import read_claims
from logical_robots_tui.game.replay import load_replay
from logical_robots_tui.lab.folder import Folder, Ledger
from logical_robots_tui.lab.handins import entries_of, stems_of
from logical_robots_tui.lab.submissions import plan_grading, read_assignment
from logical_robots_tui.lab.sweeping import read_experiment
from logical_robots_tui.language import package_patches
from logical_robots_tui.language.services import completion
from logical_robots_tui.language.services.completion import words_for
from logical_robots_tui.language.services.symbols import sections, symbol_at
from logical_robots_tui.language.source_text import prepare, size_of
from logical_robots_tui.mind.compiling.compiler import compile_text
from logical_robots_tui.mind.sqlite import casting
from logical_robots_tui.player.settings import read_settings, write_setting
from logical_robots_tui.toml_files import TomlFile
from logical_robots_tui.tui.commands.keymap import KeyMap
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.values import read_value
from logical_robots_tui.world import World
from logical_robots_tui.world.levels.load import read_level, read_web
from logical_robots_tui.world.levels.native import read_native
from tests.growth import few_of, growth_of
from tests.hostile_text import FILES, PROGRAMS, SIGNS
from tests.lab.test_handins import tarred, zipped

KEYS = KeyMap(COMMANDS)
DRAWN = "title = \"x\"\ncell = 10\nwalls = '''\n......\n......\n'''\n"
ROBOT = '[[robots]]\nname = "a"\nx = 15\ny = 15\n'
GRADES = '[assignment]\nroster = "roster.csv"\n[[level]]\nname = "01-first-steps"\n'
STATE = World(read_native(DRAWN + ROBOT, "x", "x")).save()

Read = Callable[[str, Path], object]


def written(folder: Path, name: str, content: str | bytes) -> Path:
    file = folder / name
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    return file


def quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def of_settings(text: str, folder: Path) -> None:
    read_settings(written(folder, "config.toml", text), KEYS.read)


def changed_settings(text: str, folder: Path) -> None:
    write_setting(written(folder, "config.toml", text), "frames", 20)


def of_assignment(text: str, folder: Path) -> None:
    spec = TomlFile(written(folder, "a.toml", text))
    read_assignment(spec)
    spec.refuse()


def of_experiment(text: str, folder: Path) -> None:
    spec = TomlFile(written(folder, "a.toml", text))
    read_experiment(spec)
    spec.refuse()


def of_roster(text: str, folder: Path) -> None:
    written(folder, "roster.csv", text)
    (folder / "submissions" / "1").mkdir(parents=True, exist_ok=True)
    plan_grading(written(folder, "a.toml", GRADES), folder / "submissions")


def of_late(text: str, folder: Path) -> None:
    """Students of a list who are not in the roster."""
    written(folder, "late.csv", "id\n" + text)
    late = GRADES + '[late]\nstudents = "late.csv"\nkeep = 0.5\n'
    written(folder, "roster.csv", "id\n" + "\n".join(f"a{n}" for n in range(len(text) // 100)))
    (folder / "submissions" / "1").mkdir(parents=True, exist_ok=True)
    plan_grading(written(folder, "a.toml", late), folder / "submissions")


def of_archive(pack: Callable[[Any], bytes], ending: str) -> Read:
    def read(text: str, folder: Path) -> None:
        names = [text[at : at + 4000] for at in range(0, len(text), 4000)]
        files = {f"{n}/{name}.l".replace("\0", ""): "x" for n, name in enumerate(names)}
        file = written(folder, f"class{ending}", pack(files))
        entries_of(file, stems_of(["01-first-steps"]), "{name}_{id}_{level}.l")

    return read


def of_gradescope(text: str, folder: Path) -> None:
    files = {"submission_metadata.yml": text, "s1/a.l": "", "s2/a.l": ""}
    entries_of(written(folder, "class.zip", zipped(files)), stems_of(["01-first-steps"]))


def of_replay(part: str) -> Read:
    def read(text: str, folder: Path) -> None:
        stage: dict[str, Any] = {"level": DRAWN + ROBOT, "state": STATE, "memories": "{}"}
        stage |= {"is_decided": False, "desires": [bytes(16)]}
        program = {"tick": 1, "name": "a", "text": "a"}
        (stage if part in stage else program)[part] = text
        replay = {"name": "x", "last": 1, "stages": [stage], "texts": [program]}
        body = lzma.compress(msgspec.msgpack.encode(replay | {"hashes": {1: bytes(8)}}), preset=0)
        head = b"logical-robots replay 1\n" + hashlib.sha256(body).digest()
        load_replay(written(folder, "a.replay", head + body))

    return read


def of_ledger(text: str, folder: Path) -> None:
    file = folder / "ledger.db"
    file.unlink(missing_ok=True)
    with closing(Ledger(file, "e")) as ledger:
        with closing(sqlite3.connect(file)) as database, database:
            database.executemany(
                "INSERT INTO results VALUES (?, 'e', ?, 'won', ?)",
                [(f"{n}", f"{n}", line) for n, line in enumerate(text.split("\n"))],
            )
        ledger.outcomes()
        ledger.failures()
        ledger.results()


READERS: dict[str, Read] = {
    "a level": lambda text, _: read_level(text, "x"),
    "the drawing of a level": lambda text, _: read_level(
        DRAWN.replace("......\n", text) + ROBOT, "x"
    ),
    "a name in a level": lambda text, _: read_level(
        DRAWN + ROBOT.replace('"a"', quoted(text)), "x"
    ),
    "a web level": lambda text, _: read_web(text, "x", "x"),
    "walls of a web level": lambda text, _: read_web(
        f'{{"width": 20, "height": 20, "walls": {quoted(text)}, "robots": []}}', "x", "x"
    ),
    "settings": of_settings,
    "a key map": lambda text, folder: of_settings("[keys]\n" + text, folder),
    "settings that are changed": changed_settings,
    "an assignment": of_assignment,
    "an experiment": of_experiment,
    "a roster": of_roster,
    "a list of late students": of_late,
    "a name in a roster": lambda text, folder: of_roster(f"id,name\n1,{text}\n", folder),
    "a zip": of_archive(zipped, ".zip"),
    "a tar": of_archive(lambda files: tarred(files, "w"), ".tar"),
    "Gradescope's metadata": of_gradescope,
    "the level of a replay": of_replay("level"),
    "the memories of a replay": of_replay("memories"),
    "the program of a replay": of_replay("text"),
    "a ledger": of_ledger,
    "a manifest": lambda text, folder: Folder(
        written(folder, "manifest.json", text).parent
    ).manifest(),
    "a value": lambda text, _: read_value(text),
    "progress": lambda text, folder: list(read_claims(written(folder, "progress.json", text))),
    "a program in progress": lambda text, folder: list(
        read_claims(
            written(
                folder,
                "progress.json",
                f'{{"format": 1, "levels": [{{"level": "x", "victories": [{{"program":'
                f' {quoted(text)}, "ticks": 1, "distance": 1}}]}}]}}',
            )
        )
    ),
}


def compiled(text: str, _folder: Path) -> None:
    package_patches.install()
    compile_text(text)


def cast(text: str, _folder: Path) -> None:
    casting.try_cast_like(f"{text} ", [{"a": 1.0}])
    casting.try_cast_like(f"{text} ", {"a": [1.0]})


def completed(text: str, _folder: Path) -> None:
    words_for(text, (0, len(text)))
    completion.call_before(text)
    completion.word_before(text)
    completion.word_around(text, len(text))
    completion.help_on(text, "Foo")


TEXT_READERS: dict[str, Read] = {
    "a program": compiled,
    "a text prepared": lambda text, _: prepare(text),
    "a size": lambda text, _: size_of(text),
    "a text cast": cast,
    "a text shown": lambda text, _: casting.to_text(text),
    "a text completed": completed,
    "a name changed": lambda text, _: (symbol_at(text, 0), [*sections(text)]),
}
CASES = [*product(READERS, SIGNS | FILES), *product(TEXT_READERS, SIGNS | PROGRAMS)]


@pytest.mark.parametrize(("reader", "family"), few_of(CASES))
def test_time_grows_with_the_size(reader: str, family: str, tmp_path: Path) -> None:
    read, text = (READERS | TEXT_READERS)[reader], (SIGNS | PROGRAMS | FILES)[family]
    assert growth_of(lambda text: read(text, tmp_path), text) == ""
