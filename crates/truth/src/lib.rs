//! The truth simulator: the second, independent statement of the model and of every effect, by differential equations.
//!
//! It writes the data in which an effect is hidden, so it does not depend on the crate of the models that are fitted
//! to them (its tests do), and shares only the keys of parameters and the equations in words: no closed form, no
//! stepper. Each file states a class of effects with their equations; `catalogue` lists ids, variants, keys and bounds,
//! among them effects that stand in no library of candidates (`x-...`). The equations are integrated by an L-stable
//! Rosenbrock method from edge to edge.
//!
//! Areal quantities: e_k voltage of a capacitor (V), u voltage across the strip (V), i currents (A/cm2), x bending
//! charge (C/cm2), s strain in units of charge (C/cm2). `kappa = alpha A s`, `s' = x' - lambda s`.
//!
//! Clock time counts from the drive's first edge; before it the strip rests in the steady state at the baseline
//! voltage (discharged at 0 V), the shape that it has there is the zero of curvature, and the readings say that state
//! through the instruments' own effects (offset, camera zero, ...).

pub mod catalogue;
mod charging;
mod coupling;
mod effects;
mod environment;
mod error;
mod forms;
mod leak;
mod motion;
mod network;
pub mod noise;
mod observation;
mod plant;
mod relaxation;
mod source;
mod states;
#[cfg(test)]
mod tests;
mod truth;

pub use effects::HiddenEffect;
pub use error::TruthError;
pub use noise::{ChannelNoise, noise};
pub use truth::Truth;

use ieap_domain::Drive;
use ieap_numerics::rosenbrock::Rosenbrock;

use effects::Effects;
use observation::Observation;
use plant::{Conditions, Plant, Record};

/// Local error of a step against the largest magnitude of each state.
const RELATIVE: f64 = 1e-8;
const ABSOLUTE: f64 = 1e-14;
/// First step after an edge, s.
const FIRST_STEP_S: f64 = 1e-5;

/// What the instruments would read without noise.
#[derive(Debug, Clone, PartialEq)]
pub struct TruthResponses {
    /// Current at each of its times, A.
    pub current_a: Vec<f64>,
    /// Curvature at each of its times, 1/cm.
    pub curvature_per_cm: Vec<f64>,
}

/// Readings of a run of `truth` under `drive`, without noise. Times (s) may be in any order; at the very start of a
/// segment its new level holds already. `run_index` selects what happens in one run only (a contact that breaks).
///
/// # Errors
/// An effect, variant, key or value is not known or makes no sense, or the equations have no solution.
pub fn simulate(
    truth: &Truth,
    drive: &Drive,
    current_time_s: &[f64],
    curvature_time_s: &[f64],
    run_index: usize,
) -> Result<TruthResponses, TruthError> {
    let Built {
        plant,
        start,
        observation,
    } = built(truth, drive, (current_time_s, curvature_time_s), run_index)?;
    let mut instants: Vec<f64> = current_time_s
        .iter()
        .map(|&t| observation.current_time_s(t))
        .collect();
    for &t in curvature_time_s {
        let (first, last) = observation.curvature_times_s(t);
        instants.extend([first, last]);
    }
    let records = Records::integrated(plant, start, drive, instants)?;
    let current_a = current_time_s.iter().map(|&t| {
        let record = records.at(observation.current_time_s(t));
        observation.current_a(t, record.current_a)
    });
    let curvature_per_cm = curvature_time_s.iter().map(|&t| {
        let (first, last) = observation.curvature_times_s(t);
        let seen = if observation.averages() {
            observation.mean(records.at(last).integral, records.at(first).integral)
        } else {
            let (last, first) = (records.at(last), records.at(first));
            observation.exposed(last.curvature_per_cm, first.curvature_per_cm)
        };
        observation.curvature_per_cm(t, seen)
    });
    Ok(TruthResponses {
        current_a: current_a.collect(),
        curvature_per_cm: curvature_per_cm.collect(),
    })
}

impl Truth {
    /// Checks whether it can be simulated under `drive`, but for solutions that only the integration shows to be
    /// none.
    ///
    /// # Errors
    /// As [`simulate`].
    pub fn check(&self, drive: &Drive, run_index: usize) -> Result<(), TruthError> {
        built(self, drive, (&[], &[]), run_index).map(|_| ())
    }
}

/// A system ready to be integrated.
struct Built {
    plant: Plant,
    /// States at the first edge.
    start: Vec<f64>,
    observation: Observation,
}

fn built(
    truth: &Truth,
    drive: &Drive,
    (current_time_s, curvature_time_s): (&[f64], &[f64]),
    run_index: usize,
) -> Result<Built, TruthError> {
    let times = || current_time_s.iter().chain(curvature_time_s);
    check(truth, drive, times())?;
    let effects = Effects::of_run(&truth.effects, run_index)?;
    let start_s = drive.segments[0].start_s();
    let observation = Observation::new(truth, &effects, start_s)?;
    let held = drive.levels().find_map(|(_, volts)| volts);
    let conditions = Conditions {
        baseline_v: drive.baseline_v,
        step_v: if drive.moves() {
            drive.nominal_step_v()
        } else {
            held.unwrap_or(0.0)
        },
        start_s,
        run_s: times().copied().fold(start_s, f64::max) - start_s,
        integral: observation.averages(),
    };
    let (plant, start) = Plant::new(truth, &effects, &conditions)?;
    Ok(Built {
        plant,
        start,
        observation,
    })
}

/// Records at the instants asked for.
struct Records {
    start_s: f64,
    before: Record,
    /// Instants from the first edge on, rising.
    time_s: Vec<f64>,
    records: Vec<Record>,
}

impl Records {
    /// Integrates through the drive, from instant to instant and never across an edge.
    fn integrated(
        mut plant: Plant,
        mut y: Vec<f64>,
        drive: &Drive,
        mut instants: Vec<f64>,
    ) -> Result<Records, TruthError> {
        let start_s = drive.segments[0].start_s();
        instants.retain(|&t| t >= start_s);
        instants.sort_unstable_by(f64::total_cmp);
        instants.dedup();
        let before = Record {
            current_a: plant.resting_current_a(),
            curvature_per_cm: 0.0,
            integral: 0.0,
        };
        let mut method = Rosenbrock::new(y.len(), RELATIVE, ABSOLUTE);
        let mut breaking = plant.break_s();
        let mut upcoming = drive.segments.iter().peekable();
        let mut now_s = start_s;
        let mut records = Vec::with_capacity(instants.len());
        for &t in &instants {
            loop {
                let edge_s = upcoming.peek().map_or(f64::INFINITY, |segment| segment.start_s());
                let break_s = breaking.unwrap_or(f64::INFINITY);
                let event_s = edge_s.min(break_s);
                if event_s > t {
                    break;
                }
                method.advance(&mut plant, now_s, event_s, &mut y)?;
                now_s = event_s;
                if edge_s <= break_s {
                    if let Some(segment) = upcoming.next() {
                        plant.set_level(event_s, segment.level, &mut y);
                    }
                } else {
                    plant.break_now();
                    breaking = None;
                }
                method.restart(FIRST_STEP_S);
            }
            method.advance(&mut plant, now_s, t, &mut y)?;
            now_s = t;
            records.push(plant.record(t, &y));
        }
        Ok(Records {
            start_s,
            before,
            time_s: instants,
            records,
        })
    }

    fn at(&self, t: f64) -> Record {
        if t < self.start_s {
            return self.before;
        }
        let index = self.time_s.partition_point(|&known| known < t);
        self.records.get(index).copied().unwrap_or(self.before)
    }
}

fn check<'a>(
    truth: &Truth,
    drive: &Drive,
    mut times: impl Iterator<Item = &'a f64>,
) -> Result<(), TruthError> {
    let bad = |place: &str, found: String, needed: &str| TruthError::BadValue {
        place: place.to_owned(),
        found,
        needed: needed.to_owned(),
    };
    let positive = |value: f64| value.is_finite() && value > 0.0;
    if truth.branches.is_empty() || truth.branches.len() > 2 {
        let found = truth.branches.len().to_string();
        return Err(bad("branches", found, "one or two; slow-branch adds a third"));
    }
    for branch in &truth.branches {
        if !positive(branch.resistance_ohm_cm2) || !positive(branch.capacitance_f_per_cm2) {
            let found = format!("{branch:?}");
            return Err(bad("branches", found, "a resistance and a capacitance above 0"));
        }
    }
    let rss = truth.steady_state_resistance_ohm_cm2;
    if rss.is_nan() || rss <= 0.0 {
        return Err(bad(
            "steady-state resistance",
            rss.to_string(),
            "a number above 0",
        ));
    }
    let lambda = truth.relaxation_rate_per_s;
    if !lambda.is_finite() || lambda < 0.0 || !truth.charge_to_curvature_per_c_cm.is_finite() {
        let found = format!("{lambda}, alpha {}", truth.charge_to_curvature_per_c_cm);
        return Err(bad(
            "relaxation rate",
            found,
            "finite numbers, the rate not below 0",
        ));
    }
    let sizes = [Some(truth.area_cm2), truth.length_cm, truth.width_cm];
    if let Some(found) = sizes.into_iter().flatten().find(|&size| !positive(size)) {
        return Err(bad(
            "area, length and width",
            found.to_string(),
            "numbers above 0",
        ));
    }
    let rising = drive
        .segments
        .windows(2)
        .all(|pair| pair[0].start_s() < pair[1].start_s());
    if drive.segments.is_empty() || !rising {
        let found = format!("{} segments", drive.segments.len());
        return Err(bad("drive", found, "one segment or more, with rising starts"));
    }
    match times.find(|t| !t.is_finite()) {
        Some(found) => Err(bad("times", found.to_string(), "finite numbers")),
        None => Ok(()),
    }
}
