-- Which runs take part in results.

-- What people said of whole runs: that one is taken out of all results, or put back. Like a tag set by hand it goes by the
-- run's name and outlives revisions; the newest of a name holds.
CREATE TABLE run_word (
    id        INTEGER NOT NULL PRIMARY KEY,
    run_path  TEXT    NOT NULL,
    drops     INTEGER NOT NULL,      -- 1: out of all results; 0: back
    why       TEXT,                  -- NULL: an earlier word is taken back, nothing more
    said_by   TEXT    NOT NULL,
    said_at   TEXT    NOT NULL,
    data_hash TEXT    NOT NULL       -- of the readings that it was said of
) STRICT;
CREATE INDEX run_word_path ON run_word (run_path);

-- A few readings of each run as hashes, the smallest ones: runs that hold the same readings share some.
CREATE TABLE run_marks (
    run_id  INTEGER NOT NULL PRIMARY KEY REFERENCES run (id) ON DELETE CASCADE,
    version INTEGER NOT NULL,        -- of the rule that they are made by
    marks   BLOB    NOT NULL         -- 64-bit numbers, little-endian
) STRICT;

-- Runs whose readings stand in another run too.
CREATE TABLE same_readings (
    run_id    INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    in_run_id INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    whole     INTEGER NOT NULL,      -- 1: the other holds nothing more
    PRIMARY KEY (run_id, in_run_id)
) STRICT, WITHOUT ROWID;

-- Runs whose readings a diagnosis found to be wrong.
CREATE TABLE diagnosis_condemned (
    diagnosis_id INTEGER NOT NULL REFERENCES diagnosis (id) ON DELETE CASCADE,
    run_id       INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    reason       TEXT    NOT NULL,
    PRIMARY KEY (diagnosis_id, run_id)
) STRICT, WITHOUT ROWID;
