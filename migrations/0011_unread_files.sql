-- What the system could not give is no verdict on a file: it is kept apart, for `status`, until a scan has read the file.
CREATE TABLE unread_file (
    path  TEXT NOT NULL PRIMARY KEY,             -- as in source_file
    issue TEXT NOT NULL                          -- JSON of an Issue: what the system said
) STRICT, WITHOUT ROWID;

-- Such errors were stored as refusals before; without their row the next scan reads the files.
DELETE FROM source_file WHERE state = 'refused' AND issue ->> '$.code' IN ('not-read', 'frames-not-traced');

-- Time of the last change of anything of a file, ns since 1970; 0: not known, and then not compared. The first scan that
-- finds a file otherwise unchanged notes it without reading the file.
ALTER TABLE source_file ADD COLUMN changed_ns INTEGER NOT NULL DEFAULT 0;
