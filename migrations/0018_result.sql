-- Results are documents: what every kind of result had in tables of its own stands in one. They follow from readings, and are
-- made anew by the next run; earlier ones stay in the copy that is kept of the database before this.

-- How runs were asked to be fitted by hand, by their names: the newest wish of each.
CREATE TABLE asked_fit (
    run_path TEXT NOT NULL PRIMARY KEY,
    asked    TEXT NOT NULL                       -- JSON of model, method, steps, seed, known parameters
) STRICT, WITHOUT ROWID;
INSERT INTO asked_fit
SELECT newest.path, fit.asked
FROM (SELECT run.path, max(fit.id) AS id FROM fit JOIN run ON run.id = fit.run_id GROUP BY run.path) AS newest
JOIN fit ON fit.id = newest.id WHERE fit.asked IS NOT NULL;

-- What follows from readings: fits, analyses of modulus logs, diagnoses, comparisons of models. Earlier ones stay.
CREATE TABLE result (
    id            INTEGER NOT NULL PRIMARY KEY,
    kind          TEXT    NOT NULL,              -- fit, modulus, comparison, alarms, group (its diagnosis) or run (its diagnosis by itself)
    name          TEXT    NOT NULL,              -- of the run, the modulus log or the group
    key           TEXT    NOT NULL,              -- BLAKE3 over everything that it depends on; empty: a fault stopped it
    version       TEXT    NOT NULL,              -- of the program that made it
    made_at       TEXT    NOT NULL,              -- when, RFC 3339 UTC
    superseded_at TEXT,                          -- when another took its place; NULL: it is current
    hash          BLOB    NOT NULL,              -- of kind, name, key, version, document and made_at
    document      TEXT    NOT NULL,              -- JSON: what was found, or the issue why nothing could be
    drawn         BLOB                           -- zstd of JSON: what pages draw of it; its hash stands in the document
) STRICT;
CREATE UNIQUE INDEX result_current ON result (kind, name) WHERE superseded_at IS NULL;
CREATE INDEX result_name ON result (name, kind);

-- What tells that a current result is gone.
CREATE TABLE result_sum (
    kind TEXT NOT NULL PRIMARY KEY,              -- of the results
    sum  BLOB NOT NULL                           -- hashes of all that are current, each bit added without carry
) STRICT, WITHOUT ROWID;

DROP TABLE diagnosis_condemned;
DROP TABLE diagnosis_run;
DROP TABLE diagnosis;
DROP TABLE run_comparison;
DROP TABLE modulus_curve;
DROP TABLE modulus_estimate;
DROP TABLE modulus_step;
DROP TABLE modulus_analysis;
DROP TABLE fit_along;
DROP TABLE fit_curve;
DROP TABLE fit_parameter;
DROP TABLE fit_failure;
DROP TABLE fit;
