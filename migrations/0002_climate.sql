-- Climate logs: files under ambient/, their series, what runs had of them, and what they come to together.

-- A file may hold a climate log: the list of states grows, and SQLite changes a CHECK only with the table.
CREATE TABLE source_file_2 (
    path          TEXT    NOT NULL PRIMARY KEY,  -- relative, with /; bytes that are no UTF-8 escaped without loss
    size_bytes    INTEGER NOT NULL,
    modified_ns   INTEGER NOT NULL,              -- since 1970
    inode         INTEGER NOT NULL,
    hash          TEXT,                          -- NULL: never read whole; not in `content` when refused
    state         TEXT    NOT NULL CHECK (state IN ('run', 'alias', 'refused', 'pending', 'sidecar', 'log')),
    reader        TEXT    NOT NULL,              -- format id and version that decided, '' where none did
    issue         TEXT,                          -- JSON of an Issue: why refused or pending; NULL otherwise
    missing_since TEXT                           -- NULL: the file is there
) STRICT, WITHOUT ROWID;
INSERT INTO source_file_2 SELECT * FROM source_file;
DROP TABLE source_file;
ALTER TABLE source_file_2 RENAME TO source_file;
CREATE INDEX source_file_hash ON source_file (hash);

-- One file of a logger. A path has one current revision (superseded_at IS NULL).
CREATE TABLE climate_log (
    id                INTEGER NOT NULL PRIMARY KEY,
    path              TEXT    NOT NULL,
    revision          INTEGER NOT NULL,
    superseded_at     TEXT,
    hash              TEXT    NOT NULL REFERENCES content (hash),
    format            TEXT    NOT NULL,
    reader_version    INTEGER NOT NULL,
    encoding          TEXT,
    status            TEXT    NOT NULL,
    status_evidence   TEXT    NOT NULL,
    started_raw       TEXT    NOT NULL,          -- date of the first row as the file has it
    clock_start_s     REAL    NOT NULL,          -- the same, s since 1970-01-01T00:00 on the file's own clock
    clock_offset      TEXT,                      -- of that clock from UTC, '+02:00'; NULL: the file does not say
    clock_set_back    TEXT    NOT NULL,          -- JSON array of [time since the first row, by how much], s
    original_metadata TEXT    NOT NULL,          -- JSON array of [name, value], as the file has them
    issues            TEXT    NOT NULL,          -- JSON array of Issue
    data_hash         TEXT    NOT NULL,          -- BLAKE3 of readings and clock
    ingested_at       TEXT    NOT NULL,
    UNIQUE (path, revision)
) STRICT;
CREATE UNIQUE INDEX climate_log_current ON climate_log (path) WHERE superseded_at IS NULL;
CREATE INDEX climate_log_hash ON climate_log (hash);

-- One row a sensor and quantity of a log; numbers as compressed BLOBs (see store/blob.rs).
CREATE TABLE climate_series (
    log_id     INTEGER NOT NULL REFERENCES climate_log (id) ON DELETE CASCADE,
    ordinal    INTEGER NOT NULL,
    sensor     TEXT    NOT NULL,                 -- as the file names it
    quantity   TEXT    NOT NULL,                 -- with the unit, 'temperature_c'
    raw_name   TEXT    NOT NULL,
    raw_unit   TEXT    NOT NULL,
    not_used   TEXT,                             -- why its readings are not used; NULL: they are
    readings   INTEGER NOT NULL,
    interval_s REAL    NOT NULL,                 -- time between most readings
    first_s    REAL    NOT NULL,                 -- of the first reading, since the first row of the log
    length_s   REAL    NOT NULL,                 -- from there to the last reading
    time_of    INTEGER NOT NULL,                 -- ordinal of the series that holds the time BLOB (itself, or an earlier one)
    time_blob  BLOB,                             -- NULL: shared, see time_of; s since the first row
    value_blob BLOB    NOT NULL,
    PRIMARY KEY (log_id, ordinal)
) STRICT;

-- What a run had of each sensor that covers it.
CREATE TABLE run_climate (
    run_id             INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    ordinal            INTEGER NOT NULL,
    sensor             TEXT    NOT NULL,
    quantity           TEXT    NOT NULL,
    chosen             INTEGER NOT NULL,         -- 1: this sensor speaks for the run
    readings           INTEGER NOT NULL,         -- within the run; 0: interpolated
    mean               REAL    NOT NULL,
    standard_deviation REAL,                     -- NULL: fewer than two readings
    drift_per_h        REAL,                     -- NULL: fewer than three readings
    largest_deviation  REAL    NOT NULL,
    largest_gap_s      REAL    NOT NULL,
    accuracy           REAL,                     -- NULL: not stated
    PRIMARY KEY (run_id, ordinal)
) STRICT, WITHOUT ROWID;

-- Climate around a run, thinned for drawing.
CREATE TABLE run_climate_curve (
    run_id     INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    ordinal    INTEGER NOT NULL,
    sensor     TEXT    NOT NULL,
    quantity   TEXT    NOT NULL,
    time_blob  BLOB    NOT NULL,                 -- s since the run's start
    value_blob BLOB    NOT NULL,
    PRIMARY KEY (run_id, ordinal)
) STRICT;

-- Sensors, comparisons and exposure as last computed: derived from the rows above and made again when they change.
CREATE TABLE climate_assessment (
    only_row INTEGER NOT NULL PRIMARY KEY CHECK (only_row = 1),
    inputs   TEXT    NOT NULL,                   -- BLAKE3 of everything that it was computed from
    document TEXT    NOT NULL                    -- JSON of a ClimateAssessment
) STRICT;
