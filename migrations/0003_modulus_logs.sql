-- Modulus logs (dynamic mechanical analysis) beside actuation runs, and what is found in them. A log is a run of
-- the kind 'dma': its files, revisions, tags, channels and issues are stored as those of every run.

ALTER TABLE run ADD COLUMN kind TEXT NOT NULL DEFAULT 'actuation' CHECK (kind IN ('actuation', 'dma'));

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
