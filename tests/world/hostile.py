"""Level files that want more of a machine than a level needs: by name, ending and content."""

from collections.abc import Callable

__all__ = ["FILES"]

TOML = 'title = "x"\ncell = 1\n'
WALLS = TOML + "walls = '''\n{}\n'''\n"
JSON = '{{"width": 10, "height": 10, "walls": "{}", {}}}'
MUCH = 20_000_000


def _records(kind: str, number: int, more: str = "") -> str:
    return f'[[{kind}]]\nname = "n"\nx = 1\ny = 1\n{more}\n' * number


def _level(kind: str, number: int, more: str = "", *, replaced: tuple[str, str] = ("", "")) -> str:
    return WALLS.format("...") + _records(kind, number, more).replace(*replaced)


_IN_TOML: dict[str, Callable[[], str]] = {
    # keys
    "a key of many parts": lambda: "a." * 50_000 + "a = 1",
    "a key of many quoted parts": lambda: '"a".' * 50_000 + "a = 1",
    "a key of many spaced parts": lambda: "a . " * 50_000 + "a = 1",
    "a table of many parts": lambda: "[" + "a." * 50_000 + "a]\n",
    "many keys of many parts": lambda: "".join(f"{'a.' * 500}k{i}=1\n" for i in range(2000)),
    "keys of as many parts as may be": lambda: "".join(
        f"{'a.' * 8}k{i}=1\n" for i in range(59_000)
    ),
    "tables of as many parts as may be": lambda: "".join(
        f"[{'a.' * 8}k{i}]\n" for i in range(59_000)
    ),
    "many keys": lambda: "".join(f"k{i}=1\n" for i in range(1_000_000)),
    "as many keys as may be": lambda: "".join(f"k{i}=1\n" for i in range(59_000)),
    "one key again and again": lambda: "a = 1\n" * 50_000,
    "a long key": lambda: "a" * MUCH + " = 1",
    "a key behind a drawing in a comment": lambda: "# '''\n" + "a." * 50_000 + "a=1\n# '''",
    "a key behind a drawing in a string": lambda: "t = \"'''\"\n" + "a." * 50_000 + "a=1\n",
    # tables, lists and strings
    "many tables": lambda: "[[a]]\n" * 3_000_000,
    "as many tables as may be": lambda: "[[a]]\n" * 29_000,
    "many lists": lambda: "x = [" + "[]," * 5_000_000 + "]",
    "as many lists as may be": lambda: "x = [" + "[]," * 59_000 + "]",
    "many inline tables": lambda: "x = [" + "{a=1}," * 3_000_000 + "]",
    "as many inline tables as may be": lambda: "x = [" + "{a=1}," * 29_000 + "]",
    "deep lists": lambda: "x = " + "[" * 59_000,
    "deep inline tables": lambda: "x = " + "{a = " * 29_000,
    "many dates": lambda: "x = [" + "1979-05-27T07:32:00Z," * 190_000 + "]",
    "many strings": lambda: "x = [" + '"",' * 149_000 + "]",
    "many literal strings": lambda: "x = '''" * 30_000,
    "a long string": lambda: f'title = "{"x" * MUCH}"',
    "a string of escapes": lambda: f'title = "{chr(92)}u0041' * 600_000 + '"',
    "a string of many escapes": lambda: 'title = "' + "\\u0041" * 3_000_000 + '"',
    "a string that never ends": lambda: 'title = "' + "\\" * MUCH,
    "a long string that never ends": lambda: 'title = """' + '\\"' * (MUCH // 2),
    "quotes": lambda: '"' * MUCH,
    "quotes and blanks": lambda: 'x = """' + '" ' * (MUCH // 2),
    "apostrophes": lambda: "'" * MUCH,
    "comments": lambda: "#" * MUCH,
    "empty lines": lambda: "\n" * MUCH,
    "carriage returns": lambda: "\r" * MUCH,
    "blanks": lambda: " " * MUCH,
    "tabs": lambda: "\t" * MUCH,
    "a number of many digits": lambda: TOML + "x = " + "9" * 4_000_000,
    "a number of many underscores": lambda: TOML + "x = 1" + "_1" * 2_000_000,
    "a fraction of many digits": lambda: TOML + "x = 1." + "9" * 4_000_000,
    "a number that is none": lambda: TOML.replace("1", "nan"),
    "a cell without end": lambda: TOML.replace("1", "inf"),
    "half characters": lambda: 'title = "\\ud800"\n',
    "NUL": lambda: 'title = "\0"\n',
    # drawings
    "a wide drawing": lambda: WALLS.format("#" * MUCH),
    "a drawing of many rows": lambda: WALLS.format("#\n" * (MUCH // 2)),
    "a row of many counts": lambda: WALLS.format("1# " * (MUCH // 3)),
    "a row that stands for many": lambda: WALLS.format("9999* 9999#"),
    "rows that stand for many": lambda: WALLS.format("4000* 4000#\n" * 4000),
    "a row of counts of nothing": lambda: WALLS.format("0# " * 3000),
    "large cells": lambda: WALLS.format("###\n###").replace("cell = 1", "cell = 999999999"),
    "a drawing of strange characters": lambda: WALLS.format("\u202e" * 4000),
    # records
    "many robots": lambda: _level("robots", 5000),
    "many areas": lambda: _level("areas", 5000, "radius = 1"),
    "robots of one name": lambda: _level("robots", 900),
    "a robot far away": lambda: _level("robots", 1, replaced=("x = 1", "x = 1e308")),
    "a colour that is none": lambda: _level("robots", 1, 'color = "#' + "f" * 90_000 + '"'),
    # coordinates, sizes and names in TOML
    "coordinates that are none": lambda: _level("robots", 1, replaced=("x = 1", "x = nan")),
    "coordinates without end": lambda: _level("beacons", 1, replaced=("y = 1", "y = -inf")),
    "an area of a thousand millions": lambda: _level("areas", 1, "radius = 1000000000"),
    "an area without end": lambda: _level("areas", 1, "radius = inf"),
    "an area of less than nothing": lambda: _level("areas", 1, "radius = -1e308"),
    "a robot of many joined characters": lambda: _level(
        "robots", 1, replaced=('"n"', '"e' + "\u0301" * 90_000 + '"')
    ),
    "a robot of characters without width": lambda: _level(
        "robots", 1, replaced=('"n"', '"' + "\u200b" * 50 + '"')
    ),
    "a hint again and again": lambda: WALLS.format("...") + "hints = [" + '"x",' * 140_000 + "]",
    "lists of lists of lists": lambda: "x = [" + "[[[1]]]," * 14_000 + "]",
    "a byte order mark and nothing": lambda: "\ufeff" * 1_000_000,
    "line ends of other kinds": lambda: "a = 1\u2028" * 30_000,
    "nothing": str,
}
_IN_JSON: dict[str, Callable[[], str]] = {
    "many records in JSON": lambda: '{"robots": [' + "{}," * 6_000_000 + "{}]}",
    "many lists in JSON": lambda: '{"robots": [' + "[]," * 6_000_000 + "[]]}",
    "many strings in JSON": lambda: '{"robots": [' + '"",' * 6_000_000 + '""]}',
    "many numbers in JSON": lambda: '{"robots": [' + "1.5e3," * 3_000_000 + "1]}",
    "as many numbers as may be": lambda: '{"robots": [' + "1," * 299_000 + "1]}",
    "deep JSON": lambda: '{"a": ' + "[" * 59_000,
    "one key in JSON again and again": lambda: "{" + '"a": 1,' * 100_000 + '"a": 1}',
    "a number of many digits in JSON": lambda: '{"width": ' + "9" * 4_000_000 + "}",
    "a number without end in JSON": lambda: '{"width": 1e999, "height": 1}',
    "no number in JSON": lambda: '{"width": NaN, "height": 1}',
    "a large map in JSON": lambda: '{"width": 1e9, "height": 1e9, "walls": ""}',
    "many walls in JSON": lambda: JSON.format("1" * MUCH, '"robots": []'),
    "half characters in JSON": lambda: JSON.format("", '"robots": [{"name": "\\ud800"}]'),
    "a name of many characters in JSON": lambda: JSON.format(
        "", f'"robots": [{{"name": "{"n" * MUCH}"}}]'
    ),
    "deep objects in JSON": lambda: '{"a": ' * 29_000,
    "deep objects that end in JSON": lambda: (
        '{"width": 9, "height": 9, "walls": "", "x": ' + '{"a": ' * 90 + "1" + "}" * 91
    ),
    "coordinates that are none in JSON": lambda: JSON.format(
        "0" * 100, '"robots": [{"name": "a", "x": NaN, "y": -Infinity}]'
    ),
    "coordinates beyond all in JSON": lambda: JSON.format(
        "0" * 100, '"robots": [{"name": "a", "x": 1e400, "y": -1e308}]'
    ),
    "escapes in JSON": lambda: '{"title": "' + "\\u0000" * 600_000 + '"}',
    "JSON that is a list": lambda: "[" + "1," * 290_000 + "1]",
    "JSON with two ends": lambda: "{}" * 14_000,
}
FILES: dict[str, tuple[str, Callable[[], str]]] = {
    **{name: (".toml", content) for name, content in _IN_TOML.items()},
    **{name: (".json", content) for name, content in _IN_JSON.items()},
    "anything": ("", lambda: "x" * MUCH),
    "words": (".txt", lambda: "word " * (MUCH // 5)),
    "a program": (".l", lambda: "Robot(robot_name:, memory: 1);\n" * 500_000),
}
