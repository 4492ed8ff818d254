//! Where an effect is sought in given data.

use ieap_domain::ClimateQuantity;

use crate::LumpedModel;

/// Sizes of the data and of the base model fitted to them, from which limits follow.
#[derive(Debug, Clone)]
pub struct Scale {
    /// The base model fitted to the group.
    pub base: LumpedModel,
    /// Active area, cm2.
    pub area_cm2: f64,
    /// Free length, cm; none where a run's is not known.
    pub length_cm: Option<f64>,
    /// Duration of every run, s.
    pub durations_s: Vec<f64>,
    /// Shortest time between readings, s.
    pub shortest_s: f64,
    /// Largest voltage, V.
    pub voltage_v: f64,
    /// Largest current that the base model gives at a reading, A.
    pub current_a: f64,
    /// Largest curvature that the base model gives at a reading, 1/cm; 0 where none is measured.
    pub curvature_per_cm: f64,
    /// Largest charge that the base model stores, C.
    pub charge_c: f64,
    /// Changes of the voltage in the run with most of them.
    pub edges: usize,
    /// What sensors logged in every run: lowest and highest value, in the unit of the quantity.
    pub logged: Vec<(ClimateQuantity, f64, f64)>,
}

impl Scale {
    /// Longest run, s.
    pub fn longest_s(&self) -> f64 {
        self.durations_s.iter().copied().fold(self.shortest_s, f64::max)
    }

    /// Lowest and highest value of what was logged; the same where it was not in every run.
    pub fn logged_over(&self, quantity: ClimateQuantity) -> (f64, f64) {
        let own = self.logged.iter().find(|(own, _, _)| *own == quantity);
        own.map_or((0.0, 0.0), |(_, low, high)| (*low, *high))
    }

    /// Capacitance of all branches, F/cm2.
    pub fn capacitance_f_per_cm2(&self) -> f64 {
        self.base.branches.iter().map(|b| b.capacitance_f_per_cm2).sum()
    }

    /// Shortest and longest time constant of the branches, s.
    pub fn time_constants_s(&self) -> (f64, f64) {
        let taus = self.base.branches.iter().map(|b| b.time_constant_s());
        taus.fold((f64::INFINITY, 0.0), |(low, high), tau| {
            (low.min(tau), high.max(tau))
        })
    }

    /// Times spaced evenly in their logarithm, from `low` to `high` times the longest run, and never shorter than
    /// a reading lasts.
    pub fn times_s(&self, low: f64, high: f64, count: usize) -> Vec<f64> {
        let longest_s = self.longest_s();
        let first = (low * longest_s).max(self.shortest_s).min(high * longest_s);
        spread(first, high * longest_s, count)
    }
}

/// `count` values from `low` to `high`, evenly spaced in their logarithm.
pub(super) fn spread(low: f64, high: f64, count: usize) -> Vec<f64> {
    let step = (high / low).ln() / (count.max(2) - 1) as f64;
    (0..count).map(|k| low * (step * k as f64).exp()).collect()
}

/// Limits of one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Whether its logarithm is searched.
    pub logarithmic: bool,
    /// Whether it is held at the probes' values.
    pub held: bool,
}

impl Limits {
    /// Searched as it is.
    pub fn linear(low: f64, high: f64) -> Limits {
        Limits {
            low,
            high,
            logarithmic: false,
            held: false,
        }
    }

    /// Searched by its logarithm; both limits positive.
    pub fn logarithmic(low: f64, high: f64) -> Limits {
        Limits {
            logarithmic: true,
            ..Limits::linear(low, high)
        }
    }

    /// Held at what a probe says.
    pub fn held() -> Limits {
        Limits {
            held: true,
            ..Limits::linear(f64::NEG_INFINITY, f64::INFINITY)
        }
    }
}

/// Where and at which shapes an effect is sought.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Search {
    /// Limits of every parameter, the strength first.
    pub limits: Vec<Limits>,
    /// Parameter sets at which the signature is looked for: a small strength with every shape. None: the effect
    /// cannot be sought in these data.
    pub probes: Vec<Vec<f64>>,
    /// Strength at which the effect is absent.
    pub absent: f64,
}

impl Search {
    /// Probes of the strength `small` with every combination of the shape parameters' values.
    pub fn over(small: f64, limits: Vec<Limits>, shapes: &[Vec<f64>]) -> Search {
        let mut probes = vec![vec![small]];
        for values in shapes {
            let longer = |probe: &Vec<f64>| {
                let probe = probe.clone();
                values.iter().map(move |&value| {
                    let mut next = probe.clone();
                    next.push(value);
                    next
                })
            };
            probes = probes.iter().flat_map(longer).collect();
        }
        Search {
            limits,
            probes,
            absent: 0.0,
        }
    }

    /// One addition to the curvature, of either sign and as large as the curvature itself.
    pub fn of_offset(scale: &Scale) -> Search {
        let most = scale.curvature_per_cm;
        Search::over(0.01 * most, vec![Limits::linear(-most, most)], &[])
    }

    /// Nothing to seek in these data.
    pub fn none() -> Search {
        Search::default()
    }
}
