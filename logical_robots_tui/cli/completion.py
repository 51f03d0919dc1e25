"""``logical-robots completion``: shell completion of commands, options and names."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from logical_robots_tui.cli.command import Commands, new_command

SHELLS = ("bash", "zsh", "fish")
NAMES = ("levels", "programs")
FILES, FOLDERS = "file", "directory"  # shtab's names


def declare(commands: Commands) -> None:
    command = new_command(commands, "completion", start)
    command.add_argument("what", choices=(*SHELLS, *NAMES), help="the shell, or names to print")


def start(options: argparse.Namespace) -> int:
    """print a completion script for your shell

    Print a script that completes commands, options, levels and programs.

    examples:
      logical-robots completion bash \\
        > ~/.local/share/bash-completion/completions/logical-robots
      logical-robots completion zsh > ~/.zfunc/_logical-robots
      logical-robots completion fish \\
        > ~/.config/fish/completions/logical-robots.fish

    Create the folder first if it does not exist; zsh also needs fpath+=~/.zfunc in
    ~/.zshrc. For the current shell only:
      eval "$(logical-robots completion bash)"

    The scripts call `completion levels` and `completion programs`, which print one
    name per line.
    """
    if options.what == "levels":
        from logical_robots_tui.paths import ARENAS, shipped_names

        for within in ("", ARENAS):
            print(*shipped_names("levels", ".toml", within), sep="\n")
    elif options.what == "programs":
        from logical_robots_tui.cli.command import folder_of
        from logical_robots_tui.game.source import list_programs

        print(*list_programs(folder_of(None) / "programs"), sep="\n")
    else:
        from shtab import complete

        from logical_robots_tui.cli.main import parser

        top = parser()
        for action in _arguments(top):
            completion = _completion(str(action.metavar))
            if completion:
                action.complete = completion  # type: ignore[attr-defined] # read by shtab
        print(complete(top, options.what))
    return 0


def _arguments(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    for action in parser._actions:
        yield action
        if isinstance(action, argparse._SubParsersAction):
            for command in dict.fromkeys(action.choices.values()):
                yield from _arguments(command)


def _completion(metavar: str) -> dict[str, object] | str | None:
    if metavar == "LEVEL":
        return _names_or_files("levels", ("toml", "json"))
    if metavar == "PROGRAM":
        return _names_or_files("programs", ("l",))
    return {"FILE": FILES, "FOLDER": FOLDERS}.get(metavar)


def _names_or_files(kind: str, endings: tuple[str, ...]) -> dict[str, object]:
    name = f"_logical_robots_{kind}"
    ask = f"logical-robots completion {kind} 2>/dev/null"
    globs = " ".join(f"'!*.{ending}'" for ending in endings)
    return {
        "bash": name,
        "zsh": name,
        "fish": f"({name})",
        "preamble": {
            "bash": f"""
{name}() {{
  compgen -W "$({ask})" -- "$1"
  local glob
  for glob in {globs}; do compgen -f -X "$glob" -- "$1"; done
  compgen -d -- "$1"
}}""",
            "zsh": f"""
{name}() {{
  local -a names
  names=(${{(f)"$({ask})"}})
  compadd -a names
  _files -g '*.({"|".join(endings)})'
}}""",
            "fish": f"""
function {name}
  {ask}
  __fish_complete_suffix {" ".join(f".{ending}" for ending in endings)}
end""",
        },
    }
