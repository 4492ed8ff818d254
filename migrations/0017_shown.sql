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
INSERT INTO shown_of VALUES (1, -1, '1970-01-01T00:00:00Z');
