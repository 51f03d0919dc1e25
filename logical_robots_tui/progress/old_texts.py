"""Programs by team in a text, as older versions wrote them."""

from __future__ import annotations

import json

_HEAD = "# teams: "
_LONGEST = 100_000  # characters of the table


def texts_of(text: str) -> dict[str, str]:
    """Return the programs by team in a text that an older version wrote.

    Its first line says how many lines each team has; otherwise it is the program of "".
    """
    head, _, rest = text.partition("\n")
    lines, texts, begin = rest.split("\n"), {}, 0
    if head.startswith(_HEAD) and len(head) < _LONGEST:
        try:
            for team, count in json.loads(head.removeprefix(_HEAD)).items():
                end = begin + max(count, 0)
                texts[team], begin = "\n".join(lines[begin:end]), end
        except (AttributeError, RecursionError, TypeError, ValueError):
            return {"": text}
    return {"": text} if begin < len(lines) or not texts else texts
