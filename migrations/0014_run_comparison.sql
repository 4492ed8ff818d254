-- How several models describe a run: the newest comparison that was asked for, as its document.
CREATE TABLE run_comparison (
    run_id       INTEGER NOT NULL PRIMARY KEY REFERENCES run (id) ON DELETE CASCADE,
    input_hash   TEXT    NOT NULL,               -- of everything that it depends on
    code_version TEXT    NOT NULL,
    document     TEXT    NOT NULL,               -- JSON: scores of the models, and their curves
    made_at      TEXT    NOT NULL                -- RFC 3339 UTC
) STRICT;
