"""Files from a browser, which are kept beside the player's others, or refused."""

from pathlib import Path

from logical_robots_tui.game import load_program
from logical_robots_tui.tui.commands.help import Help
from logical_robots_tui.tui.terminal.driver import Uploaded
from tests.installed import CHECKOUT
from tests.tui.conftest import LEVELS, ROOM, STILL, Opened, opened

REPLAY = (CHECKOUT / "tests" / "old" / "one.replay").read_bytes()
WEB = min(LEVELS.glob("*.json"))
REFUSED = [
    ("", b"x", "This can't be opened here"),
    (".l", STILL.encode(), ".l can't be opened here"),
    ("notes.pdf", b"x", "notes.pdf can't be opened here. A program ends in .l"),
    ("\ud800.pdf", b"x", "-.pdf can't be opened here"),
    ("empty.l", b"", "empty.l is empty."),
    ("large.l", b"x" * 1_000_001, "large.l is larger than 1 MB."),
    ("long.l", b"x" * 200_001, "long.l has 200,001 characters"),
    ("binary.l", b"\0", "binary.l is a binary file"),
    ("old.l", b"# caf\xe9\n", "old.l, line 1 is not UTF-8 text"),
    ("room.toml", ROOM.replace("= 15", "= true").encode(), "room.toml: areas[0]"),
    ("web.json", b"{}", "web.json: "),
    ("run.replay", REPLAY[:-1], "run.replay is not a replay file: it is damaged"),
]
KEPT = [
    ("own.l", "own.l"),
    ("own.l", "own-2.l"),
    ("../../own.l", "own-3.l"),
    ("C:\\own.L", "own-4.l"),
    (".hidden (1).l", "hidden-1.l"),
    ("first-steps.l", "first-steps-2.l"),
    ("+.l", "upload.l"),
    ("ß" * 300 + ".l", "ß" * 60 + ".l"),
]


def files(data_dir: Path) -> set[str]:
    folders = (data_dir / folder for folder in ("programs", "levels", "replays"))
    return {file.name for folder in folders for file in folder.glob("*")}


async def send(game: Opened, name: str, content: str | bytes, message: str) -> None:
    game.app.clear_notifications()
    game.app.post_message(Uploaded(name, content.encode() if isinstance(content, str) else content))
    await game.until(lambda: any(message in toast.message for toast in game.app._notifications))


async def test_what_can_not_be_opened_is_refused_and_changes_nothing(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        former = game.session.source, game.session.level, files(data_dir)
        for name, content, complaint in REFUSED:
            await send(game, name, content, complaint)
        (data_dir / "levels").rmdir()
        (data_dir / "levels").write_text("not a folder", "utf-8")
        await send(game, "room.toml", ROOM, "can't be saved: ")
        assert (game.session.source, game.session.level, files(data_dir)) == former


async def test_a_program_is_kept_under_a_free_name_and_opened_once_it_can_be(
    data_dir: Path,
) -> None:
    async with opened(data_dir, ready=True) as game:
        former = files(data_dir)
        for number, (name, file) in enumerate(KEPT):
            text = f"# {number}\n{STILL}"
            await send(game, name, text, f"Saved {file} in ")
            await game.settled()
            assert game.session.source.path == data_dir / "programs" / file
            assert game.editor.text == load_program(game.session.source.path).text == text
        assert files(data_dir) - former == {file for _, file in KEPT}
        await game.press("f1", on=Help)
        await send(game, "broken.l", "Robot(", "Saved broken.l in ")
        await game.settled()
        assert game.editor.text == text
        await game.press("escape", until=lambda: game.editor.text == "Robot(")


async def test_levels_and_replays_are_opened_as_their_dialogs_would(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        former = files(data_dir)
        await send(game, "a room.toml", ROOM, "Saved a-room.toml in ")
        await game.until(lambda: game.session.level.name == "a-room")
        await send(game, "web.json", WEB.read_bytes(), "Saved web.json in ")
        await game.until(lambda: game.session.level.name == "web")
        await send(game, "run.replay", REPLAY, "go to any of them")
        assert files(data_dir) - former == {"a-room.toml", "web.json", "run.replay"}
