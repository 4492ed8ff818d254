//! Laws and observations stated as one function each.

use crate::extended::{Coefficients, Law, Now, Observation};

/// No resistance, capacitance or rate falls below this part of itself.
pub(super) const LEAST: f64 = 0.05;

struct Instant<A>(A);

impl<A: Fn(&Now, &mut Coefficients)> Law for Instant<A> {
    fn act(&self, now: &Now, _memory: f64, c: &mut Coefficients) {
        (self.0)(now, c);
    }
}

/// A law that remembers nothing.
pub(super) fn instant(act: impl Fn(&Now, &mut Coefficients) + 'static) -> Box<dyn Law> {
    Box::new(Instant(act))
}

struct Remembering<I, A> {
    time_s: f64,
    input: I,
    act: A,
}

impl<I: Fn(&Now) -> f64, A: Fn(f64, &mut Coefficients)> Law for Remembering<I, A> {
    fn memory_time_s(&self) -> Option<f64> {
        Some(self.time_s)
    }
    fn memory_input(&self, now: &Now) -> f64 {
        (self.input)(now)
    }
    fn act(&self, _now: &Now, memory: f64, c: &mut Coefficients) {
        (self.act)(memory, c);
    }
}

/// A law that acts by what it remembers: m' = input - m/time.
pub(super) fn remembering(
    time_s: f64,
    input: impl Fn(&Now) -> f64 + 'static,
    act: impl Fn(f64, &mut Coefficients) + 'static,
) -> Box<dyn Law> {
    Box::new(Remembering { time_s, input, act })
}

struct Pointwise<M>(M);

impl<M: Fn(f64, f64) -> f64> Observation for Pointwise<M> {
    fn observe(&self, clock_s: &[f64], curvature_per_cm: &mut [f64]) {
        for (t, kappa) in clock_s.iter().zip(curvature_per_cm) {
            *kappa = (self.0)(t.max(0.0), *kappa);
        }
    }
}

/// What is read of a curvature (1/cm) at a time since the start of the drive (s, 0 before it).
pub(super) fn read_as(map: impl Fn(f64, f64) -> f64 + 'static) -> Box<dyn Observation> {
    Box::new(Pointwise(map))
}

/// Multiplies every branch's resistance.
pub(super) fn scale_resistances(c: &mut Coefficients, factor: f64) {
    let factor = factor.max(LEAST);
    c.resistance_ohm_cm2.iter_mut().for_each(|r| *r *= factor);
}

/// Multiplies differential capacitances by a function of the voltage across each: all of them, or those of one of
/// the base's branches.
pub(super) fn scale_capacitances(
    now: &Now,
    c: &mut Coefficients,
    of_base: Option<usize>,
    factor: impl Fn(f64) -> f64,
) {
    let capacitors = c.capacitance_f_per_cm2.iter_mut().zip(now.capacitor_v);
    for ((c, &e), branch) in capacitors.zip(now.branches) {
        if of_base.is_none() || branch.of_base == of_base {
            *c *= factor(e).max(LEAST);
        }
    }
}

/// Forms of an effect that goes its way in a time, where nobody knows by which law.
pub(super) const APPROACHES: [&str; 3] = ["exponential", "diffusive", "delayed"];

/// Part of the way after `x` time constants, in the form of that place: by first order; as a sheet takes up what diffuses
/// into both its faces; or by two first orders, one after the other.
pub(super) fn approached(form: usize, x: f64) -> f64 {
    match form {
        0 => -(-x).exp_m1(),
        1 => taken_up(x),
        _ => -(-x).exp_m1() - x * (-x).exp(),
    }
}

/// Uptake of a sheet (Crank 1975, equations 4.18 and 4.20), `x` the time over that of its slowest term.
fn taken_up(x: f64) -> f64 {
    use std::f64::consts::PI;
    if x < EARLY {
        return 4.0 * (x.max(0.0) / PI.powi(3)).sqrt();
    }
    let term = |n: usize| {
        let square = ((2 * n + 1) * (2 * n + 1)) as f64;
        8.0 / (square * PI * PI) * (-square * x).exp()
    };
    1.0 - (0..TERMS).map(term).sum::<f64>()
}

/// Time up to which uptake goes with the root of time to 1e-8, and terms that are enough from there on.
const EARLY: f64 = 0.15;
const TERMS: usize = 5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_approach_goes_from_nothing_to_the_whole() {
        for form in 0..APPROACHES.len() {
            assert_eq!(approached(form, 0.0), 0.0);
            assert!((approached(form, 40.0) - 1.0).abs() < 1e-12);
            let ways: Vec<f64> = (0..400).map(|k| approached(form, 0.02 * f64::from(k))).collect();
            assert!(ways.windows(2).all(|pair| pair[0] < pair[1]), "{form}");
        }
    }

    #[test]
    fn uptake_passes_smoothly_from_its_early_to_its_late_law() {
        let (before, after) = (taken_up(EARLY - 1e-12), taken_up(EARLY));
        assert!((before - after).abs() < 1e-7, "{before} {after}");
        // Half is taken up after D t/h^2 = 0.04919 (Crank 1975).
        let half = taken_up(0.04919 * std::f64::consts::PI.powi(2));
        assert!((half - 0.5).abs() < 1e-4, "{half}");
    }
}
