//! Parameters that differ between the runs of a group: drawn over the voltage, or run by run.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::error::ReportError;
use crate::figures::axis::Axis;
use crate::figures::law::{Beside, Mark, SMALL, sized_panel};
use ieap_analysis::ParameterInfo;
use ieap_domain::number::{measured, significant};
use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_domain::{GroupDiagnosis, VaryingParameter, VaryingValue};

/// A parameter with its figure and its values.
#[derive(Debug, Serialize)]
pub struct DiffersBlock {
    symbol: String,
    unit: String,
    figure: Option<String>,
    rows: Vec<DiffersRow>,
}

#[derive(Debug, Serialize)]
struct DiffersRow {
    run: String,
    step_v: String,
    value: String,
}

/// The section of a group whose runs differ; empty for others.
///
/// # Errors
/// [`ReportError::Figure`] where a figure cannot be drawn.
pub fn differs_blocks(
    found: &GroupDiagnosis,
    figures: &mut BTreeMap<String, String>,
) -> Result<Vec<DiffersBlock>, ReportError> {
    let mut blocks = Vec::new();
    for (place, parameter) in found.differs.iter().enumerate() {
        let id = format!("differs-{}", place + 1);
        let known = ParameterInfo::of(&parameter.key);
        let (symbol, unit, factor) = known.map_or((parameter.key.as_str(), "", 1.0), |known| {
            (known.symbol, known.shown_unit, known.shown_factor)
        });
        let drawn = figure(parameter, (symbol, unit, factor)).map_err(|reason| ReportError::Figure {
            figure: id.clone(),
            reason,
        })?;
        let row = |value: &VaryingValue| DiffersRow {
            run: value.run.clone(),
            step_v: significant(value.step_v, 3),
            value: measured(factor * value.value, factor * value.standard_error),
        };
        blocks.push(DiffersBlock {
            symbol: symbol.to_owned(),
            unit: unit.to_owned(),
            rows: parameter.values.iter().map(row).collect(),
            figure: drawn.map(|svg| {
                figures.insert(id.clone(), svg);
                id
            }),
        });
    }
    Ok(blocks)
}

/// None of fewer than two values.
fn figure(
    parameter: &VaryingParameter,
    (symbol, unit, factor): (&str, &str, f64),
) -> Result<Option<String>, String> {
    let volts: Vec<f64> = parameter.values.iter().map(|value| value.step_v.abs()).collect();
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        })
    };
    let (low_v, high_v) = ends(&mut volts.iter().copied());
    let over_voltage = high_v > 1.001 * low_v;
    let place = |k: usize| if over_voltage { volts[k] } else { (k + 1) as f64 };
    let (first, last) = ends(&mut (0..volts.len()).map(place));
    let bars: Vec<(f64, f64)> = parameter
        .values
        .iter()
        .map(|value| {
            let half = NORMAL_95_ROUNDED * value.standard_error;
            (factor * (value.value - half), factor * (value.value + half))
        })
        .collect();
    let (low, high) = ends(&mut bars.iter().flat_map(|(low, high)| [*low, *high]));
    if volts.len() < 2 || high <= low {
        return Ok(None);
    }
    let margin = 0.06 * (last - first);
    let x = if over_voltage {
        Axis::linear(first - margin, last + margin, "Voltage", "V", 5)
    } else {
        Axis::linear(
            first - margin,
            last + margin,
            "Run, in the order of the table",
            "",
            5,
        )
    };
    let y = Axis::linear_rounded(low, high, symbol, unit, 5);
    let marks: Vec<Mark> = parameter
        .values
        .iter()
        .zip(&bars)
        .enumerate()
        .map(|(k, (value, bar))| Mark {
            x: place(k),
            x_error: 0.0,
            y: factor * value.value,
            bar: *bar,
            style: 0,
            run: None,
        })
        .collect();
    let beside = Beside {
        names: vec!["Run".to_owned()],
        ..Beside::default()
    };
    let title = format!("{symbol} of every run");
    let desc = format!("{symbol} of every run by itself, with its 95 % interval.");
    sized_panel(SMALL, (&x, &y), (&marks, &beside), (&title, &desc)).map(Some)
}
