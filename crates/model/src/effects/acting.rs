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
