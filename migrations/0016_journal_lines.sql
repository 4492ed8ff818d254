-- The lines of the journal that this database has: what they say is stored in it (see store/journal/course.rs).
CREATE TABLE journal_line (
    n       INTEGER NOT NULL PRIMARY KEY,                       -- its number
    line    TEXT    NOT NULL,                                   -- as it stands in archive/journal.jsonl, with its checksum
    is_lost INTEGER NOT NULL CHECK (is_lost IN (0, 1))          -- 1 where it says that words may be lost, or answers that
) STRICT;
CREATE INDEX journal_line_lost ON journal_line (n) WHERE is_lost = 1;
