-- What tells this database from every other; the archive beside it holds the same (archive/database-id).
CREATE TABLE identity (
    only_row INTEGER NOT NULL PRIMARY KEY CHECK (only_row = 1),
    id       TEXT    NOT NULL
) STRICT;
INSERT INTO identity VALUES (1, lower(hex(randomblob(16))));

-- Runs that share a name by accident are read again, so that each is in the list.

-- Two tables of one name in one file: the later was stored as a revision of the earlier, in the same moment.
UPDATE run SET reader_version = 0 WHERE superseded_at IS NULL AND path IN (
    SELECT run.path FROM run JOIN run_file ON run_file.run_id = run.id
    GROUP BY run.path, run.ingested_at, run_file.path, run_file.hash HAVING count(DISTINCT run.id) > 1);
UPDATE source_file SET reader = '' WHERE path IN (
    SELECT run_file.path FROM run_file JOIN run ON run.id = run_file.run_id
    WHERE run.reader_version = 0 AND run.superseded_at IS NULL);
-- A file whose run was superseded by the run of another file.
UPDATE source_file SET reader = '' WHERE state = 'run' AND missing_since IS NULL AND path NOT IN (
    SELECT run_file.path FROM run_file JOIN run ON run.id = run_file.run_id WHERE run.superseded_at IS NULL);

-- Checksums of rows that are read together (see store/seal/mod.rs).
CREATE TABLE seal (
    subject TEXT NOT NULL,                       -- what the rows are of: 'run', 'fit', ...
    id      ANY  NOT NULL,                       -- which one: row id, path, or 0 where there is one only
    sum     BLOB NOT NULL,                       -- first 16 bytes of BLAKE3
    PRIMARY KEY (subject, id)
) STRICT, WITHOUT ROWID;
