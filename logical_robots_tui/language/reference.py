"""Help on every function, aggregate and operator that a program may use, as data.

Each line below reads ``signature -- summary -- example => result``; the result is JSON.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Literal, NamedTuple

from logical_robots_tui.language.diagnostics import closest

Kind = Literal["function", "aggregate", "operator"]


class FunctionHelp(NamedTuple):
    """Help on a function, aggregate or operator; `result` is the value of `example` as JSON."""

    name: str
    signature: str
    summary: str
    example: str
    result: str
    kind: Kind


_OPERATORS = """
x + y -- the sum -- 1 + 2 => 3
x - y -- the difference; -x is the negative of x -- 5 - 2 => 3
x * y -- the product -- 2 * 3 => 6
x / y -- the quotient; integers are not rounded -- 7 / 2 => 3.5
x % y -- the remainder, with the sign of x -- 7 % 3 => 1
x ^ y -- x to the power of y -- 2 ^ 10 => 1024
x ++ y -- the concatenation of two strings or lists -- "a" ++ "b" => "ab"
x == y -- whether x and y are equal -- 1 + 1 == 2 => true
x != y -- whether x and y differ -- 1 != 2 => true
x < y -- whether x is smaller than y -- 1 < 2 => true
x <= y -- whether x is smaller than or equal to y -- 2 <= 2 => true
x > y -- whether x is larger than y -- 1 > 2 => false
x >= y -- whether x is larger than or equal to y -- 1 >= 2 => false
a && b -- whether both hold -- 1 < 2 && 2 < 3 => true
a || b -- whether at least one holds -- 1 < 2 || 2 < 1 => true
! a -- whether a condition does not hold -- !(1 < 2) => false
x in list -- in a body each element of a list; elsewhere whether x is an element -- \
2 in [1, 2] => true
x is null -- whether x has no value -- null is null => true
x is not null -- whether x has a value -- 1 is not null => true
x -> y -- a pair for ArgMin, ArgMax, Array and WeightedAverage -- (1 -> 2).value => 2
a => b -- holds unless a holds and b does not; in bodies b has to hold for all x of a -- \
(x in [1, 2] => x > 0) => true
~ P(x) -- holds if P(x) has no rows, or if a condition does not hold -- ~(1 == 2) => true
if a then x else y -- x if a holds, otherwise y -- (if 1 < 2 then "yes" else "no") => "yes"
"""

_AGGREGATES = """
Sum{x :- P(x)} -- the sum -- Sum{x :- x in [1, 2, 3]} => 6
Avg{x :- P(x)} -- the mean -- Avg{x :- x in [1, 2]} => 1.5
Min{x :- P(x)} -- the smallest -- Min{x :- x in [4, 2]} => 2
Max{x :- P(x)} -- the largest -- Max{x :- x in [4, 2]} => 4
Count{x :- P(x)} -- the number of distinct values -- Count{x :- x in [4, 2, 4]} => 2
ExactCount{x :- P(x)} -- the same as Count -- ExactCount{x :- x in [4, 2, 4]} => 2
List{x :- P(x)} -- a list of all values; null if there are none -- \
List{2 * x :- x in [4, 2]} => [8, 4]
Set{x :- P(x)} -- a sorted list of the distinct values -- Set{x :- x in [4, 2, 4]} => [2, 4]
SomeValue{x :- P(x)} -- the same as AnyValue -- SomeValue{x :- x in [3]} => 3
AnyValue{x :- P(x)} -- any one of the values -- AnyValue{x :- x in [3]} => 3
ArrayConcatAgg{x :- P(x)} -- the same as ++=, in braces -- \
ArrayConcatAgg{x :- x in [[1], [2]]} => [1, 2]
ArgMin{x -> y :- P(x, y)} -- the x of the smallest y -- ArgMin{x -> -x :- x in [1, 2]} => 2
ArgMax{x -> y :- P(x, y)} -- the x of the largest y -- ArgMax{x -> -x :- x in [1, 2]} => 1
Array{i -> x :- P(i, x)} -- a list of x, ordered by i -- Array{-x -> x :- x in [1, 2]} => [2, 1]
WeightedAverage{w -> x :- P(w, x)} -- the mean of x, weighted by w -- \
WeightedAverage{w -> 10 * w :- w in [1, 3]} => 25
StringAgg{x :- P(x)} -- all strings, separated by commas -- StringAgg{x :- x in ["a", "b"]} => "a,b"
Aggr{f :- P(x)} -- any expression of aggregates -- Aggr{Sum(x) * 2 :- x in [1, 2]} => 6
P(x, total? += y) distinct :- Q(x, y); -- the sum, in a head or with combine -- \
(combine += x :- x in [1, 2]) => 3
P(x, all? ++= y) distinct :- Q(x, y); -- the lists or strings one after the other, in a head or \
with combine -- \
(combine ++= x :- x in [[1], [2]]) => [1, 2]
P(x, one? 1= y) distinct :- Q(x, y); -- the single value, in a head or with combine -- \
(combine 1= x :- x in [7]) => 7
"""

_FUNCTIONS = """
Abs(x) -- the absolute value -- Abs(-2.5) => 2.5
Acos(x) -- the angle with this cosine, in radians -- Acos(1) => 0
Acosh(x) -- the inverse of Cosh -- Acosh(1) => 0
ArgMaxK(pairs, k) -- arguments of the k largest; with braces: Far(x) = ArgMaxK(x, 2); -- \
ArgMaxK({arg: "a", value: 1}, 2) => ["a"]
ArgMinK(pairs, k) -- arguments of the k smallest; with braces: Near(x) = ArgMinK(x, 2); -- \
ArgMinK({arg: "a", value: 1}, 2) => ["a"]
Arrow(left, right) -- the pair left -> right, also to match one -- \
Sum{a + b :- p in [{arg: 1, value: 2}], Arrow(a, b) == p} => 3
ArrayConcat(list, ...) -- the concatenation of lists -- ArrayConcat([1], [2], [3]) => [1, 2, 3]
ArrayLength(list) -- the same as Size -- ArrayLength([1, 2]) => 2
ArrayToString(list, between) -- the same as Join -- ArrayToString(["a", "b"], "-") => "a-b"
Asin(x) -- the angle with this sine, in radians -- Asin(0) => 0
Asinh(x) -- the inverse of Sinh -- Asinh(0) => 0
AssembleRecord(pairs) -- a record from a list of pairs name -> value -- \
AssembleRecord([{arg: "a", value: 1}]) => {"a": 1}
Atan(x) -- the angle with this tangent, in radians -- Atan(0) => 0
Atan2(y, x) -- the direction of the point (x, y), in radians -- Atan2(0, 1) => 0
Atanh(x) -- the inverse of Tanh -- Atanh(0) => 0
Cast(x, type) -- x as a value of a type, such as Num, Int, {a: Str} or "INTEGER" -- \
Cast("12", Int) => 12
Ceil(x) -- x rounded up -- Ceil(1.2) => 2
CharLength(string) -- the same as Length -- CharLength("abc") => 3
Chr(code) -- the character with this code point -- Chr(65) => "A"
Coalesce(x, y, ...) -- the first value that is not null -- Coalesce(null, 5) => 5
Concat(list, list) -- the concatenation of two lists -- Concat([1], [2]) => [1, 2]
Constraint(a) -- holds if an expression is true -- Constraint(1 < 2) => true
Cos(x) -- the cosine of an angle in radians -- Cos(0) => 1
Cosh(x) -- the hyperbolic cosine -- Cosh(0) => 1
CumulativeMax(x, [group], [order]) -- the largest up to this row -- CumulativeMax(1, [1], [1]) => 1
CumulativeMin(x, [group], [order]) -- the smallest up to this row -- CumulativeMin(1, [1], [1]) => 1
CumulativeSum(x, [group], [order]) -- the sum up to this row -- CumulativeSum(1, [1], [1]) => 1
DisassembleRecord(record) -- a list of pairs name -> value -- \
DisassembleRecord({a: 1}) => [{"arg": "a", "value": 1}]
Element(list, i) -- the element at index i, from 0 -- Element([5, 6], 1) => 6
EndsWith(string, end) -- whether a string ends with another -- EndsWith("robot", "bot") => true
Exp(x) -- e to the power of x -- Exp(0) => 1
Fingerprint(x) -- the same as NaturalHash -- Fingerprint("a") == Fingerprint("a") => true
Floor(x) -- x rounded down -- Floor(2.7) => 2
Format(format, x, ...) -- a string with values inserted, as in printf -- \
Format("%.2f", 1.5) => "1.50"
GenerateArray(x, y, step) -- the list of numbers from x to y; step is optional -- \
GenerateArray(1, 7, 3) => [1, 4, 7]
Greatest(x, y, ...) -- the largest of its arguments -- Greatest(1, 3, 2) => 3
If(a, x, y) -- x if a holds, otherwise y -- If(1 < 2, "yes", "no") => "yes"
Ifnull(x, y) -- x, or y if x is null -- Ifnull(null, 3) => 3
IsNull(x) -- whether x has no value -- IsNull(null) => true
Join(list, between) -- the elements as one string, with a separator -- \
Join(["a", "b"], "-") => "a-b"
JsonExtract(json, path) -- a part of JSON text -- JsonExtract("[4, 5]", "$[1]") => 5
Least(x, y, ...) -- the smallest of its arguments -- Least(3, 1, 2) => 1
Length(string) -- the number of characters -- Length("abc") => 3
Like(string, pattern) -- whether a string matches; % is any string, _ any character -- \
Like("robot", "r%t") => true
Ln(x) -- the natural logarithm -- Ln(1) => 0
Log(x) -- the natural logarithm, the same as Ln; Log10 has base 10 -- Log(1) => 0
Log10(x) -- the logarithm to base 10 -- Log10(100) => 2
Lower(string) -- the string in lower case -- Lower("ABC") => "abc"
Lpad(string, n, fill) -- the string filled on the left to n characters -- Lpad("7", 3, "0") => "007"
Ltrim(string) -- the string without leading spaces -- Ltrim("  a") => "a"
Mod(x, y) -- the remainder, with the sign of x -- Mod(7, 3) => 1
NaturalHash(x) -- an integer hash, always the same for the same value -- \
NaturalHash("a") == NaturalHash("a") => true
Nullif(x, y) -- x, or null if both are equal -- Nullif(1, 1) => null
Num(x) -- the number x; also the type of numbers -- Num(5) => 5
Ord(string) -- the code point of the first character -- Ord("A") => 65
Pow(x, y) -- x to the power of y -- Pow(2, 3) => 8
Range(n) -- the list of integers from 0 to n - 1 -- Range(3) => [0, 1, 2]
RecordAsJson(record) -- a record as JSON text -- Length(RecordAsJson({a: 1})) => 7
RegexpExtract(string, pattern) -- the first match of a regular expression (RE2), or "" -- \
RegexpExtract("at 12", "[0-9]+") => "12"
Repeat(string, n) -- the string n times -- Repeat("ab", 2) => "abab"
Replace(string, old, new) -- the string with every old replaced by new -- \
Replace("aba", "a", "c") => "cbc"
Reverse(string) -- the string reversed -- Reverse("abc") => "cba"
Round(x, digits) -- x rounded; digits is optional -- Round(2.567, 2) => 2.57
Rpad(string, n, fill) -- the string filled on the right to n characters -- \
Rpad("7", 3, "0") => "700"
Rtrim(string) -- the string without trailing spaces -- Rtrim("a  ") => "a"
Sign(x) -- -1, 0 or 1 -- Sign(-3) => -1
Sin(x) -- the sine of an angle in radians -- Sin(0) => 0
Sinh(x) -- the hyperbolic sine -- Sinh(0) => 0
Size(list) -- the number of elements -- Size([1, 2, 3]) => 3
Sort(list) -- the list in ascending order -- Sort([3, 1, 2]) => [1, 2, 3]
Split(string, between) -- the parts of a string between separators -- \
Split("a,b", ",") => ["a", "b"]
Sqrt(x) -- the square root; null for a negative number -- Sqrt(16) => 4
StartsWith(string, start) -- whether a string starts with another -- \
StartsWith("robot", "rob") => true
Strpos(string, part) -- where a string contains another, from 1; 0 if nowhere -- \
Strpos("abc", "c") => 3
Str(x) -- the string x; also the type of strings -- Str("a") => "a"
Substr(string, from, count) -- a part of a string; positions start at 1 -- \
Substr("hello", 2, 3) => "ell"
Tan(x) -- the tangent of an angle in radians -- Tan(0) => 0
Tanh(x) -- the hyperbolic tangent -- Tanh(0) => 0
ToFloat64(x) -- x as a number -- ToFloat64("1.5") => 1.5
ToInt64(x) -- x as an integer -- ToInt64("12") => 12
ToString(x) -- x as string -- ToString(12) => "12"
Trim(string) -- the string without leading and trailing spaces -- Trim("  a ") => "a"
Trunc(x) -- x without its fraction -- Trunc(2.7) => 2
TruthToString(a) -- "true" or "false" -- TruthToString(1 < 2) => "true"
TryCast(x, example) -- x as the type of the example, or null -- TryCast("12", 0) => 12
UniqueNumber() -- another number at each use -- UniqueNumber() => 1
Unique(list) -- the distinct elements, sorted -- Unique([2, 1, 2]) => [1, 2]
Upper(string) -- the string in upper case -- Upper("abc") => "ABC"
WindowMax(x, [group], [order], n) -- the largest of this row and the n rows before -- \
WindowMax(1, [1], [1], 2) => 1
WindowMin(x, [group], [order], n) -- the smallest of this row and the n rows before -- \
WindowMin(1, [1], [1], 2) => 1
WindowSum(x, [group], [order], n) -- the sum of this row and the n rows before -- \
WindowSum(1, [1], [1], 2) => 1
"""


def _parse_table(table: str, kind: Kind) -> Iterator[FunctionHelp]:
    for line in table.strip().splitlines():
        signature, summary, sample = line.split(" -- ")
        example, result = sample.rsplit(" => ", 1)
        name, words = re.split(r"[({]", signature)[0], signature.split()
        if kind == "aggregate" and "?" in signature:
            name = signature.split("? ")[1].split()[0]
        elif kind == "operator":
            name = words[0] if words[0] in ("if", "!", "~") else words[1]
            name = "is not" if words[1:3] == ["is", "not"] else name
        yield FunctionHelp(name, signature, summary, example, result, kind)


REFERENCE: tuple[FunctionHelp, ...] = (
    *_parse_table(_OPERATORS, "operator"),
    *_parse_table(_AGGREGATES, "aggregate"),
    *_parse_table(_FUNCTIONS, "function"),
)
"""All entries: operators, then aggregates, then functions."""


def find_help(name: str) -> FunctionHelp | None:
    exact = next((h for h in REFERENCE if h.name == name), None)
    return exact or next((h for h in REFERENCE if h.name.lower() == name.lower()), None)


def similar(name: str) -> str:
    return closest(name, (h.name for h in REFERENCE), 0.6)
