//! Predictions and found drives as figures for print.

use super::document::PredictedRow;
use super::{DriveDocument, PredictionDocument};
use crate::analysis::forecast::Forecast;
use crate::pipeline::PipelineError;
use crate::report::print_figures::{Print, charts_print, figure_format_named};
use crate::show::{Chart, Ink, Layer, Mark, Panel, Range};

/// Width, mm, and resolution, dots per inch.
const WIDTH_MM: f64 = 85.0;
const DOTS_PER_INCH: f64 = 600.0;
/// What a band is.
const BAND: &str = "Band: a further run lies in it in 95 of 100 cases.";

/// The prediction over time, with its intervals, in the format of that name.
///
/// # Errors
/// There is no such format, or the drawing library's message.
pub fn prediction_figure(
    document: &PredictionDocument,
    notice: Option<&str>,
    format: &str,
) -> Result<Vec<u8>, PipelineError> {
    let rows = &document.course;
    let response = |quantity: &'static str, unit, of: &dyn Fn(&PredictedRow) -> Option<Forecast>| {
        predicted(
            quantity,
            unit,
            rows.iter().filter_map(|row| Some((row.time_s, of(row)?))),
        )
    };
    let electrical = vec![
        response("Current", "A", &|row| Some(row.current_a)),
        response("Charge", "C", &|row| Some(row.charge_c)),
    ];
    let bending = vec![
        response("Curvature", "1/cm", &|row| row.curvature_per_cm),
        response("Tip displacement", "mm", &|row| row.tip_displacement_mm),
    ];
    let moment = response("Blocked moment", "mN mm", &|row| row.blocked_moment_mn_mm);
    let all = vec![
        Chart::new("Electrical", electrical),
        Chart::new("Bending", bending),
        Chart::new("Force", vec![moment]),
    ];
    let strip = &document.strip;
    let title = format!(
        "Predicted for {} in {}, {} mm by {} mm, with 95 % intervals of a further run",
        document.sample, document.environment, strip.length_mm, strip.width_mm
    );
    written(&title, notice, all, format)
}

/// The found drive, the wanted and the reached course, in the format of that name.
///
/// # Errors
/// There is no such format, or the drawing library's message.
pub fn course_figure(
    document: &DriveDocument,
    notice: Option<&str>,
    format: &str,
) -> Result<Vec<u8>, PipelineError> {
    let rows = &document.course;
    let voltage = Layer::new(
        "",
        Mark::Line,
        Ink::FIRST,
        rows.iter().map(|row| (row.time_s, row.voltage_v)),
    );
    let wanted = rows.iter().map(|row| (row.time_s, row.wanted_mm));
    let reached = rows.iter().map(|row| (row.time_s, row.reached_mm));
    let mut tip = predicted("Tip displacement", "mm", reached);
    tip.layers
        .push(Layer::new("Wanted", Mark::MarkedLine, Ink::SECOND, wanted));
    let all = vec![Chart::new(
        "",
        vec![over_time("Voltage", "V", vec![voltage]), tip],
    )];
    let title = format!(
        "Drive for {} in {}, and what it reaches",
        document.sample, document.environment
    );
    written(&title, notice, all, format)
}

/// A response as a line in its band, all of which is seen.
fn predicted(
    quantity: &'static str,
    unit: &'static str,
    values: impl Iterator<Item = (f64, Forecast)>,
) -> Panel {
    let (mut points, mut band) = (Vec::new(), Vec::new());
    for (time_s, predicted) in values {
        points.push((time_s, predicted.value));
        band.push((predicted.low_95, predicted.high_95));
    }
    let ends: Vec<f64> = band.iter().flat_map(|(low, high)| [*low, *high]).collect();
    let line = Layer::new("Predicted", Mark::Line, Ink::FIRST, points).with_bars(band);
    let mut panel = over_time(quantity, unit, vec![line]);
    panel.y.always.extend(ends);
    panel
}

fn over_time(quantity: &'static str, unit: &'static str, layers: Vec<Layer>) -> Panel {
    let (x, y) = (
        Range::linear("Time", "s"),
        Range::linear(quantity, unit).with(0.0),
    );
    Panel { x, y, layers }
}

fn written(
    title: &str,
    notice: Option<&str>,
    mut charts: Vec<Chart>,
    format: &str,
) -> Result<Vec<u8>, PipelineError> {
    let format = figure_format_named(format).ok_or_else(|| PipelineError::BadArgument {
        what: "--output",
        found: format!("a file that ends in .{format}"),
        needed: "one that ends in .csv, .svg, .png or .pdf".to_owned(),
    })?;
    let failed = |reason| PipelineError::Figure {
        figure: "prediction",
        reason,
    };
    for chart in &mut charts {
        chart.panels.retain(|panel| panel.layers[0].points.len() > 1);
        chart.caption = BAND.to_owned();
    }
    charts.retain(|chart| !chart.panels.is_empty());
    let print = charts_print(&charts, 1, title, WIDTH_MM).map_err(failed)?;
    let print = Print {
        notice: notice.map(str::to_owned),
        ..print
    };
    (format.write)(&print, DOTS_PER_INCH).map_err(failed)
}
