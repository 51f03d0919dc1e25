"""What is under way to a terminal is never much, and its answers are never taken for keys."""

import heapq
import re

from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.tui.terminal.diff_app import _PATIENCE, Line
from logical_robots_tui.tui.terminal.driver import InputFilter, Pasted, UnbracketedPasteDetector


def watch(rate: float, way: float, frame: int, seconds: float = 20.0) -> tuple[float, float]:
    """Send frames thirty times a second over a line; a terminal answers each at once.

    The line carries so many bytes a second and takes so many seconds from one end to the other; of
    a frame so many bytes differ after each thirtieth of a second, up to three frames. Tell, for the
    second half, the longest time that a frame takes to the terminal, and frames a second.
    """
    line, free_at, slowest, count = Line(), 0.0, 0.0, 0
    answers: list[float] = []
    for turn in range(int(1000 * seconds)):
        now = turn / 1000
        while answers and answers[0] <= now:
            line.note_answer(heapq.heappop(answers))
        if turn % 33 == 0 and line.is_free:
            size = 0 if line.is_to_be_measured else int(min(line.room, 3 * frame))
            free_at = max(free_at, now) + size / rate
            heapq.heappush(answers, free_at + 2 * way)
            line.note_output(size, now)
            if now > seconds / 2:
                slowest, count = max(slowest, free_at + way - now), count + 1
    return slowest, count / (seconds / 2)


def test_nothing_waits_for_long_and_on_a_line_that_is_only_long_many_frames_are_under_way() -> None:
    for rate, way in ((20_000, 0.01), (64_000, 0.01), (10_000_000, 0.1)):
        slowest, frames = watch(rate, way, 4000)
        assert slowest < 0.12, rate
    assert frames > 15


def test_a_line_waits_for_no_silent_terminal_or_lost_answer_and_is_measured_anew() -> None:
    line = Line()
    for turn in range(5):
        assert line.is_free
        line.note_output(1000, turn / 30)
    line = Line()
    line.note_output(1000, 0.0)
    line.note_answer(0.01)
    line.note_output(1000, 1.0)
    for now, is_free in ((1.0, False), (1.0 + _PATIENCE / 2, False), (1.1 + _PATIENCE, True)):
        line.forget(now)
        assert line.is_free is is_free
    line = Line()
    for start in (0.0, 1.0):
        line.note_output(0, start)
        line.note_answer(start + 0.3)
    line.note_output(1000, 2.0)
    assert line.is_free  # several are under way on it
    line.forget(2.1 + _PATIENCE)
    line.note_output(1000, 5.0)
    line.note_answer(5.01)
    assert line.is_to_be_measured
    line.note_output(0, 6.0)
    assert not line.is_free


@given(st.lists(st.text("ab[;0R1m", max_size=8), min_size=1), st.integers(1, 9))
def test_answers_are_heard_also_in_a_paste_that_stays_whole(texts: list[str], size: int) -> None:
    came = "\x1b[200~" + "\x1b[12;34R".join(texts) + "\x1b[201~"
    incoming, answers = InputFilter(), 0
    found: list[str | Pasted] = []
    # A cut right after an escape is left out: that may be the escape key.
    for chunk in re.findall(rf"(?s).{{{size}}}(?:(?<=\x1b).)?|.+", came):
        more, heard = incoming.take(chunk.encode(), 0.0)
        found, answers = found + more, answers + heard
    assert [Pasted] == [type(piece) for piece in found]
    assert (found, answers) == (["".join(texts)], len(texts) - 1)
    assert InputFilter().take(b"a\x1b", 0.0) == (["a\x1b"], 0), "the escape key is not held back"


LINES = "A(x) :- B(x);\r" * 8


def test_lines_that_come_in_at_once_are_a_paste_unless_it_is_marked() -> None:
    for before, typed, is_pasted in (
        ("", LINES, True),
        ("2", LINES.replace("\r", "\r\n\t"), True),
        ("", "n" * 500, False),
        ("", "A(1);\r", False),
        ("", "a long question, " * 8 + "\r", False),
        ("", LINES + "\x12", False),
        ("", "\x1b[A" * 20 + LINES, False),
        ("\x1b[200~A", LINES, False),
        ("\x1b[200~A\x1b[201~", LINES, True),
        ("\x1b", f"[200~{LINES}", False),
    ):
        unmarked = UnbracketedPasteDetector()
        assert not unmarked.paste_in(before)
        lines = typed.replace("\r\n", "\n").replace("\r", "\n")
        assert unmarked.paste_in(typed) == (lines if is_pasted else ""), (before, typed)
