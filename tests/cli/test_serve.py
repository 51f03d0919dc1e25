"""``serve --class``: the file of its players, and what it refuses."""

from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.errors import LogicalRobotsError
from logical_robots_tui.web.players import Players, digest_of
from tests.cli.running import Command

ENTRY = f'sha256 = "{digest_of("token")}"\nsince = 2026-11-28T18:00:00Z\n'


def test_a_player_is_added_gets_another_link_and_is_revoked(
    command: Command, tmp_path: Path
) -> None:
    file = tmp_path / "players.toml"
    serve = "serve", "--class", file
    assert command(*serve, "--add", "ada").success
    assert file.stat().st_mode & 0o777 == 0o600
    file.write_text(f"{file.read_text()}# Bob asks for a new link each week\n[bob.b]\n{ENTRY}")
    file.write_text(file.read_text().replace("[bob.b]", '["bob.b"]'))
    old = Players(file, print).digests()
    url = "https://school.example/robots"
    told = command(*serve, "--add", "bob.b", "--url", url)
    address, _, token = told.success.strip().rpartition("#")
    assert address == f"{url}/"
    assert "no longer valid" in told.err
    assert Players(file, print).digests() == {**old, "bob.b": digest_of(token)}
    assert token not in file.read_text()
    assert "# Bob asks" in file.read_text()
    assert command(*serve, "--revoke", "ada").success == ""
    assert [*Players(file, print).digests()] == ["bob.b"]
    assert "players.toml has no player bob" in command(*serve, "--revoke", "bob").refusal
    assert command(*serve, "--revoke", "bob.b").success == ""
    assert "has no players. Make a link: logical-robots serve --class" in command(*serve).refusal


@pytest.mark.parametrize(
    ("text", "mode", "message"),
    [
        (None, 0o600, "players.toml isn't there. Make a link"),
        ("", 0o600, "players.toml has no players. Make a link"),
        ("[ada", 0o600, "players.toml:1: This is not valid TOML"),
        (f"[ada]\n{ENTRY}", 0o604, "is open to everybody on this computer. Run: chmod o="),
        ('[ada]\nsha256 = "x"\n', 0o600, 'players.toml:1: "ada.since" is missing.'),
        (f"[ada]\n{ENTRY}token = 1", 0o600, 'players.toml:4: "token" is not a known key.'),
        (ENTRY, 0o600, 'players.toml:1: "sha256" must be a table'),
        (f'["../x"]\n{ENTRY}', 0o600, '"../x" is not a name of at most 32 letters'),
        (f"[ada]\n{ENTRY}".replace('"', '"A', 1), 0o600, "players.toml:2: This is not a digest."),
    ],
)
def test_a_file_that_cannot_be_used_is_told_with_its_line(
    text: str | None, mode: int, message: str, command: Command, tmp_path: Path
) -> None:
    file = tmp_path / "players.toml"
    if text is not None:
        file.write_text(text)
        file.chmod(mode)
    assert message in command("serve", "--class", file).refusal
    if text and mode == 0o600:
        assert message in command("serve", "--class", file, "--add", "eve").refusal
        assert file.read_text() == text


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--add", "ada"), "--add and --revoke need the file of the class. Add --class FILE."),
        (("--host", "0.0.0.0"), "0.0.0.0 is open to other computers. Leave out --host, or"),
        (("--host", "::"), ":: is open to other computers."),
    ],
)
def test_what_needs_a_class_says_so(words: tuple[str, ...], message: str, command: Command) -> None:
    assert message in command("serve", *words).refusal


PIECES = [*'[]"=.\n#aé', "sha256", "since", ENTRY, "[ada]\n"]


@given(text=st.lists(st.sampled_from(PIECES)).map("".join))
def test_any_text_is_read_or_refused(text: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    file = tmp_path_factory.getbasetemp() / "players.toml"
    file.write_text(text)
    file.chmod(0o600)
    with suppress(LogicalRobotsError):
        assert set(Players(file, print).digests().values()) == {digest_of("token")}
