-- The database of poundd.  All of it is made in one transaction; a later version changes it step by step
-- (PRAGMA user_version counts the steps, server/database.c has them).  Times are milliseconds since 1970, UTC.

PRAGMA application_id = 0x706f756e; -- "poun"
PRAGMA user_version = 7;

CREATE TABLE study (
	id              INTEGER PRIMARY KEY, -- milliseconds << 20 | random bits: a newer study has a larger id
	status          TEXT    NOT NULL CHECK (status IN ('queued', 'running', 'succeeded', 'failed', 'cancelled')),
	kind            TEXT    NOT NULL,
	name            TEXT,
	hash            TEXT    NOT NULL,           -- of the study's meaning, hex
	runs            INTEGER NOT NULL,           -- pounding runs asked for
	created         INTEGER NOT NULL,
	started         INTEGER,                    -- when it was first taken up
	finished        INTEGER,
	attempt         INTEGER NOT NULL DEFAULT 0, -- times it was taken up
	error           TEXT,                       -- why it failed
	idempotency_key TEXT    UNIQUE,             -- after client and a space: a key is its client's own
	crashes         INTEGER NOT NULL DEFAULT 0, -- of the server by this study, since a block of it was kept
	client          TEXT,                       -- name of the token it was submitted with
	runs_done       INTEGER NOT NULL DEFAULT 0, -- pounding runs in its blocks
	cpu_s           REAL    NOT NULL DEFAULT 0, -- of its blocks, and of its reductions when they are known to be long or done
	attempt_kept    INTEGER NOT NULL DEFAULT 0, -- that kept a block last
	cpu_s_estimated REAL    NOT NULL DEFAULT 0, -- when it was submitted; 0: not known
	memory          INTEGER NOT NULL DEFAULT 0, -- [bytes] estimated then, while it runs
	CHECK ((finished IS NULL) = (status IN ('queued', 'running'))),
	CHECK ((error IS NULL) = (status <> 'failed'))
) STRICT;

CREATE INDEX study_status ON study (status, id, client);

-- what the client sent, and what the client gets
CREATE TABLE document (
	study   INTEGER NOT NULL REFERENCES study ON DELETE CASCADE,
	name    TEXT    NOT NULL CHECK (name IN ('request', 'result')),
	sha256  BLOB    NOT NULL, -- over name, study and content
	content BLOB    NOT NULL,
	PRIMARY KEY (study, name)
) STRICT;

-- finished blocks of a study: what a restart need not run again, and what its samples are made of
CREATE TABLE block (
	study   INTEGER NOT NULL REFERENCES study ON DELETE CASCADE,
	number  INTEGER NOT NULL,
	attempt INTEGER NOT NULL, -- that ran it
	runs    INTEGER NOT NULL, -- pounding runs in it
	cpu_s   REAL    NOT NULL,
	sha256  BLOB    NOT NULL, -- over engine version, study, number and content
	content BLOB    NOT NULL, -- doubles of this machine's byte order
	wall_s  REAL    NOT NULL DEFAULT 0, -- since the study started, without the time between sessions
	PRIMARY KEY (study, number)
) STRICT;

-- sums over them, without a look at their contents
CREATE INDEX block_progress ON block (study, attempt, runs, cpu_s);

-- files of recorded ground motions, as they came
CREATE TABLE record (
	sha256  TEXT    PRIMARY KEY, -- of the content, hex
	created INTEGER NOT NULL,    -- when it was sent last
	content BLOB    NOT NULL
) STRICT;

-- which of them a study names
CREATE TABLE study_record (
	study  INTEGER NOT NULL REFERENCES study ON DELETE CASCADE,
	record TEXT    NOT NULL REFERENCES record,
	PRIMARY KEY (study, record)
) STRICT, WITHOUT ROWID;

CREATE INDEX study_record_names ON study_record (record);

-- a record lives while a study names it
CREATE TRIGGER record_unnamed AFTER DELETE ON study_record
WHEN NOT EXISTS (SELECT 1 FROM study_record WHERE record = OLD.record)
BEGIN
	DELETE FROM record WHERE sha256 = OLD.record;
END;
