"""What tests do with the dialogs of a game."""

from textual.widgets import Input, Static

from tests.tui.conftest import Opened

__all__ = ["complaint", "dialog", "fill"]


async def dialog(game: Opened, key: str, kind: type) -> None:
    """Open a dialog."""
    await game.press(key, on=kind)


async def fill(game: Opened, text: str) -> None:
    """Put a text into the first line of a dialog."""
    game.app.screen.query_one(Input).value = text
    await game.settled()


def complaint(game: Opened) -> str:
    """What a dialog says is wrong."""
    said = game.app.screen.query_one("#complaint", Static)
    return str(said.visual) if said.display else ""
