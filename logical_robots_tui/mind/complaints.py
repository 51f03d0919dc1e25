"""What the `logica` package complains about, told in plain words with its place in the text."""

from __future__ import annotations

import difflib
import re
from typing import TYPE_CHECKING

from logica.compiler import rule_translate
from logica.parser_py import parse

from logical_robots_tui.mind.text import Prepared, diagnostic_at

if TYPE_CHECKING:
    from collections.abc import Iterable

    from logical_robots_tui.mind.diagnostics import Diagnostic

__all__ = [
    "FUNCTION",
    "at_definition",
    "at_word",
    "explain",
    "is_function",
    "line_of_definition",
    "plain_message",
    "undefined",
]

FUNCTION = "{} is a function of its arguments; it has no rows of its own."

_ANSI = re.compile(r"\x1b\[[0-9;]*m")
_EMPHASISED = re.compile(r"\x1b\[1m(.*?)\x1b\[0m", re.DOTALL)
_UNASSIGNED = re.compile(r"no way to assign variables: ([^.]*)")


def explain(error: BaseException, text: str, source: Prepared) -> Diagnostic:
    """The diagnostic for an exception of the package."""
    if isinstance(error, RecursionError) or isinstance((error.args or (None,))[0], RecursionError):
        return diagnostic_at(
            text, 0, 0, "the program is nested too deeply", "Give parts of it names of their own."
        )
    message = plain_message(error)
    if (found := _UNASSIGNED.search(_plain_text(error))) and (
        rule := getattr(error, "rule_str", "")
    ):
        return _unassigned(found.group(1).split(", "), str(rule), text, source)
    start, length = _place(error, source)
    return diagnostic_at(text, start, length, message, _hint(message))


def plain_message(error: BaseException) -> str:
    """The package's message without colours, in one line."""
    if not isinstance(error, parse.ParsingException | rule_translate.RuleCompileException):
        return "Logica can't compile this program"
    message = _plain_text(error)
    for pattern, plain in _PLAIN:
        if re.search(pattern, message):
            return plain
    return message[:1].lower() + message[1:]


def _plain_text(error: BaseException) -> str:
    return " ".join(_ANSI.sub("", str(error)).split()).rstrip(".")


def _unassigned(names: list[str], rule: str, text: str, source: Prepared) -> Diagnostic:
    """The diagnostic for variables without a value: those mentioned once are the cause."""
    start = _find_statement(rule, source)
    end = start + len(rule)

    def mentions(name: str) -> int:
        return len(re.findall(rf"(?<!\w){re.escape(name)}(?!\w)", source.skeleton[start:end]))

    names = [name.split(" in rule for ")[0] for name in names]
    culprits = [name for name in names if mentions(name) == 1] or names
    what = " and ".join(culprits) + (" is" if len(culprits) == 1 else " are")
    message = f"nothing says what {what}"
    at = _find_word(culprits[0], source.skeleton, start, end)
    return diagnostic_at(text, max(at, start), len(culprits[0]), message, _hint(message))


def is_function(error: BaseException) -> bool:
    """Whether the package complains only that arguments are missing."""
    return "no way to assign variables" in str(error) or "not passed a required argument" in str(
        error
    )


def undefined(name: str, known: Iterable[str], text: str, source: Prepared) -> Diagnostic:
    """The diagnostic for a name that nobody defines."""
    close = difflib.get_close_matches(name, [k for k in known if k.isidentifier()], n=1, cutoff=0.7)
    hint = f"Did you mean {close[0]}?" if close else "Define it, or correct its name."
    return at_word(name, text, source, f"{name} is not defined", hint)


def at_word(name: str, text: str, source: Prepared, message: str, hint: str) -> Diagnostic:
    """A diagnostic at the first mention of a name."""
    return diagnostic_at(text, _find_word(name, source.skeleton), len(name), message, hint)


def at_definition(name: str, text: str, source: Prepared, message: str, hint: str) -> Diagnostic:
    """A diagnostic at the first rule of a predicate."""
    return diagnostic_at(text, _definition(name, source), len(name), message, hint)


def line_of_definition(name: str, text: str, source: Prepared) -> int:
    """Line of a predicate's first rule, from 1."""
    return text.count("\n", 0, _definition(name, source)) + 1


_PLAIN = (
    (r"^Could not parse expression", "this is not an expression"),
    (r"^Could not parse proposition", "this is not a condition"),
    (r"^Could not parse predicate call", "this is not a predicate with arguments"),
    (r"^Found no call in rule head", "a rule starts with a predicate such as Robot(...)"),
    (r"^Too many :-", "there are two ':-' in one rule; is a ';' missing before the second?"),
    (r"^Can not parse rule head", "the head of this rule can't be understood"),
    (r"split by (else|then)", "this 'if' can't be read"),
    (r"split by : in", "more than one value stands here"),
    (r"^Aggregating predicate must be", "a head that aggregates needs the word distinct"),
    (r"^Unexpected text in the head", "this does not belong in the head of a rule"),
)

_HINTS = (
    (r"nothing says what", "Give it a value in the body, or take it from a predicate."),
    (r"is not an expression|is not a condition", "Look for a missing comma, quote or operator."),
    (r"'if' can't be read", "Put it in parentheses: x = (if a < b then c else d)."),
    (r"more than one value", "A comma or a ';' seems to be missing."),
    (r"belong in the head", "Is a ';' missing before it?"),
    (r"needs the word distinct", "Write it between the head and ':-'."),
    (r"can't compile this", "Take away what you added last to find the rule it stumbles over."),
    (r"missing before", "Rules end with ';'."),
    (r"starts with a predicate", "Names of predicates start with a capital letter."),
    (r"does not have an argument", "Compare with the rule that defines it."),
)


def _hint(message: str) -> str:
    return next((hint for pattern, hint in _HINTS if re.search(pattern, message)), "")


def _place(error: BaseException, source: Prepared) -> tuple[int, int]:
    """Offset and length of what an exception is about."""
    if isinstance(error, parse.ParsingException):
        location = error.location
        if isinstance(location, parse.HeritageAwareString):
            statement = _find_statement(location.heritage, source)
            start, stop = location.start, location.stop
            while start < stop and location.heritage[start].isspace():
                start += 1
            return statement + start, max(1, stop - start)
        return _find_statement(str(location), source), 1
    rule = getattr(error, "rule_str", "")
    statement = _find_statement(str(rule), source)
    names = [n for group in _EMPHASISED.findall(str(error)) for n in group.split(", ")]
    for name in names:
        at = _find_word(name, source.skeleton, statement, statement + len(str(rule)))
        if at >= statement:
            return at, len(name)
    return statement, 1


def _find_statement(statement: str, source: Prepared) -> int:
    return max(0, source.text.find(statement.strip())) if statement.strip() else 0


def _find_word(name: str, text: str, start: int = 0, end: int | None = None) -> int:
    pattern = re.compile(rf"(?<![\w@]){re.escape(name)}(?!\w)")
    found = pattern.search(text, start, len(text) if end is None else end)
    return found.start() if found else -1 if start else 0


def _definition(name: str, source: Prepared) -> int:
    pattern = re.compile(rf"(?:^|;)\s*({re.escape(name)})\s*(?:\(|:=)")
    found = pattern.search(source.skeleton)
    return found.start(1) if found else _find_word(name, source.skeleton)
