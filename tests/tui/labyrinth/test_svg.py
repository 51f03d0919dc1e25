"""Pictures of the screen."""

from pathlib import Path
from xml.etree import ElementTree

from tests.tui.conftest import STILL, opened


async def test_a_screenshot_is_a_picture_and_a_text_or_says_why_not(data_dir: Path) -> None:
    folder = data_dir / "screens"
    async with opened(data_dir, text=STILL, size=(100, 30), ready=True) as game:
        folder.write_text("in the way")
        await game.app.run_action("screen.command('screenshot')")
        await game.sees("The picture could not be saved: File exists.")
        folder.unlink()
        await game.press("ctrl+p", sees="Find a command")
        await game.press(*"screens", "enter", until=lambda: len(list(folder.glob("*"))) == 2)
        (text,) = folder.glob("*.txt")
        assert "LOGICAL ROBOTS" in text.read_text("utf-8")
        assert "Find a command" not in text.read_text("utf-8")
        (picture,) = folder.glob("*.svg")
        svg = ElementTree.fromstring(picture.read_text("utf-8"))
        assert svg.tag.endswith("}svg")
        assert svg.attrib["{http://www.w3.org/XML/1998/namespace}space"] == "preserve"
