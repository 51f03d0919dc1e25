"""The examples that a reader finds: command lines and code in the help, the README and the docs."""

import argparse
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from logical_robots_tui.cli.main import PROGRAM
from logical_robots_tui.cli.main import parser as command_parser
from tests.installed import CHECKOUT

__all__ = ["PAGES", "Block", "blocks", "commands", "in_help", "in_page"]

PAGES = (CHECKOUT / "README.md", *sorted((CHECKOUT / "docs").glob("*.md")))
_REMARK = re.compile(r"""((?:'[^']*'|"[^"]*"|[^'"])*?)(?:\s{2,}.*)?""", re.DOTALL)
_FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_CALL = re.compile(rf"(?:^|\| ){PROGRAM}(?: |$)")


@dataclass(frozen=True)
class Block:
    language: str
    text: str


def blocks(page: Path) -> list[Block]:
    return [Block(*found.groups()) for found in _FENCE.finditer(page.read_text("utf-8"))]


def commands() -> dict[str, argparse.ArgumentParser]:
    """The parser of every command by what is typed for it, such as "level new"."""
    return dict(_commands(command_parser(), ""))


def _commands(
    parser: argparse.ArgumentParser, name: str
) -> Iterator[tuple[str, argparse.ArgumentParser]]:
    yield name, parser
    for action in parser._actions:  # argparse has no other way to list them
        if isinstance(action, argparse._SubParsersAction):
            for each, parser_of_it in action.choices.items():
                yield from _commands(parser_of_it, f"{name} {each}".strip())


def in_help(parser: argparse.ArgumentParser) -> list[str]:
    """The command lines under "examples:" in a help, without the remarks beside them."""
    _, _, after = parser.format_help().partition("\nexamples:\n")
    examples, _, _ = after.partition("\n\n")
    joined = re.sub(r"\\\n\s*", "", examples)
    return [_bare(line) for line in joined.splitlines() if re.match(r"  \S", line)]


def in_page(page: Path) -> list[str]:
    """The command lines in a page: in code without a language, and between backquotes."""
    text = page.read_text("utf-8")
    lines = [
        _bare(line)
        for block in blocks(page)
        if block.language in {"", "sh"}
        for line in re.sub(r"\\\n\s*", "", block.text).splitlines()
        if _CALL.search(line)
    ]
    for quoted in re.findall(rf"`({PROGRAM}[^`]*)`", _FENCE.sub("", text)):
        words = quoted.split()
        # The mere name of a command stands for the command, not for a line to type.
        lines.append(" ".join([*words, "--help"] if len(words) <= 2 else words))
    return lines


def _bare(line: str) -> str:
    """A line without the remark that stands beside it, two blanks or more to the right."""
    found = _REMARK.fullmatch(line.strip())
    assert found, f"quotes that do not match: {line}"
    return found[1]
