"""Whatever comes in from a terminal is taken apart in time, and no input is an error."""

from __future__ import annotations

import random

import pytest

from logical_robots_tui.tui.terminal.driver import MOST_PASTED, InputFilter, Pasted, TolerantParser
from tests.memory_use import memory_use

CHUNK = 4096


class Input:
    """Takes in bytes as the driver does, and remembers what they come to."""

    def __init__(self) -> None:
        self.incoming, self.parser = InputFilter(), TolerantParser()
        self.keys: list[str] = []
        self.pasted: list[int] = []
        self.answers = 0
        self.now = 0.0

    def take(self, data: bytes) -> Input:
        for begin in range(0, len(data), CHUNK):
            pieces, answers = self.incoming.take(data[begin : begin + CHUNK], self.now)
            self.answers += answers
            for piece in pieces:
                if isinstance(piece, Pasted):
                    self.pasted.append(len(piece))
                    self.parser = TolerantParser()
                else:
                    self.keys += [getattr(m, "key", str(m)) for m in self.parser.feed(piece)]
        return self


JUNK = [
    *(b"\x1b[1114112u", b"\x1b[99999999999u", b"\x1b[97;1:9;1114112u", b"\x1b[5;5z"),
    *(b"\x1b[>0;276;0c", b"\x1b[?62;22c", b"\x1bP1$r0m\x1b\\", b"\x1bP>|xterm(390)\x1b\\"),
    *(b"\x1b]11;rgb:1e1e/1e1e/1e1e\x1b\\", b"\x1b]11;rgb:1e1e/1e1e/1e1e\x07"),
    *(b"\x1b]52;c;" + b"QUJD" * 20_000 + b"\x07", b"\x1b_G" + b"A" * 70_000 + b"\x1b\\"),
    *(b"\x1bX" + b"\xff" * 5_000 + b"\x1b\\", b"\x1b[?9999999999999999999999u"),
    *(b"\x1b[<0;99999999999999999999;1z", b"\x1b[97;5:3;" + b"1:" * 15 + b"u"),
    *(b"\x1b[48;99999999;t", b"\x1b[" + b"7" * 50 + b"u", b"\x1b[" + b"7" * 10_000 + b"u"),
]


def test_what_cant_be_understood_is_dropped_and_the_next_key_is_heard() -> None:
    for junk in JUNK:
        assert Input().take(junk + b"n").keys == ["n"], junk[:40]


def test_a_terminal_that_says_it_has_no_size_may_have_a_mouse() -> None:
    for size in (b"0;0;0;0", b"24;80;0;0", b"0;0;400;800"):
        resized, moved = b"\x1b[48;" + size + b"t", b"\x1b[<35;7;5M\x1b[<0;7;5M"
        assert Input().take(resized + moved + moved + b"n").keys[-1] == "n", size


def test_keys_are_what_they_were() -> None:
    sent = (b"\x1b[A", b"\x1b[[A", b"\x1b[1;5A", b"\x1b[3~", b"\x1b[97;5u", b"\x1bOP", "ü".encode())
    keys = ["up", "f1", "ctrl+up", "delete", "ctrl+a", "f1", "ü"]
    assert [Input().take(key).keys for key in sent] == [[key] for key in keys]
    for rest, keys in ((b"n", ["escape", "n"]), (b"[A", ["up"]), (b"OP", ["f1"]), (b"", [])):
        assert Input().take(b"\x1b").take(rest).keys == keys


def test_what_a_terminal_says_in_several_parts_is_no_typing() -> None:
    for end in (b"\x07", b"\x1b\\"):
        answer = b"\x1b]11;rgb:1e1e/1e1e/1e1e" + end
        for at in range(3, len(answer)):
            assert Input().take(answer[:at]).take(answer[at:]).take(b"n").keys == ["n"], at


def test_what_it_never_ends_to_say_is_ended_by_a_key_after_a_silence() -> None:
    found = Input().take(b"\x1b]0;" + b"x" * 200_000)
    found.now += 5
    assert found.take(b"n").keys == ["n"]
    assert Input().take(b"\x1b_" + b"x" * 9000).take(b"\x1b[A").keys == ["up"]


def test_of_what_comes_in_as_much_is_taken_as_is_of_use() -> None:
    for chunks, pasted, keys, answers in (
        ((b"\x1b[" + b"1" * 5_000_000, b"un"), [], ["n"], 0),
        ((b"\x1b[200~" + b"x" * 6_000_000 + b"\x1b[201~n",), [MOST_PASTED], ["n"], 0),
        ((b"\x1b", b"[200~abc\x1b", b"[201~n"), [3], ["n"], 0),
        ((b"\x1b[1;1R" * 200_000,), [], [], 200_000),
    ):
        heard = Input()
        for chunk in chunks:
            heard.take(chunk)
        assert (heard.pasted, heard.keys, heard.answers) == (pasted, keys, answers)

    # A paste that is never ended is ended by a key after a silence.
    found = Input().take(b"\x1b[200~" + b"x" * 3_000_000)
    assert (found.pasted, found.keys) == ([], [])
    found.now += 0.5
    assert found.take(b"y").keys == []
    found.now += 3.0
    found.take(b"\x1b[A")
    assert (found.pasted, found.keys) == ([MOST_PASTED], ["up"])


def hostile(size: int, seed: int) -> bytes:
    """Random bytes, sequences that are known and changed, and pieces of them."""
    chance = random.Random(seed)
    known = [
        *(b"\x1b[200~", b"\x1b[201~", b"\x1b[A", b"\x1b[1;5A", b"\x1b[97;5u", b"\x1b[<0;5;5M"),
        *(b"\x1b[M !!", b"\x1b[48;24;80;1;1t", b"\x1b[?2026;2$y", b"\x1b[12;34R", b"\x1b]0;x\x07"),
    ]
    parts = bytearray()
    while len(parts) < size:
        kind = chance.randrange(4)
        part = bytearray(chance.choice(known))
        if kind == 0:
            part = bytearray(chance.randbytes(chance.randrange(1, 40)))
        elif kind == 1:
            part[chance.randrange(len(part))] = chance.randrange(256)
        elif kind == 2:
            del part[chance.randrange(len(part)) :]
        parts += part
    return bytes(parts[:size])


@pytest.mark.parametrize(
    ("size", "seed"),
    [
        (10_000, 1),
        pytest.param(40_000, 2, marks=pytest.mark.slow),
        pytest.param(10_000_000, 3, marks=pytest.mark.proof),
    ],
)
def test_ten_million_hostile_bytes_are_no_error_and_take_no_memory(size: int, seed: int) -> None:
    found = Input()
    data, before = hostile(size, seed), memory_use("self")
    for begin in range(0, size, CHUNK):
        found.take(data[begin : begin + CHUNK])
        found.keys.clear()
    assert memory_use("self") - before < 50_000_000
    for key in (b"\x1b[201~", b"\x1b[A", b"\x1b[A", b"n"):
        found.now += 5
        found.take(key)
    assert found.keys[-1:] == ["n"]
