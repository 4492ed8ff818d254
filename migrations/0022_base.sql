-- The schema as a whole: where the history of this program begins. A database of an earlier one is made anew from the raw
-- files, the words of people and what stands in the folder (`ieap rebuild`).
--
-- Every row that says something carries a hash of itself, and every list of such rows the sum of their hashes (see
-- store/rows.rs): what a damaged disk gives is told from what was stored. What is searched for stands in a column, the rest in
-- documents.

-- Raw bytes that were taken in, archived under their hash.
CREATE TABLE content (
    id           INTEGER NOT NULL PRIMARY KEY,
    hash         TEXT    NOT NULL UNIQUE,        -- BLAKE3 of the bytes, hexadecimal
    size_bytes   INTEGER NOT NULL,
    archive_path TEXT    NOT NULL,               -- relative to the campaign, with /
    ingested_at  TEXT    NOT NULL,
    row_hash     BLOB    NOT NULL DEFAULT x''
) STRICT;

-- One measurement. A path has one current revision (superseded_at IS NULL).
CREATE TABLE run (
    id            INTEGER NOT NULL PRIMARY KEY,
    path          TEXT    NOT NULL,              -- the run's name: path of its file, '#TABLE' where a file has several
    revision      INTEGER NOT NULL,
    superseded_at TEXT,
    kind          TEXT    NOT NULL CHECK (kind IN ('actuation', 'dma', 'impedance')),
    state         TEXT    NOT NULL CHECK (state IN ('ready', 'untagged', 'not_fitted', 'no_steps')),
    data_hash     TEXT    NOT NULL,              -- BLAKE3 of the readings
    measurement   TEXT    NOT NULL,              -- what it is known by: BLAKE3 of its raw bytes, whatever their name
    continues     TEXT    NOT NULL,              -- earlier bytes of it, with blanks between: what was said of them holds of it
    tag_digest    TEXT    NOT NULL,              -- BLAKE3 over everything the tags came from
    ingested_at   TEXT    NOT NULL,
    row_hash      BLOB    NOT NULL DEFAULT x'',
    reading       TEXT    NOT NULL,              -- JSON: what was read: format, files, channels, clocks, flags, issues
    tagging       TEXT    NOT NULL,              -- JSON: tags and what follows: chosen ones, drive, area, climate, issues
    climate_curves BLOB,                         -- zstd of JSON: climate around the run, to draw; its hash stands in tagging
    UNIQUE (path, revision)
) STRICT;
CREATE UNIQUE INDEX run_current ON run (path) WHERE superseded_at IS NULL;
CREATE INDEX run_measurement ON run (measurement);

-- The raw files of a run: one, or several joined.
CREATE TABLE run_file (
    id       INTEGER NOT NULL PRIMARY KEY,
    run_id   INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    ordinal  INTEGER NOT NULL,
    path     TEXT    NOT NULL,
    hash     TEXT    NOT NULL REFERENCES content (hash),
    row_hash BLOB    NOT NULL DEFAULT x'',
    UNIQUE (run_id, ordinal)
) STRICT;
CREATE INDEX run_file_hash ON run_file (hash);
CREATE INDEX run_file_path ON run_file (path);

-- Readings: one row a channel, numbers as compressed BLOBs (see store/blob.rs). Their hash stands in run.reading.
CREATE TABLE channel (
    run_id        INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    ordinal       INTEGER NOT NULL,
    time_of       INTEGER NOT NULL,              -- ordinal of the channel that holds the time BLOB (itself, or an earlier one)
    time_blob     BLOB,                          -- NULL: shared, see time_of
    value_blob    BLOB    NOT NULL,
    excluded_blob BLOB    NOT NULL,
    PRIMARY KEY (run_id, ordinal)
) STRICT;

-- Saved profiles as they were when a file was read with them.
CREATE TABLE profile (
    digest        TEXT    NOT NULL PRIMARY KEY,  -- BLAKE3 of the text, hexadecimal
    id            TEXT    NOT NULL,
    version       INTEGER NOT NULL,
    text          TEXT    NOT NULL,              -- TOML
    first_used_at TEXT    NOT NULL
) STRICT, WITHOUT ROWID;

-- Files under the runs folder as the last scan saw them.
CREATE TABLE source_file (
    id            INTEGER NOT NULL PRIMARY KEY,
    path          TEXT    NOT NULL UNIQUE,       -- relative, with /; bytes that are no UTF-8 escaped without loss
    size_bytes    INTEGER NOT NULL,
    modified_ns   INTEGER NOT NULL,              -- since 1970
    inode         INTEGER NOT NULL,
    changed_ns    INTEGER NOT NULL,
    hash          TEXT,                          -- NULL: never read whole; not in `content` when refused
    state         TEXT    NOT NULL CHECK (state IN ('run', 'alias', 'refused', 'pending', 'sidecar', 'log')),
    reader        TEXT    NOT NULL,              -- format id and version that decided, '' where none did
    issue         TEXT,                          -- JSON of an Issue: why refused or pending; NULL otherwise
    missing_since TEXT,                          -- NULL: the file is there
    row_hash      BLOB    NOT NULL DEFAULT x''
) STRICT;
CREATE INDEX source_file_hash ON source_file (hash);

-- What the system could not give is no verdict on a file: it is kept apart, for `status`, until a scan has read the file.
CREATE TABLE unread_file (
    path  TEXT NOT NULL PRIMARY KEY,             -- as in source_file
    issue TEXT NOT NULL                          -- JSON of an Issue: what the system said
) STRICT, WITHOUT ROWID;

-- One file of a logger. A path has one current revision (superseded_at IS NULL).
CREATE TABLE climate_log (
    id            INTEGER NOT NULL PRIMARY KEY,
    path          TEXT    NOT NULL,
    revision      INTEGER NOT NULL,
    superseded_at TEXT,
    hash          TEXT    NOT NULL REFERENCES content (hash),
    ingested_at   TEXT    NOT NULL,
    row_hash      BLOB    NOT NULL DEFAULT x'',
    reading       TEXT    NOT NULL,              -- JSON: what was read: format, clock, issues, series without their readings
    UNIQUE (path, revision)
) STRICT;
CREATE UNIQUE INDEX climate_log_current ON climate_log (path) WHERE superseded_at IS NULL;
CREATE INDEX climate_log_hash ON climate_log (hash);

-- Readings of a log: one row a sensor and quantity, numbers as compressed BLOBs. Their hash stands in climate_log.reading.
CREATE TABLE climate_series (
    log_id     INTEGER NOT NULL REFERENCES climate_log (id) ON DELETE CASCADE,
    ordinal    INTEGER NOT NULL,
    time_of    INTEGER NOT NULL,                 -- ordinal of the series that holds the time BLOB (itself, or an earlier one)
    time_blob  BLOB,                             -- NULL: shared, see time_of; s since the first row
    value_blob BLOB    NOT NULL,
    PRIMARY KEY (log_id, ordinal)
) STRICT;

-- What people said and what no file holds: the lines of archive/journal.jsonl (see store/journal/course.rs).
CREATE TABLE journal_line (
    n        INTEGER NOT NULL PRIMARY KEY,       -- its number
    line     TEXT    NOT NULL,                   -- as it stands in archive/journal.jsonl, with its checksum
    what     TEXT    NOT NULL,                   -- what it says: read, tag, word, asked, told, missed, ...
    name     TEXT,                               -- the measurement that it is about (run.measurement), or id of the alarm; NULL: of neither
    row_hash BLOB    NOT NULL DEFAULT x''
) STRICT;
CREATE INDEX journal_line_what ON journal_line (what, name);

-- What follows from readings: fits, analyses of modulus logs, diagnoses, comparisons of models. Earlier ones stay.
CREATE TABLE result (
    id            INTEGER NOT NULL PRIMARY KEY,
    kind          TEXT    NOT NULL,              -- fit, modulus, comparison, alarms, climate, marks, same, group (its diagnosis) or run (its diagnosis by itself)
    run_id        INTEGER REFERENCES run (id) ON DELETE CASCADE, -- the run or modulus log that it is of, whatever that is named; NULL: of none alone
    name          TEXT,                          -- of the group, or of what there is one of; NULL where it is of a run
    key           TEXT    NOT NULL,              -- BLAKE3 over everything that it depends on; empty: a fault stopped it
    version       TEXT    NOT NULL,              -- of the program that made it
    built_from    TEXT    NOT NULL,              -- commit that this program was built from, or unknown; empty: not told
    made_at       TEXT    NOT NULL,              -- when, RFC 3339 UTC
    superseded_at TEXT,                          -- when another took its place; NULL: it is current
    row_hash      BLOB    NOT NULL DEFAULT x'',
    document      TEXT    NOT NULL,              -- JSON: what was found, or the issue why nothing could be
    drawn         BLOB,                          -- zstd of JSON: what pages draw of it; its hash stands in the document
    CHECK ((run_id IS NULL) <> (name IS NULL))
) STRICT;
CREATE UNIQUE INDEX result_of_run ON result (kind, run_id) WHERE superseded_at IS NULL AND run_id IS NOT NULL;
CREATE UNIQUE INDEX result_named ON result (kind, name) WHERE superseded_at IS NULL AND name IS NOT NULL;
CREATE INDEX result_run ON result (run_id, kind);

-- Counts every committed change, so that a report knows whether it is out of date.
CREATE TABLE change_count (
    only_row   INTEGER NOT NULL PRIMARY KEY CHECK (only_row = 1),
    changes    INTEGER NOT NULL,
    changed_at TEXT    NOT NULL,
    row_hash   BLOB    NOT NULL DEFAULT x''
) STRICT;

-- What tells that a row of a list is gone.
CREATE TABLE list_sum (
    list TEXT NOT NULL PRIMARY KEY,              -- table, and what its rows have in common: 'run actuation', 'result fit'
    sum  BLOB NOT NULL                           -- hashes of all rows of the list, each bit added without carry
) STRICT, WITHOUT ROWID;

-- What tells this database from every other; the archive beside it holds the same (archive/database-id).
CREATE TABLE identity (
    only_row INTEGER NOT NULL PRIMARY KEY CHECK (only_row = 1),
    id       TEXT    NOT NULL
) STRICT;

-- What follows from everything and stands in no other table, as the last report shows it: standing and material of runs,
-- what was found, what holds across runs, what is watched. For whoever asks in SQL (the views read it); the program reads
-- none of it, and makes it anew with every report.
CREATE TABLE shown (
    kind     TEXT    NOT NULL,                   -- run, finding, law or monitoring
    ordinal  INTEGER NOT NULL,
    document TEXT    NOT NULL,                   -- JSON: a row of what `ieap export` writes
    PRIMARY KEY (kind, ordinal)
) STRICT, WITHOUT ROWID;

CREATE TABLE shown_of (
    only_row INTEGER NOT NULL PRIMARY KEY CHECK (only_row = 1),
    changes  INTEGER NOT NULL,                   -- change_count.changes that it was made from
    made_at  TEXT    NOT NULL                    -- RFC 3339 UTC
) STRICT;

INSERT INTO change_count VALUES (1, 0, '1970-01-01T00:00:00Z', x'');
INSERT INTO identity VALUES (1, lower(hex(randomblob(16))));
INSERT INTO shown_of VALUES (1, -1, '1970-01-01T00:00:00Z');
