-- Views for people who ask the database in SQL. They hold no data and the program reads none of them: they are made anew
-- whenever their text changes.
-- Their text is what SQLite and DuckDB both understand (DuckDB makes its own views of it): numbers are CAST AS DOUBLE, for
-- REAL has four bytes there, and what JSON holds is taken out with ->>. Lists are JSON arrays.
-- Words are those of GLOSSARY.md; a column's name ends in its unit. Only current runs, fits and findings are shown.

-- One row a run: what was measured, under which tags, and whether anybody or anything speaks against it.
CREATE VIEW runs_view AS
WITH fit AS (SELECT run_id, document FROM result WHERE kind = 'fit' AND superseded_at IS NULL AND (document -> '$.found') IS NOT NULL),
condemned AS (
    SELECT CAST(value ->> '$.run' AS VARCHAR) AS run, CAST(value ->> '$.reason' AS VARCHAR) AS reason
    FROM result, json_each(document, '$.found.condemned') WHERE kind IN ('group', 'run') AND superseded_at IS NULL
),
same AS MATERIALIZED (
    SELECT run_id, CAST(value ->> '$.data_hash' AS VARCHAR) AS data_hash
    FROM result, json_each(document, '$.found.standing_in') WHERE kind = 'same' AND superseded_at IS NULL
),
shown_run AS (
    SELECT document ->> '$.run' AS path, document ->> '$.standing' AS standing, document ->> '$.standing_reason' AS reason
    FROM shown WHERE kind = 'run'
),
shown_sample AS (
    SELECT document ->> '$.sample' AS id, CAST(document ->> '$.material' AS VARCHAR) AS material FROM shown WHERE kind = 'sample'
)
SELECT
    run_id, run, kind, state, sample, shown_sample.material AS material, environment, voltage_v, relative_humidity_percent,
    temperature_c, cycle, started_at, area_cm2, length_cm, format, technique, status, revision, ingested_at,
    data_hash, model, converged, r_squared_current, r_squared_curvature, files, dropped_why, condemned_why,
    same_readings_in,
    standing,
    CASE WHEN dropped_why IS NOT NULL THEN dropped_why WHEN shown_standing IS NOT NULL THEN shown_reason ELSE condemned_why END
        AS standing_reason,
    CASE WHEN standing IN ('speaks', 'vouched') THEN 1 WHEN standing IS NOT NULL THEN 0 END AS speaks
FROM (SELECT *,
    -- A person's word holds at once, the rest as of the last report; a run that it does not know speaks unless something that is
    -- known already is against it: of two with the same readings the report decides which is the copy.
    CASE
        WHEN dropped_why IS NOT NULL THEN 'dropped'
        WHEN shown_standing IS NOT NULL THEN shown_standing
        WHEN condemned_why IS NOT NULL THEN 'condemned'
        WHEN same_readings_in IS NULL THEN 'speaks'
    END AS standing
FROM (SELECT
    run.id AS run_id,
    run.path AS run,
    run.kind,
    CASE WHEN fit.run_id IS NOT NULL THEN 'fitted' ELSE run.state END AS state,
    CAST(run.tagging ->> '$.chosen.sample' AS VARCHAR) AS sample,
    CAST(run.tagging ->> '$.chosen.environment' AS VARCHAR) AS environment,
    CAST(run.tagging ->> '$.chosen.voltage_v' AS DOUBLE) AS voltage_v,
    CAST(run.tagging ->> '$.chosen.relative_humidity_percent' AS DOUBLE) AS relative_humidity_percent,
    CAST(run.tagging ->> '$.chosen.temperature_c' AS DOUBLE) AS temperature_c,
    CAST(run.tagging ->> '$.chosen.cycle' AS INTEGER) AS cycle,
    CAST(run.tagging ->> '$.chosen.started_at' AS VARCHAR) AS started_at,
    CAST(run.tagging ->> '$.area_cm2' AS DOUBLE) AS area_cm2,
    CAST(run.tagging ->> '$.length_cm' AS DOUBLE) AS length_cm,
    CAST(run.reading ->> '$.format' AS VARCHAR) AS format,
    CAST(run.reading ->> '$.technique' AS VARCHAR) AS technique,
    CAST(run.reading ->> '$.status' AS VARCHAR) AS status,
    run.revision,
    run.ingested_at,
    run.data_hash,
    CAST(fit.document ->> '$.found.model' AS VARCHAR) AS model,
    CAST(CAST(fit.document ->> '$.found.converged' AS VARCHAR) IN ('1', 'true') AS INTEGER) AS converged,
    CAST(fit.document ->> '$.found.r_squared_current' AS DOUBLE) AS r_squared_current,
    CAST(fit.document ->> '$.found.r_squared_curvature' AS DOUBLE) AS r_squared_curvature,
    CAST((SELECT json_group_array(path) FROM (SELECT path FROM run_file WHERE run_id = run.id ORDER BY ordinal)) AS VARCHAR)
        AS files,
    (SELECT CASE WHEN CAST(line ->> '$.entry.drops' AS VARCHAR) IN ('1', 'true')
        THEN coalesce(CAST(line ->> '$.entry.why' AS VARCHAR), '') END
     FROM journal_line WHERE what = 'word' AND (journal_line.name IN (run.path, run.measurement)
         OR (instr(' ' || run.continues || ' ', ' ' || journal_line.name || ' ') > 0
             OR journal_line.name IN (SELECT hash FROM run_file WHERE run_id = run.id))
         AND journal_line.name NOT IN (SELECT measurement FROM run AS other WHERE other.superseded_at IS NULL))
     ORDER BY n DESC LIMIT 1) AS dropped_why,
    (SELECT condemned.reason FROM condemned WHERE condemned.run = run.path LIMIT 1) AS condemned_why,
    nullif(CAST((SELECT json_group_array(other.path) FROM same
     JOIN run AS other ON other.data_hash = same.data_hash AND other.superseded_at IS NULL AND other.id <> same.run_id
     WHERE same.run_id = run.id) AS VARCHAR), '[]') AS same_readings_in,
    (SELECT standing FROM shown_run WHERE shown_run.path = run.path) AS shown_standing,
    (SELECT reason FROM shown_run WHERE shown_run.path = run.path) AS shown_reason
FROM run
LEFT JOIN fit ON fit.run_id = run.id
WHERE run.superseded_at IS NULL) AS known) AS told
LEFT JOIN shown_sample ON shown_sample.id = told.sample;

-- One row a run and parameter of its current fit, and one for each number that it estimated beside them.
CREATE VIEW fits_view AS
SELECT
    runs.run_id,
    runs.run,
    runs.sample,
    runs.material,
    runs.environment,
    runs.voltage_v,
    runs.relative_humidity_percent,
    runs.model,
    fit.model_version,
    fit.code_version,
    fit.built_from,
    fit.key AS parameter,
    fit.role,
    CASE
        WHEN key LIKE '%\_a\_sqrt\_s\_per\_v\_cm2' ESCAPE '\' THEN 'A sqrt(s)/(V cm2)'
        WHEN key LIKE '%\_a\_per\_v\_cm2' ESCAPE '\' THEN 'A/(V cm2)'
        WHEN key LIKE '%\_f\_per\_cm2' ESCAPE '\' THEN 'F/cm2'
        WHEN key LIKE '%\_a\_per\_cm2' ESCAPE '\' THEN 'A/cm2'
        WHEN key LIKE '%\_c\_per\_cm2' ESCAPE '\' THEN 'C/cm2'
        WHEN key LIKE '%\_s\_per\_cm2' ESCAPE '\' THEN 'S/cm2'
        WHEN key LIKE '%\_cm2\_per\_c' ESCAPE '\' THEN 'cm2/C'
        WHEN key LIKE '%\_cm2\_per\_j' ESCAPE '\' THEN 'cm2/J'
        WHEN key LIKE '%\_cm\_per\_c2' ESCAPE '\' THEN '1/(C2 cm)'
        WHEN key LIKE '%\_ohm\_per\_sq' ESCAPE '\' THEN 'Ohm/sq'
        WHEN key LIKE '%\_ohm\_cm2' ESCAPE '\' THEN 'Ohm cm2'
        WHEN key LIKE '%\_per\_c\_cm' ESCAPE '\' THEN '1/(C cm)'
        WHEN key LIKE '%\_per\_v2\_cm' ESCAPE '\' THEN '1/(V2 cm)'
        WHEN key LIKE '%\_per\_v\_cm' ESCAPE '\' THEN '1/(V cm)'
        WHEN key LIKE '%\_per\_cm\_v' ESCAPE '\' THEN '1/(cm V)'
        WHEN key LIKE '%\_per\_v2' ESCAPE '\' THEN '1/V2'
        WHEN key LIKE '%\_per\_cm' ESCAPE '\' THEN '1/cm'
        WHEN key LIKE '%\_per\_c' ESCAPE '\' THEN '1/C'
        WHEN key LIKE '%\_per\_h' ESCAPE '\' THEN '1/h'
        WHEN key LIKE '%\_per\_s' ESCAPE '\' THEN '1/s'
        WHEN key LIKE '%\_per\_v' ESCAPE '\' THEN '1/V'
        WHEN key LIKE '%\_v\_s\_cm' ESCAPE '\' THEN 'V s cm'
        WHEN key LIKE '%\_percent' ESCAPE '\' THEN '%'
        WHEN key LIKE '%\_bytes' ESCAPE '\' THEN 'bytes'
        WHEN key LIKE '%\_cm2' ESCAPE '\' THEN 'cm2'
        WHEN key LIKE '%\_mpa' ESCAPE '\' THEN 'MPa'
        WHEN key LIKE '%\_ohm' ESCAPE '\' THEN 'Ohm'
        WHEN key LIKE '%\_ppm' ESCAPE '\' THEN 'ppm'
        WHEN key LIKE '%\_degree' ESCAPE '\' THEN 'degree'
        WHEN key LIKE '%\_rad' ESCAPE '\' THEN 'rad'
        WHEN key LIKE '%\_cm' ESCAPE '\' THEN 'cm'
        WHEN key LIKE '%\_hz' ESCAPE '\' THEN 'Hz'
        WHEN key LIKE '%\_kg' ESCAPE '\' THEN 'kg'
        WHEN key LIKE '%\_mm' ESCAPE '\' THEN 'mm'
        WHEN key LIKE '%\_mn' ESCAPE '\' THEN 'mN'
        WHEN key LIKE '%\_ms' ESCAPE '\' THEN 'ms'
        WHEN key LIKE '%\_ns' ESCAPE '\' THEN 'ns'
        WHEN key LIKE '%\_pa' ESCAPE '\' THEN 'Pa'
        WHEN key LIKE '%\_px' ESCAPE '\' THEN 'px'
        WHEN key LIKE '%\_um' ESCAPE '\' THEN 'µm'
        WHEN key LIKE '%\_us' ESCAPE '\' THEN 'µs'
        WHEN key LIKE '%\_a' ESCAPE '\' THEN 'A'
        WHEN key LIKE '%\_c' ESCAPE '\' THEN '°C'
        WHEN key LIKE '%\_h' ESCAPE '\' THEN 'h'
        WHEN key LIKE '%\_s' ESCAPE '\' THEN 's'
        WHEN key LIKE '%\_v' ESCAPE '\' THEN 'V'
        WHEN key LIKE '%\_w' ESCAPE '\' THEN 'W'
    END AS unit,
    fit.value,
    fit.standard_error,
    fit.low_95,
    fit.high_95,
    fit.at_bound,
    fit.reason,
    runs.converged,
    fit.why_stopped,
    fit.n_samples,
    fit.made_at,
    runs.dropped_why,
    runs.condemned_why,
    runs.same_readings_in,
    runs.standing,
    runs.standing_reason,
    runs.speaks
FROM runs_view AS runs JOIN (
    SELECT
        run_id,
        version AS code_version,
        built_from,
        made_at,
        CAST(document ->> '$.found.model_version' AS INTEGER) AS model_version,
        CAST(document ->> '$.found.why_stopped' AS VARCHAR) AS why_stopped,
        CAST(document ->> '$.found.n_samples' AS INTEGER) AS n_samples,
        role,
        CAST(own ->> '$.key' AS VARCHAR) AS key,
        CAST(own ->> '$.estimate.value' AS DOUBLE) AS value,
        CAST(own ->> '$.estimate.standard_error' AS DOUBLE) AS standard_error,
        CAST(own ->> '$.estimate.low_95' AS DOUBLE) AS low_95,
        CAST(own ->> '$.estimate.high_95' AS DOUBLE) AS high_95,
        CAST(CAST(own ->> '$.estimate.at_bound' AS VARCHAR) IN ('1', 'true') AS INTEGER) AS at_bound,
        CAST(own ->> '$.estimate.reason' AS VARCHAR) AS reason
    FROM (
        SELECT run_id, version, built_from, made_at, document, 'parameter' AS role, own.value AS own
        FROM result, json_each(document, '$.found.parameters') AS own
        WHERE kind = 'fit' AND superseded_at IS NULL
        UNION ALL
        SELECT run_id, version, built_from, made_at, document, 'nuisance' AS role, own.value AS own
        FROM result, json_each(document, '$.found.nuisances') AS own
        WHERE kind = 'fit' AND superseded_at IS NULL
    ) AS stated
) AS fit ON fit.run_id = runs.run_id;

-- One row a run and tag, from every source; chosen = 1 marks the value that holds.
CREATE VIEW tags_view AS
SELECT run.id AS run_id, run.path AS run,
    CAST(own.value ->> '$.key' AS VARCHAR) AS key,
    CAST(own.value ->> '$.value' AS VARCHAR) AS value,
    CAST(own.value ->> '$.source' AS VARCHAR) AS source,
    CAST(own.value ->> '$.detail' AS VARCHAR) AS detail,
    CAST(CAST(own.value ->> '$.chosen' AS VARCHAR) IN ('1', 'true') AS INTEGER) AS chosen
FROM run, json_each(run.tagging, '$.tags') AS own
WHERE run.superseded_at IS NULL;

-- One row a finding: of a group of runs, or of one run by itself.
CREATE VIEW findings_view AS
-- What follows from all findings together, the q and what it takes back, is the report's; of a finding that is newer, its own.
WITH shown_finding AS (
    SELECT document ->> '$.kind' AS kind, document ->> '$.name' AS name, document, shown_of.made_at
    FROM shown JOIN shown_of ON true WHERE shown.kind = 'finding'
)
SELECT
    diagnosis.id AS diagnosis_id,
    diagnosis.kind,
    diagnosis.name,
    shown_finding.document ->> '$.material' AS material,
    shown_finding.document ->> '$.sample' AS sample,
    shown_finding.document ->> '$.environment' AS environment,
    coalesce(shown_finding.document ->> '$.verdict', CAST(diagnosis.document ->> '$.found.verdict' AS VARCHAR)) AS verdict,
    coalesce(shown_finding.document ->> '$.sentence', CAST(diagnosis.document ->> '$.found.sentence' AS VARCHAR)) AS sentence,
    CAST(diagnosis.document ->> '$.found.p_misfit' AS DOUBLE) AS p_misfit,
    CAST(shown_finding.document ->> '$.q_misfit' AS DOUBLE) AS q_misfit,
    coalesce(shown_finding.document ->> '$.effects',
        CAST((SELECT json_group_array(value ->> '$.effect') FROM json_each(diagnosis.document, '$.found.effects')) AS VARCHAR), '[]')
        AS effects,
    coalesce(shown_finding.document ->> '$.as_good', CAST(diagnosis.document -> '$.found.set' AS VARCHAR)) AS as_good,
    coalesce(CAST(diagnosis.document -> '$.found.posterior[0].effects' AS VARCHAR), '[]') AS most_probable,
    CAST(diagnosis.document ->> '$.found.posterior[0].mass' AS DOUBLE) AS most_probable_mass,
    CAST(diagnosis.document ->> '$.found.gain.held_out' AS VARCHAR) AS held_out,
    CAST(diagnosis.document ->> '$.found.gain.deviance' AS DOUBLE) AS gain_deviance,
    CAST(diagnosis.document ->> '$.found.gain.standard_error' AS DOUBLE) AS gain_standard_error,
    CAST(diagnosis.document ->> '$.found.gain.nrmse_current_before' AS DOUBLE) AS nrmse_current_before,
    CAST(diagnosis.document ->> '$.found.gain.nrmse_current_after' AS DOUBLE) AS nrmse_current_after,
    CAST(diagnosis.document ->> '$.found.gain.nrmse_curvature_before' AS DOUBLE) AS nrmse_curvature_before,
    CAST(diagnosis.document ->> '$.found.gain.nrmse_curvature_after' AS DOUBLE) AS nrmse_curvature_after,
    CASE WHEN shown_finding.name IS NULL THEN CAST(diagnosis.document ->> '$.found.next_run.drive' AS VARCHAR)
        ELSE shown_finding.document ->> '$.next_run' END AS next_run,
    CAST(diagnosis.document ->> '$.found.base_model' AS VARCHAR) AS base_model,
    CAST((SELECT json_group_array(value ->> '$[0]') FROM json_each(diagnosis.document, '$.found.members')) AS VARCHAR) AS runs,
    CAST(diagnosis.document ->> '$.found.draws' AS INTEGER) AS draws,
    diagnosis.made_at
FROM (
    SELECT result.id, result.kind, coalesce(result.name, run.path) AS name, document, version, made_at, result.superseded_at
    FROM result LEFT JOIN run ON run.id = run_id
) AS diagnosis
LEFT JOIN shown_finding
    ON shown_finding.kind = diagnosis.kind AND shown_finding.name = diagnosis.name AND shown_finding.made_at >= diagnosis.made_at
WHERE diagnosis.kind IN ('group', 'run') AND diagnosis.superseded_at IS NULL;

-- One row a law that was asked for: how a parameter follows what differs from run to run, and whether that is claimed.
CREATE VIEW laws_view AS
SELECT
    CAST(document ->> '$.question' AS VARCHAR) AS question,
    CAST(document ->> '$.material' AS VARCHAR) AS material,
    CAST(document ->> '$.against_material' AS VARCHAR) AS against_material,
    CAST(document ->> '$.parameter' AS VARCHAR) AS parameter,
    CAST(document ->> '$.covariate' AS VARCHAR) AS covariate,
    CAST(document ->> '$.follows' AS VARCHAR) AS follows,
    CAST(document ->> '$.over' AS VARCHAR) AS over,
    CAST(document ->> '$.claimed' AS INTEGER) AS claimed,
    CAST(document ->> '$.certainty' AS VARCHAR) AS certainty,
    CAST(document ->> '$.scope' AS VARCHAR) AS scope,
    CAST(document ->> '$.scale' AS VARCHAR) AS scale,
    CAST(document ->> '$.per_unit' AS DOUBLE) AS per_unit,
    CAST(document ->> '$.per_unit_low_95' AS DOUBLE) AS per_unit_low_95,
    CAST(document ->> '$.per_unit_high_95' AS DOUBLE) AS per_unit_high_95,
    CAST(document ->> '$.low_end' AS DOUBLE) AS low_end,
    CAST(document ->> '$.high_end' AS DOUBLE) AS high_end,
    CAST(document ->> '$.change' AS DOUBLE) AS change,
    CAST(document ->> '$.change_low_95' AS DOUBLE) AS change_low_95,
    CAST(document ->> '$.change_high_95' AS DOUBLE) AS change_high_95,
    CAST(document ->> '$.p' AS DOUBLE) AS p,
    CAST(document ->> '$.q' AS DOUBLE) AS q,
    CAST(document ->> '$.of_material' AS DOUBLE) AS of_material,
    CAST(document ->> '$.of_material_low_95' AS DOUBLE) AS of_material_low_95,
    CAST(document ->> '$.of_material_high_95' AS DOUBLE) AS of_material_high_95,
    CAST(document ->> '$.of_material_q' AS DOUBLE) AS of_material_q,
    CAST(document ->> '$.strips_differ_p' AS DOUBLE) AS strips_differ_p,
    CAST(document ->> '$.also_changed' AS VARCHAR) AS also_changed,
    CAST(document ->> '$.runs' AS INTEGER) AS runs,
    CAST(document ->> '$.samples' AS INTEGER) AS samples,
    CAST(document ->> '$.sentence' AS VARCHAR) AS sentence,
    shown_of.made_at
FROM shown JOIN shown_of ON true
WHERE kind = 'law';

-- One row a sample and parameter that long-term monitoring watches.
CREATE VIEW monitoring_view AS
SELECT
    CAST(document ->> '$.material' AS VARCHAR) AS material,
    CAST(document ->> '$.sample' AS VARCHAR) AS sample,
    CAST(document ->> '$.parameter' AS VARCHAR) AS parameter,
    CAST(document ->> '$.axis' AS VARCHAR) AS axis,
    CAST(document ->> '$.runs' AS INTEGER) AS runs,
    CAST(document ->> '$.changes' AS INTEGER) AS changes,
    CAST(document ->> '$.p_trend' AS DOUBLE) AS p_trend,
    CAST(document ->> '$.law' AS VARCHAR) AS law,
    CAST(document ->> '$.change' AS DOUBLE) AS change,
    CAST(document ->> '$.change_low_95' AS DOUBLE) AS change_low_95,
    CAST(document ->> '$.change_high_95' AS DOUBLE) AS change_high_95,
    CAST(document ->> '$.is_ratio' AS INTEGER) AS is_ratio,
    CAST(document ->> '$.alarms' AS VARCHAR) AS alarms,
    CAST(document ->> '$.limit_reached_at' AS DOUBLE) AS limit_reached_at,
    CAST(document ->> '$.sentence' AS VARCHAR) AS sentence,
    shown_of.made_at
FROM shown JOIN shown_of ON true
WHERE kind = 'monitoring';

-- One row a row of a table that `ieap table` makes and no other view shows.
CREATE VIEW tables_view AS
SELECT
    CAST(document ->> '$.table' AS VARCHAR) AS name,
    CAST(document ->> '$.row' AS INTEGER) AS row_number,
    CAST(document -> '$.cells' AS VARCHAR) AS cells,
    shown_of.made_at
FROM shown JOIN shown_of ON true
WHERE kind = 'table_row';

-- One row a column of these tables.
CREATE VIEW columns_view AS
SELECT
    CAST(document ->> '$.table' AS VARCHAR) AS name,
    CAST(document ->> '$.column' AS VARCHAR) AS key,
    CAST(document ->> '$.unit' AS VARCHAR) AS unit,
    CAST(document ->> '$.meaning' AS VARCHAR) AS meaning
FROM shown
WHERE kind = 'table_column';

-- One row a file that no run is made of, with the reason: refused, or not given by the system.
CREATE VIEW refused_view AS
SELECT
    path AS file,
    CAST(issue ->> '$.code' AS VARCHAR) AS code,
    CAST(issue ->> '$.place' AS VARCHAR) AS place,
    CAST(issue ->> '$.message' AS VARCHAR) AS reason,
    CAST(issue ->> '$.mend' AS VARCHAR) AS mend,
    1 AS is_refused
FROM source_file WHERE state = 'refused' AND missing_since IS NULL
UNION ALL
SELECT path, CAST(issue ->> '$.code' AS VARCHAR), CAST(issue ->> '$.place' AS VARCHAR),
    CAST(issue ->> '$.message' AS VARCHAR), CAST(issue ->> '$.mend' AS VARCHAR), 0
FROM unread_file;

-- One row a run and channel, with its readings as blobs (docs/schema.md says how to read them). A channel that shares the
-- times of an earlier one has them here too.
CREATE VIEW readings_view AS
SELECT
    run.id * 10000 + channel.ordinal AS rowid,
    run.id AS run_id,
    run.path AS run,
    channel.ordinal,
    own.quantity,
    CASE own.quantity
        WHEN 'voltage' THEN 'V' WHEN 'control_voltage' THEN 'V' WHEN 'current' THEN 'A'
        WHEN 'current_density' THEN 'A/cm2' WHEN 'curvature' THEN '1/cm' WHEN 'tip_displacement' THEN 'mm'
        WHEN 'blocking_force' THEN 'mN' WHEN 'temperature' THEN '°C' WHEN 'relative_humidity' THEN '%'
        WHEN 'pressure' THEN 'Pa' WHEN 'oxygen' THEN 'ppm' WHEN 'water' THEN 'ppm' WHEN 'storage_modulus' THEN 'MPa' WHEN 'loss_modulus' THEN 'MPa'
        WHEN 'complex_modulus' THEN 'MPa' WHEN 'frequency' THEN 'Hz' WHEN 'time' THEN 's'
        WHEN 'impedance_real' THEN 'Ohm' WHEN 'impedance_imaginary' THEN 'Ohm' WHEN 'impedance_magnitude' THEN 'Ohm'
        WHEN 'impedance_phase' THEN 'degree' ELSE ''
    END AS unit,
    own.position_mm,
    own.readings,
    own.excluded,
    clock.time_blob AS time_s_blob,
    channel.value_blob,
    channel.excluded_blob
FROM run
JOIN (
    SELECT run_of,
        CAST(value ->> '$.ordinal' AS INTEGER) AS ordinal,
        CAST(value ->> '$.quantity' AS VARCHAR) AS quantity,
        CAST(value ->> '$.position_mm' AS DOUBLE) AS position_mm,
        CAST(value ->> '$.readings' AS INTEGER) AS readings,
        CAST(value ->> '$.excluded' AS INTEGER) AS excluded
    FROM (SELECT id AS run_of, reading FROM run), json_each(reading, '$.channels')
) AS own ON own.run_of = run.id
JOIN channel ON channel.run_id = run.id AND channel.ordinal = own.ordinal
JOIN channel AS clock ON clock.run_id = run.id AND clock.ordinal = channel.time_of
WHERE run.superseded_at IS NULL;
