-- Impedance spectra are runs of their own kind. SQLite changes the CHECK of a column only with the column: a new one
-- takes its place.
ALTER TABLE run ADD COLUMN kind_now TEXT NOT NULL DEFAULT 'actuation'
    CHECK (kind_now IN ('actuation', 'dma', 'impedance'));
UPDATE run SET kind_now = kind;
ALTER TABLE run DROP COLUMN kind;
ALTER TABLE run RENAME COLUMN kind_now TO kind;
