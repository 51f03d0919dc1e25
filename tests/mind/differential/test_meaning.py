"""Programs mean what the platform's compiler, the development branch, made of them."""

import gzip
import json
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.mind import Mind, Program, ProgramError
from tests.mind.differential.whole_programs import engines, same_memory, told

_FILE = Path(__file__).parents[2] / "conformance" / "meaning.jsonl.gz"
with gzip.open(_FILE, "rt", encoding="utf-8") as _lines:
    FIRST, *RECORDS = map(json.loads, _lines)

REFUSED = {
    "Now": "robots have no clock but the sensor's",
    "Cast DATE": "robots have no dates",
    "=> with in": "the package's release does not parse it",
}


@pytest.mark.sampled
@pytest.mark.parametrize("record", RECORDS, ids=[record["title"] for record in RECORDS])
def test_a_program_means_what_it_means_on_the_platform(record: Any) -> None:
    try:
        program = Program.compile(record["program"])
    except ProgramError:
        assert record["title"] in REFUSED
        return
    with closing(Mind(program, "all", "all")) as mind:
        for moment in record["moments"]:
            for decision in mind.think(FIRST["sensors"][moment["sensors"]], moment["memories"]):
                rows = [r for r in moment["rows"] if r["robot_name"] == decision.robot_name]
                if len(rows) == 1:  # both sides have own rules for none and several
                    powers, memory = told(decision)
                    assert powers == pytest.approx(engines(rows[0]["desire"]), rel=1e-6)
                    assert same_memory(memory, rows[0]["memory"], 1e-6)
