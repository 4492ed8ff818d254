-- What `ieap diagnose` found. Old diagnoses stay; the newest of a name with superseded_at NULL is the current one.
-- The document is the whole finding as JSON; what people count and compare by stands in columns and rows beside it.
-- Values are those of the group by itself: what may be claimed over a campaign (q) follows from all current rows.

CREATE TABLE diagnosis (
    id            INTEGER NOT NULL PRIMARY KEY,
    kind          TEXT    NOT NULL CHECK (kind IN ('group', 'run')),
    name          TEXT    NOT NULL,              -- of the group: its shared tags; of a run: its name
    input_hash    TEXT    NOT NULL,              -- BLAKE3 of everything that the finding depends on
    base_model    TEXT    NOT NULL,
    library       TEXT    NOT NULL,              -- BLAKE3 of the library of effects
    seed          INTEGER NOT NULL,              -- as a signed number of the same 64 bits
    draws         INTEGER NOT NULL,
    code_version  TEXT    NOT NULL,
    verdict       TEXT    NOT NULL,
    p_misfit      REAL,                          -- NULL: could not be asked
    p_leftover    REAL,                          -- NULL: nothing was accepted
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

-- Every candidate that was looked at, the most promising first.
CREATE TABLE diagnosis_candidate (
    diagnosis_id        INTEGER NOT NULL REFERENCES diagnosis (id) ON DELETE CASCADE,
    ordinal             INTEGER NOT NULL,
    effect              TEXT    NOT NULL,
    variant             TEXT,                    -- NULL: it has one form
    forecast_gain       REAL,                    -- fall of the sum of squares, in units of the noise; NULL: not finite
    fitted_gain         REAL,                    -- NULL: not fitted
    held_out_gain       REAL,                    -- NULL: not asked
    extra_parameters    INTEGER NOT NULL,
    detectable_strength REAL,                    -- in the unit of the effect's strength; NULL: none would have been seen
    accepted            INTEGER NOT NULL,
    PRIMARY KEY (diagnosis_id, ordinal)
) STRICT, WITHOUT ROWID;
CREATE INDEX diagnosis_candidate_effect ON diagnosis_candidate (effect);

-- Accepted effects, and their parameters as rows; the key carries the unit.
CREATE TABLE diagnosis_effect (
    diagnosis_id INTEGER NOT NULL REFERENCES diagnosis (id) ON DELETE CASCADE,
    ordinal      INTEGER NOT NULL,
    effect       TEXT    NOT NULL,
    variant      TEXT,
    p            REAL    NOT NULL,
    PRIMARY KEY (diagnosis_id, ordinal)
) STRICT, WITHOUT ROWID;
CREATE INDEX diagnosis_effect_effect ON diagnosis_effect (effect);

CREATE TABLE diagnosis_parameter (
    diagnosis_id   INTEGER NOT NULL,
    effect_ordinal INTEGER NOT NULL,
    ordinal        INTEGER NOT NULL,
    key            TEXT    NOT NULL,
    value          REAL,                         -- NULL: not determined, or bounded on one side only
    standard_error REAL,
    low_95         REAL,
    high_95        REAL,
    at_bound       INTEGER NOT NULL,
    reason         TEXT,                         -- why there is no value
    PRIMARY KEY (diagnosis_id, effect_ordinal, ordinal),
    FOREIGN KEY (diagnosis_id, effect_ordinal) REFERENCES diagnosis_effect (diagnosis_id, ordinal) ON DELETE CASCADE
) STRICT, WITHOUT ROWID;
CREATE INDEX diagnosis_parameter_key ON diagnosis_parameter (key);
