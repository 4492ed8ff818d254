//! Resistances that follow the water taken from the air.

use super::acting::{APPROACHES, approached, instant, scale_resistances};
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct WaterExchange;

static ABOUT: About = About {
    id: "water-exchange",
    code: "N3",
    summary: "R follows the water taken up from the air during the run",
    equation: "R_k -> R_k (1 + c g(t/tau)), t the time since the start of the drive; exponential: g = 1 - e^-x; diffusive: g = 1 - SUM 8/((2n+1)^2 pi^2) e^(-(2n+1)^2 x); delayed: g = 1 - (1 + x) e^-x",
    variants: &APPROACHES,
    parameters: &[
        EffectParameter {
            key: "change",
            symbol: "c",
            unit: "",
            meaning: "relative change in the end",
        },
        EffectParameter {
            key: "time_constant_s",
            symbol: "tau",
            unit: "s",
            meaning: "time of the exchange",
        },
    ],
    vanishes: "c = 0",
    signature: "time constants that change with clock time, whatever the voltage",
    twins: &[
        "resistance-drift",
        "dispersion",
        "voltage-dependent-capacitance",
        "asymmetric-capacitance",
    ],
    separated_by: "a record of humidity or mass; idle time and a repeat",
    sources: "sorption of water by ionomers (Majsztrik 2007; Hallinan and Elabd 2009); uptake of a sheet (Crank 1975)",
};

/// Fastest exchange with the air: water crosses half of a strip of 0.1 mm by diffusion (1e-10 m2/s) in ten seconds. What
/// changes faster is another cause.
const SHORTEST_S: f64 = 10.0;

impl Equation for WaterExchange {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let longest_s = scale.longest_s();
        let low_s = (longest_s / 100.0).max(SHORTEST_S);
        let mut times_s = match variant {
            0 => scale.times_s(0.02, 2.0, 4),
            _ => scale.times_s(0.06, 0.6, 2),
        };
        times_s.retain(|time_s| *time_s >= low_s);
        if times_s.is_empty() {
            return Search::none();
        }
        let limits = vec![
            Limits::linear(-0.8, 2.0),
            Limits::logarithmic(low_s, 5.0 * longest_s),
        ];
        Search::over(0.02, limits, &[times_s])
    }

    fn apply(&self, variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        let [change, time_s] = [parameters[0], parameters[1]];
        system.laws.push(instant(move |now, c| {
            scale_resistances(
                c,
                1.0 + change * approached(variant, now.clock_s.max(0.0) / time_s),
            );
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{respond, scale};
    use super::*;

    /// A record of one second shows no water coming from the air.
    #[test]
    fn it_is_not_asked_for_where_the_record_ends_before_water_can_move() {
        let of = |duration_s: f64| {
            let scale = Scale {
                durations_s: vec![duration_s],
                ..scale()
            };
            WaterExchange.search(0, &scale)
        };
        assert!(of(1.0).probes.is_empty());
        let of_minutes = of(300.0);
        assert!(!of_minutes.probes.is_empty());
        assert!(of_minutes.probes.iter().all(|probe| probe[1] >= SHORTEST_S));
    }

    #[test]
    fn a_late_step_meets_the_changed_resistance() {
        let late = [(0.0, Some(0.0)), (150.0, Some(2.0))];
        for variant in 0..APPROACHES.len() {
            let found = respond(&[("water-exchange", variant, &[-0.3, 4.0])], &late, &[150.0], &[]);
            let expected = 0.1 * 2.0 * ((1.0 / 3.0 + 1.0 / 15.0) / 0.7 + 1.0 / 300.0);
            assert!((found.current_a[0] / expected - 1.0).abs() < 1e-9);
        }
    }
}
