-- What was measured along a strip with the simulated values beside it, thinned for drawing: one row a quantity of a
-- fit. Values lie place after place, each over all times; NaN where a place has no reading (see store/blob.rs).
CREATE TABLE fit_along (
    fit_id        INTEGER NOT NULL REFERENCES fit (id) ON DELETE CASCADE,
    ordinal       INTEGER NOT NULL,
    quantity      TEXT    NOT NULL,
    frames        INTEGER NOT NULL,              -- times before thinning
    position_blob BLOB    NOT NULL,              -- mm from the clamp, increasing
    noise_blob    BLOB    NOT NULL,              -- of each place, canonical unit
    time_blob     BLOB    NOT NULL,              -- s
    measured_blob BLOB    NOT NULL,              -- empty: only the model speaks of these places
    fitted_blob   BLOB    NOT NULL,
    PRIMARY KEY (fit_id, ordinal)
) STRICT;
