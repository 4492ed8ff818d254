//! A strip that remembers which polarity it had: the answer to a pulse depends on the one before.

use super::acting::{LEAST, scale_resistances};
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{Coefficients, Law, Now, RunContext, System};
use ieap_domain::{Level, Segment};

/// See the module.
pub(super) struct PolarityMemory;

static ABOUT: About = About {
    id: "polarity-memory",
    code: "E20",
    summary: "the answer to a pulse depends on the polarity of those before",
    equation: "X -> X f with f = 1 + c w m e^(-t_e/tau), t_e since the last edge, m what that edge found: tau m' = w - m before it, w = v/V, V the largest voltage of the run; resistance: 1/R_k, capacitance: C_k, relaxation: lambda",
    variants: &["resistance", "capacitance", "relaxation"],
    parameters: &[
        EffectParameter {
            key: "change",
            symbol: "c",
            unit: "",
            meaning: "relative change just after a long time of the same polarity; after the other one it has the other sign",
        },
        EffectParameter {
            key: "memory_time_s",
            symbol: "tau",
            unit: "s",
            meaning: "time over which polarities are remembered",
        },
    ],
    vanishes: "c = 0",
    signature: "pulses of one polarity in turn answer otherwise than pulses of both in turn",
    twins: &[
        "asymmetric-capacitance",
        "water-redistribution",
        "residual-charge",
    ],
    separated_by: "pulses of both polarities in turn against pulses of one, and rests between them",
    sources: "history of polarisation of ion gels and ionic liquids: layers of ions that turn over slowly",
};

struct Memory {
    variant: usize,
    change: f64,
    time_s: f64,
    largest_v: f64,
    /// Times of the edges since the start of the drive, s, and what each found.
    found: Vec<(f64, f64)>,
}

/// What every edge finds of the polarities before it. While the circuit is open the strip keeps its polarity.
fn found(run: &RunContext, time_s: f64, largest_v: f64) -> Vec<(f64, f64)> {
    let start_s = run.start_s();
    let (mut remembered, mut polarity, mut before_s) = (0.0, 0.0, 0.0);
    let at = |segment: &Segment| {
        let clock_s = segment.start_s() - start_s;
        remembered += (remembered - polarity) * (-(clock_s - before_s) / time_s).exp_m1();
        before_s = clock_s;
        if let Level::Voltage(v) = segment.level {
            polarity = if v == 0.0 { 0.0 } else { v / largest_v };
        }
        (clock_s, remembered)
    };
    run.drive.segments.iter().map(at).collect()
}

impl Law for Memory {
    fn act(&self, now: &Now, _memory: f64, c: &mut Coefficients) {
        let edge_s = now.clock_s - now.since_edge_s;
        let place = self
            .found
            .partition_point(|(at_s, _)| at_s - edge_s < 1e-9 * (1.0 + edge_s.abs()));
        let found = place.checked_sub(1).map_or(0.0, |place| self.found[place].1);
        let polarity = (now.source_v / self.largest_v).clamp(-1.0, 1.0);
        let left = found * (-now.since_edge_s.max(0.0) / self.time_s).exp();
        let factor = (1.0 + self.change * polarity * left).max(LEAST);
        match self.variant {
            0 => scale_resistances(c, factor.recip()),
            1 => c.capacitance_f_per_cm2.iter_mut().for_each(|c| *c *= factor),
            _ => c.relaxation_factor *= factor,
        }
    }
}

impl Equation for PolarityMemory {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let relaxes = scale.curvature_per_cm > 0.0 && scale.base.relaxation_rate_per_s > 0.0;
        if scale.voltage_v == 0.0 || variant == 2 && !relaxes {
            return Search::none();
        }
        let longest_s = scale.longest_s();
        let low_s = (longest_s / 100.0).max(scale.shortest_s);
        let limits = vec![
            Limits::linear(-0.8, 2.0),
            Limits::logarithmic(low_s, 3.0 * longest_s.max(low_s)),
        ];
        Search::over(0.03, limits, &[scale.times_s(0.04, 0.5, 2)])
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        let largest_v = run.largest_voltage_v();
        let found = found(run, parameters[1], largest_v);
        // Where no edge finds anything nothing is changed, not even by rounding.
        if found.iter().any(|(_, remembered)| *remembered != 0.0) {
            system.laws.push(Box::new(Memory {
                variant,
                change: parameters[0],
                time_s: parameters[1],
                largest_v,
                found,
            }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;

    #[test]
    fn the_first_pulse_finds_nothing_and_the_third_what_both_before_left() {
        use crate::extended::tests::{context, drive};
        let drive = drive(&[(5.0, Some(2.0)), (15.0, Some(0.0)), (25.0, Some(-1.0))]);
        let found = super::found(&context(&drive), 10.0, 2.0);
        let e = (-1.0_f64).exp();
        let expected = [(0.0, 0.0), (10.0, 1.0 - e), (20.0, (1.0 - e) * e)];
        for ((at, m), (expected_at, expected_m)) in found.into_iter().zip(expected) {
            assert!(
                (at - expected_at).abs() < 1e-12 && (m - expected_m).abs() < 1e-12,
                "{at} {m}"
            );
        }
        let (times, levels) = ([0.0, 1.0, 30.0], [(0.0, Some(2.0))]);
        let plain = respond(&[], &levels, &times, &times);
        let with = respond(&[("polarity-memory", 0, &[0.5, 10.0])], &levels, &times, &times);
        assert_eq!(with, plain);
    }

    /// Long after the first pulse m = 1: a pulse of the same polarity meets R/(1 + c), one of the other R/(1 - c).
    #[test]
    fn a_pulse_meets_the_resistance_that_the_one_before_left() {
        let jump = |volts: f64| {
            let levels = [(0.0, Some(2.0)), (150.0, Some(0.0)), (150.01, Some(volts))];
            let effect = ("polarity-memory", 0, [0.3, 10.0].as_slice());
            let found = respond(&[effect], &levels, &[150.01 - 1e-7, 150.01], &[]);
            found.current_a[1] - found.current_a[0]
        };
        // A capacitor at e draws e/R back at 0 V, where the factor is 1, and (v - e) f/R at v.
        let branches = [(3.0, 0.3), (15.0, 9.0)];
        let of = |volts: f64, factor: f64| {
            let jump = |(r, tau): (f64, f64)| {
                let e = 2.0 * (-0.01_f64 / tau).exp();
                ((volts - e) * factor + e) / r
            };
            0.1 * (branches.map(jump).iter().sum::<f64>() + volts / 300.0)
        };
        for (volts, factor) in [(2.0, 1.3), (-2.0, 0.7)] {
            let (found, expected) = (jump(volts), of(volts, factor));
            assert!(
                (found / expected - 1.0).abs() < 3e-3,
                "{volts}: {found} {expected}"
            );
        }
    }
}
