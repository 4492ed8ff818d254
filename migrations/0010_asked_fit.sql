-- How a fit was asked for by hand (JSON of model, method, steps, seed): `run` keeps it. NULL: nothing was asked for.
ALTER TABLE fit ADD COLUMN asked TEXT;
CREATE INDEX run_path ON run (path);
CREATE INDEX fit_run ON fit (run_id);
