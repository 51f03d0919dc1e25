-- A file of the first version, as it was written then. Never change it.
PRAGMA application_id = 1280462658;
PRAGMA user_version = 1;
BEGIN TRANSACTION;
CREATE TABLE fact (name TEXT PRIMARY KEY, value TEXT NOT NULL);
INSERT INTO "fact" VALUES('tour','seen');
CREATE TABLE level (
            name TEXT PRIMARY KEY,
            begun TEXT,
            won TEXT,
            hints INTEGER NOT NULL DEFAULT 0
        );
INSERT INTO "level" VALUES('01-first-steps','2026-11-21T04:27:51.743766+00:00','2026-11-21T04:27:51.743732+00:00',2);
INSERT INTO "level" VALUES('02-open-space','2026-11-21T04:27:51.746750+00:00',NULL,0);
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
            starts INTEGER,
            UNIQUE (level, digest)
        );
INSERT INTO "version" VALUES(1,'01-first-steps','7d4e2576b9825534e62eefe84546b6dd17196eb9d57df733ff7303faa41bdcf0','Robot(first);',1,'2026-11-21T04:27:51.743732+00:00','2026-11-21T04:27:51.743732+00:00',1255,1,2310.25,19,20);
INSERT INTO "version" VALUES(2,'01-first-steps','15a9ef598f0cc1599a9d9206bd26aca7be90c11357faaa9accb92b27d808dce7','Robot(later);',2,'2026-11-21T04:27:51.745473+00:00',NULL,NULL,NULL,NULL,NULL,NULL);
CREATE INDEX version_by_turn ON version (level, turn);
CREATE INDEX version_by_digest ON version (digest);
COMMIT;
