"""Files that were valid before somebody changed them."""

from typing import TypeAlias

from hypothesis import strategies as st

Change: TypeAlias = tuple[int, str, int]


def changes() -> st.SearchStrategy[list[Change]]:
    hows = st.sampled_from(["flip", "cut", "double", "nest"])
    change = st.tuples(st.integers(0), hows, st.integers(1, 255))
    return st.lists(change, min_size=1, max_size=4)


def changed(content: bytes, changes: list[Change]) -> bytes:
    """A content with bytes of it flipped, cut out, doubled, or brackets put into it."""
    for place, how, number in changes:
        at = place % (len(content) + 1)
        before, after = content[:at], content[at:]
        if how == "flip" and after:
            after = bytes([after[0] ^ number]) + after[1:]
        elif how == "cut":
            after = after[number:]
        elif how == "double":
            after = after[:number] * 50 + after
        else:
            after = b"[" * number * 40 + after
        content = before + after
    return content
