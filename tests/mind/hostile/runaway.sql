counts for ever: NUMBERS SELECT count(*) FROM t_0_N
grows a table: WITH RECURSIVE t_0_N(n, s) AS (SELECT 1, '' UNION SELECT n + 1, printf('%5000d', n) FROM t_0_N) SELECT count(*) FROM t_0_N
sorts for ever: NUMBERS SELECT n FROM (SELECT n, printf('%1000d', n) s FROM t_0_N) ORDER BY s
groups for ever: NUMBERS SELECT count(*) FROM t_0_N GROUP BY printf('%100d', n)
collects for ever: NUMBERS SELECT json_group_array(printf('%1000d', n)) FROM t_0_N
collects in Python: NUMBERS SELECT list_of_distinct(n) FROM t_0_N
collects pairs: NUMBERS SELECT array_by(n, printf('%1000d', n)) FROM t_0_N
concatenates for ever: NUMBERS SELECT group_concat(printf('%1000d', n)) FROM t_0_N
concatenates in a window: NUMBERS SELECT group_concat(n) OVER (ORDER BY n ROWS 100000 PRECEDING) FROM t_0_N LIMIT 1000000000
gives rows for ever: NUMBERS SELECT n FROM t_0_N
gives large rows: NUMBERS SELECT BIG FROM t_0_N
searches: NUMBERS SELECT sum(instr(BIG || 'a', BIG || n)) FROM t_0_N
replaces: NUMBERS SELECT sum(length(replace(BIG, ' ', n))) FROM t_0_N
trims: NUMBERS SELECT sum(length(trim(BIG, ' x' || n))) FROM t_0_N
likes: NUMBERS SELECT sum(BIG || n LIKE '%_ _ _ _ _%_ _ _x_%b') FROM t_0_N
likes a long pattern: SELECT 'a' LIKE BIG
joins: WITH t_1_N(v) AS (SELECT value FROM json_each(number_range(99999))) SELECT count(*) FROM t_1_N a, t_1_N b, t_1_N c WHERE a.v + b.v + c.v = -1
doubles a blob: WITH RECURSIVE t_0_N(s) AS (SELECT CAST('x' AS BLOB) UNION ALL SELECT s || s FROM t_0_N) SELECT max(length(s)) FROM t_0_N
nests JSON: WITH RECURSIVE t_0_N(s) AS (SELECT '[]' UNION ALL SELECT json_array(json(s)) FROM t_0_N LIMIT 1500) SELECT max(s) FROM t_0_N
makes half a character: SELECT char(55296) || char(0) || char(1114111)
makes bad UTF-8: SELECT CAST(char(255, 254) AS BLOB), CAST(CAST(char(255) AS BLOB) AS TEXT)
overflows: SELECT abs(-9223372036854775808)
divides by zero: SELECT 1 / 0, divide(1, 0), modulo(1, 0), 9e999, -9e999
