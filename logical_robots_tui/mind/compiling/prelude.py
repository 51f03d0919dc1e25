"""The prelude: everyday predicates, in Logica, that every program may use.

A program that defines one of them itself uses its own; so none of them may lean on another.
Aggregates take ``argument -> value`` pairs, which the compiler knows as ``{arg:, value:}``.
"""

__all__ = ["PRELUDE"]

PRELUDE = """
->(left:, right:) = {arg: left, value: right};
`=`(left:, right:) = right :- left == right;
Arrow(left, right) = arrow :- left == arrow.arg, right == arrow.value;

WeightedAverage(pair) = Sum(pair.arg * pair.value) / Sum(pair.arg);

ArgMin(pair) = SqlExpr("arg_min({a}, {v})", {a: pair.arg, v: pair.value});
ArgMax(pair) = SqlExpr("arg_max({a}, {v})", {a: pair.arg, v: pair.value});
ArgMinK(pair, k) = SqlExpr("arg_min_k({a}, {v}, {k})", {a: pair.arg, v: pair.value, k:});
ArgMaxK(pair, k) = SqlExpr("arg_max_k({a}, {v}, {k})", {a: pair.arg, v: pair.value, k:});
Array(pair) = SqlExpr("array_by({a}, {v})", {a: pair.arg, v: pair.value});

NaturalHash(x) = SqlExpr("natural_hash({x})", {x:});
Fingerprint(x) = SqlExpr("natural_hash({x})", {x:});
TryCast(value, example) = SqlExpr("try_cast_like({v}, {e})", {v: value, e: example});
TruthToString(truth) = SqlExpr("truth_to_text({t})", {t: truth});
RecordAsJson(record) = SqlExpr("record_as_json({r})", {r: record});
AssembleRecord(pairs) = SqlExpr("assemble_record({p})", {p: pairs});
DisassembleRecord(record) = SqlExpr("disassemble_record({r})", {r: record});
Chr(code) = SqlExpr("char({c})", {c: code});
Ord(text) = SqlExpr("unicode_of({t})", {t: text});
Num(x) = x;
Str(x) = x;
"""
