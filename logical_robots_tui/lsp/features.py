"""What an editor asks of a place in a program: words, help, uses, renaming, structure, a run."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams

from logical_robots_tui.errors import InputError
from logical_robots_tui.language.diagnostics import TextChange
from logical_robots_tui.language.reference import find_help
from logical_robots_tui.language.services.completion import (
    Definition,
    call_before,
    definitions,
    help_at,
    help_on,
    word_before,
    words_for,
)
from logical_robots_tui.language.services.lexer import LineStates, pieces
from logical_robots_tui.language.services.symbols import renaming, sections, symbol_at
from logical_robots_tui.language.source_text import line_of
from logical_robots_tui.lsp.documents import Document
from logical_robots_tui.lsp.levels import run_command
from logical_robots_tui.lsp.server import SERVER, Server, range_of
from logical_robots_tui.schema import MAIN

_KINDS = {
    "annotation": "decorator",
    "predicate": "function",
    "field": "property",
    **{kind: kind for kind in ("comment", "string", "keyword", "number", "operator")},
}
_TOKENS = [*_KINDS.values()]
_NO_NUMBERS = ("Any", "Null", "Bool", "Str")
_TICKS, _MOST_TICKS = 5_000, 1_000_000
_STRING = re.compile(r'"([^"]*)"|\'([^\']*)\'')


@SERVER.feature(types.TEXT_DOCUMENT_COMPLETION, types.CompletionOptions(trigger_characters=["."]))
def complete(ls: Server, params: types.CompletionParams) -> types.CompletionList:
    document, (row, column), _ = ls.place(params)
    typed = word_before(document.lines[row][:column])[1]
    start = document.position(row, column - len(typed))
    place, kinds = types.Range(start, document.position(row, column)), types.CompletionItemKind
    items = [
        types.CompletionItem(
            word.name,
            kind=kinds.Function if word.name[:1].isupper() else kinds.Field,
            detail=word.shape,
            documentation=word.meaning,
            filter_text=typed or word.name,  # `ra` also finds sensor.radar
            sort_text=f"{number:05}",
            text_edit=types.TextEdit(place, word.name),
        )
        for number, word in enumerate(words_for(document.text, (row, column)))
    ]
    return types.CompletionList(is_incomplete=True, items=items)


@SERVER.feature(
    types.TEXT_DOCUMENT_SIGNATURE_HELP, types.SignatureHelpOptions(trigger_characters=["(", ","])
)
def signature(ls: Server, params: types.SignatureHelpParams) -> types.SignatureHelp | None:
    document, _, offset = ls.place(params)
    name, argument = call_before(document.text[:offset])
    word = help_on(document.text, name)
    if word is None:
        return None
    parts = re.findall(r"[^,(){}]+", word.shape.partition(name)[2].partition(" :- ")[0])
    parameters = [types.ParameterInformation(part.strip()) for part in parts]
    active = min(argument, max(len(parts) - 1, 0))
    call = types.SignatureInformation(word.shape, word.meaning, parameters)
    return types.SignatureHelp([call], active_signature=0, active_parameter=active)


@SERVER.feature(types.TEXT_DOCUMENT_HOVER)
def hover(ls: Server, params: types.HoverParams) -> types.Hover | None:
    document, (row, column), _ = ls.place(params)
    for text in _STRING.finditer(document.lines[row]):
        if text.start() <= column <= text.end():
            meaning = ls.facts(document).meanings.get(text[1] or text[2] or "")
            return types.Hover(meaning) if meaning else None
    word = help_at(document.text, (row, column))
    if word is None:
        return None
    paragraphs = [f"```logica\n{word.shape}\n```", word.meaning, *_columns(document, word.name)]
    entry = find_help(word.name)
    if entry is not None and entry.summary == word.meaning:
        paragraphs.append(f"`{entry.example}` gives `{entry.result}`")
    markdown = types.MarkupContent(types.MarkupKind.Markdown, "\n\n".join(paragraphs))
    return types.Hover(markdown)


def _columns(document: Document, name: str) -> Iterator[str]:
    """Yield a list of a predicate's columns with their types, when the program last compiled."""
    if (program := document.program) and (kinds := json.loads(program.kinds).get(name)):
        yield "\n".join(
            f"- {program.label(name, column)}: `{_type(kind)}`" for column, kind in kinds.items()
        )


def _type(kind: Any) -> str:
    """Return a type, as in ``Program.kinds``, as programs write it: [Num], {label: Str}."""
    if isinstance(kind, list):
        return f"[{_type(kind[0])}]"
    if isinstance(kind, dict):
        return f"{{{', '.join(f'{name}: {_type(inner)}' for name, inner in kind.items())}}}"
    return kind if kind in _NO_NUMBERS else "Num"


@SERVER.feature(types.TEXT_DOCUMENT_DEFINITION)
def definition(ls: Server, params: types.DefinitionParams) -> types.Location | None:
    document, _, offset = ls.place(params)
    symbol, heads = symbol_at(document.text, offset), definitions(document.text)
    if symbol is None or (symbol.is_predicate and symbol.name not in heads):
        return None
    place = symbol.places[0]
    if symbol.is_predicate:
        place = line_of(document.text, heads[symbol.name].line + 1)
    return _location(document, symbol.name, place)


@SERVER.feature(types.TEXT_DOCUMENT_REFERENCES)
def references(ls: Server, params: types.ReferenceParams) -> list[types.Location]:
    document, _, offset = ls.place(params)
    symbol = symbol_at(document.text, offset)
    if symbol is None:
        return []
    return [_location(document, symbol.name, place) for place in symbol.places]


def _location(document: Document, name: str, place: int) -> types.Location:
    return types.Location(document.uri, document.range(place, place + len(name)))


@SERVER.feature(types.TEXT_DOCUMENT_RENAME)
def rename(ls: Server, params: types.RenameParams) -> types.WorkspaceEdit:
    document, _, offset = ls.place(params)
    try:
        return _edit(document, renaming(document.text, offset, params.new_name))
    except InputError as error:
        raise JsonRpcInvalidParams(error.message) from error


def _edit(document: Document, changes: Sequence[TextChange]) -> types.WorkspaceEdit:
    edits = [types.TextEdit(document.range(c.start, c.stop), c.text) for c in changes]
    return types.WorkspaceEdit({document.uri: edits})


@SERVER.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
def outline(ls: Server, params: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
    document = ls.documents[params.text_document.uri]
    return [
        types.DocumentSymbol(
            name,
            types.SymbolKind.Function if name[:1].isupper() else types.SymbolKind.Property,
            document.range(start, stop),
            document.range(start, start + len(name)),
            detail=" ".join(document.text[start:stop].partition(":-")[0].split())[:80],
        )
        for name, start, stop in sections(document.text)
    ]


@SERVER.feature(types.TEXT_DOCUMENT_FOLDING_RANGE)
def folds(ls: Server, params: types.FoldingRangeParams) -> list[types.FoldingRange]:
    document = ls.documents[params.text_document.uri]
    return [
        types.FoldingRange(place.start.line, place.end.line)
        for _, start, stop in sections(document.text)
        if (place := document.range(start, stop)).start.line < place.end.line
    ]


@SERVER.feature(types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL, types.SemanticTokensLegend(_TOKENS, []))
def tokens(ls: Server, params: types.SemanticTokensParams) -> types.SemanticTokens:
    document = ls.documents[params.text_document.uri]
    states, numbers, last_row = LineStates(), [], 0
    for row, line in enumerate(document.lines):
        last = 0
        for start, end, kind in pieces(line, states.at(row, document.lines.__getitem__)):
            first, stop = (document.position(row, column).character for column in (start, end))
            numbers += [row - last_row, first - last, stop - first, _TOKENS.index(_KINDS[kind]), 0]
            last_row, last = row, first
    return types.SemanticTokens(numbers)


@SERVER.feature(
    types.TEXT_DOCUMENT_CODE_ACTION, types.CodeActionOptions([types.CodeActionKind.QuickFix])
)
def actions(ls: Server, params: types.CodeActionParams) -> list[types.CodeAction]:
    document = ls.documents[params.text_document.uri]
    return [
        types.CodeAction(
            f"{'Write' if fix.stop > fix.start else 'Add'} {fix.text.strip()}",
            types.CodeActionKind.QuickFix,
            edit=_edit(document, [fix]),
        )
        for diagnostic in document.diagnostics
        if (fix := diagnostic.fix)
        and (place := range_of(document, diagnostic)).start <= params.range.end
        and params.range.start <= place.end
    ]


@SERVER.command("logical-robots.run")
async def run(ls: Server, *arguments: Any) -> dict[str, Any]:
    """Run an open program, named by its URI, in its level, for some ticks at most; show a summary.

    Another run, or cancelling the request, ends it.
    """
    uri, ticks, *_ = (*arguments, _TICKS) if arguments else ("", _TICKS)
    document = ls.documents.get(str(uri))
    if document is None or type(ticks) is not int or not 0 < ticks <= _MOST_TICKS:
        raise JsonRpcInvalidParams(
            f"The arguments are an open document and 1 to {_MOST_TICKS:,} ticks"
        )
    level = ls.level_of(document)
    if not level:
        raise JsonRpcInvalidParams("Name a level in the first line: # level: 05-lighthouse")
    words = ("run", level, "-", "--json", "--ticks", str(ticks))
    command = run_command(*words, folder=document.path.parent, text=document.text)
    result = await ls.run_alone(command)
    outcome = _outcome(document, level, result)
    ls.window_show_message(types.ShowMessageParams(types.MessageType.Info, outcome["message"]))
    return outcome


def _outcome(document: Document, level: str, result: dict[str, Any]) -> dict[str, Any]:
    if error := result.get("error"):
        first = (error.get("diagnostics") or [error])[0]
        place = f"line {first['line']}: " if "line" in first else ""
        return {"won": False, "ticks": 0, "message": f"{level}: {place}{first['message']}"}
    heads = definitions(document.text)
    notices = [
        notice | {"line": _line_of(notice["message"], heads) + 1}
        for notice in result["notices"]["first"]
    ]
    verdict = "won at tick" if result["won"] else "not won; ended at tick"
    message = f"{level}: {verdict} {result['ticks']}."
    if notices:
        first = notices[0]
        message += f" Line {first['line']}, tick {first['tick']}: {first['message']}"
    return {key: result[key] for key in ("won", "ticks")} | {"notices": notices, "message": message}


def _line_of(notice: str, heads: Mapping[str, Definition]) -> int:
    """Return the line, from 0, of the predicate that a notice names, or else of Robot."""
    named = (name for name in re.findall(r"\b[A-Z]\w*", notice) if name in heads)
    head = heads.get(next(named, MAIN))
    return head.line if head is not None else 0
