//! A current without a time scale: what falls as a power of the time since each edge, beside what a resistance leaks.

use crate::readings::policy::{POWER_LAW_EXPONENTS, POWER_LAW_FROM_PART};
use ieap_domain::{Drive, Level};

/// Exponents that are tried between the two ends.
const TRIED: usize = 91;

/// The law beside one run's current.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PowerLaw {
    /// The current falls with the time to the minus this power.
    pub(crate) exponent: f64,
    /// Root mean square of what it leaves, A.
    pub(crate) rms_a: f64,
}

/// The power law that describes these readings best, with `step_s` between them; none of a circuit that is opened, of a
/// voltage that moves all the time, or of too few readings.
pub(crate) fn fitted(time_s: &[f64], current_a: &[f64], drive: &Drive, step_s: f64) -> Option<PowerLaw> {
    if drive.moves() {
        return None;
    }
    let mut level_v = drive.baseline_v;
    let mut edges: Vec<(f64, f64)> = Vec::new();
    for segment in &drive.segments {
        let Level::Voltage(volts) = segment.level else {
            return None;
        };
        edges.push((segment.start_s(), volts - level_v));
        level_v = volts;
    }
    let first_s = edges.first()?.0;
    let is_clear = |t: f64| {
        t > first_s
            && edges
                .iter()
                .all(|(at_s, _)| t < *at_s || t - at_s > POWER_LAW_FROM_PART * step_s)
    };
    let readings: Vec<(f64, f64)> = (time_s.iter().copied())
        .zip(current_a.iter().copied())
        .filter(|(t, _)| is_clear(*t))
        .collect();
    if readings.len() <= 3 {
        return None;
    }
    let of_exponent = |k: usize| {
        let exponent = POWER_LAW_EXPONENTS.0
            + (POWER_LAW_EXPONENTS.1 - POWER_LAW_EXPONENTS.0) * k as f64 / (TRIED - 1) as f64;
        let square = left(&readings, &edges, drive.baseline_v, exponent);
        (exponent, square)
    };
    let (exponent, square) = (0..TRIED)
        .map(of_exponent)
        .filter(|(_, square)| square.is_finite())
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(PowerLaw {
        exponent,
        rms_a: (square / readings.len() as f64).sqrt(),
    })
}

/// Sum of squares that a leak and a current of that exponent leave of the readings.
fn left(readings: &[(f64, f64)], edges: &[(f64, f64)], baseline_v: f64, exponent: f64) -> f64 {
    let columns = |t: f64| {
        let before = edges.iter().filter(|(at_s, _)| t > *at_s);
        before.fold((baseline_v, 0.0), |(level_v, falling), (at_s, by_v)| {
            (level_v + by_v, falling + by_v * (t - at_s).powf(-exponent))
        })
    };
    let (mut aa, mut ab, mut bb, mut ay, mut by, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for &(t, y) in readings {
        let (a, b) = columns(t);
        aa += a * a;
        ab += a * b;
        bb += b * b;
        ay += a * y;
        by += b * y;
        yy += y * y;
    }
    let of_leak = if aa > 0.0 { ab / aa } else { 0.0 };
    let (falling, rest) = (bb - ab * of_leak, by - ay * of_leak);
    let by_leak = if aa > 0.0 { ay * ay / aa } else { 0.0 };
    (yy - by_leak - rest * rest / falling).max(0.0)
}

#[cfg(test)]
mod tests {
    use ieap_domain::{Drive, Level, Segment};

    use super::*;

    fn there_and_back() -> Drive {
        let mut drive = Drive::step(2.0);
        drive.segments.push(Segment::at(300.0, Level::Voltage(0.0)));
        drive
    }

    #[test]
    fn diffusion_has_its_exponent_and_a_circuit_is_left_over() {
        let time_s: Vec<f64> = (0..600).map(f64::from).collect();
        let of = |current: &dyn Fn(f64) -> f64| -> PowerLaw {
            let answer = |t: f64, from_s: f64| if t > from_s { current(t - from_s) } else { 0.0 };
            let current_a: Vec<f64> = (time_s.iter())
                .map(|&t| 2.0 * answer(t, 0.0) - 2.0 * answer(t, 300.0))
                .collect();
            fitted(&time_s, &current_a, &there_and_back(), 1.0).unwrap()
        };
        let diffusion = of(&|t| 3e-3 * t.powf(-0.5) + 1e-4);
        assert!((diffusion.exponent - 0.5).abs() < 1e-9 && diffusion.rms_a < 1e-9);
        let circuit = of(&|t| 3e-3 * (-t / 10.0).exp() + 1e-3 * (-t / 80.0).exp());
        assert!(circuit.rms_a > 5e-5, "{circuit:?}");
    }

    #[test]
    fn an_open_circuit_has_no_law() {
        let mut drive = there_and_back();
        drive.segments[1].level = Level::OpenCircuit;
        assert_eq!(fitted(&[1.0, 2.0, 3.0, 4.0, 5.0], &[1.0; 5], &drive, 1.0), None);
    }
}
