//! Curves along the strip that fits store.

use rusqlite::params;

use super::blob::pack_f64;
use super::columns::{count_in, key_in, series_in};
use super::{StepError, Store, StoreError, Subject, Transaction};
use ieap_domain::{AlongCurve, Quantity};

impl Store {
    /// Curves along the strip of the run's current fit; empty where there is none, or where the model says nothing of
    /// places.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn fit_along(&self, run_id: i64) -> Result<Vec<AlongCurve>, StoreError> {
        let Some(fit_id) = self.current_fit(run_id)? else {
            return Ok(Vec::new());
        };
        self.check_seal(&Subject::FitCurves(fit_id))?;
        let sql = "SELECT quantity, frames, position_blob, noise_blob, time_blob, measured_blob, fitted_blob
                   FROM fit_along WHERE fit_id = ?1 ORDER BY ordinal";
        self.rows(
            "reading a fit's curves along the strip",
            sql,
            [fit_id],
            read_along,
        )
    }
}

fn read_along(row: &rusqlite::Row<'_>) -> Result<AlongCurve, StepError> {
    Ok(AlongCurve {
        quantity: key_in(row, "quantity", "a curve's quantity", Quantity::from_key)?,
        frames: count_in(row, "frames")?,
        position_mm: series_in(row, "position_blob")?,
        noise: series_in(row, "noise_blob")?,
        time_s: series_in(row, "time_blob")?,
        measured: series_in(row, "measured_blob")?,
        fitted: series_in(row, "fitted_blob")?,
    })
}

pub(super) fn insert_along(
    transaction: &Transaction<'_>,
    fit_id: i64,
    ordinal: usize,
    curve: &AlongCurve,
) -> Result<(), StepError> {
    transaction
        .prepare_cached("INSERT INTO fit_along VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)")?
        .execute(params![
            fit_id,
            ordinal as i64,
            curve.quantity.key(),
            curve.frames as i64,
            pack_f64(&curve.position_mm)?,
            pack_f64(&curve.noise)?,
            pack_f64(&curve.time_s)?,
            pack_f64(&curve.measured)?,
            pack_f64(&curve.fitted)?,
        ])?;
    Ok(())
}
