-- The first schema. Words are those of GLOSSARY.md. Migrations are append-only: this file never changes
-- once released; a test holds its hash. Parameters and tags are rows, so that a new effect or tag needs
-- no migration. Times are RFC 3339 in UTC.

-- Raw bytes that were taken in, archived under their hash.
CREATE TABLE content (
    hash         TEXT    NOT NULL PRIMARY KEY,   -- BLAKE3 of the bytes, hexadecimal
    size_bytes   INTEGER NOT NULL,
    archive_path TEXT    NOT NULL,               -- relative to the campaign, with /
    ingested_at  TEXT    NOT NULL
) STRICT, WITHOUT ROWID;

-- Files under the runs folder as the last scan saw them.
CREATE TABLE source_file (
    path          TEXT    NOT NULL PRIMARY KEY,  -- relative, with /; bytes that are no UTF-8 escaped without loss
    size_bytes    INTEGER NOT NULL,
    modified_ns   INTEGER NOT NULL,              -- since 1970
    inode         INTEGER NOT NULL,
    hash          TEXT,                          -- NULL: never read whole; not in `content` when refused
    state         TEXT    NOT NULL CHECK (state IN ('run', 'alias', 'refused', 'pending', 'sidecar')),
    reader        TEXT    NOT NULL,              -- format id and version that decided, '' where none did
    issue         TEXT,                          -- JSON of an Issue: why refused or pending; NULL otherwise
    missing_since TEXT                           -- NULL: the file is there
) STRICT, WITHOUT ROWID;
CREATE INDEX source_file_hash ON source_file (hash);

-- One measurement. A path has one current revision (superseded_at IS NULL).
CREATE TABLE run (
    id                INTEGER NOT NULL PRIMARY KEY,
    path              TEXT    NOT NULL,          -- the run's name: path of its file, '#TABLE' where a file has several
    revision          INTEGER NOT NULL,
    superseded_at     TEXT,
    state             TEXT    NOT NULL CHECK (state IN ('ready', 'untagged', 'not_fitted')),
    status            TEXT    NOT NULL,          -- how the measurement ended
    status_evidence   TEXT    NOT NULL,
    format            TEXT    NOT NULL,
    reader_version    INTEGER NOT NULL,
    technique         TEXT,
    is_step_response  INTEGER NOT NULL,
    encoding          TEXT,
    time_zero_is_step INTEGER NOT NULL,
    original_metadata TEXT    NOT NULL,          -- JSON array of [name, value], as the file has them
    drive             TEXT,                      -- JSON of a Drive; NULL: unknown
    area_cm2          REAL,                      -- NULL: the sample is not known or has no dimensions
    length_cm         REAL,                      -- NULL: as above
    electrode_resistance_ohm_per_sq REAL,        -- along the strip; NULL: not measured
    data_hash         TEXT    NOT NULL,          -- BLAKE3 of the readings
    tag_digest        TEXT    NOT NULL,          -- BLAKE3 over everything the tags came from
    ingested_at       TEXT    NOT NULL,
    UNIQUE (path, revision)
) STRICT;
CREATE UNIQUE INDEX run_current ON run (path) WHERE superseded_at IS NULL;

-- The raw files of a run: one, or several joined.
CREATE TABLE run_file (
    run_id  INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    ordinal INTEGER NOT NULL,
    path    TEXT    NOT NULL,
    hash    TEXT    NOT NULL REFERENCES content (hash),
    PRIMARY KEY (run_id, ordinal)
) STRICT, WITHOUT ROWID;
CREATE INDEX run_file_hash ON run_file (hash);

-- Readings: one row a channel, numbers as compressed BLOBs (see store/blob.rs).
CREATE TABLE channel (
    run_id        INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    ordinal       INTEGER NOT NULL,
    quantity      TEXT    NOT NULL,
    raw_name      TEXT    NOT NULL,
    raw_unit      TEXT    NOT NULL,
    position_mm   REAL,                          -- NULL: measured on the strip as a whole
    readings      INTEGER NOT NULL,
    excluded      INTEGER NOT NULL,              -- how many are no measurement
    first_time_s  REAL,                          -- NULL: no reading
    last_time_s   REAL,
    first_value   REAL,
    last_value    REAL,
    time_of       INTEGER NOT NULL,              -- ordinal of the channel that holds the time BLOB (itself, or an earlier one)
    time_blob     BLOB,                          -- NULL: shared, see time_of
    value_blob    BLOB    NOT NULL,
    excluded_blob BLOB    NOT NULL,
    PRIMARY KEY (run_id, ordinal)
) STRICT;

-- Every tag from every source; the chosen one of a key has chosen = 1.
CREATE TABLE tag (
    run_id  INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    ordinal INTEGER NOT NULL,
    key     TEXT    NOT NULL,
    value   TEXT    NOT NULL,
    source  TEXT    NOT NULL,
    detail  TEXT    NOT NULL,
    chosen  INTEGER NOT NULL,
    PRIMARY KEY (run_id, ordinal)
) STRICT, WITHOUT ROWID;
CREATE INDEX tag_key ON tag (key, value);

-- Tags set by hand, by the run's name, so that they outlive revisions. The newest of a key counts.
CREATE TABLE hand_tag (
    id       INTEGER NOT NULL PRIMARY KEY,
    run_path TEXT    NOT NULL,
    key      TEXT    NOT NULL,
    value    TEXT,                               -- NULL: the hand tag was taken back
    set_by   TEXT    NOT NULL,
    set_at   TEXT    NOT NULL
) STRICT;
CREATE INDEX hand_tag_run ON hand_tag (run_path);

-- What a reader must know of a run.
CREATE TABLE run_issue (
    run_id   INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    ordinal  INTEGER NOT NULL,
    stage    TEXT    NOT NULL CHECK (stage IN ('read', 'tag')),
    severity TEXT    NOT NULL,
    code     TEXT    NOT NULL,
    place    TEXT    NOT NULL,
    message  TEXT    NOT NULL,
    mend     TEXT    NOT NULL,
    PRIMARY KEY (run_id, ordinal)
) STRICT, WITHOUT ROWID;

-- Fits. Old ones stay; the newest of a run with superseded_at NULL is the current one.
CREATE TABLE fit (
    id                  INTEGER NOT NULL PRIMARY KEY,
    run_id              INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    input_hash          TEXT    NOT NULL,        -- BLAKE3 of data hash, drive, area, length, model and its version
    model               TEXT    NOT NULL,
    model_version       INTEGER NOT NULL,
    code_version        TEXT    NOT NULL,
    method              TEXT    NOT NULL,
    converged           INTEGER NOT NULL,
    why_stopped         TEXT    NOT NULL,
    n_samples           INTEGER NOT NULL,
    r_squared_current   REAL,                    -- NULL: no current was fitted
    r_squared_curvature REAL,                    -- NULL: no curvature was fitted
    noise               TEXT    NOT NULL,        -- JSON array of ChannelNoise
    issues              TEXT    NOT NULL,        -- JSON array of Issue
    evaluations         INTEGER NOT NULL,
    made_at             TEXT    NOT NULL,
    superseded_at       TEXT
) STRICT;
CREATE UNIQUE INDEX fit_current ON fit (run_id) WHERE superseded_at IS NULL;

-- One row a parameter; the key carries the unit.
CREATE TABLE fit_parameter (
    fit_id         INTEGER NOT NULL REFERENCES fit (id) ON DELETE CASCADE,
    ordinal        INTEGER NOT NULL,
    key            TEXT    NOT NULL,
    value          REAL,                         -- NULL: not determined, or bounded on one side only
    standard_error REAL,
    low_95         REAL,
    high_95        REAL,
    at_bound       INTEGER NOT NULL,
    reason         TEXT,                         -- why there is no value
    PRIMARY KEY (fit_id, ordinal)
) STRICT, WITHOUT ROWID;
CREATE INDEX fit_parameter_key ON fit_parameter (key);

-- Curves to draw: thinned, measured, fitted and residual (see store/blob.rs).
CREATE TABLE fit_curve (
    fit_id        INTEGER NOT NULL REFERENCES fit (id) ON DELETE CASCADE,
    ordinal       INTEGER NOT NULL,
    quantity      TEXT    NOT NULL,
    readings      INTEGER NOT NULL,              -- before thinning
    time_blob     BLOB    NOT NULL,
    measured_blob BLOB    NOT NULL,
    fitted_blob   BLOB    NOT NULL,
    residual_blob BLOB    NOT NULL,
    PRIMARY KEY (fit_id, ordinal)
) STRICT;

-- Runs whose fit could not be made, so that it is not tried again before something changes.
CREATE TABLE fit_failure (
    run_id     INTEGER NOT NULL PRIMARY KEY REFERENCES run (id) ON DELETE CASCADE,
    input_hash TEXT    NOT NULL,
    issue      TEXT    NOT NULL,                 -- JSON of an Issue
    failed_at  TEXT    NOT NULL
) STRICT;

-- Counts every committed change, so that a report knows whether it is out of date.
CREATE TABLE change_count (
    only_row INTEGER NOT NULL PRIMARY KEY CHECK (only_row = 1),
    changes  INTEGER NOT NULL,
    changed_at TEXT  NOT NULL
) STRICT;
INSERT INTO change_count VALUES (1, 0, '1970-01-01T00:00:00Z');
