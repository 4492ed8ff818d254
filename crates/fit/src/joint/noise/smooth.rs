//! The smooth part of a channel: a free sum of exponentials per segment, and what it leaves. Where the voltage moves all the
//! time there is beside it a free answer to the voltage.

use std::cell::OnceCell;

use ieap_domain::{Drive, Level};
use ieap_numerics::decay::blocks;
use ieap_numerics::sums::add;

use crate::joint::policy::{POWERS, READINGS_PER_ANSWER};
use crate::sampled::{Sampled, Span};

use super::columns::{inner, orthonormal};
use super::short_shapes::ShortShapes;
use super::spread::{add_decay, rates_per_s, time_constants_s};

/// Smooth shapes of every span, and what they leave.
pub(super) struct Smooth {
    /// The shapes at nodes, where all readings follow each other evenly and no voltage moves.
    short: Option<Vec<ShortShapes>>,
    /// Orthonormal shapes at all readings, where they are asked for.
    whole: OnceCell<Vec<Vec<Vec<f64>>>>,
    terms: usize,
    pub(super) level: Vec<f64>,
    pub(super) rest: Vec<f64>,
}

impl Smooth {
    pub(super) fn of(sampled: &Sampled) -> Smooth {
        let mut smooth = Smooth {
            short: None,
            whole: OnceCell::new(),
            terms: 0,
            level: vec![0.0; sampled.len()],
            rest: sampled.values.to_vec(),
        };
        let short = |span: &Span| ShortShapes::of(sampled, span, &mut smooth.level[span.first..span.end]);
        smooth.short = sampled.spans.iter().map(short).collect();
        if let Some(short) = &smooth.short {
            smooth.terms = short.iter().map(ShortShapes::count).sum();
            add(&mut smooth.rest, -1.0, &smooth.level);
            return smooth;
        }
        smooth.level.fill(0.0);
        let whole = whole(sampled);
        for (span, shapes) in sampled.spans.iter().zip(&whole) {
            let rest = &mut smooth.rest[span.first..span.end];
            let level = &mut smooth.level[span.first..span.end];
            for shape in shapes {
                let part = inner(shape, rest);
                add(rest, -part, shape);
                add(level, part, shape);
            }
        }
        smooth.terms = whole.iter().map(Vec::len).sum();
        smooth.whole = OnceCell::from(whole);
        smooth
    }

    /// How many shapes there are.
    pub(super) fn terms(&self) -> f64 {
        self.terms as f64
    }

    /// Orthonormal shapes of every span of `sampled`, whose smooth part this is.
    pub(super) fn shapes(&self, sampled: &Sampled) -> &[Vec<Vec<f64>>] {
        self.whole.get_or_init(|| whole(sampled))
    }

    /// The shapes at nodes; none where there are no such.
    pub(super) fn short(&self) -> Option<&[ShortShapes]> {
        self.short.as_deref()
    }
}

/// Orthonormal shapes of every span at all readings.
fn whole(sampled: &Sampled) -> Vec<Vec<Vec<f64>>> {
    let of_span = |span: &Span| {
        let elapsed_s = &sampled.elapsed_s[span.first..span.end];
        let columns = match (&span.segment, &sampled.course) {
            (None, _) => vec![vec![1.0; elapsed_s.len()]],
            (Some(_), None) => decays(elapsed_s),
            (Some(_), Some(drive)) => {
                let answers = answers(drive, &sampled.time_s[span.first..span.end], elapsed_s);
                [decays(elapsed_s), answers].concat()
            }
        };
        orthonormal(columns, elapsed_s.len())
    };
    sampled.spans.iter().map(of_span).collect()
}

/// A constant and exponentials whose time constants are spread over the segment.
fn decays(elapsed_s: &[f64]) -> Vec<Vec<f64>> {
    let blocks = blocks(elapsed_s, 0, elapsed_s.len());
    let column = |rate: f64| {
        let mut column = vec![0.0; elapsed_s.len()];
        add_decay(1.0, rate, &blocks, elapsed_s, &mut column);
        column
    };
    rates_per_s(elapsed_s).into_iter().map(column).collect()
}

/// What follows a moving voltage: its powers, and their means over the past that forget in so many time constants.
fn answers(drive: &Drive, time_s: &[f64], elapsed_s: &[f64]) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    for (power, most) in POWERS {
        columns.push(remembered(drive, time_s, power, 0.0));
        let count = time_s.len() / READINGS_PER_ANSWER / POWERS.len();
        for tau_s in time_constants_s(elapsed_s, count, most) {
            columns.push(remembered(drive, time_s, power, tau_s));
        }
    }
    columns
}

/// The mean of a power of the voltage over the past, forgotten in `tau_s`, at times that increase; in steady state before the
/// first segment. With the circuit open the last voltage stays.
fn remembered(drive: &Drive, time_s: &[f64], power: i32, tau_s: f64) -> Vec<f64> {
    let left = |passed_s: f64| {
        if tau_s > 0.0 {
            (-passed_s / tau_s).exp()
        } else {
            0.0
        }
    };
    let mut segments = drive.segments.iter().peekable();
    let mut level = drive.baseline_v.powi(power);
    let (mut mean, mut at_s) = (level, time_s.first().copied().unwrap_or(0.0));
    let mut out = Vec::with_capacity(time_s.len());
    for &t in time_s {
        while let Some(segment) = segments.next_if(|segment| segment.start_s() <= t) {
            mean = level + (mean - level) * left((segment.start_s() - at_s).max(0.0));
            at_s = segment.start_s();
            if let Level::Voltage(volts) = segment.level {
                level = volts.powi(power);
            }
        }
        mean = level + (mean - level) * left((t - at_s).max(0.0));
        at_s = t;
        out.push(mean);
    }
    out
}
