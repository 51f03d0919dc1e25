"""Reading a file takes little memory, and ends with a level or a reason."""

import json
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import load_program
from logical_robots_tui.world import LevelError, load_level
from tests.processes import run_command
from tests.world.hostile import FILES

BYTES = 300 * 1024  # KiB that the process may grow by

READS = """if True:
    import re, resource, sys, time
    from logical_robots_tui.world import LevelError, load_level
    resource.setrlimit(resource.RLIMIT_AS, (int(sys.argv[1]),) * 2)

    def most():
        return int(re.search(r"VmHWM:\\s+(\\d+)", open("/proc/self/status").read())[1])

    for path in sys.argv[2:]:
        with open("/proc/self/clear_refs", "w") as file:
            file.write("5")
        before, began = most(), time.process_time()
        try:
            said = load_level(path).title and "loaded"
        except LevelError as error:
            said = str(error)
        print(json.dumps([said, time.process_time() - began, most() - before]), flush=True)
"""


def read(names: Sequence[str], folder: Path) -> list[tuple[str, float, int]]:
    """What reading some of the files says, its seconds of a processor, and KiB that it takes."""
    paths = []
    for number, name in enumerate(names):
        ending, content = FILES[name]
        path = folder / f"{number}{ending}"
        path.write_text(content(), encoding="utf-8", newline="")
        paths.append(str(path))
    script = "import json\n" + READS
    done = run_command([sys.executable, "-c", script, 1024**3, *paths])
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.mark.sampled
@pytest.mark.parametrize("part", range(10))
def test_a_hostile_level_file_is_refused_in_little_memory(part: int, tmp_path: Path) -> None:
    names = list(FILES)[part::10]
    assert len(FILES) >= 60
    for name, (said, _, grown) in zip(names, read(names, tmp_path), strict=True):
        assert grown < BYTES, (name, grown)
        assert said == "loaded" or len(said) < 600, name


@pytest.mark.parametrize("path", ["/proc/self/environ", "/proc/kmsg", "/dev/zero", "/dev/tty"])
def test_files_of_the_kernel_are_neither_levels_nor_programs(path: str, tmp_path: Path) -> None:
    (tmp_path / "level.toml").symlink_to("/proc/self/status")
    for level in (path, tmp_path / "level.toml"):
        with pytest.raises(LevelError, match=r"not a regular file|no such file"):
            load_level(level)
    with pytest.raises(InputError):
        load_program(path)
