"""Dates as learning platforms write them, in numbers or in the words of several languages."""

from __future__ import annotations

import re
from datetime import datetime

from logical_robots_tui.lab.platforms.names import plain

_LONGEST = 100
_MONTHS = (
    *(("jan", "ene", "gen", "sty"), ("feb", "fev", "lut"), ("mar", "maa", "mrt")),
    *(
        ("apr", "avr", "abr", "kwi"),
        ("may", "mai", "mag", "maj", "mei"),
        ("jun", "juin", "giu", "cze"),
    ),
    *(("jul", "juil", "lug", "lip"), ("aug", "aou", "ago", "sie")),
    *(
        ("sep", "set", "wrz"),
        ("oct", "okt", "out", "ott", "paz"),
        ("nov", "lis"),
        ("dec", "dez", "dic", "gru"),
    ),
)
"""How the names of months begin in the languages of `tables.HEADS`."""

_TIME = r"\D{0,9}(?P<hour>\d\d?)[:.h]?(?P<minute>\d\d)(?:[:.](?P<second>\d\d))?"
_FORMS = (
    re.compile(
        r"(?P<year>\d{4})-(?P<month>\d\d)-(?P<day>\d\d)[T _-]"
        r"(?P<hour>\d\d)[:-]?(?P<minute>\d\d)(?:[:-]?(?P<second>\d\d))?(?:\.\d+)? ?(?P<zone>\S*)"
    ),
    # Sunday, 18 October 2026, 8:15 PM; domingo, 18 de octubre de 2026, 20:15
    re.compile(
        r"(?:.*?[\s,])??(?P<day>\d\d?)\.? (?:de )?(?P<month>[^\W\d_]+)\.?,? (?:de )?(?P<year>\d{4})"
        rf"{_TIME}\s*(?P<half>[AaPp]?)"
    ),
    # Nov 29, 2026 1159 PM, of Brightspace
    re.compile(
        rf"(?:.*?[\s,])??(?P<month>[^\W\d_]+)\.? (?P<day>\d\d?),? (?P<year>\d{{4}}){_TIME}"
        r"\s*(?P<half>[AaPp]?)"
    ),
)


def parse_date(text: str) -> datetime | None:
    """Return a date and time, without a zone if the text has none; None if it can't be read."""
    text = " ".join(text[:_LONGEST].split())
    match = next(filter(None, (form.match(text) for form in _FORMS)), None)
    try:
        return _date_of(match.groupdict("")) if match else None
    except ValueError:
        return None


def _date_of(fields: dict[str, str]) -> datetime:
    name, hour, half = plain(fields["month"]), int(fields["hour"]), fields.get("half", "").lower()
    month = next((n for n, starts in enumerate(_MONTHS, 1) if name.startswith(starts)), 0)
    zone = fields.get("zone", "").replace("UTC", "Z")
    return datetime(
        int(fields["year"]),
        month or int(name),
        int(fields["day"]),
        hour % 12 + 12 * (half == "p") if half else hour,
        int(fields["minute"]),
        int(fields["second"] or 0),
        tzinfo=datetime.strptime(zone, "%z").tzinfo if zone else None,
    )
