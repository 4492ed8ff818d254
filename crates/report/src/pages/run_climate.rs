//! The climate panel of a run.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::error::ReportError;
use crate::figures::climate::around_run;
use ieap_domain::number::{fixed, significant};
use ieap_domain::{ClimateCurve, ClimateQuantity, RunClimate, RunRecord};

/// Climate during the run and around it.
#[derive(Debug, Serialize)]
pub struct ClimatePanel {
    /// Id of the figure; empty where there is none.
    figure: String,
    rows: Vec<ClimateRow>,
    note: String,
}

#[derive(Debug, Serialize)]
struct ClimateRow {
    quantity: String,
    mean: String,
    standard_deviation: String,
    drift: String,
    largest_deviation: String,
    gap: String,
    readings: String,
    sensor: String,
    accuracy: String,
    chosen: bool,
}

/// The panel, whose figure goes to `figures` as `id`; none where no log says anything of the run.
///
/// # Errors
/// [`ReportError::Figure`]: a fault of the program.
pub fn climate_panel(
    record: &RunRecord,
    curves: &[ClimateCurve],
    name: &str,
    id: String,
    figures: &mut BTreeMap<String, String>,
) -> Result<Option<ClimatePanel>, ReportError> {
    if record.climate.is_empty() {
        return Ok(None);
    }
    let firsts = record.channels.iter().filter_map(|channel| channel.first_time_s);
    let lasts = record.channels.iter().filter_map(|channel| channel.last_time_s);
    let length_s = lasts.fold(0.0, f64::max) - firsts.fold(0.0, f64::min);
    let title = format!("Climate around {name}");
    let desc = "Readings of the sensors that speak for the run; the time of the run is shaded.";
    let drawn = around_run(curves, length_s, &title, desc);
    let svg = drawn.map_err(|reason| ReportError::Figure {
        figure: id.clone(),
        reason,
    })?;
    let figure = match svg {
        Some(svg) => {
            figures.insert(id.clone(), svg);
            id
        }
        None => String::new(),
    };
    let interpolated = record.climate.iter().any(|found| found.readings == 0);
    Ok(Some(ClimatePanel {
        figure,
        rows: record.climate.iter().map(row).collect(),
        note: if interpolated {
            "Where no reading lies within the run, the mean is interpolated between those before and after it."
        .to_owned()
        } else {
            String::new()
        },
    }))
}

fn row(found: &RunClimate) -> ClimateRow {
    let unit = found.quantity.unit();
    let decimals = match found.quantity {
        ClimateQuantity::VapourPressure => 0,
        _ => 2,
    };
    // Pressures and traces span decades.
    let spans_decades = [
        ClimateQuantity::Pressure,
        ClimateQuantity::Oxygen,
        ClimateQuantity::Water,
    ]
    .contains(&found.quantity);
    let number = |value: f64| {
        if spans_decades {
            significant(value, 4)
        } else {
            fixed(value, decimals)
        }
    };
    let or_dash = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), number);
    ClimateRow {
        quantity: format!("{} ({unit})", found.quantity.label()),
        mean: number(found.mean),
        standard_deviation: or_dash(found.standard_deviation),
        drift: or_dash(found.drift_per_h),
        largest_deviation: number(found.largest_deviation),
        gap: format!("{} s", fixed(found.largest_gap_s, 0)),
        readings: found.readings.to_string(),
        sensor: found.sensor.clone(),
        accuracy: found
            .accuracy
            .map_or_else(|| "not stated".to_owned(), |accuracy| format!("±{accuracy}")),
        chosen: found.chosen,
    }
}
