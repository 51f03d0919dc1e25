"""The server: what an editor asks, and what `language/` answers."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from pathlib import Path
from typing import Any

from lsprotocol import types
from pygls.lsp.server import LanguageServer

from logical_robots_tui import __version__
from logical_robots_tui.language.diagnostics import Diagnostic
from logical_robots_tui.language.services.editing import width_of
from logical_robots_tui.lsp.checking import Checker
from logical_robots_tui.lsp.documents import Document
from logical_robots_tui.lsp.levels import LevelFacts, facts_of, level_of

_SEVERITY = {
    "error": types.DiagnosticSeverity.Error,
    "warning": types.DiagnosticSeverity.Warning,
}


class Server(LanguageServer):
    """The documents that are open, each with its level."""

    def __init__(self) -> None:
        # Whole texts: pygls counts other line separators than editors do when it applies changes.
        sync = types.TextDocumentSyncKind.Full
        super().__init__("logical-robots", __version__, text_document_sync_kind=sync)
        self.documents: dict[str, Document] = {}
        self.level = ""
        self._facts: dict[tuple[str, Path, int], asyncio.Task[LevelFacts]] = {}
        self._run: asyncio.Task[Any] | None = None

    def begin(self) -> None:
        self.checker = Checker(self.facts, self._publish)
        self._work = asyncio.create_task(self.checker.run())

    def place(self, params: Any) -> tuple[Document, tuple[int, int], int]:
        """Return the document that a request is about, its row and column, and its offset."""
        document = self.documents[params.text_document.uri]
        return document, document.cursor(params.position), document.offset(params.position)

    def configure(self, settings: Any) -> None:
        """Use settings such as ``{"level": "05-lighthouse"}``."""
        if isinstance(settings, dict):
            level = settings.get("logical-robots", settings)
            level = level.get("level") if isinstance(level, dict) else None
            self.level = level if isinstance(level, str) else ""
            self._check_all()

    def _check_all(self) -> None:
        for document in self.documents.values():
            self.checker.submit(document)

    async def run_alone(self, command: Coroutine[Any, Any, Any]) -> Any:
        """Return what a command answers; it ends with its request, and when another begins."""
        await self.end_run()
        run = self._run = asyncio.create_task(command)
        # pygls cancels the request of a command, but not what works on it.
        if request := self.protocol._request_futures.get(self.protocol.msg_id or ""):
            request.add_done_callback(lambda request: request.cancelled() and run.cancel())
        try:
            return await run
        except asyncio.CancelledError:  # which pygls would not answer
            return {"error": {"message": "The run was ended."}}

    async def end_run(self) -> None:
        if self._run is not None:
            self._run.cancel()
            await asyncio.wait([self._run])

    def level_of(self, document: Document) -> str:
        return level_of(document.text, document.path, self.level)

    def facts(self, document: Document) -> LevelFacts:
        """Return what is in a document's level, or nothing yet; then it is checked once more."""
        level, folder = self.level_of(document), document.path.parent
        if not level:
            return LevelFacts()
        try:
            changed = (folder / level).stat().st_mtime_ns
        except (OSError, ValueError):
            changed = 0  # it is the name of a shipped level, or nothing
        key = level, folder, changed
        if key not in self._facts:
            self._facts[key] = asyncio.create_task(facts_of(level, folder))
            self._facts[key].add_done_callback(lambda _: self._check_all())
        task = self._facts[key]
        return task.result() if task.done() and not task.cancelled() else LevelFacts()

    def _publish(self, document: Document, diagnostics: tuple[Diagnostic, ...]) -> None:
        uri = document.uri
        if self.documents.get(uri) is not document:
            return
        document.diagnostics = diagnostics
        entries = [_published(document, diagnostic) for diagnostic in diagnostics]
        self.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(uri, entries, document.version)
        )


def _published(document: Document, diagnostic: Diagnostic) -> types.Diagnostic:
    message = diagnostic.message
    return types.Diagnostic(
        range_of(document, diagnostic),
        f"{message}. {diagnostic.hint}" if diagnostic.hint else message,
        severity=_SEVERITY[diagnostic.severity],
        source="logical-robots",
        tags=None if diagnostic.has_effect else [types.DiagnosticTag.Unnecessary],
        related_information=[_related(document, line) for line in diagnostic.related] or None,
    )


def range_of(document: Document, diagnostic: Diagnostic) -> types.Range:
    row = min(diagnostic.line, len(document.lines)) - 1
    start, stop = width_of(diagnostic, document.lines[row])
    return types.Range(document.position(row, start), document.position(row, stop))


def _related(document: Document, number: int) -> types.DiagnosticRelatedInformation:
    line = document.lines[number - 1]
    stop = document.position(number - 1, len(line))
    location = types.Location(document.uri, types.Range(types.Position(number - 1, 0), stop))
    return types.DiagnosticRelatedInformation(location, f"line {number}: {line.strip()}")


SERVER = Server()


@SERVER.feature(types.INITIALIZE)
def initialize(ls: Server, params: types.InitializeParams) -> None:
    ls.begin()
    ls.configure(params.initialization_options)


@SERVER.feature(types.WORKSPACE_DID_CHANGE_CONFIGURATION)
def configure(ls: Server, params: types.DidChangeConfigurationParams) -> None:
    ls.configure(params.settings)


@SERVER.feature(types.TEXT_DOCUMENT_DID_OPEN)
@SERVER.feature(types.TEXT_DOCUMENT_DID_CHANGE)
def changed(
    ls: Server, params: types.DidOpenTextDocumentParams | types.DidChangeTextDocumentParams
) -> None:
    uri = params.text_document.uri
    source = ls.workspace.get_text_document(uri)
    document = Document(uri, source.source, source.version, ls.workspace.position_codec)
    if uri in ls.documents:
        document.program = ls.documents[uri].program
    ls.documents[uri] = document
    ls.checker.submit(document)


@SERVER.feature(types.TEXT_DOCUMENT_DID_CLOSE)
def closed(ls: Server, params: types.DidCloseTextDocumentParams) -> None:
    uri = params.text_document.uri
    ls.checker.withdraw(uri)
    ls.documents.pop(uri, None)
    ls.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, []))


@SERVER.feature(types.SHUTDOWN)
async def end(ls: Server, _: None) -> None:
    await ls.end_run()
