//! Foreign laws that several effects share. Each file of a class says which of its effects have which; the name is
//! empty for the effect's own law.

/// What has been reached at `z`, the time in units of the time constant, by what goes from 0 to 1: `1 - exp(-z)`, and
///
/// - `hyperbolic`: `z/(1 + z)`, a reaction of second order;
/// - `stretched`: `1 - exp(-sqrt z)`, many time constants;
/// - `late`: `1 - exp(-z^3)`, begun slowly.
pub(super) fn reached(law: &str, z: f64) -> f64 {
    match law {
        "hyperbolic" => z / (1.0 + z),
        "stretched" => -(-z.sqrt()).exp_m1(),
        "late" => -(-z.powi(3)).exp_m1(),
        _ => -(-z).exp_m1(),
    }
}

/// How far a drift has come at `share` of the run: evenly, and
///
/// - `root`: by its square root; `cubic`: by its third power;
/// - `wave`: `sin(2 pi share)`, there and back.
pub(super) fn drifted(law: &str, share: f64) -> f64 {
    match law {
        "root" => share.sqrt(),
        "cubic" => share.powi(3),
        "wave" => (std::f64::consts::TAU * share).sin(),
        _ => share,
    }
}

/// What is left of a bending at `z`, the charge in units of that at which it saturates: `1/(1 + z)`, and
///
/// - `tanh`: `tanh(z)/z`;
/// - `langevin`: `3 (coth z - 1/z)/z`, dipoles in a field;
/// - `hard`: 1 up to z = 1, `1/z` beyond.
pub(super) fn unsaturated(law: &str, z: f64) -> f64 {
    match law {
        // The series: both differences cancel.
        "tanh" | "langevin" if z < 1e-3 => 1.0 - z * z / if law == "tanh" { 3.0 } else { 15.0 },
        "tanh" => z.tanh() / z,
        "langevin" => 3.0 * (z.tanh().recip() - z.recip()) / z,
        "hard" => z.max(1.0).recip(),
        _ => (1.0 + z).recip(),
    }
}

/// A soft step from 0 to 1 as `value` passes `threshold`, a tenth of it wide.
pub(super) fn passed(value: f64, threshold: f64) -> f64 {
    (1.0 + (-10.0 * (value / threshold - 1.0)).exp()).recip()
}
