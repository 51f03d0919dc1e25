"""The wall before DuckDB: a query may hold only what the translation writes.

DuckDB has no authorizer that is asked what a statement may read and call. A query comes out of the
cache of compiled programs, where somebody may have put another one; so each of its words is looked
at before DuckDB sees it.
"""

from __future__ import annotations

import re

__all__ = ["is_harmless"]

_TOKEN = re.compile(
    r"""
    (?P<space> \s+ )
    | (?P<text> '(?:[^'\0]|'')*' )
    | (?P<number> \d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.]) )
    | (?P<word> [A-Za-z_]\w* )
    | (?P<sign> <> | <= | >= | [-+*/%=<>(),.] )
    """,
    re.VERBOSE | re.ASCII,
)

_NAME = re.compile(r"[csq]\d+", re.ASCII)

_WORDS = frozenset(
    (
        "SELECT DISTINCT FROM AS WITH WHERE GROUP BY UNION ALL VALUES FILTER "
        "CASE WHEN THEN ELSE END AND OR NOT IS IN NULL TRUE FALSE BIGINT DOUBLE VARCHAR BOOLEAN "
        "Sensor Memory Ray RobotRay BeaconRay answer items "
        "id robot_name forward_distance forward_object forward_label clock can_charge has_battery "
        "battery_level battery_capacity viewer sensor ray angle distance object label value col0"
    ).split()
)

_BEFORE_PARENTHESES = frozenset(
    (
        "SELECT FROM AS WHERE BY UNION ALL VALUES FILTER WHEN THEN ELSE AND OR NOT IN EXISTS CAST "
        "abs arg_max_null arg_min_null atan atan2 avg ceil coalesce cos count degrees exp floor "
        "greatest least ln log10 log2 max min nullif pi pow radians round row sin sqrt sum tan "
        "trunc"
    ).split()
)


def is_harmless(query: str) -> bool:
    """Whether a query reads the tables of a tick and calls listed functions, and does no more."""
    place, word, last = 0, "", ""
    while place < len(query):
        token = _TOKEN.match(query, place)
        if token is None or "--" in token.group():
            return token is not None and token.lastgroup == "text" and False
        place = token.end()
        if token.lastgroup == "space":
            continue
        text = token.group()
        if token.lastgroup == "sign" and last == text and text in "-/":
            return False  # a comment
        if text == "(" and word and word not in _BEFORE_PARENTHESES:
            return False
        if word and text != "(" and word not in _WORDS and not _NAME.fullmatch(word):
            return False
        if token.lastgroup == "text" and word in ("FROM", "AS", "e", "E", "x", "X"):
            return False
        word = text if token.lastgroup == "word" else ""
        last = text
    return (not word or word in _WORDS or _NAME.fullmatch(word) is not None) and last != ""
