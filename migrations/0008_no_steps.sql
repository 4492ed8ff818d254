-- Runs whose voltage does not go in steps, such as sweeps: a state of their own among those that are not fitted.
-- SQLite changes the CHECK of `state` only with the table, which everything refers to; so it is a mark beside it.
ALTER TABLE run ADD COLUMN no_steps INTEGER NOT NULL DEFAULT 0 CHECK (no_steps IN (0, 1));
