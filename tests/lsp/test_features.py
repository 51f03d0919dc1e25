"""What an editor asks about a program, over the protocol."""

import asyncio
import os
import signal
from typing import Any

import pytest
from lsprotocol import types
from pygls.exceptions import JsonRpcException

from logical_robots_tui.game import load_program
from tests.lsp.editor import Editor
from tests.mind.test_broken import FINE
from tests.processes import is_running
from tests.waiting import until

pytestmark = pytest.mark.asyncio(loop_scope="module")

TEXT = f"""\
# level: 05-lighthouse
{FINE}
Near(x, y:) :-  # 🤖
  Sensor(robot_name: r, sensor:), "🤖" == "🜲", x == Least(sensor.clock, 2), y == "Harbour";
Far(x) :- Near(x, y:), y != r
Last(x) :- Far(x);"""
"""With a semicolon missing, and a variable without a value."""


def at(editor: Editor, word: str) -> dict[str, Any]:
    """Return the position of a word, which may be behind characters outside of the first plane."""
    before = TEXT[: TEXT.index(word)].rpartition("\n")
    return editor.at(before[0].count("\n") + 1, len(before[2].encode("utf-16-le")) // 2)


def pieces(ranges: list[types.Range]) -> list[str]:
    lines = TEXT.encode("utf-16-le").decode("utf-16-le").split("\n")
    texts = []
    for place in ranges:
        line = lines[place.start.line].encode("utf-16-le")
        assert place.start.line == place.end.line
        texts.append(line[2 * place.start.character : 2 * place.end.character].decode("utf-16-le"))
    return texts


@pytest.fixture
async def opened(editor: Editor) -> Editor:
    editor.open(TEXT)
    return editor


async def test_words_are_offered_with_help(opened: Editor) -> None:
    params = types.CompletionParams(**at(opened, "ast(sensor"))
    answer = await opened.client.text_document_completion_async(params)
    assert isinstance(answer, types.CompletionList)
    (item,) = [item for item in answer.items if item.label == "Least"]
    assert item.detail == "Least(x, y, ...)"
    assert isinstance(item.text_edit, types.TextEdit)
    assert pieces([item.text_edit.range]) == ["Le"]


async def test_a_call_is_shown_with_the_argument_at_hand(opened: Editor) -> None:
    params = types.SignatureHelpParams(**at(opened, "2), y"))
    answer = await opened.client.text_document_signature_help_async(params)
    assert answer is not None
    assert answer.signatures[0].label == "Least(x, y, ...)"
    assert answer.active_parameter == 1


@pytest.mark.parametrize(
    ("word", "text"),
    [
        ("Least", "`Least(3, 1, 2)` gives `1`"),
        ("clock", "number of the tick"),
        ("Harbour", "beacon of 05-lighthouse at"),
        ("Near", "defined in line 3"),
        ("Far", "defined in line 5"),
    ],
)
async def test_hovering_explains(word: str, text: str, opened: Editor) -> None:
    found = ""
    while text not in found:  # once the level is read
        answer = await opened.client.text_document_hover_async(
            types.HoverParams(**at(opened, word))
        )
        found = "" if answer is None else str(answer.contents)
        assert text in found or word == "Harbour"


async def test_columns_are_those_of_the_last_text_that_compiled(editor: Editor) -> None:
    editor.open(f'{FINE}\nA(x, name: "a") :- x in [1];')
    params = types.HoverParams(**editor.at(1, 0))
    found = ""
    while "- x: `" not in found:  # once it is compiled
        answer = await editor.client.text_document_hover_async(params)
        found = str(answer and answer.contents)
    editor.type(f'{FINE}\nA(x, name: "a") :- x in [1')
    await editor.published()
    answer = await editor.client.text_document_hover_async(params)
    assert "- name: `Str`" in str(answer and answer.contents)


@pytest.mark.parametrize(
    ("word", "places", "head"),
    [
        ("Near(x, y:),", 2, 2),
        ("y != r", 2, 4),
        ("x == Least", 2, 2),
        ("Robot", 1, 1),
        ("2), y", 0, None),
    ],
)
async def test_uses_of_a_name_are_found(
    word: str, places: int, head: int | None, opened: Editor
) -> None:
    context = types.ReferenceContext(include_declaration=True)
    params = types.ReferenceParams(context, **at(opened, word))
    answer = await opened.client.text_document_references_async(params)
    name = word.split("(")[0].split(" ")[0]
    assert pieces([place.range for place in answer or ()]) == [name] * places
    place = await opened.client.text_document_definition_async(
        types.DefinitionParams(**at(opened, word))
    )
    assert (place.range.start.line if isinstance(place, types.Location) else None) == head


async def test_a_name_is_changed_or_the_refusal_is_shown(opened: Editor) -> None:
    params = types.RenameParams(new_name="z", **at(opened, "y == "))
    answer = await opened.client.text_document_rename_async(params)
    assert answer is not None
    (edits,) = (answer.changes or {}).values()
    assert [edit.new_text for edit in edits] == [" z", "z"]
    with pytest.raises(JsonRpcException, match="another variable"):
        await opened.client.text_document_rename_async(
            types.RenameParams(new_name="x", **at(opened, "y == "))
        )


async def test_statements_are_listed_folded_and_coloured_in_a_broken_program(
    opened: Editor,
) -> None:
    document = types.TextDocumentIdentifier(opened.uri)
    symbols = await opened.client.text_document_document_symbol_async(
        types.DocumentSymbolParams(document)
    )
    assert [symbol.name for symbol in symbols or ()] == ["Robot", "Near", "Far", "Last"]
    folds = await opened.client.text_document_folding_range_async(
        types.FoldingRangeParams(document)
    )
    assert [(fold.start_line, fold.end_line) for fold in folds or ()] == [(2, 3)]
    tokens = await opened.client.text_document_semantic_tokens_full_async(
        types.SemanticTokensParams(document)
    )
    assert tokens is not None
    row = column = 0
    ranges = []
    for rows, columns, length, *_ in zip(*[iter(tokens.data)] * 5, strict=True):
        row, column = row + rows, columns + (column if rows == 0 else 0)
        start = types.Position(row, column)
        ranges.append(types.Range(start, types.Position(row, column + length)))
    texts = pieces(ranges)
    assert texts[:2] == ["# level: 05-lighthouse", "Robot"]
    assert {"# 🤖", '"🤖"', '"🜲"', "Least", ":-"} <= {*texts}


async def test_what_a_diagnostic_proposes_can_be_done(opened: Editor) -> None:
    mistakes = await opened.published(len)
    titles = []
    for mistake in mistakes:
        params = types.CodeActionParams(
            types.TextDocumentIdentifier(opened.uri), mistake.range, types.CodeActionContext([])
        )
        answer = await opened.client.text_document_code_action_async(params)
        titles += [action.title for action in answer or ()]
    assert titles == ["Add ;"]


@pytest.mark.parametrize("place", [(0, 999), (99, 0), (99, 999), (3, 26)])
async def test_nonsense_is_answered(place: tuple[int, int], opened: Editor) -> None:
    client, position = opened.client, opened.at(*place)
    await client.text_document_hover_async(types.HoverParams(**position))
    await client.text_document_completion_async(types.CompletionParams(**position))
    await client.text_document_definition_async(types.DefinitionParams(**position))
    await client.text_document_signature_help_async(types.SignatureHelpParams(**position))
    document = types.TextDocumentIdentifier("file:///not/open.l")
    with pytest.raises(JsonRpcException):
        await client.text_document_folding_range_async(types.FoldingRangeParams(document))


async def test_a_program_is_run_in_its_level(editor: Editor) -> None:
    async def run(*arguments: Any) -> Any:
        return await editor.client.workspace_execute_command_async(
            types.ExecuteCommandParams("logical-robots.run", [*arguments])
        )

    editor.open(load_program("first-steps").text, "/nowhere/first-steps.l")
    outcome = await run(editor.uri)
    assert outcome["won"]
    assert outcome["message"] == f"01-first-steps: won at tick {outcome['ticks']}."
    assert outcome["message"] in editor.messages
    editor.type("\n" + FINE.replace("right_engine: 0", 'right_engine: "a"'))
    outcome = await run(editor.uri, 3)
    assert "Line 2, tick 1: right_engine" in outcome["message"]
    editor.type("A(1")
    assert "line 1: This '(' is never closed" in (await run(editor.uri))["message"]
    for arguments in ([], ["file:///other"], [editor.uri, 0], [editor.uri, "x"]):
        with pytest.raises(JsonRpcException, match="arguments"):
            await run(*arguments)
    editor.open(FINE)
    with pytest.raises(JsonRpcException, match="# level: 05-lighthouse"):
        await run(editor.uri)


async def test_a_run_ends_with_a_server_that_is_killed() -> None:
    editor = Editor()
    await editor.start()
    editor.open(FINE, "/nowhere/first-steps.l")
    await editor.published()
    helpers = {*editor.children()}
    words = [editor.uri, 1_000_000]
    params = types.ExecuteCommandParams("logical-robots.run", words)
    editor.client.protocol.send_request(types.WORKSPACE_EXECUTE_COMMAND, params)
    await asyncio.to_thread(until, lambda: {*editor.children()} - helpers)
    processes = editor.children()
    os.kill(editor.pid, signal.SIGKILL)
    await asyncio.to_thread(until, lambda: not any(map(is_running, processes)))
    await editor.closed()


@pytest.mark.parametrize("ends", ["the request is cancelled", "another run begins"])
async def test_a_run_blocks_nothing_and_ends_when(ends: str, editor: Editor) -> None:
    def params(ticks: int) -> types.ExecuteCommandParams:
        return types.ExecuteCommandParams("logical-robots.run", [editor.uri, ticks])

    def start(ticks: int) -> Any:
        return editor.client.protocol.send_request(
            types.WORKSPACE_EXECUTE_COMMAND, params(ticks), msg_id=f"{ends}, {ticks}"
        )

    editor.open(FINE, "/nowhere/first-steps.l")
    await editor.published()
    helpers = {*editor.children()}
    endless = start(1_000_000)
    await asyncio.to_thread(until, lambda: {*editor.children()} - helpers)
    (process,) = {*editor.children()} - helpers
    assert await editor.client.text_document_hover_async(types.HoverParams(**editor.at(0, 0)))
    if ends == "another run begins":
        assert (await asyncio.wrap_future(start(1)))["ticks"] == 1
        assert "The run was ended." in (await asyncio.wrap_future(endless))["message"]
    else:
        editor.client.cancel_request(types.CancelParams(f"{ends}, 1000000"))
        with pytest.raises(JsonRpcException, match="canceled"):
            await asyncio.wrap_future(endless)
    await asyncio.to_thread(until, lambda: not is_running(process))
