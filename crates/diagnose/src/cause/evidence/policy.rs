//! Every number that the evidence rests on and no reading gives: what may be there, how sure an equation is, and from which
//! probability on something is said.
//!
//! Where a number says "prototype" it was set on linearised groups (24 effects, 34 foreign forms, d = 16 to 64) before this
//! engine was written; `cargo run --release --example hide_and_seek -- laws 1 16,64` counts what this engine says with it.

/// Prior weight of parameters that differ between the runs, all subsets and laws together. Prototype.
pub(super) const VARIES: f64 = 2.0;
/// Sizes of what is added, in standard deviations of the noise after the refit: the least that can be seen and the largest
/// that is thought of. A size between them is as likely on any part of a logarithmic scale. Chosen on development seeds.
pub(crate) const SIZES: (f64, f64) = (3.0, 600.0);
/// Spread of a parameter between runs, in parts of itself, likewise. The prototype ended at 0.3; measured resistances differ
/// 9-fold between voltages.
pub(super) const SPREADS: (f64, f64) = (0.003, 3.0);
/// Precision with which a coordinate of the base, of order one, is known before any reading: under every hypothesis the same.
pub(super) const KNOWN_BEFORE: f64 = 1e-4;

/// Square of the length of all columns of a law together, in variances of the noise, below which it changes nothing that could
/// be seen: far below [`SIZES`], above what rounding leaves. Chosen.
pub(super) const NOTHING: f64 = 1e-12;

/// Waves of slow noise: the longest lasts two records, the shortest a sixth of one. Not calibrated.
pub(super) const WAVES: usize = 12;
/// Waves of all channels of a group together, for the time that they take.
pub(super) const MOST_BY_CLOCK: usize = 160;

/// Upper end of the ratio of a parameter's values below which it is not told to differ: less is not printed. Chosen.
pub(super) const LEAST_RATIO: f64 = 1.005;
/// Subsets of parameters that differ which are fitted in full: the leading ones. Chosen.
pub(super) const SUBSETS_FITTED: usize = 3;
/// Parameters of which all subsets are asked; of more only singles, pairs and all. Chosen: each doubles them.
pub(super) const MOST_FOR_ALL_SUBSETS: usize = 11;

/// Voltages from which a line over them is asked: one is left out, two give the line.
pub(super) const FEWEST_VOLTAGES: usize = 3;
/// Voltages that differ by less than this part are one. Chosen: what a source is off by.
pub(super) const SAME_VOLTAGE_PART: f64 = 1e-2;

/// Points of the grids over sizes and spreads.
pub(super) const GRID: usize = 9;

/// Evenly spaced points on the logarithmic scale between two ends.
pub(crate) fn grid((low, high): (f64, f64)) -> impl Iterator<Item = f64> {
    let step = (high / low).ln() / (GRID - 1) as f64;
    (0..GRID).map(move |k| low * (step * k as f64).exp())
}

/// Logarithm of the mean of what has these logarithms.
pub(crate) fn log_mean(logarithms: &[f64]) -> f64 {
    log_sum(logarithms) - (logarithms.len() as f64).ln()
}

/// Logarithm of the sum of what has these logarithms.
pub(crate) fn log_sum(logarithms: &[f64]) -> f64 {
    let most = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !most.is_finite() {
        return f64::NEG_INFINITY;
    }
    most + logarithms.iter().map(|l| (l - most).exp()).sum::<f64>().ln()
}
