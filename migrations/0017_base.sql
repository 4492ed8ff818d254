-- The schema 17 as a whole: where the history of this program begins. A new database is made by this and by what follows it.

-- Raw bytes that were taken in, archived under their hash.
CREATE TABLE content (
    hash         TEXT    NOT NULL PRIMARY KEY,   -- BLAKE3 of the bytes, hexadecimal
    size_bytes   INTEGER NOT NULL,
    archive_path TEXT    NOT NULL,               -- relative to the campaign, with /
    ingested_at  TEXT    NOT NULL
) STRICT, WITHOUT ROWID;

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
    ingested_at       TEXT    NOT NULL, no_steps INTEGER NOT NULL DEFAULT 0 CHECK (no_steps IN (0, 1)), kind TEXT NOT NULL DEFAULT 'actuation'
    CHECK (kind IN ('actuation', 'dma', 'impedance')),
    UNIQUE (path, revision)
) STRICT;
CREATE UNIQUE INDEX run_current ON run (path) WHERE superseded_at IS NULL;
CREATE INDEX run_path ON run (path);

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
, asked TEXT) STRICT;
CREATE UNIQUE INDEX fit_current ON fit (run_id) WHERE superseded_at IS NULL;
CREATE INDEX fit_run ON fit (run_id);

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

-- Files under the runs folder as the last scan saw them.
CREATE TABLE "source_file" (
    path          TEXT    NOT NULL PRIMARY KEY,  -- relative, with /; bytes that are no UTF-8 escaped without loss
    size_bytes    INTEGER NOT NULL,
    modified_ns   INTEGER NOT NULL,              -- since 1970
    inode         INTEGER NOT NULL,
    hash          TEXT,                          -- NULL: never read whole; not in `content` when refused
    state         TEXT    NOT NULL CHECK (state IN ('run', 'alias', 'refused', 'pending', 'sidecar', 'log')),
    reader        TEXT    NOT NULL,              -- format id and version that decided, '' where none did
    issue         TEXT,                          -- JSON of an Issue: why refused or pending; NULL otherwise
    missing_since TEXT                           -- NULL: the file is there
, changed_ns INTEGER NOT NULL DEFAULT 0) STRICT, WITHOUT ROWID;
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

-- What the analysis found in a log. Old ones stay; that with superseded_at NULL is the current one.
CREATE TABLE modulus_analysis (
    id               INTEGER NOT NULL PRIMARY KEY,
    run_id           INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    input_hash       TEXT    NOT NULL,          -- BLAKE3 of data hash, column tags and version of the analysis
    analysis_version INTEGER NOT NULL,
    code_version     TEXT    NOT NULL,
    modulus_source   TEXT    NOT NULL,          -- how |E*| was had, in words
    frequency_hz     REAL,                      -- NULL: no frequency channel
    temperature_low_c  REAL,                    -- NULL: no temperature channel
    temperature_high_c REAL,
    readings         INTEGER NOT NULL,          -- of |E*| that were used
    issues           TEXT    NOT NULL,          -- JSON array of Issue
    made_at          TEXT    NOT NULL,
    superseded_at    TEXT
) STRICT;
CREATE UNIQUE INDEX modulus_analysis_current ON modulus_analysis (run_id) WHERE superseded_at IS NULL;

-- Humidity steps in order of time.
CREATE TABLE modulus_step (
    analysis_id INTEGER NOT NULL REFERENCES modulus_analysis (id) ON DELETE CASCADE,
    ordinal     INTEGER NOT NULL,
    start_s     REAL    NOT NULL,               -- when the humidity leaves its level
    settled_s   REAL    NOT NULL,               -- when it has reached the next
    end_s       REAL    NOT NULL,               -- start of the next step, or the log's end
    PRIMARY KEY (analysis_id, ordinal)
) STRICT, WITHOUT ROWID;

-- One row a number; the key carries the unit. step is the ordinal of a step, NULL for the log as a whole.
CREATE TABLE modulus_estimate (
    analysis_id    INTEGER NOT NULL REFERENCES modulus_analysis (id) ON DELETE CASCADE,
    ordinal        INTEGER NOT NULL,
    step           INTEGER,
    key            TEXT    NOT NULL,
    value          REAL,                        -- NULL: not determined, or bounded on one side only
    standard_error REAL,
    low_95         REAL,
    high_95        REAL,
    at_bound       INTEGER NOT NULL,
    reason         TEXT,                        -- why there is no value
    PRIMARY KEY (analysis_id, ordinal)
) STRICT, WITHOUT ROWID;

-- Curves to draw: thinned, as those of fits (see store/blob.rs); fitted is empty where nothing was fitted.
CREATE TABLE modulus_curve (
    analysis_id   INTEGER NOT NULL REFERENCES modulus_analysis (id) ON DELETE CASCADE,
    ordinal       INTEGER NOT NULL,
    quantity      TEXT    NOT NULL,
    readings      INTEGER NOT NULL,             -- before thinning
    time_blob     BLOB    NOT NULL,
    measured_blob BLOB    NOT NULL,
    fitted_blob   BLOB    NOT NULL,
    residual_blob BLOB    NOT NULL,
    PRIMARY KEY (analysis_id, ordinal)
) STRICT;

-- Saved profiles as they were when a file was read with them.
CREATE TABLE profile (
    digest        TEXT    NOT NULL PRIMARY KEY,  -- BLAKE3 of the text, hexadecimal
    id            TEXT    NOT NULL,
    version       INTEGER NOT NULL,
    text          TEXT    NOT NULL,              -- TOML
    first_used_at TEXT    NOT NULL
) STRICT, WITHOUT ROWID;

-- Which files of a run were read with which profile.
CREATE TABLE run_profile (
    run_id  INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    ordinal INTEGER NOT NULL,                    -- of the file in run_file
    digest  TEXT    NOT NULL REFERENCES profile (digest),
    PRIMARY KEY (run_id, ordinal)
) STRICT, WITHOUT ROWID;

-- The clock of each file of a run.
CREATE TABLE run_clock (
    run_id         INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    ordinal        INTEGER NOT NULL,
    file           TEXT    NOT NULL,             -- relative, with /
    is_reference   INTEGER NOT NULL,             -- 1 for the clock that the others are held against
    first_channel  INTEGER NOT NULL,             -- ordinal of the first channel that it times
    channels       INTEGER NOT NULL,
    time_column    TEXT,                         -- NULL: rows are numbered
    time_unit      TEXT    NOT NULL,
    printed_column TEXT,                         -- the printed time beside a rebuilt one; NULL: the time is as printed
    stamp_raw      TEXT,                         -- NULL: the file states no date
    stamp_kind     TEXT CHECK (stamp_kind IN ('start', 'end', 'export')),
    stamp_local    TEXT,                         -- NULL: the order of day and month is not certain
    stamp_offset   TEXT,                         -- NULL: the file states no zone
    stamp_basis    TEXT,
    PRIMARY KEY (run_id, ordinal)
) STRICT, WITHOUT ROWID;

-- What has to be added to the times of a clock to have those of the run's reference clock.
CREATE TABLE clock_offset (
    run_id           INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    clock            INTEGER NOT NULL,           -- ordinal in run_clock
    source           TEXT    NOT NULL CHECK (source IN ('stated', 'header', 'estimated')),
    offset_s         REAL,                       -- NULL: the source cannot give it
    standard_error_s REAL,                       -- NULL: not known
    applied          INTEGER NOT NULL,           -- whether channel times are used with it
    detail           TEXT    NOT NULL,
    PRIMARY KEY (run_id, clock, source)
) STRICT, WITHOUT ROWID;

-- Stretches of readings that the instrument itself marks.
CREATE TABLE sample_flag (
    run_id      INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    ordinal     INTEGER NOT NULL,
    column_name TEXT    NOT NULL,
    flag        TEXT    NOT NULL,
    from_s      REAL    NOT NULL,
    to_s        REAL    NOT NULL,
    readings    INTEGER NOT NULL,
    excludes    INTEGER NOT NULL,                -- whether their current is left out of fits
    PRIMARY KEY (run_id, ordinal)
) STRICT, WITHOUT ROWID;

CREATE TABLE diagnosis (
    id            INTEGER NOT NULL PRIMARY KEY,
    kind          TEXT    NOT NULL CHECK (kind IN ('group', 'run')),
    name          TEXT    NOT NULL,              -- of the group: its shared tags; of a run: its name
    input_hash    TEXT    NOT NULL,              -- BLAKE3 of everything that the finding depends on
    library       TEXT    NOT NULL,              -- BLAKE3 of the library of effects
    seed          INTEGER NOT NULL,              -- as a signed number of the same 64 bits
    draws         INTEGER NOT NULL,
    code_version  TEXT    NOT NULL,
    document      TEXT    NOT NULL,              -- JSON of a GroupDiagnosis
    made_at       TEXT    NOT NULL,
    superseded_at TEXT
) STRICT;
CREATE UNIQUE INDEX diagnosis_current ON diagnosis (kind, name) WHERE superseded_at IS NULL;

-- The runs that it is about.
CREATE TABLE diagnosis_run (
    diagnosis_id INTEGER NOT NULL REFERENCES diagnosis (id) ON DELETE CASCADE,
    ordinal      INTEGER NOT NULL,
    run_id       INTEGER NOT NULL REFERENCES run (id) ON DELETE CASCADE,
    PRIMARY KEY (diagnosis_id, ordinal)
) STRICT, WITHOUT ROWID;
CREATE INDEX diagnosis_run_run ON diagnosis_run (run_id);

CREATE TABLE alarm (
    id             TEXT PRIMARY KEY,     -- of sample, parameter, chart and first run
    sample         TEXT NOT NULL,
    parameter      TEXT NOT NULL,        -- stored key
    chart          TEXT NOT NULL CHECK (chart IN ('shewhart', 'ewma', 'cusum', 'limit')),
    run_path       TEXT NOT NULL,        -- run with which it began
    message        TEXT NOT NULL,
    raised_at      TEXT NOT NULL,        -- RFC 3339 UTC; before the command was run
    command_status TEXT                  -- how the command ended; NULL: none was set, or it was cut short
) STRICT;

-- What was measured along a strip with the simulated values beside it, thinned for drawing: one row a quantity of a
-- fit. Values lie place after place, each over all times; NaN where a place has no reading (see store/blob.rs).
CREATE TABLE fit_along (
    fit_id        INTEGER NOT NULL REFERENCES fit (id) ON DELETE CASCADE,
    ordinal       INTEGER NOT NULL,
    quantity      TEXT    NOT NULL,
    frames        INTEGER NOT NULL,              -- times before thinning
    position_blob BLOB    NOT NULL,              -- mm from the clamp, increasing
    noise_blob    BLOB    NOT NULL,              -- of each place, canonical unit
    time_blob     BLOB    NOT NULL,              -- s
    measured_blob BLOB    NOT NULL,              -- empty: only the model speaks of these places
    fitted_blob   BLOB    NOT NULL,
    PRIMARY KEY (fit_id, ordinal)
) STRICT;

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

-- What the system could not give is no verdict on a file: it is kept apart, for `status`, until a scan has read the file.
CREATE TABLE unread_file (
    path  TEXT NOT NULL PRIMARY KEY,             -- as in source_file
    issue TEXT NOT NULL                          -- JSON of an Issue: what the system said
) STRICT, WITHOUT ROWID;

-- What tells this database from every other; the archive beside it holds the same (archive/database-id).
CREATE TABLE identity (
    only_row INTEGER NOT NULL PRIMARY KEY CHECK (only_row = 1),
    id       TEXT    NOT NULL
) STRICT;

-- Checksums of rows that are read together (see store/seal/mod.rs).
CREATE TABLE seal (
    subject TEXT NOT NULL,                       -- what the rows are of: 'run', 'fit', ...
    id      ANY  NOT NULL,                       -- which one: row id, path, or 0 where there is one only
    sum     BLOB NOT NULL,                       -- first 16 bytes of BLAKE3
    PRIMARY KEY (subject, id)
) STRICT, WITHOUT ROWID;

-- How several models describe a run: the newest comparison that was asked for, as its document.
CREATE TABLE run_comparison (
    run_id       INTEGER NOT NULL PRIMARY KEY REFERENCES run (id) ON DELETE CASCADE,
    input_hash   TEXT    NOT NULL,               -- of everything that it depends on
    code_version TEXT    NOT NULL,
    document     TEXT    NOT NULL,               -- JSON: scores of the models, and their curves
    made_at      TEXT    NOT NULL                -- RFC 3339 UTC
) STRICT;

-- The lines of the journal that this database has: what they say is stored in it (see store/journal/course.rs).
CREATE TABLE journal_line (
    n       INTEGER NOT NULL PRIMARY KEY,                       -- its number
    line    TEXT    NOT NULL,                                   -- as it stands in archive/journal.jsonl, with its checksum
    is_lost INTEGER NOT NULL CHECK (is_lost IN (0, 1))          -- 1 where it says that words may be lost, or answers that
) STRICT;
CREATE INDEX journal_line_lost ON journal_line (n) WHERE is_lost = 1;

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

INSERT INTO change_count VALUES (1, 0, '1970-01-01T00:00:00Z');
INSERT INTO identity VALUES (1, lower(hex(randomblob(16))));
INSERT INTO shown_of VALUES (1, -1, '1970-01-01T00:00:00Z');
