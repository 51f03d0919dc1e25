"""Errors during a think, in plain words."""

from __future__ import annotations

import logging
import re
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager

from logical_robots_tui.language.diagnostics import Stopped, printable
from logical_robots_tui.mind.sqlite.database import TooMuchError, TooSlowError
from logical_robots_tui.mind.sqlite.moment import TooHeavyError, Within
from logical_robots_tui.mind.sqlite.stored import TooDeepError

NO_MEMORY = 3
"""The exit status of a compile process that ran out of memory."""

_log = logging.getLogger(__name__)
_logged: set[type[Exception]] = set()  # each class of our bugs is logged once


class FailureError(Exception):
    """A query failed; the message is for the player.

    `slow` means that trying again would take too long, too; `late`, that a time limit ended it.
    """

    def __init__(self, message: str, *, slow: bool = False, late: bool = False) -> None:
        self.slow = slow
        self.late = late
        super().__init__(message)


@contextmanager
def failures_in_words(within: Within) -> Iterator[None]:
    """Turn any exception of a query but `Stopped` into a `FailureError` for the player."""
    try:
        yield
    except TooSlowError:
        raise _slow(within) from None
    except TooHeavyError as error:
        raise FailureError(str(error), slow=True) from None
    except (TooMuchError, TooDeepError) as error:
        raise FailureError(str(error)) from None
    except (sqlite3.Error, sqlite3.Warning) as error:
        raise FailureError(printable(in_plain_words(error))) from None
    except (FailureError, Stopped):
        raise
    except Exception as error:
        if type(error) not in _logged:
            _logged.add(type(error))
            _log.exception("a query failed in our own code")
        raise FailureError("it can't be computed; this is a bug in the game") from error


def _slow(within: Within) -> FailureError:
    if within.budget.is_late:
        message = (
            f"a guard ended it after {within.seconds:g} seconds, elsewhere it may go otherwise"
        )
        return FailureError(message, slow=True, late=True)
    return FailureError(f"thinking took more than {within.steps:,} steps", slow=True)


def in_plain_words(error: Exception) -> str:
    text = str(error)
    for pattern, words in _WORDS:
        if found := re.search(pattern, text):
            return found.expand(words)
    return "it can't be computed"


_WORDS = (
    (r"malformed JSON", "a field was read from something that is neither a record nor a list"),
    (r"user-defined: '?utf", "a text holds half of a character, as Chr(55296) makes it"),
    (
        r"user-defined",
        "a function was given a value that it can't use, such as text instead of a list",
    ),
    (
        r"parser stack overflow|too many levels|too large|tree is too|too many terms",
        "an expression is nested too deeply; give parts of it names of their own",
    ),
    (
        r"too many references|tables in a join",
        "it combines too many predicates; mention long ones less often",
    ),
    (r"too many arguments", "a list or a call has too many parts"),
    (r"not authorized|prohibited|not a query", "it uses something that robots may not use"),
    (r"too big|out of memory", "a value became too large"),
    (r"integer overflow", "an integer became too large"),
    (r"no such function: (\w+)", r"there is no function \1"),
    (r"wrong number of arguments to function (\w+)", r"\1 has the wrong number of arguments"),
    (r"misuse of aggregate", "an aggregate is used where a plain value is needed"),
    (r"misuse of window", "a function is used that needs an order of rows"),
    (r"no such column: (?:\w+\.)?(col\d+)", "a positional column is used that does not exist"),
    (r"no such column: (?:\w+\.)?(\w+)", r"a column \1 is used that does not exist"),
    (r"no such table: (?:\w+\.)?(\w+)", r"there is no predicate \1"),
    (r"same number of result columns", "its rules have different columns"),
    (r'near "\.": syntax', "it passes on a whole record (..r); name the fields instead"),
    (r"circular reference", "it depends on itself in a way that can't be computed"),
)
