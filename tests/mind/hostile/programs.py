"""Programs that want more than to think.

Each has a name, what must become of it, and a text, in which `ROBOT` stands for a rule that
remembers `m`. A text that begins with `=` is the expression that is remembered.

| outcome | what must happen |
|---|---|
| refused | it is not compiled, and a diagnostic says why |
| failed | it is compiled, the thought fails with a notice and the memory stays |
| bounded | either of these, or it ends in time by itself |
| slow | as bounded, but compiling it may be cut short, because it takes long |
| harmless | it thinks, and what it names stays mere data |
"""

import re

from tests.mind.rows import ROBOT

__all__ = ["PROGRAMS"]

_LONG_NAME = "A" + "a" * 60_000

_HARMLESS = {
    # digits
    "rounds to all digits": '= Round(2.5, ToInt64("9223372036854775807")) + Round(2.5, -400)',
    # other programs and machines
    "chooses DuckDB": '@Engine("duckdb"); ROBOT m = 1;',
    "chooses BigQuery": '@Engine("bigquery"); ROBOT m = 1;',
    "chooses an engine that is SQL": "@Engine(\"x'; ATTACH 'y' AS z\"); ROBOT m = 1;",
    "defines a flag": '@DefineFlag("f", "touched"); ROBOT m = FlagValue("f");',
    "compiles as a table function": "@CompileAsTvf(F); F(x) :- x in [1]; ROBOT m = 1;",
    # SQL
    "closes a string": '= "\'; DROP TABLE Sensor; --"',
    "comments in SQL": '= "-- /* */ --"',
    "casts to a number": '= Cast("12", "INTEGER")',
    "orders by a column": '@OrderBy(P, "col0 desc"); P(1); ROBOT P(m);',
    # growing in a single step, and by names that are not ours
    "replaces nothing": '= Replace("abc", "", "x")',
    "counts to what is no number": "= Size(Range(Log(0 - 1)))",
    "builds a tower of powers": "= 10 ^ (10 ^ (10 ^ 10))",
    "cuts beyond all ends": '= Substr("abc", -9223372036854775808, 9223372036854775807)',
    "picks beyond the end": "= Element(Range(10), 9223372036854775807)",
    "writes what is no character": "= [Chr(1114112), Chr(-1), Chr(55296)]",
    "nests its memory ever deeper": (
        "ROBOT Memory(robot_name:, memory:), m = [[[[[[[[[[memory]]]]]]]]]];"
    ),
    "casts to a list": '= Cast(Range(10), "INTEGER[]")',
    # not text
    "turns direction": '= "\u202e;1 = m"',
    "controls the terminal": '= "\x1b]0;owned\x07\x1b[2J\x9b31m[red]"',
    "marks up": '= "[bold][link=file:///etc/passwd]x[/link]"',
    "names a prototype": "= {__proto__: {constructor: 1}, __class__: 2}",
}

_REFUSED = {
    # files
    "reads a file": '= ReadFile("/etc/passwd")',
    "reads a file as JSON": '= ReadJson("/etc/passwd")',
    "writes a file": '= WriteFile("touched", content: "x")',
    "reads a file in a helper": 'F(x) = ReadFile(x); ROBOT m = F("/etc/passwd");',
    "reads a file by a functor": "G := F(H: ReadFile); F(x) = H(x); ROBOT m = G(1);",
    "prints to the console": 'ROBOT PrintToConsole("x"), m = 1;',
    "imports a module": "import os.path.Join; ROBOT m = 1;",
    "imports at the end": "ROBOT m = 1;\nimport a.b.C;",
    "imports upwards": "import ..secret.P as Q; ROBOT m = Q();",
    # other programs and machines
    "asks a language model": '= Intelligence("hello")',
    "runs clingo": '= RunClingo("a.")',
    "runs a clingo file": '= RunClingoFile("/etc/passwd")',
    "attaches a database": '@AttachDatabase("a", "touched.db"); ROBOT m = 1;',
    "attaches itself": '@AttachDatabase("logica_test", ":memory:"); ROBOT m = 1;',
    "chooses a data set": '@Dataset("touched"); ROBOT m = 1;',
    "writes SQL by a flag": """@DefineFlag("f", "' || upper('abc') || '"); ROBOT m = "${f}";""",
    "writes SQL by a flag in a flag": (
        """@DefineFlag("f", "${g}"); @DefineFlag("g", "' || 1 || '"); ROBOT m = FlagValue("f");"""
    ),
    "compiles as a function": "@CompileAsUdf(F); F(x) = x; ROBOT m = F(1);",
    "resets the flags": '@ResetFlagValue("logica_default_engine", "x"); ROBOT m = 1;',
    "invents an annotation": '@Shell("touch touched"); ROBOT m = 1;',
    # SQL
    "writes SQL": '= SqlExpr("1", {})',
    "writes SQL by a functor": 'F(x) = H("1", {}); G := F(H: SqlExpr); ROBOT m = G(1);',
    "quotes SQL": "= `(select sqlite_version())`",
    "quotes a table": "ROBOT `(sqlite_master)`(name:), m = name;",
    "orders by SQL": '@OrderBy(P, "(select 1 from sqlite_master)"); P(1); ROBOT P(m);',
    "orders by a write": '@OrderBy(P, "1; DROP TABLE Sensor"); P(1); ROBOT P(m);',
    "casts to SQL": '= Cast("1", "INT); DROP TABLE Sensor; --")',
    "casts to SQL by a rule": 'C(x) = Cast("1", x); ROBOT m = C("INT) || (SELECT 7");',
    "casts to SQL by a name": 'ROBOT t == "INT) || (SELECT 7", m = Cast("1", t);',
    "casts to SQL by a functor": (
        'F(x, t) = H(x, t); G := F(H: Cast); ROBOT m = G(1, "INT) || (SELECT 7");'
    ),
    "orders by two columns and SQL": '@OrderBy(P, "col0, (SELECT 1)"); P(1); ROBOT P(m);',
    "orders by a function": '@OrderBy(P, "random()"); P(1); ROBOT P(m);',
    "orders by a column that is not there": '@OrderBy(P, "rowid"); P(1); ROBOT P(m);',
    "redefines its sensors": "Sensor(robot_name: 1, sensor: 2); ROBOT m = 1;",
    "redefines its memory": "Memory(robot_name: 1, memory: 2); ROBOT m = 1;",
    # functions that are not there
    "loads an extension": '= Load_extension("x")',
    "makes a blob": "= Zeroblob(2000000000)",
    "makes a random blob": "= Randomblob(2000000000)",
    "asks the version": "= Sqlite_version()",
    # growing in a single step, and by names that are not ours
    "casts to bytes": '= Cast(1, "BLOB")',
    "casts to a length and SQL": '= Cast(1, "VARCHAR(1)) || (SELECT 1")',
    "orders by more columns and SQL": (
        '@OrderBy(P, "col0", "col0 desc", "(select 1)"); P(1); ROBOT P(m);'
    ),
    "orders by a record": '@OrderBy(P, {x: "col0"}); P(1); ROBOT P(m);',
    "limits by a query": '@Limit(P, "1 union select 2"); P(1); ROBOT P(m);',
    "reads a text": '= ReadText("/etc/passwd")',
    "reads a blob": '= Read_blob("/etc/passwd")',
    "lists files": '= Glob("/etc/*")',
    "lists a folder": "ROBOT Fsdir(name:), m = name;",
    "asks the environment": '= Getenv("HOME")',
    "asks a pragma": "ROBOT Pragma_database_list(file:), m = file;",
    "asks for series": "ROBOT Generate_series(value:), m = value;",
    "evaluates": '= Eval("1")',
    # the parser
    "opens brackets": "ROBOT m = " + "(" * 20_000 + "1" + ")" * 20_000 + ";",
    "opens lists": "ROBOT m = " + "[" * 20_000 + "]" * 20_000 + ";",
    "opens and never closes": "ROBOT m = " + "{" * 50_000,
    "separates nothing": ";" * 100_000,
    "never ends its comments": "/* " * 50_000,
    "is too long": " " * 200_001,
    # not text
    "has a zero byte": '= "\x00"',
    "has half a character": '= "\ud800"',
    "controls it in a mistake": "= \x1b[2J\x1b]0;owned\x07",
    "controls it in a name": "= `\x1b[2J`",
    "names Python": "= __import__(1)",
    "is Python": "import os\nos.system('touch touched')\n",
    "is empty": "",
}

_BOUNDED = {
    # SQL
    "reads the schema": "ROBOT sqlite_master(name:), m = name;",
    "reads the statements": "= 1, Sqlite_stmt(sql:)",
    "is named like a table": "Sqlite_master(name: 1); ROBOT Sqlite_master(name:), m = 1;",
    "closes a field": "= {`a' || (select 1) || '`: 1}",
    "formats into SQL": '= "%s {m} ${m} %%"',
    "grounds outside": '@Ground(P, "other.table"); P(x) :- x in [1]; ROBOT P(m);',
    "grounds a file": '@Ground(P, "touched.csv"); P(x) :- x in [1]; ROBOT P(m);',
    "limits by SQL": '@Limit(P, "1; DROP TABLE Sensor"); P(1); ROBOT P(m);',
    # bombs of time
    "recurses in itself": "F(x) = F(F(F(x))); ROBOT m = F(1);",
    "depends on itself": "P(x) :- Q(x); Q(x) :- P(x); ROBOT P(m);",
    "negates itself": "P(x) :- x in [1], ~P(x); ROBOT P(m);",
    "has a hard pattern": '= Like(Join(List{"a" :- a in Range(9000)}, ""), "%a%a%a%a%a%a%a%a%a%b")',
    "has a hard expression": '= RegexpExtract(Join(List{"a" :- a in Range(9000)}, ""), "(a+)+$")',
    "has a pattern of many states": (
        '= RegexpExtract(Repeat("a", 1900000), Repeat("(a?){1000}", 20) ++ "b")'
    ),
    "has a pattern of some states": '= RegexpExtract(Repeat("a", 1900000), "(a?){900}b")',
    # bombs of memory
    "counts below zero": "= Range(-1000000000000)",
    "fills with zeros": '= Format("%2000000000d", 1)',
    "fills with digits": '= Format("%.2000000000f", 1.5)',
    "counts past 64 bits": "= 9223372036854775807 + 9223372036854775807",
    "writes a long number": f"ROBOT m = {'9' * 5000};",
    # objects that take far more than their text
    "remembers empty records": "= List{{} :- i in Range(20000), j in [1, 2]}",
    "remembers many empty records": "= List{{} :- i in Range(20000)}",
    "remembers empty lists": "= List{[] :- i in Range(20000)}",
    "remembers records of one field": "= List{{a: 1} :- i in Range(20000)}",
    "remembers lists of lists": "= List{[[[1]]] :- i in Range(10000)}",
    "remembers empty texts": '= List{"" :- i in Range(20000)}',
    "remembers letters": '= Split(Format("%019999d", 1), "")',
    "remembers wide letters": '= Join(List{"\U0001f916" :- i in Range(9999)}, "")',
    "remembers fractions": "= List{i / 7 :- i in Range(19999)}",
    "remembers a long text": '= Format("%0900000d", sensor.clock)',
    "has many names": "= AssembleRecord(List{{arg: ToString(i), value: {}} :- i in Range(4000)})",
    "remembers what it remembered": (
        "ROBOT Memory(robot_name:, memory:), m = [memory, memory, memory, memory];"
    ),
    # steps
    "writes large letters": '= Sum{Length(Upper(Format("%0900000d", i))) :- i in Range(9000)}',
    "cuts texts": '= Sum{Length(Substr(Format("%01900000d", i), 1, 1000000)) :- i in Range(9000)}',
    "ranks pairs": "= ArgMaxK({i -> j :- i in Range(9000), j in Range(9)}, 3)",
    "makes all texts different": '= Size(Set{Format("%0100d", i) :- i in Range(90000)})',
    "goes round in circles": (
        "@Recursive(N, 30); E(a, b) :- a in Range(40), b in Range(40); N(0); "
        "N(b) :- N(a), E(a, b); ROBOT m = Sum{x :- N(x)};"
    ),
    "grows in circles": (
        '@Recursive(N, 20); N("a"); N(a ++ b) :- N(a), N(b); ROBOT m = Sum{Length(x) :- N(x)};'
    ),
    "counts down in text": (
        '@Recursive(N, 25); N(Format("%01000d", 1)); N(a ++ a) :- N(a); ROBOT m = Max{x :- N(x)};'
    ),
    "remembers a growing list": (
        "ROBOT Memory(robot_name:, memory:), m = Concat(memory.l, memory.l);"
    ),
    "counts all robots": "= Sum{1 :- Sensor(a), Sensor(b), Sensor(c)}",
    "divides by nothing": "= List{i / 0 :- i in Range(1000)}",
    "wants a root of less than nothing": "= Sqrt(0 - 1)",
    "raises high": "= 10 ^ 400",
    # growing in a single step, and by names that are not ours
    "remembers long names of fields": (
        '= AssembleRecord(List{{arg: Format("%0500d", i), value: i} :- i in Range(1500)})'
    ),
    "has engines without bounds": (
        "Robot(robot_name:, desire: {left_engine: 1e308 * 10, right_engine: -1e300}, "
        "memory: 1) :- Sensor(robot_name:);"
    ),
    "wants a list of engines": (
        "Robot(robot_name:, desire: Range(90000), memory: 1) :- Sensor(robot_name:);"
    ),
    "has a name without end": (
        'Robot(robot_name: Format("%01900000d", 1), desire: {left_engine: 1, right_engine: 1}, '
        "memory: 1);"
    ),
    # the parser
    "has a long comment": "# " + "x" * 190_000 + "\nROBOT m = 1;",
    # not text
    "has a byte order mark": "\ufeffROBOT m = 1;",
    "has wide spaces": "ROBOT\u3000m\u2003=\u00a01;",
    "looks like another": "R\u043ebot(x: 1); ROBOT m = 1;",
    "says the incantation": "Signa inter verba conjugo, symbolum infixus evoco!\nROBOT m = 1;",
}

_FAILED = {
    # bombs of time
    "joins and joins": (
        "= Sum{a * b * c * d :- a in Range(9000), b in Range(9000), c in Range(9000), d in "
        "Range(9000)}"
    ),
    "joins robots": "S(x) :- x in Range(5000); C() += 1 :- S(a), S(b), S(c), S(d); ROBOT m = C();",
    # bombs of memory
    "counts to a million millions": "= Size(Range(1000000000000))",
    "joins a huge text": '= Join(List{"xxxxxxxxxx" :- a in Range(99999), b in Range(999)}, "")',
    "joins with a huge separator": (
        'T() = Join(List{"0123456789" :- a in Range(9999)}, "");'
        ' ROBOT m = Join(List{"" :- a in Range(9999)}, T());'
    ),
    "doubles a text": (
        "".join(
            ['T0() = "0123456789"; ']
            + [f"T{i}() = T{i - 1}() ++ T{i - 1}(); " for i in range(1, 4)]
        )
        + 'S(x) = Join(List{x :- a in Range(1000)}, ""); ROBOT m = S(S(S(T3())));'
    ),
    "collects huge lists": "= List{Range(99999) :- a in Range(99999)}",
    "keeps all lists": "= Set{[a, b] :- a in Range(9999), b in Range(9999)}",
    "has a huge memory": '= List{"0123456789" :- a in Range(99999), b in [1, 2]}',
    "makes too many rows": "ROBOT m in Range(99999);",
    # objects that take far more than their text
    "remembers a text too long": '= Format("%01900000d", 1)',
    "gives heavy rows": "ROBOT i in Range(400), m = List{[[], [], []] :- j in Range(6000)};",
    "gives many long rows": 'ROBOT i in Range(400), m = Format("%0100000d", i);',
    # steps
    "counts slowly": "= Sum{1 :- i in Range(90000), j in Range(90000)}",
    "counts rays slowly": (
        "= Sum{1 :- a in sensor.radar, b in sensor.radar, c in sensor.radar, d in sensor.radar, "
        "e in sensor.radar, f in sensor.radar}"
    ),
    "sorts again and again": "= Sum{Size(Sort(Range(15000 + i))) :- i in Range(4000)}",
    "splits again and again": '= Sum{Size(Split(Format("%09999d", i), "")) :- i in Range(90000)}',
    "joins again and again": '= Sum{Length(Join(Range(15000 + i), "-")) :- i in Range(4000)}',
    "hashes again and again": '= Sum{Fingerprint(Format("%0900000d", i)) :- i in Range(9000)}',
    "replaces": '= Sum{Length(Replace(Format("%0900000d", i), "0", "11")) :- i in Range(9000)}',
    "looks like it": '= Sum{1 :- i in Range(9000), Like(Format("%0900000d", i), "%0_0%1%")}',
    "takes the least of pairs": "= ArgMin{[i, j] -> i * j :- i in Range(9000), j in Range(9000)}",
    "compares everything with everything": (
        "P(x) :- x in Range(9000); ROBOT m = Sum{1 :- P(a), P(b), ~P(a + b)};"
    ),
    # growing in a single step, and by names that are not ours
    "doubles a text by recursion": (
        '@Recursive(T, 60); T("ab", 0); T(x ++ x, n + 1) :- T(x, n), n < 50; '
        "ROBOT m = Max{Length(x) :- T(x, n)};"
    ),
    "doubles rows by recursion": (
        "@Recursive(N, 40); N(x: 0); N(x: y * 2) :- N(x: y); N(x: y * 2 + 1) :- N(x: y); "
        "ROBOT m = Sum{1 :- N(x:)};"
    ),
    "lists triples": "= List{[a, b, c] :- a in sensor.radar, b in sensor.radar, c in sensor.radar}",
    "joins triples of rays": (
        "= Join(List{ToString(a) ++ ToString(b) :- a in sensor.radar, b in sensor.radar, c in "
        'sensor.radar}, "")'
    ),
    "collects its sensor": "= List{sensor :- i in Range(20000)}",
    "replaces by more": (
        'R(x) = Replace(x, "a", "aaaaaaaaaa"); ROBOT m = Length(R(R(R(R(R(R(R(R("a")))))))));'
    ),
    "takes a width from a number": '= Format("%*d", 2000000000, 1)',
    "fills with blanks": '= Format("%1999999999s", "x")',
    "fills with hex digits": '= Format("%.1000000x", 1)',
    "fills a hundred times": 'ROBOT m = Format("' + "%1000000d" * 100 + '"' + ", 1" * 100 + ");",
    "writes through a format": '= Format("%n%p%a%q%Q%w", 1, 2, 3, 4, 5, 6)',
    "counts to a fraction": "= Size(Range(1e18))",
    "counts to a text": '= Size(Range("99999999999"))',
    "sorts what is nested": "= Sort(List{[[i, j], {a: i}] :- i in Range(140), j in Range(140)})",
}

_SLOW = {
    # bombs of time
    "recurses in width": (
        "@Recursive(N, 200); N(0); N(x) :- N(y), N(z), x = y + z + 1; ROBOT m = Sum{x :- N(x)};"
    ),
    "recurses for ever": (
        "@Recursive(N, 1000000000); N(0); N(x + 1) :- N(x); ROBOT m = Sum{x :- N(x)};"
    ),
    "recurses without end": "@Recursive(N, -1); N(0); N(x + 1) :- N(x); ROBOT m = 1;",
    "doubles by calls": (
        "F0(x) = x + x; "
        + "".join(f"F{i}(x) = F{i - 1}(x) + F{i - 1}(x); " for i in range(1, 40))
        + "ROBOT m = F39(1);"
    ),
    "doubles by names": (
        "".join(
            ["P0(x) :- x in [1]; "]
            + [f"@With(P{i}); P{i}(x) :- P{i - 1}(x), P{i - 1}(x); " for i in range(1, 30)]
        )
        + "ROBOT P29(m);"
    ),
    "doubles by functors": (
        "F(x) :- G(x); G(x) :- x in [1]; "
        + "".join(f"F{i + 1} := F{i or ''}(G: F{i or ''}); " for i in range(20))
        + "ROBOT F20(m);"
    ),
    "alternates": (
        "A0(x) :- x in [1];"
        + "".join(
            f"A{i}(x) :- (A{i - 1}(x) | A{i - 1}(x)), (A{i - 1}(x) | A{i - 1}(x));"
            for i in range(1, 12)
        )
        + "ROBOT A11(m);"
    ),
    # bombs of memory
    "nests values": (
        "".join(["T0() = [1]; "] + [f"T{i}() = [[[[[[[T{i - 1}()]]]]]]]; " for i in range(1, 30)])
        + "ROBOT m = T29();"
    ),
    # the parser
    "adds and adds": "ROBOT m = " + "+".join(["1"] * 20_000) + ";",
    "negates and negates": "ROBOT m = 1, " + "~" * 20_000 + "(1 == 2);",
    "says minus": "ROBOT m = " + "-" * 20_000 + "1;",
    "chooses and chooses": "ROBOT m = " + "if true then 1 else " * 5_000 + "2;",
    "lists commas": "ROBOT " + "," * 100_000,
    "has many rules": "".join(f"P{i}(x) :- x in [{i}];" for i in range(4_000)) + "ROBOT P0(m);",
    "has many conditions": "ROBOT m = 1" + ", 1 == 1" * 5_000 + ";",
    "has many columns": "P(" + ", ".join(f"c{i}: 1" for i in range(3_000)) + "); ROBOT P(c0: m);",
    "has long names": f"{_LONG_NAME}(1); ROBOT {_LONG_NAME}(m);",
    "has a long text": 'ROBOT m = "' + "x" * 190_000 + '";',
    "never ends its texts": '"\n' * 50_000,
}

_BY_OUTCOME = {
    "refused": _REFUSED,
    "failed": _FAILED,
    "bounded": _BOUNDED,
    "slow": _SLOW,
    "harmless": _HARMLESS,
}
PROGRAMS = {
    name: (outcome, re.sub("^= (.*)", r"ROBOT m = \1;", text).replace("ROBOT", ROBOT.rstrip()))
    for outcome, texts in _BY_OUTCOME.items()
    for name, text in texts.items()
}
assert len(PROGRAMS) == sum(map(len, _BY_OUTCOME.values()))
