//! Parameters that differ between the runs of a group: drawn over the voltage, or run by run.

use super::wording::shown_as;
use crate::blocks::Writer;
use crate::error::ReportError;
use crate::figures::axis::Axis;
use crate::figures::law::{Beside, Mark, SMALL, sized_panel};
use ieap_domain::number::measured;
use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_domain::{GroupDiagnosis, VaryingParameter, VaryingValue, Verdict};
use ieap_show::{Block, Sheet, Source, rough};

/// The parameters that differ; none where that is not the finding.
fn differing(found: &GroupDiagnosis) -> &[VaryingParameter] {
    match found.verdict {
        Verdict::Differs => &found.differs,
        _ => &[],
    }
}

/// Draws the parameters that differ.
///
/// # Errors
/// [`ReportError::Figure`] where a figure cannot be drawn.
pub fn drawn(page: &mut Writer, found: &GroupDiagnosis) -> Result<(), ReportError> {
    let differing = differing(found);
    if differing.is_empty() {
        return Ok(());
    }
    page.part("What differs", |part| {
        for (place, parameter) in differing.iter().enumerate() {
            let (symbol, unit, _) = shown_as(&parameter.key);
            let heading = [symbol, unit].join(", ");
            let heading = heading.trim_end_matches(", ");
            if let Some(drawn) = figure(parameter).transpose() {
                part.drawing(&format!("differs-{}", place + 1), (heading, ""), drawn)?;
            }
        }
        part.below("Each run by itself, with its 95 % interval; parameters that are not shown here are shared by all runs.");
        Ok(())
    })
}

/// The same as tables.
pub fn tables(found: &GroupDiagnosis) -> impl Iterator<Item = Block> {
    differing(found).iter().map(|parameter| {
        let (symbol, unit, factor) = shown_as(&parameter.key);
        let head = [&format!("{symbol} ± standard error"), unit].join(", ");
        let table = Sheet::<&VaryingValue>::new("differs", "", 1)
            .made_from(|value| vec![Source::file(&value.run)])
            .plain("Run", |value| value.run.as_str())
            .plain("Voltage, V", |value| rough(value.step_v))
            .plain(head.trim_end_matches(", "), |value| {
                measured(factor * value.value, factor * value.standard_error)
            })
            .over(&parameter.values);
        Block::part(format!("{symbol} of every run"), vec![Block::Table(table)])
    })
}

/// None of fewer than two values.
fn figure(parameter: &VaryingParameter) -> Result<Option<String>, String> {
    let (symbol, unit, factor) = shown_as(&parameter.key);
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
