-- A file of the second version, as it was written then. Never change it.
PRAGMA application_id = 1280462658;
PRAGMA user_version = 2;
BEGIN TRANSACTION;
CREATE TABLE fact (name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE level (
            name TEXT PRIMARY KEY,
            begun TEXT,
            won TEXT,
            hints INTEGER NOT NULL DEFAULT 0
        );
INSERT INTO "level" VALUES('match','2026-11-24T04:20:56.920484+00:00','2026-11-24T04:20:56.993223+00:00',0);
CREATE TABLE version (
            number INTEGER PRIMARY KEY,
            level TEXT NOT NULL,
            digest TEXT NOT NULL,
            text TEXT NOT NULL,
            turn INTEGER NOT NULL,
            kept TEXT NOT NULL,
            won TEXT,
            ticks INTEGER,
            rules INTEGER,
            distance REAL,
            wins INTEGER,
            starts INTEGER, goals TEXT NOT NULL DEFAULT '',
            UNIQUE (level, digest)
        );
INSERT INTO "version" VALUES(1,'match','5cb92a6a6725cd5afe09cdcfd8560cde672d75746a83d5f2590176b6b8a28d90','
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: n) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  n = (if memory == "" then 1 else memory + 1);
',3,'2026-11-24T04:20:56.975965+00:00',NULL,NULL,NULL,NULL,NULL,NULL,'');
INSERT INTO "version" VALUES(2,'match','b0bc62c27d84b66d8cdc756f07c8eada6970613c8d256e1bd919de4ee72181b8','# mine

Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: n) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  n = (if memory == "" then 1 else memory + 1);
',2,'2026-11-24T04:20:56.960030+00:00',NULL,NULL,NULL,NULL,NULL,NULL,'');
INSERT INTO "version" VALUES(3,'match','67c0728eabbed7521cf1681b35e5e41d65f0ad940e7de8405cb3c559acb6d966','# teams: {"red": 5, "blue": 5}

Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: n) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  n = (if memory == "" then 1 else memory + 1);


Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: n) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  n = (if memory == "" then 1 else memory + 1);
',4,'2026-11-24T04:20:56.993223+00:00','2026-11-24T04:20:56.993223+00:00',43,1,129.0,NULL,NULL,'');
CREATE INDEX version_by_turn ON version (level, turn);
CREATE INDEX version_by_digest ON version (digest);
COMMIT;
