//! The run table of a strip that is read at several places: the ladder of cells, sampled, with noise.

use std::fmt::Write;

use super::spec::Spec;
use super::strip_spec::StripSpec;
use super::table::{printed, times};
use crate::domain::number::{digits, scientific};
use crate::model::distributed::{Ladder, LadderResponse, StripField};
use crate::truth::{ChannelNoise, noise};

/// Cells of the ladder: what it misses lies below a millionth of the voltage.
const CELLS: usize = 400;
/// Local error of a step over the largest value so far.
const RELATIVE: f64 = 1e-8;
/// Streams of noise begin here, apart from those of other runs.
const FIRST_STREAM: u64 = 1 << 32;
/// Streams that a strip may use.
const STREAMS: u64 = 1 << 16;

/// The text of the run table. `number` (the strip's place in the spec) and the spec's seed fix the noise.
///
/// # Errors
/// The strip cannot be cut into cells.
pub fn strip_table(spec: &Spec, strip: &StripSpec, number: usize) -> Result<String, String> {
    let stretches = if strip.sampling.is_empty() {
        &spec.sampling
    } else {
        &strip.sampling
    };
    let time_s = times(spec, stretches);
    let drive = strip.drive();
    let model = strip.model();
    let ladder = Ladder::new(&model, CELLS).map_err(|error| error.to_string())?;
    let exact = ladder.respond(&drive, &time_s, RELATIVE);
    let voltage_noise = ChannelNoise {
        standard_deviation: strip.voltage_noise_v,
        ..ChannelNoise::default()
    };
    let mut columns = vec![(
        "current_a".to_owned(),
        exact.clamp_current_a.clone(),
        spec.noise.current(),
    )];
    columns.extend(strip.voltage_at_mm.iter().map(|mm| {
        let values = at_place(&exact, &exact.voltage_v, mm / 10.0);
        (format!("voltage_v@{mm}"), values, voltage_noise)
    }));
    columns.extend(strip.curvature_at_mm.iter().map(|mm| {
        let values = at_place(&exact, &exact.curvature_per_cm, mm / 10.0);
        (format!("curvature_per_cm@{mm}"), values, spec.noise.curvature())
    }));
    let first = FIRST_STREAM + STREAMS * number as u64;
    let noisy: Vec<Vec<f64>> = (first..)
        .zip(&columns)
        .map(|(stream, (_, values, with))| noise(values, with, spec.simulation.seed, stream))
        .collect();
    let mut text = String::new();
    // Writing to a String cannot fail.
    for line in &spec.simulation.statement {
        let _ = writeln!(text, "# {line}");
    }
    text += "time_s,voltage_v";
    columns
        .iter()
        .for_each(|(name, _, _)| text += &format!(",{name}"));
    text += "\n";
    for (row, t) in time_s.iter().enumerate() {
        let applied = drive.level_at(*t).volts().unwrap_or(drive.baseline_v);
        let _ = write!(text, "{},{applied}", printed(*t));
        for ((name, _, _), values) in columns.iter().zip(&noisy) {
            let _ = match name.as_str() {
                "current_a" => write!(text, ",{}", scientific(values[row], 5)),
                _ => write!(text, ",{}", digits(values[row], 5)),
            };
        }
        text += "\n";
    }
    Ok(text)
}

/// Values at a place over all times, between the middles of the two cells around it.
fn at_place(exact: &LadderResponse, field: &StripField, position_cm: f64) -> Vec<f64> {
    let middles = &exact.arc_length_cm;
    let above = middles.partition_point(|s| *s < position_cm).clamp(1, CELLS - 1);
    let (low, high) = (middles[above - 1], middles[above]);
    let share = (position_cm - low) / (high - low);
    (0..exact.clamp_current_a.len())
        .map(|time| (1.0 - share) * field.at(time, above - 1) + share * field.at(time, above))
        .collect()
}
