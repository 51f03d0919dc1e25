"""``python -m benchmarks``: the numbers that matter, as a table and as JSON."""

from __future__ import annotations

import os
import sys

from benchmarks.answers import answers
from benchmarks.arenas import arenas
from benchmarks.arrivals import arrivals
from benchmarks.board import boards
from benchmarks.breakpoints import breakpoints
from benchmarks.classes import classes, large_classes
from benchmarks.diagnosing import diagnosing
from benchmarks.editing import editing
from benchmarks.editors import editors
from benchmarks.first_frame import first_frame
from benchmarks.folding import folding
from benchmarks.functions import functions
from benchmarks.history import history
from benchmarks.inspector import inspector
from benchmarks.lab import laboratory
from benchmarks.learning import learning
from benchmarks.memory import memory
from benchmarks.mind import compiling, thinking
from benchmarks.proofs import proofs
from benchmarks.replays import replays
from benchmarks.runner import Suite, run
from benchmarks.safety import safety
from benchmarks.schemas import schemas
from benchmarks.sessions import session
from benchmarks.ssh import processor, ssh
from benchmarks.swarm import swarms
from benchmarks.teams import teams
from benchmarks.tournament import tournament
from benchmarks.web import web
from benchmarks.whole_game import whole_game
from benchmarks.with_screen import traffic, with_screen
from benchmarks.world import crowds
from logical_robots_tui.caching import FOLDER_VARIABLE
from logical_robots_tui.processes.helper import collect_seldom

SUITE = Suite(
    {
        "world": crowds,
        "compile": compiling,
        "think": thinking,
        "functions": functions,
        "schemas": schemas,
        "swarms": swarms,
        "teams": teams,
        "game": whole_game,
        "breakpoints": breakpoints,
        "editing": editing,
        "history": history,
        "replays": replays,
        "memory": memory,
        "session": session,
        "safety": safety,
        "inspector": inspector,
        "folding": folding,
        "answers": answers,
        "diagnosing": diagnosing,
        "lsp": editors,
        "proofs": proofs,
        "screen": with_screen,
        "traffic": traffic,
        "ssh": ssh,
        "class": classes,
        "large-class": large_classes,
        "arrivals": arrivals,
        "web": web,
        "board": boards,
        "lab": laboratory,
        "learning": learning,
        "arenas": arenas,
        "tournament": tournament,
        "processor": processor,
        "first-frame": first_frame,
    },
    named=frozenset(
        {
            "arrivals",
            "arenas",
            "functions",
            "lab",
            "large-class",
            "learning",
            "memory",
            "safety",
            "session",
            "tournament",
            "web",
        }
    ),
    thorough=frozenset(
        {"class", "editing", "folding", "inspector", "processor", "ssh", "teams", "traffic"}
    ),
)

if __name__ == "__main__":
    collect_seldom()  # as the commands do
    os.environ[FOLDER_VARIABLE] = ""  # cached programs would make the numbers too good
    sys.exit(run(SUITE))
