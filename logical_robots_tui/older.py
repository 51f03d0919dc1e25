"""The form in which older versions wrote the programs of teams: one text, headed by a table."""

from __future__ import annotations

import json

_HEAD = "# teams: "
_LONGEST = 100_000  # characters of the table


def texts_of(text: str) -> dict[str, str]:
    """Return the programs by team in a text that an older version wrote.

    Its first line says how many lines each team has; otherwise it is the program of "".
    """
    head, _, rest = text.partition("\n")
    lines, texts = rest.split("\n"), {}
    if head.startswith(_HEAD) and len(head) < _LONGEST:
        try:
            for team, count in json.loads(head.removeprefix(_HEAD)).items():
                texts[team] = "\n".join(lines[:count])
                del lines[:count]
        except (AttributeError, RecursionError, TypeError, ValueError):
            return {"": text}
    return {"": text} if lines or not texts else texts
