"""An editor that talks to a real server, as pygls' own client does."""

import asyncio
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from lsprotocol import types
from pygls.lsp.client import LanguageClient

from tests.waiting import PATIENCE

__all__ = ["Editor"]

F = TypeVar("F", bound=Callable[..., Any])


class Editor:
    """Has a program open at a time; positions are those of the protocol."""

    def __init__(self) -> None:
        self.client = LanguageClient("editor", "1")
        self.messages: list[str] = []
        self._published: dict[tuple[str, int | None], list[types.Diagnostic]] = {}
        self._news = asyncio.Event()
        self.uri, self.version = "", 0

        @self._feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def published(params: types.PublishDiagnosticsParams) -> None:
            self._published[params.uri, params.version] = [*params.diagnostics]
            self._news.set()

        @self._feature(types.WINDOW_SHOW_MESSAGE)
        def shown(params: types.ShowMessageParams) -> None:
            self.messages.append(params.message)

    def _feature(self, method: str) -> Callable[[F], F]:
        decorate: Callable[[F], F] = self.client.feature(method)
        return decorate

    @property
    def pid(self) -> int:
        assert self.client._server is not None
        return self.client._server.pid

    async def start(self, **environ: str) -> None:
        words = (sys.executable, "-m", "logical_robots_tui", "lsp")
        await self.client.start_io(*words, env=os.environ | environ)
        await self.client.initialize_async(types.InitializeParams(types.ClientCapabilities()))

    def children(self) -> list[int]:
        """Return the process numbers of the server's helpers."""
        threads = Path(f"/proc/{self.pid}/task").glob("*/children")
        return [int(child) for file in threads for child in file.read_text().split()]

    def open(self, text: str, path: Path | str = "/nowhere/program.l") -> None:
        self.uri, self.version = f"file://{path}", self.version + 1
        item = types.TextDocumentItem(self.uri, "logica", self.version, text)
        self.client.text_document_did_open(types.DidOpenTextDocumentParams(item))

    def type(self, text: str) -> None:
        self.version += 1
        self.client.text_document_did_change(
            types.DidChangeTextDocumentParams(
                types.VersionedTextDocumentIdentifier(self.version, self.uri),
                [types.TextDocumentContentChangeWholeDocument(text)],
            )
        )

    async def published(
        self, fits: Callable[[list[types.Diagnostic]], object] = lambda _: True
    ) -> list[types.Diagnostic]:
        """Return what is published last about the current version, once it fits."""
        key = self.uri, self.version
        async with asyncio.timeout(PATIENCE):
            while key not in self._published or not fits(self._published[key]):
                self._news.clear()
                await self._news.wait()
        return self._published[key]

    def at(self, line: int, character: int) -> dict[str, Any]:
        return {
            "text_document": types.TextDocumentIdentifier(self.uri),
            "position": types.Position(line, character),
        }

    async def stop(self) -> int:
        """Shut the server down as editors do, and return its exit status."""
        await self.client.shutdown_async(None)
        self.client.exit(None)
        await self.closed()
        assert self.client._server is not None
        assert self.client._server.returncode is not None
        return self.client._server.returncode

    async def closed(self) -> None:
        stop: Any = self.client.stop  # without types
        await stop()
