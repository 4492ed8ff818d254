//! What runs had of the climate logs: statistics, and curves to draw.

use rusqlite::params;

use super::blob::pack_f64;
use super::columns::{count_in, key_in, series_in};
use super::{StepError, Store, StoreError, Subject, Transaction};
use ieap_domain::{ClimateCurve, ClimateQuantity, RunClimate};

impl Store {
    /// Climate of a run as it was last joined.
    pub(super) fn run_climate(&self, run_id: i64) -> Result<Vec<RunClimate>, StoreError> {
        let sql = "SELECT sensor, quantity, chosen, readings, mean, standard_deviation, drift_per_h, largest_deviation,
                          largest_gap_s, accuracy FROM run_climate WHERE run_id = ?1 ORDER BY ordinal";
        self.rows_of(run_id, sql, |row| {
            Ok(RunClimate {
                sensor: row.get("sensor")?,
                quantity: key_in(row, "quantity", "a quantity", ClimateQuantity::from_key)?,
                chosen: row.get("chosen")?,
                readings: count_in(row, "readings")?,
                mean: row.get("mean")?,
                standard_deviation: row.get("standard_deviation")?,
                drift_per_h: row.get("drift_per_h")?,
                largest_deviation: row.get("largest_deviation")?,
                largest_gap_s: row.get("largest_gap_s")?,
                accuracy: row.get("accuracy")?,
            })
        })
    }

    /// Climate around a run, thinned for drawing.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn run_climate_curves(&self, run_id: i64) -> Result<Vec<ClimateCurve>, StoreError> {
        self.check_seal(&Subject::ClimateCurves(run_id))?;
        let sql = "SELECT sensor, quantity, time_blob, value_blob FROM run_climate_curve
                   WHERE run_id = ?1 ORDER BY ordinal";
        self.rows_of(run_id, sql, |row| {
            Ok(ClimateCurve {
                sensor: row.get("sensor")?,
                quantity: key_in(row, "quantity", "a quantity", ClimateQuantity::from_key)?,
                time_s: series_in(row, "time_blob")?,
                values: series_in(row, "value_blob")?,
            })
        })
    }
}

/// Puts the climate of a run in place of what was stored before.
pub(super) fn replace_climate(
    transaction: &Transaction<'_>,
    run_id: i64,
    climate: &[RunClimate],
    curves: &[ClimateCurve],
) -> Result<(), StepError> {
    transaction.changes(Subject::Run(run_id))?;
    transaction.changes(Subject::ClimateCurves(run_id))?;
    for table in ["run_climate", "run_climate_curve"] {
        transaction
            .prepare_cached(&format!("DELETE FROM {table} WHERE run_id = ?1"))?
            .execute([run_id])?;
    }
    for (ordinal, of) in climate.iter().enumerate() {
        transaction
            .prepare_cached(
                "INSERT INTO run_climate VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12)",
            )?
            .execute(params![
                run_id,
                ordinal as i64,
                of.sensor,
                of.quantity.key(),
                of.chosen,
                of.readings as i64,
                of.mean,
                of.standard_deviation,
                of.drift_per_h,
                of.largest_deviation,
                of.largest_gap_s,
                of.accuracy
            ])?;
    }
    for (ordinal, curve) in curves.iter().enumerate() {
        transaction
            .prepare_cached("INSERT INTO run_climate_curve VALUES (?1, ?2, ?3, ?4, ?5, ?6)")?
            .execute(params![
                run_id,
                ordinal as i64,
                curve.sensor,
                curve.quantity.key(),
                pack_f64(&curve.time_s)?,
                pack_f64(&curve.values)?
            ])?;
    }
    Ok(())
}
