//! Rows as `ieap export --what traces --partitioned` writes them: channels with clocks of their own, the drive, and how the
//! campaign fits each.

use std::sync::Arc;

use arrow_array::RecordBatch;
use ieap::analysis::run_rows::LISTED;
use ieap::domain::{AskedFit, Channel, Drive, Edge, Issue, Level, Quantity, Segment};
use ieap::pipeline::fits::instruments::NoiseOfOthers;
use ieap::pipeline::standalone::in_memory::CampaignRow;

use crate::columns::{list_at, numbers, text_at};
use crate::rows::number;

/// Columns that only such rows have.
const SIGNS: [&str; 3] = ["input_hash", "data_hash", "drive_v"];

/// Whether the rows of a batch are runs of a campaign.
pub fn are_in(batch: &RecordBatch) -> bool {
    SIGNS.iter().all(|name| batch.column_by_name(name).is_some())
}

/// The run in a row, or why it is not fitted by itself.
pub fn row_at(batch: &RecordBatch, row: usize, name: &str) -> Result<CampaignRow, Issue> {
    if let Some(reason) = text(batch, "reason", row) {
        return Err(Issue::error("not-by-itself", reason).mend("fit it in the campaign"));
    }
    let needed = |key: &str| {
        text(batch, key, row).ok_or_else(|| {
            let issue = Issue::error("column-empty", "there is no text").at(format!("column {key}"));
            issue.mend("leave the columns as `ieap export --what traces --partitioned` writes them")
        })
    };
    let area = number(batch, "area_cm2", row).ok_or_else(|| {
        Issue::error("no-area", "the active area of the strip is not stated").at("area_cm2")
    })?;
    let channels = LISTED
        .into_iter()
        .filter_map(|quantity| channel(batch, row, quantity));
    Ok(CampaignRow {
        run: name.to_owned(),
        data_hash: needed("data_hash")?,
        input_hash: needed("input_hash")?,
        area_cm2: area,
        length_cm: number(batch, "length_cm", row),
        electrode_resistance_ohm_per_sq: number(batch, "electrode_resistance_ohm_per_sq", row),
        electrode_resistance_error_ohm_per_sq: number(batch, "electrode_resistance_error_ohm_per_sq", row),
        drive: drive(batch, row)?,
        channels: channels.collect::<Result<_, _>>()?,
        chosen: AskedFit {
            known: Vec::new(),
            model: Some(needed("model")?),
            method: Some(needed("method")?),
            simultaneous: number(batch, "simultaneous", row).map(|flag| flag != 0.0),
            seed: None,
        },
        noise: of_others(batch, row)?,
    })
}

/// What other runs of its instrument tell of its noise; nothing in rows where nobody tells.
fn of_others(batch: &RecordBatch, row: usize) -> Result<NoiseOfOthers, Issue> {
    let key = "instrument_noise";
    let Some(told) = text(batch, key, row) else {
        return Ok(NoiseOfOthers::default());
    };
    serde_json::from_str(&told).map_err(|error| unequal(key, error.to_string()))
}

fn text(batch: &RecordBatch, key: &str, row: usize) -> Option<String> {
    text_at(batch.column_by_name(key)?, row).map(str::to_owned)
}

/// The list in a cell; none where it is empty.
fn list(batch: &RecordBatch, key: &str, row: usize) -> Option<Vec<f64>> {
    numbers(&list_at(batch.column_by_name(key)?, row)?)
}

fn unequal(key: &str, found: String) -> Issue {
    let issue = Issue::error("column-unusable", found).at(format!("column {key}"));
    issue.mend("leave the columns as `ieap export --what traces --partitioned` writes them")
}

fn drive(batch: &RecordBatch, row: usize) -> Result<Drive, Issue> {
    let starts = list(batch, "drive_start_s", row).unwrap_or_default();
    let levels = list(batch, "drive_v", row).unwrap_or_default();
    if starts.is_empty() || starts.len() != levels.len() {
        let found = format!("{} starts and {} voltages", starts.len(), levels.len());
        return Err(unequal("drive_v", found));
    }
    // Not in rows that were exported before edges were known to lie between readings.
    let before = list(batch, "drive_last_before_s", row).unwrap_or_default();
    let segment = |(place, (start_s, voltage_v)): (usize, (f64, f64))| {
        let level = match voltage_v.is_nan() {
            true => Level::OpenCircuit,
            false => Level::Voltage(voltage_v),
        };
        let edge = match before.get(place).copied() {
            Some(before_s) if before_s.is_finite() => Edge::between(before_s, start_s),
            _ => Edge::at(start_s),
        };
        Segment { edge, level }
    };
    let pairs = starts.into_iter().zip(levels).enumerate();
    Ok(Drive {
        baseline_v: number(batch, "baseline_v", row).unwrap_or(0.0),
        segments: pairs.map(segment).collect(),
    })
}

fn channel(batch: &RecordBatch, row: usize, quantity: Quantity) -> Option<Result<Channel, Issue>> {
    let key = quantity.key();
    let readings = format!("{}_readings", quantity.column());
    let values = list(batch, &readings, row)?;
    let times = list(batch, &format!("{key}_time_s"), row).unwrap_or_default();
    let excluded = list(batch, &format!("{key}_excluded"), row).unwrap_or_default();
    if times.len() != values.len() {
        let found = format!("{} times and {} readings", times.len(), values.len());
        return Some(Err(unequal(&readings, found)));
    }
    let channel = Channel::new(quantity, Arc::from(times), Arc::from(values));
    Some(Ok(Channel {
        excluded: excluded.into_iter().map(|place| place as u32).collect(),
        ..channel
    }))
}
