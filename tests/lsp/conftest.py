"""A server for all tests of a module."""

from collections.abc import AsyncIterator

import pytest_asyncio

from tests.lsp.editor import Editor


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def editor() -> AsyncIterator[Editor]:
    editor = Editor()
    await editor.start()
    yield editor
    assert await editor.stop() == 0
