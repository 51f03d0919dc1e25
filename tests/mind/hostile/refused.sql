ATTACH DATABASE 'touched' AS other
ATTACH ':memory:' AS other
DETACH DATABASE main
CREATE TABLE x(y)
CREATE TEMP TABLE x(y)
CREATE VIEW x AS SELECT 1
CREATE TRIGGER t AFTER INSERT ON Memory BEGIN SELECT 1; END
CREATE VIRTUAL TABLE x USING fts5(y)
CREATE INDEX i ON Memory(robot_name)
DROP TABLE Sensor
ALTER TABLE Sensor RENAME TO other
INSERT INTO Memory VALUES ('Ada', 1)
INSERT INTO Memory SELECT * FROM Memory RETURNING 1
WITH x AS (SELECT 1) DELETE FROM Memory
DELETE FROM Memory
UPDATE Sensor SET sensor = 1
REPLACE INTO Memory VALUES ('Ada', 1)
PRAGMA writable_schema = 1
PRAGMA hard_heap_limit
PRAGMA temp_store_directory = '.'
PRAGMA database_list
VACUUM
VACUUM INTO 'touched'
REINDEX
ANALYZE
BEGIN
COMMIT
SAVEPOINT s
-- nothing
SELECT 1; SELECT 2
SELECT load_extension('touched')
SELECT readfile('/etc/passwd')
SELECT writefile('touched', 'x')
SELECT edit('x', 'touch touched')
SELECT fts3_tokenizer('simple')
SELECT randomblob(1000000000)
SELECT zeroblob(2000000000)
SELECT hex(zeroblob(1000000))
SELECT 'a' GLOB '*a*a*a*'
SELECT 'a' REGEXP '(a+)+$'
SELECT 'a' MATCH 'a'
SELECT random()
SELECT datetime('now')
SELECT strftime('%s')
SELECT sqlite_version()
SELECT sqlite_source_id()
SELECT sqlite_compileoption_get(1)
SELECT sqlite_log(1, 'x')
SELECT last_insert_rowid()
SELECT total_changes()
SELECT * FROM sqlite_master
SELECT * FROM sqlite_schema
SELECT * FROM sqlite_temp_master
SELECT * FROM sqlite_stmt
SELECT * FROM dbstat
SELECT * FROM pragma_database_list
SELECT * FROM pragma_function_list
SELECT * FROM pragma_hard_heap_limit(1)
SELECT count(*) FROM pragma_database_list
SELECT count(*) FROM sqlite_master
SELECT key FROM json_tree('[]')
SELECT * FROM fsdir('/')
SELECT * FROM other.Sensor
EXPLAIN ATTACH DATABASE 'touched' AS other
