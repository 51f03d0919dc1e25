"""What is wrong is published while a program is typed, and is what ``check`` says."""

import os
import signal
from pathlib import Path

import pytest
from lsprotocol import types

from logical_robots_tui.cli.check import diagnostics
from logical_robots_tui.game import load_program
from logical_robots_tui.lsp.levels import level_of
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.world import load_level
from tests.lsp.editor import Editor
from tests.mind.test_broken import FINE, PROGRAMS
from tests.processes import is_running
from tests.waiting import until

pytestmark = pytest.mark.asyncio(loop_scope="module")

SEEKING = FINE + '\nA(r) :- Sensor(robot_name: r, sensor:), sensor.forward_label == "Harbor";'
SAMPLE = [*PROGRAMS][::17]


def words(published: list[types.Diagnostic]) -> list[tuple[int, str]]:
    return [(diagnostic.range.start.line + 1, diagnostic.message) for diagnostic in published]


@pytest.mark.parametrize("name", [*SAMPLE, "lighthouse", "first-steps-starter"])
async def test_it_says_what_check_says(name: str, editor: Editor) -> None:
    text = PROGRAMS[name][0] if name in PROGRAMS else load_program(name).text
    expected = [
        (d.line, f"{d.message}. {d.hint}" if d.hint else d.message) for d in diagnostics(text)
    ]
    editor.open(text)
    await editor.published(lambda found: words(found) == expected)  # at last


@pytest.mark.parametrize(
    ("text", "name", "setting", "level"),
    [
        ("# level: 05-lighthouse\n", "05-lighthouse.l", "", "05-lighthouse"),
        ("\n#level:  mine.toml \nA(1);", "lighthouse.l", "03-the-long-hall", "mine.toml"),
        ("A(1);\n# level: mine.toml", "lighthouse-2.l", "", "05-lighthouse"),
        ("", "the-long-hall-starter.l", "", "03-the-long-hall"),
        *(("", name, "08-formation", "08-formation") for name in ("lighthouses.l", "x.l")),
        ("", "x.l", "", ""),
    ],
)
async def test_a_program_is_for_the_level_of_its_comment_its_name_or_a_setting(
    text: str, name: str, setting: str, level: str
) -> None:
    assert level_of(text, Path("/home") / name, setting) == level


async def test_names_are_those_of_the_level(editor: Editor) -> None:
    (warning,) = diagnostics(SEEKING, load_level("05-lighthouse"))
    editor.open(SEEKING)
    assert await editor.published() == []
    told = [(2, f"{warning.message}. {warning.hint}")]
    editor.open(SEEKING, "/nowhere/lighthouse.l")
    await editor.published(lambda found: words(found) == told)
    editor.client.workspace_did_change_configuration(
        types.DidChangeConfigurationParams({"logical-robots": {"level": "05-lighthouse"}})
    )
    editor.open(f"# level: 05-lightouse\n{SEEKING}")
    (unknown,) = await editor.published(lambda found: len(found) == 1)
    assert (unknown.range.start.line, unknown.range.start.character) == (0, 9)
    assert 'Did you mean "05-lighthouse"?' in unknown.message


async def test_related_lines_and_what_has_no_effect_are_marked(editor: Editor) -> None:
    editor.open(f"{FINE}\nA(x) :- x in [1], x == null;\n")
    assert (await editor.published())[0].tags == (types.DiagnosticTag.Unnecessary,)
    editor.type(f"{FINE}\nB(\n  1];\n")
    (other,) = (await editor.published())[0].related_information or []
    assert (other.location.range.start.line, other.message) == (1, "line 2: B(")


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("before", ["", "🤖", "𝔘é", "\t", "a\x0cb\u2028c"])
async def test_places_are_counted_in_utf_16(before: str, newline: str, editor: Editor) -> None:
    editor.open(f'{FINE}{newline}A("{before}", Wings(1))')
    (mistake,) = await editor.published()
    start = len(f'A("{before}", '.encode("utf-16-le")) // 2
    place = mistake.range.start, mistake.range.end
    assert place == (types.Position(1, start), types.Position(1, start + len("Wings")))


async def test_a_long_text_and_one_that_is_too_long_are_answered(editor: Editor) -> None:
    most = Limits().program_characters
    editor.open(FINE + "\n" + "# 🤖".ljust(99) * 2_000)
    assert await editor.published() == []
    editor.type("#" * (most + 1))
    (refusal,) = await editor.published()
    assert f"more than the {most:,}" in refusal.message
    editor.type("\ud800")
    assert "not text" in (await editor.published())[0].message


async def test_a_compile_process_that_crashes_is_started_again(editor: Editor) -> None:
    editor.open(f"{FINE}\n# before")
    await editor.published()
    for pid in editor.children():
        os.kill(pid, signal.SIGKILL)
    editor.type(f"{FINE}\nA(x) :- x in [1], x == null;")
    assert len(await editor.published()) == 1


async def test_it_ends_with_the_editor_even_while_it_compiles() -> None:
    editor = Editor()
    await editor.start()
    editor.open(f"{load_program('distributed-mapping').text}\n# {os.getpid()}")
    await editor.published()
    pids = editor.children()
    server = editor.client._server
    assert server is not None
    assert server.stdin is not None
    server.stdin.close()
    assert await server.wait() == 0
    until(lambda: not any(map(is_running, pids)))
    await editor.closed()
