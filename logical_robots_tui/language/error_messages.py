"""The `logica` package's errors in plain words, with their place in the text."""

from __future__ import annotations

import re
from dataclasses import replace

from logica.compiler import functors, rule_translate
from logica.parser_py import parse

from logical_robots_tui.language.diagnostics import Diagnostic, Proposal, TextChange, closest
from logical_robots_tui.language.source_text import (
    COMMENT_HINT,
    Prepared,
    diagnostic_at,
    distinct_after_head,
)
from logical_robots_tui.schema import INPUTS, SENSOR

COMPLAINTS = (
    parse.ParsingException,
    rule_translate.RuleCompileException,
    functors.FunctorError,
    AssertionError,
    KeyError,
    TypeError,
    IndexError,
    AttributeError,
    ValueError,
    RuntimeError,
)
"""Exceptions of the package for programs that it can't compile, including unintended ones."""

FUNCTION = "{} is a function of its arguments; it has no rows of its own."
OPEN = "{} uses {}, which is a parameter for :=; it has no rows of its own."

_NO_CONDITION = "This is not a condition"
NOT_IN_HEAD = "This does not belong in the head of a rule"
_NO_HEAD = "A rule starts with a predicate such as Robot(...)"
_TWO_SIGNS = "There are two ':-'"
_NO_FIELD = "Names of fields are lower case"
_TOO_MANY_EQUALS = (
    "There is more than one '=' in the head of this rule",
    "This needs exactly one '='",
)
_NO_EXPRESSION = "This is not an expression"
_NO_CALL = "This is not a predicate with arguments"
_NO_DISTINCT = "The head of this rule can't be understood"
_NOT_DISTINCT = "Add `distinct` after the head"
_NO_IF = "This 'if' can't be read"
_NO_COPY = "This is not a predicate made from another"
_UNREAD = (_NO_CONDITION, _NO_EXPRESSION, _NO_CALL, _NO_IF, _NO_HEAD, NOT_IN_HEAD)

_IF = "(if a < b then c else d)"
_LOOK = "Look for a missing comma, quote or operator."
_DISTINCT = "The word distinct comes last in a head, before ':-'."
_ENDS = "Rules end with ';'."
END_MISSING = "Is a ';' missing before it?"
_LOST = "is a ';' missing before"
_BRACES = "Aggregates use braces: Sum{x :- Item(x)}."
_HEADS = "Heads aggregate like this: P(x, best? Max= v)."
_TO_THE_END = "Move it to the end."
_LOWER = "Use lower case letters and '_'."
_COPY = "Write New := Old(Used: Other); a rule has ':-', and a value '='."
_START = "Add a rule for it that does not use it."
_ELEMENT = "An element of a list is Element(list, 0), Element(list, 1) ..."
_PREDICATE = re.compile(r"[A-Z]\w*")
_FIELD = re.compile(r"[a-z_]\w*(\.[a-z_]\w*)*")
_INSTEAD_OF_SIGN = re.compile(r"<-|[{:]|(if|when|where)\b", re.IGNORECASE)
_CONSTANT = re.compile(r"([A-Z]\w*)\s*=")
_IN_BODY = re.compile(r"[=<>~]|\bin\b")
_COMPARISON = re.compile(r"[<>!=]=")
_SECOND_HEAD = re.compile(r"[\w)\]}\"']\s*\n\s*(?P<name>[A-Z@]\w*)")
_HEAD = re.compile(r"\)\s*(=[^=,]*|distinct)?\s*$|\n\s*[A-Z]\w*\([^:]*$")

_ANSI = re.compile(r"\x1b\[[0-9;]*m")
_EMPHASISED = re.compile(r"\x1b\[1m(.*?)\x1b\[0m", re.DOTALL)
_UNASSIGNED = re.compile(r"no way to assign variables: ([^.]*)")
_OWN = (parse.ParsingException, rule_translate.RuleCompileException, functors.FunctorError)


def explain(
    error: BaseException, source: Prepared, within: tuple[int, int] | None = None
) -> Diagnostic:
    """Return the diagnostic for an exception raised within a statement (its start and end)."""
    start, end = within or rule_of(error, source)
    if isinstance(error, RecursionError) or isinstance((error.args or (None,))[0], RecursionError):
        hint = "Split it into named parts."
        return diagnostic_at(source.original, start, 0, "The program is nested too deeply", hint)
    if names := unbound_variables(error):
        return _without_value(names, source, start, end)
    message, hint = _plain(error)
    offset, length = _place(error, source, start, end)
    for sign, prefix in _AT_SIGN.items():
        text = source.text if sign == "${" else source.skeleton
        if message.startswith(prefix) and (first := text.find(sign, offset, end)) >= 0:
            second = text.find(sign, first + 1, end) if sign == ":-" else first
            offset, length = max(first, second), len(sign)
    value = source.original[offset : offset + length].strip()
    copy_sign = source.skeleton.find(":=", start, end)
    if copy_sign >= 0 and ":-" in source.text[start:copy_sign]:
        offset, length, message = copy_sign, 2, "':=' can't be used in the body of a rule"
        hint = "Write '=' for a value; ':=' makes a predicate from another."
    elif message in (_TOO_MANY_EQUALS[0], _NO_DISTINCT) and (
        head := _SECOND_HEAD.search(source.skeleton, offset, end)
    ):
        offset, length = head.start("name"), len(head["name"])
        message, hint = f"There are two heads in one rule; {_LOST} {head['name']}?", _ENDS
    else:
        place, rule = (offset, offset + length), (start, end)
        message, hint = _fitting(message, hint, value, source, place, rule)
    diagnostic = diagnostic_at(source.original, offset, length, message, hint)
    if message == _NOT_DISTINCT:
        return replace(diagnostic, fix=distinct_after_head(source, start, end))
    if hint.startswith((_ENDS, END_MISSING)) and (
        head := _SECOND_HEAD.search(source.skeleton, start, end)
    ):
        stop = head.start() + 1
        return replace(diagnostic, fix=TextChange(stop, stop, ";"))
    return diagnostic


def _fitting(
    message: str,
    usual: str,
    value: str,
    source: Prepared,
    place: tuple[int, int],
    statement: tuple[int, int],
) -> tuple[str, str]:
    """Return a message and a hint as they fit a value at a place in a statement."""
    if message == _NO_FIELD and re.search(r"[^\w.]", value):
        message = _NO_EXPRESSION
    if message in _UNREAD:
        hint = _neighbour_hint(source.skeleton, place[0], *statement)
        if message == NOT_IN_HEAD and _INSTEAD_OF_SIGN.match(value):
            return message, "Write ':-' between the head and the body."
        if hint := hint or _foreign_hint(source.skeleton[slice(*place)]):
            return message, hint
    if message == _NO_CONDITION and _FIELD.fullmatch(value):
        hint = f"A value alone is not a condition: write {value} == true, or name it: x = {value}."
        return message, hint
    if message == _NO_CONDITION and _PREDICATE.fullmatch(value):
        return f"{value} is named without its arguments", f"Write {value}(...)."
    if message in _TOO_MANY_EQUALS and _COMPARISON.search(value):
        left, _, compared = value.partition("=")
        return message, f"Put the comparison in parentheses: {left}= ({compared.strip()[:60]})."
    if message.startswith(_TWO_SIGNS) and not _HEAD.search(source.skeleton, statement[0], place[0]):
        return f"{_TWO_SIGNS} in one rule", _BRACES
    if message == _NO_HEAD and (constant := _CONSTANT.match(value)):
        return message, f"A predicate has parentheses, also a constant: {constant[1]}() = 0.5;"
    if message == _NO_HEAD and statement[0] and _IN_BODY.search(source.skeleton, *statement):
        return message, "A ';' ends a rule; write ',' between its conditions."
    return message, usual


def plain_message(error: BaseException) -> str:
    return _plain(error)[0]


def _plain(error: BaseException) -> tuple[str, str]:
    undo = "Undo your last changes to find the cause."
    if not isinstance(error, _OWN):
        return "Logica can't compile this", undo
    message = _plain_text(error)
    for pattern, plain, hint in _PLAIN:
        if match := re.search(pattern, message):
            return match.expand(plain), hint
    return message[:300], undo


def unbound_variables(error: BaseException) -> list[str]:
    match = _UNASSIGNED.search(_plain_text(error))
    return [n.split(" in rule for ")[0] for n in match.group(1).split(", ")] if match else []


def is_function(error: BaseException) -> bool:
    """Return whether the package only complains about missing arguments."""
    return bool(unbound_variables(error)) or "not passed a required argument" in str(error)


def _plain_text(error: BaseException) -> str:
    return " ".join(_ANSI.sub("", str(error)).split()).rstrip(".")


def _without_value(names: list[str], source: Prepared, start: int, end: int) -> Diagnostic:
    """Return the diagnostic for variables without a value; those mentioned once are the cause."""
    rule = source.skeleton[start:end]
    culprits = [name for name in names if len(_mentions(name, rule)) == 1] or names
    message = f"{' and '.join(culprits)} {'has' if len(culprits) == 1 else 'have'} no value"
    candidates = {*re.findall(r"(?<![\w.`@])[a-z_]\w*(?![\w(])", rule)} - {*names} - _WORDS
    close = closest(culprits[0], candidates)
    places = _mentions(culprits[0], rule) or [0]
    hint = Proposal(close) if close else _value_hint(culprits[0], rule[: places[0]])
    return diagnostic_at(source.original, start + places[0], len(culprits[0]), message, hint)


def _value_hint(name: str, prefix: str) -> str:
    """Return a hint how to give a variable its value."""
    if name in SENSOR.names:
        return Proposal(f"sensor.{name}", "Write {}.")
    table = next((predicate for predicate, columns in INPUTS.items() if name in columns), "")
    if table:
        return f"Take it from {table}({', '.join(f'{column}:' for column in INPUTS[table])})."
    if re.search(r"(label|object|robot_name)\s*(!=|==?)\s*$", prefix):
        return f'A string is written in quotes: "{name}".'
    return "Give it a value in the body, or take it from a predicate."


def _mentions(name: str, rule: str) -> list[int]:
    pattern = rf"(?<![\w.]){re.escape(name)}(?!\w|\s*:(?!-|\s*[,)}}]))"
    return [match.start() for match in re.finditer(pattern, rule)]


_AT_SIGN = {":-": _TWO_SIGNS, "|": "'|' can't be used", "${": "A string can't hold"}
"""Messages that are better shown at the sign they are about."""

_WORDS = frozenset({"if", "then", "else", "in", "is", "not", "distinct", "null", "true", "false"})

_PLAIN = (
    (r"^Could not parse expression", _NO_EXPRESSION, _LOOK),
    (r"^Could not parse proposition", _NO_CONDITION, _LOOK),
    (r"^Could not parse predicate call", _NO_CALL,
     "Rules and facts start with a name: Robot(...)."),
    (r"^Found no call in rule head", _NO_HEAD, "Names of predicates start with a capital letter."),
    (r"^Too many :-", f"{_TWO_SIGNS} in one rule; {_LOST} the second?", _ENDS),
    (r"should have been split by :- ", f"{_TWO_SIGNS} here", _ENDS),
    (r"^Unexpected :- in record", "A ':-' can't be used in parentheses", _BRACES),
    (r"^Can not parse rule head|^Too many distinct", _NO_DISTINCT,
     _DISTINCT),
    (r"^Denotation (\w+) should go last", r"The word \1 comes last in the head", _TO_THE_END),
    (r"split by (else|then)", _NO_IF, f"Put it in parentheses: x = {_IF}."),
    (r"^If-then-else clause", "An 'if' gives a value; it is not a condition",
     f"Write x = {_IF}, or join conditions with ','."),
    (r"split by =", _TOO_MANY_EQUALS[1], _HEADS),
    (r"split by : in", "Expected a comma", "A comma or a ';' seems to be missing."),
    (r"^Aggregating predicate must be", _NOT_DISTINCT,
     "A rule with '?' needs it: P(x, best? Max= v) distinct :- ..."),
    (r"^Aggregation of fields is only", "Only the head of a rule can aggregate with '?'", _HEADS),
    (r"^Aggregated fields have to", "An aggregated column needs a name before the '?'", _HEADS),
    (r"^Unexpected text in the head", NOT_IN_HEAD, END_MISSING),
    (r"^Too many '=' in predicate", _TOO_MANY_EQUALS[0], "A head has one value: F(x) = y :- ..."),
    (r"^Variables starting with x_", "Names of variables can't start with x_",
     "Choose another name."),
    (r"^Record fields may not start", "Names of fields start with a lower case letter", _LOWER),
    (r"^Backticks in variable", "Give this column a variable", "For example: `my column`: x."),
    (r"^Positional argument can not", "Arguments without a name come before those with one",
     "Give this one a name, too, or move it to the front."),
    (r"^Field \.\.<rest_of> must", "'..' comes last", _TO_THE_END),
    (r"^Field \.\.<rest_of> in record", "'..' can't be used in a record",
     "Name its fields instead."),
    (r"^Subscript must be", _NO_FIELD, _LOWER),
    (r"^Array subscription must", "An index is a number, without a name", _ELEMENT),
    (r"^Negation", "'~' goes before what it negates", "Write ~P(x) or ~(a == b)."),
    (r"^Incorrect syntax for functor", _NO_COPY, _COPY),
    (r"^Disjunction is disallowed", "'|' can't be used in an aggregate or a negation",
     "Give the alternatives a predicate of their own."),
    (r"^Tables with no columns", "A predicate needs at least one column",
     "Give it an argument or a value."),
    (r"circular dependency of In", "These lists depend on each other",
     "Take one of them from a predicate."),
    (r"^Could not create record", "A whole row can't be used as a value",
     "Name the columns that you need."),
    (r"^Built-in function (\S+) takes", r"\1 has the wrong number of arguments",
     "See `logical-robots help NAME`."),
    (r"^Unsupported supposedly built-in function: (\S+)", r"\1 can't be used as a function",
     "Give it a value with '=', or use it as a condition."),
    (r"^Expected field (\S+) missing in a record", r"Not all branches of this 'if' have \1",
     "Give every branch the same fields."),
    (r"^Predicate (\S+) was proven", r"The recursion of \1 has nothing to start from", _START),
    (r"^All rules contain nil for predicate", "This recursion has nothing to start from", _START),
    (r"^Failed to eliminate recursion of (\S+)", r"\1 can't be recursive in this way",
     "Recursion works for predicates, not for functions."),
    (r"^Functor (\S+) is applied to arguments (\S+),", r"\1 does not use \2",
     "Name a predicate that its rules mention."),
    (r"^Rules for (\S+) when making", r"There is no predicate \1 to make this from",
     "Define it, or correct its name."),
    (r"^Could not resolve Make", "These predicates are made from each other",
     "Define one of them by rules."),
    (r"^Bad functor call", _NO_COPY, _COPY),
    (r"^Signature differs for bodies of ([^\s.]+)", r"The rules of \1 aggregate differently",
     "Use the same aggregate in all of them."),
    (r"^Inconsistency in distinct|^Either all rules of a",
     "Some rules of this predicate are distinct and some are not",
     "Write distinct in all of its heads, or in none."),
    (r"^Parameters .* are undefined", "A string can't hold ${...}", "Separate '$' and '{'."),
    (r"^Cast must have", "Cast needs a value and the name of a type in quotes",
     'For example: Cast("12", "INTEGER").'),
    (r"^Unspecified flag: (\S+)", r"There is no flag \1",
     'Define it: @DefineFlag("name", "value");'),
    (r"^Annotation (\S+) must be applied to an existing predicate.*predicate (\S+)$",
     r"\1 refers to \2, which is not defined", "Define it, or remove the annotation."),
    (r"[Aa]nnotation", "This annotation can't be understood",
     'For example: @Recursive(P, 50); @OrderBy(P, "col0"); @Limit(P, 3);'),
)  # fmt: skip
"""Patterns of the package's messages, each with a plain message and a hint."""


_AND = "Write ',' between conditions, and '&&' within an expression."
_GROUPS = "A head groups by its other columns: P(x, n? += 1) distinct :- Q(x)."
_FOREIGN = (
    (r"\A(//|--|/\*)", COMMENT_HINT),
    (r"\n(?P<next>(?-i:[A-Z@])\w*)", f"{_ENDS} Is one missing before {{next}}?"),
    (r"\A(select|insert|create|update|delete|with)\s|\bselect\s",
     "Rows come from rules: P(x) :- Q(x), x > 1."),
    (r"\bgroup\s+by\b|\S\s+having\s", _GROUPS),
    (r"\border\s+by\b|\blimit\s+\d",
     'Write a statement of its own: @OrderBy(P, "col0 DESC"); or @Limit(P, 3);'),
    (r"\S\s+(not\s+)?between\s", "Write both bounds: a <= x, x <= b."),
    (r"\S\s+i?like\s", 'Write Like(x, "a%").'),
    (r"\S\s+join\s", "Write ',' between predicates; a variable in both joins their rows."),
    (r"\S\s+union\s", "Write a rule for each part, or '|' between conditions."),
    (r"\bcase\s|\bwhen\s", f"Write {_IF}."),
    (r"(?-i:\b(IS|IN|IF|THEN|ELSE|NULL)\b)",
     "Write these words in lower case: is, in, if, then, else, not, null."),
    (r"\bel(s?if|seif)\b", "Write 'else if', as in (if a < b then c else if d then e else f)."),
    (r"\A(?=.*\bthen\b)(?!.*\belse\b)", f"Every 'if' needs an 'else': {_IF}."),
    (r"\bthen\b.*\belse\b", f"Begin with 'if': {_IF}."),
    (r"(?<!\bis )\bnot\b", "Write ~(a == b) or ~P(x) for negation."),
    (r"\band\b|(?<!&)&(?!&)|\S\s+where\b", _AND),
    (r"\bor\b", "Write '|' between conditions, and '||' within an expression."),
    (r"\?.*:|\S\s+if\b", f"Write {_IF}."),
    (r"\A(for|let|var|where)\b", "Leave this word out."),
    (r"\bfor\b", "A body follows ':-', as in List{x :- x in [1, 2]}."),
    (r"\bdistinct\b", _DISTINCT),
    (r"\S\s+as\s+\w", "A name goes before its value: P(name: x), or y = x for a variable."),
    (r"[\w)]\[", _ELEMENT),
)  # fmt: skip
"""Syntax of other languages, or forgotten parts, in a piece of text that can't be parsed."""

_BESIDE = (
    (r"[A-Z]\w*\s*\{\s*$", r"[^{}:]*,", "An aggregate takes one value, or a pair: x -> y."),
    (r"[A-Z]\w*\s*\{\s*$", r"[^{}]*?\s[:|]\s", "A body follows ':-': List{x :- x in [1, 2]}."),
    (r"\bin\s*\(\s*$", r"", "A list is in brackets: x in [1, 2]."),
    (r"~\s*$", r"", "Put the condition after ~ in parentheses: ~(a == b)."),
    (r"=\s*$", r"\s*<", "Write '<='."),
    (r"==\s*$", r"=", "Write '=='."),
    (r"<\s*$", r">", "Write '!='."),
    (r"", r"\S*\s*=>", "Write '>=' to compare."),
    (r"[/-]$", r"[/-]\s", COMMENT_HINT),
    (r"", r"\s*(//|--)", COMMENT_HINT),
    (r"--\s*$", r"", COMMENT_HINT),
    (r"(?i)count\s*\(\s*$", r"\*", _GROUPS),
    (r",\s*$", r"\s*(;|\)|\}|$)", "Remove the ',' before it."),
    (r"[-+*/%]\s*$", r"\s*-\s*\w", "Put a negative value in parentheses: a * (-b)."),
    (r"[-+*/%]\s*$", r"\s*\w+\s*=(?!=)", "Compare with '==': a + b == c."),
    (r"\bif\s+$", r"(?:(?!\bthen\b).)*?\belse\b", f"Every 'if' needs a 'then': {_IF}."),
    (r"", r"\w+ [A-Z]\w*\s*=[^,]*[<>!=]=", "Put the comparison in parentheses: x Max= (a <= b)."),
)
"""Patterns of the text before an error and from it on, each with a hint."""


def _neighbour_hint(skeleton: str, offset: int, start: int, end: int) -> str:
    prefix, suffix = skeleton[start:offset], skeleton[offset:end]
    for pattern, continuation, hint in _BESIDE:
        if re.search(pattern, prefix) and re.match(continuation, suffix, re.DOTALL):
            return hint
    return ""


def _foreign_hint(piece: str) -> str:
    for pattern, hint in _FOREIGN:
        if match := re.search(pattern, piece, re.DOTALL | re.IGNORECASE):
            return hint.format(**match.groupdict()) if match.groupdict() else hint
    return ""


def rule_of(error: BaseException, source: Prepared) -> tuple[int, int]:
    """Return start and end of the statement that an exception is about."""
    rule = getattr(error, "rule_str", "")
    if isinstance(rule, parse.HeritageAwareString) and rule.heritage == source.text:
        return rule.start, rule.stop
    start = source.text.find(str(rule)) if rule else -1
    if start >= 0:
        return start, start + len(str(rule))
    if isinstance(error, functors.FunctorError):
        start = max(0, source.skeleton.find(str(error.functor_name)))
        return start, start + len(str(error.functor_name))
    return 0, len(source.text)


def _place(error: BaseException, source: Prepared, start: int, end: int) -> tuple[int, int]:
    """Return offset and length of the text that an exception is about."""
    location = getattr(error, "location", None)
    if isinstance(location, parse.HeritageAwareString) and location.heritage == source.text:
        begin, stop = location.start, location.stop
        while begin < stop and source.text[begin].isspace():
            begin += 1
        return begin, max(1, stop - begin)
    names = [n for group in _EMPHASISED.findall(str(error)) for n in group.split(", ")]
    for name in names:
        if match := re.search(rf"(?<!\w){re.escape(name)}(?!\w)", source.skeleton[start:end]):
            return start + match.start(), len(name)
    return start, 1
