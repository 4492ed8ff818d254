//! A train of cycles, cycle by cycle: amplitude, charge in and out, coulombic efficiency, energy, alpha and resistance
//! against their number, and what of it has a trend.

mod of_cycle;
mod of_held;
mod of_wave;
pub mod policy;
#[cfg(test)]
mod tests;
mod train;

use serde::{Deserialize, Serialize};

use ieap_domain::number::fixed;
use ieap_domain::{Channel, Drive, Estimate, Level as Source, Quantity, RunRecord};
use ieap_numerics::robust::{median, sd_on_a_slope};

use crate::laws::words::{moves, short};
use crate::levels::{Flow, Level, levels};
use crate::monitoring::series::{Reaches, Series};
use ieap_numerics::control_chart;
use of_cycle::{Numbers, Readings};
use of_held::of_held;
use of_wave::of_wave;
use policy::{END_OF_LIFE, MOST_POINTS};
use train::{Train, train};

/// Every number of a cycle.
pub const CYCLE_FIGURES: [ieap_show::Quantity; 7] = [
    ieap_show::Quantity::new(
        "amplitude_per_cm",
        "κ̂",
        "half of the swing of the curvature, from the ends of the levels or of the wave",
        "cm⁻¹",
    ),
    ieap_show::Quantity::new("charge_in_c", "Q_in", "charge that flowed in", "C"),
    ieap_show::Quantity::new("charge_out_c", "Q_out", "charge that flowed out", "C"),
    ieap_show::Quantity::new(
        "coulombic_efficiency_percent",
        "Q_out/Q_in",
        "coulombic efficiency",
        "%",
    ),
    ieap_show::Quantity::new(
        "energy_mj",
        "E",
        "electrical energy that stayed, heat and work together",
        "mJ",
    ),
    ieap_show::Quantity::new(
        "curvature_per_c_cm",
        "Δκ/ΔQ",
        "curvature per charge that flows",
        "C⁻¹ cm⁻¹",
    ),
    ieap_show::Quantity::new(
        "resistance_ohm",
        "R",
        "voltage over current at the edges, or of the wave",
        "Ω",
    ),
];

/// One cycle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// Its number in the run, from 1.
    pub number: usize,
    /// When it begins, s.
    pub start_s: f64,
    /// Its numbers, in the order of [`CYCLE_FIGURES`].
    pub values: Numbers,
}

/// The cycles of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CycleRun {
    /// Row id of the run.
    pub run_id: i64,
    /// Its path.
    pub path: String,
    /// Lowest and highest voltage, V.
    pub voltage_v: (f64, f64),
    /// Cycles in their order.
    pub cycles: Vec<Cycle>,
    /// What of them has a trend, a sentence each.
    pub sentences: Vec<String>,
}

/// The cycles of a run; none where its drive is no train of three cycles or more.
///
/// `channels` are those of the strip as a whole, with a curvature where one follows from what was measured.
pub fn cycle_run(run: &RunRecord, channels: &[Channel]) -> Option<CycleRun> {
    Some(CycleRun {
        run_id: run.id,
        path: run.path.clone(),
        ..cycles_of(run.drive.as_ref()?, channels)?
    })
}

/// The same of readings that no campaign holds.
pub fn cycles_of(drive: &Drive, channels: &[Channel]) -> Option<CycleRun> {
    let read = |quantity| {
        let channel = channels.iter().find(|channel| channel.is_whole(quantity))?;
        Some(channel.included())
    };
    let (current, curvature) = (read(Quantity::Current), read(Quantity::Curvature));
    let last = [&current, &curvature].into_iter().flatten();
    let last_s = last
        .filter_map(|(time_s, _)| time_s.last())
        .copied()
        .reduce(f64::max)?;
    let flow = channels
        .iter()
        .find(|channel| channel.is_whole(Quantity::Current))
        .and_then(|channel| Flow::of(channel, &levels(drive, last_s)));
    let current = current.as_ref().map(|(t, y)| Readings::of(t, y));
    let curvature = curvature.as_ref().map(|(t, y)| Readings::of(t, y));
    let volts = volts_of(drive);
    let found: Vec<(f64, Numbers)> = match train(drive, last_s)? {
        Train::Held(cycles) => {
            let of = |levels: &Vec<Level>| {
                let numbers = of_held(levels, flow.as_ref(), curvature.as_ref());
                (levels[0].from.no_later_s, numbers)
            };
            cycles.iter().map(of).collect()
        }
        Train::Wave(starts) => {
            let volts = Readings::of(&volts.0, &volts.1);
            let of = |pair: &[f64]| {
                let numbers = of_wave(pair[0], pair[1], &volts, current.as_ref(), curvature.as_ref());
                (pair[0], numbers)
            };
            starts.windows(2).map(of).collect()
        }
    };
    let mut cycles: Vec<Cycle> = found
        .into_iter()
        .enumerate()
        .map(|(k, (start_s, values))| Cycle {
            number: k + 1,
            start_s,
            values,
        })
        .collect();
    (0..CYCLE_FIGURES.len()).for_each(|k| allow_for_scatter(&mut cycles, k));
    Some(CycleRun {
        run_id: 0,
        path: String::new(),
        voltage_v: ieap_domain::range_of(volts.1.iter().copied()),
        sentences: sentences(&cycles),
        cycles,
    })
}

/// Times in the middle of the drive's segments and their voltages.
fn volts_of(drive: &Drive) -> (Vec<f64>, Vec<f64>) {
    let ends = drive.segments.iter().skip(1).map(|next| next.start_s());
    let last = drive.segments.last().map(|segment| segment.start_s());
    let of = |(segment, end): (&ieap_domain::Segment, f64)| match segment.level {
        Source::Voltage(volts) => Some((0.5 * (segment.start_s() + end), volts)),
        Source::OpenCircuit => None,
    };
    drive.segments.iter().zip(ends.chain(last)).filter_map(of).unzip()
}

/// Widens the errors of a number to what neighbouring cycles differ by beyond a steady course, where that is more: noise
/// that goes on from reading to reading, and a clock beside the cycles.
fn allow_for_scatter(cycles: &mut [Cycle], k: usize) {
    let values: Option<Vec<f64>> = cycles.iter().map(|cycle| cycle.values[k].value).collect();
    let errors: Vec<f64> = cycles
        .iter()
        .filter_map(|cycle| cycle.values[k].standard_error)
        .collect();
    let (Some(values), Some(usual)) = (values, median(&errors)) else {
        return;
    };
    let seen = sd_on_a_slope(&values);
    if seen <= usual || usual <= 0.0 {
        return;
    }
    for cycle in cycles {
        let own = &mut cycle.values[k];
        if let (Some(value), Some(error), Some(low), Some(high)) =
            (own.value, own.standard_error, own.low_95, own.high_95)
        {
            let wider = seen / usual;
            let (low, high) = (value - wider * (value - low), value + wider * (high - value));
            *own = Estimate::determined(value, wider * error, low, high);
        }
    }
}

/// What the numbers do over the cycles.
fn sentences(cycles: &[Cycle]) -> Vec<String> {
    let limit = control_chart::limit(1e4);
    CYCLE_FIGURES
        .iter()
        .enumerate()
        .filter_map(|(k, figure)| sentence(cycles, k, figure, limit))
        .collect()
}

fn sentence(cycles: &[Cycle], k: usize, figure: &ieap_show::Quantity, limit: f64) -> Option<String> {
    let series = series(cycles, k)?;
    let study = series.study(limit, 1);
    let law = study.trends.first().filter(|_| study.is_shown())?;
    let mut text = format!(
        "{} ({}) {} over {} cycles, {} (p = {}).",
        figure.symbol,
        figure.name,
        moves(law.size, series.is_log),
        cycles.len(),
        law.law.key(),
        short(study.p_trend?),
    );
    // Of a resistance or an energy that grows no such end is agreed on.
    if law.size.value < 0.0 && series.is_log {
        let limit = study.start + END_OF_LIFE.ln();
        let percent = 100.0 * END_OF_LIFE;
        text += &match series.reaches(&study, limit, true) {
            Reaches::Beyond => format!(" It has fallen below {percent} % of its beginning."),
            Reaches::At(at) => {
                let end = |end: Option<f64>| end.map_or("open".to_owned(), |cycle| fixed(cycle, 0));
                format!(
                    " It reaches {percent} % of its beginning at cycle {} [{} to {}].",
                    fixed(at.value, 0),
                    end(at.low_95),
                    end(at.high_95)
                )
            }
            Reaches::Unknown(why) => {
                format!(" When it reaches {percent} % of its beginning cannot be told: {why}.")
            }
        };
    }
    Some(text)
}

/// A number over the cycles, of many cycles the means of neighbours.
fn series(cycles: &[Cycle], k: usize) -> Option<Series> {
    let known: Vec<(f64, f64, f64)> = cycles
        .iter()
        // The first one begins at rest.
        .skip(1)
        .filter_map(|cycle| {
            let own = &cycle.values[k];
            Some((cycle.number as f64, own.value?, own.standard_error?))
        })
        .collect();
    let is_log = known.iter().all(|(_, value, _)| *value > 0.0);
    let together = known.len().div_ceil(MOST_POINTS).max(1);
    let mut series = Series {
        x: Vec::new(),
        y: Vec::new(),
        variance: Vec::new(),
        is_log,
        breaks: Vec::new(),
    };
    for some in known.chunks_exact(together) {
        let count = some.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64, f64)) -> f64| some.iter().map(of).sum::<f64>() / count;
        let (value, variance) = (mean(&|one| one.1), mean(&|one| one.2 * one.2) / count);
        series.x.push(mean(&|one| one.0));
        series.y.push(if is_log { value.ln() } else { value });
        series.variance.push(if is_log {
            variance / (value * value)
        } else {
            variance
        });
    }
    (series.x.len() >= 5).then_some(series)
}
