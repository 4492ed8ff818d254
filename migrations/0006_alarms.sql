-- Alarms of long-term monitoring that were told: each once.

CREATE TABLE alarm (
    id             TEXT PRIMARY KEY,     -- of sample, parameter, chart and first run
    sample         TEXT NOT NULL,
    parameter      TEXT NOT NULL,        -- stored key
    chart          TEXT NOT NULL CHECK (chart IN ('shewhart', 'ewma', 'cusum', 'limit')),
    run_path       TEXT NOT NULL,        -- run with which it began
    message        TEXT NOT NULL,
    raised_at      TEXT NOT NULL,        -- RFC 3339 UTC; before the command was run
    command_status TEXT                  -- how the command ended; NULL: none was set, or it was cut short
) STRICT;
