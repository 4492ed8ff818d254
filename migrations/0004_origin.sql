-- What the readings of a run rest on beside their files: profiles, clocks with their offsets, flags of instruments.
-- Words are those of GLOSSARY.md.

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
