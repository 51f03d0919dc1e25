"""``logical-robots serve``: the game in a browser on this computer."""

from __future__ import annotations

import argparse
import os
import sys
import webbrowser
from threading import Thread

from logical_robots_tui.cli import command
from logical_robots_tui.errors import InputError, check_installed


@command.declare(
    "serve",
    command.option("level", "LEVEL", "a level's name or file", nargs="?"),
    command.option("program", "PROGRAM", "a program's name or file", nargs="?"),
    command.option("--port", "N", "the port, by default any that is free", type=int, default=0),
    command.flag("--no-open", "print the address only, without opening a browser"),
    command.DATA_DIR,
)
def serve(options: argparse.Namespace) -> int:
    """play in a browser on this computer

    Play in a browser on this computer, with your own files, until ^C.
    Whoever has the printed address can play as you; nobody else can.

    examples:
      logical-robots serve                  open the game in the browser
      logical-robots serve 02-open-space --no-open

    exit status: 0 after ^C, 2 if the page can't be served
    """
    for library in ("aiohttp", "textual_serve"):
        check_installed(library, "A browser", "'logical-robots-tui[web]'")
    from logical_robots_tui.web.server import serve as serve_page

    words = [word for word in (options.level, options.program) if word is not None]
    if options.data_dir is not None:
        words += ["--data-dir", str(options.data_dir)]

    def announce(address: str) -> None:
        print(f"Playing at {address}\n^C ends the game; unsaved text is kept.", flush=True)
        # Without a desktop it would be a browser in this terminal.
        has_desktop = sys.platform == "darwin" or {"DISPLAY", "WAYLAND_DISPLAY"} & {*os.environ}
        if has_desktop and not options.no_open:
            Thread(target=webbrowser.open, args=(address,), daemon=True).start()

    try:
        serve_page(words, options.port, announce)
    except (OSError, OverflowError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"Port {options.port} can't be used: {reason}") from None
    return 0
