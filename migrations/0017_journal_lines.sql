-- The lines of the journal that this database has: what they say is stored in it (see store/journal/course.rs).
CREATE TABLE journal_line (
    n    INTEGER NOT NULL PRIMARY KEY,           -- its number
    line TEXT    NOT NULL                        -- as it stands in archive/journal.jsonl, with its checksum
) STRICT;
