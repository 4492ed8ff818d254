//! The distributed strip with any number of branches under any held drive, in closed form.
//!
//! With `v = V` at the clamp and no current out of the tip, `1 = SUM b_n sin(beta_n s)` with `b_n = 2/(beta_n L)`
//! parts (22) into modes. Each is the laminate behind an areal resistance `R_sq / beta_n^2`, driven by `b_n V`: a
//! lumped circuit, whose rates follow from a symmetric matrix as large as it has branches. What is added up is how
//! each mode differs from the strip with perfect electrodes, which falls with the fourth power of n.

use ieap_domain::{Drive, Level};
use ieap_numerics::sums;
use ieap_numerics::symmetric::Symmetric;

use super::StripField;
use crate::lumped::{Branch, LumpedModel};

/// Modes added at least, and further ones per unit of `sqrt(R_sq L^2 (1/R + 1/R_ss))`, which is how many times the
/// strip is longer than what charges at once.
const LEAST_MODES: f64 = 40.0;
const MODES_PER_DECAY: f64 = 8.0;
/// Modes added at most.
const MOST_MODES: f64 = 600.0;
/// A mode's branch below this share of the laminate's capacitance is none: a zero of rounding.
const NEGLIGIBLE: f64 = 1e-13;

/// A strip whose electrodes resist along it.
#[derive(Debug, Clone, Copy)]
pub struct BranchedStrip<'a> {
    /// The laminate, with the coupling of this strip per total charge.
    pub model: &'a LumpedModel,
    /// Resistance of both electrodes along the strip, Ohm per square; not negative.
    pub electrode_resistance_ohm_per_sq: f64,
    /// Free length, cm.
    pub length_cm: f64,
    /// Width, cm.
    pub width_cm: f64,
}

/// What the strip does at given times.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchedResponse {
    /// Current into the strip at the clamp, A.
    pub current_a: Vec<f64>,
    /// Charge on the capacitors of the whole strip, C.
    pub charge_c: Vec<f64>,
    /// Charge that has flowed through R_ss since the drive began, C.
    pub leaked_charge_c: Vec<f64>,
    /// Mean curvature over the length, 1/cm: the turn of the tip over the length.
    pub mean_curvature_per_cm: Vec<f64>,
    /// Curvature at the places, 1/cm.
    pub curvature_per_cm: StripField,
}

/// Responses of one mode, or of the strip with perfect electrodes, per unit of the drive's share.
struct Parts {
    current_a: Vec<f64>,
    charge_c: Vec<f64>,
    leaked_charge_c: Vec<f64>,
    curvature_per_cm: Vec<f64>,
}

impl BranchedStrip<'_> {
    /// The response to a drive without open circuits at any times, and the curvature at places (cm from the clamp).
    /// None where the drive has an open circuit: its terminal couples the modes.
    pub fn respond(&self, drive: &Drive, places_cm: &[f64], time_s: &[f64]) -> Option<BranchedResponse> {
        let held = |level: &Level| matches!(level, Level::Voltage(_));
        if !drive.segments.iter().all(|segment| held(&segment.level)) {
            return None;
        }
        let flux_vs: Vec<f64> = time_s.iter().map(|&t| voltage_time_integral(drive, t)).collect();
        let even = self.parts(self.model, self.model, 0.0, drive, time_s, &flux_vs);
        let mut local = vec![0.0; time_s.len() * places_cm.len()];
        for (row, curvature) in local
            .chunks_exact_mut(places_cm.len().max(1))
            .zip(&even.curvature_per_cm)
        {
            row.fill(*curvature);
        }
        let mut response = BranchedResponse {
            current_a: even.current_a.clone(),
            charge_c: even.charge_c.clone(),
            leaked_charge_c: even.leaked_charge_c.clone(),
            mean_curvature_per_cm: even.curvature_per_cm.clone(),
            curvature_per_cm: StripField {
                positions: places_cm.len(),
                values: Vec::new(),
                truncation_bound: None,
            },
        };
        for n in 1..=self.modes() {
            let beta = (2 * n - 1) as f64 * std::f64::consts::FRAC_PI_2 / self.length_cm;
            let series_ohm_cm2 = self.electrode_resistance_ohm_per_sq / (beta * beta);
            let (charging, conducting) = self.behind(series_ohm_cm2);
            let mode = self.parts(&charging, &conducting, series_ohm_cm2, drive, time_s, &flux_vs);
            let share = 2.0 / (beta * self.length_cm).powi(2);
            add(&mut response.current_a, share, &mode.current_a, &even.current_a);
            add(&mut response.charge_c, share, &mode.charge_c, &even.charge_c);
            add(
                &mut response.leaked_charge_c,
                share,
                &mode.leaked_charge_c,
                &even.leaked_charge_c,
            );
            add(
                &mut response.mean_curvature_per_cm,
                share,
                &mode.curvature_per_cm,
                &even.curvature_per_cm,
            );
            let weights: Vec<f64> = places_cm
                .iter()
                .map(|s| 2.0 / (beta * self.length_cm) * (beta * s).sin())
                .collect();
            for (k, row) in local.chunks_exact_mut(places_cm.len().max(1)).enumerate() {
                let differs = mode.curvature_per_cm[k] - even.curvature_per_cm[k];
                sums::add(row, differs, &weights);
            }
        }
        response.curvature_per_cm.values = local;
        Some(response)
    }

    fn modes(&self) -> usize {
        let conductance: f64 = self
            .model
            .branches
            .iter()
            .map(|b| b.resistance_ohm_cm2.recip())
            .sum();
        let first = conductance + self.model.steady_state_resistance_ohm_cm2.recip();
        let decays = (self.electrode_resistance_ohm_per_sq * first).sqrt() * self.length_cm;
        (LEAST_MODES + MODES_PER_DECAY * decays).min(MOST_MODES) as usize
    }

    fn parts(
        &self,
        charging: &LumpedModel,
        conducting: &LumpedModel,
        series_ohm_cm2: f64,
        drive: &Drive,
        time_s: &[f64],
        flux_vs: &[f64],
    ) -> Parts {
        let area_cm2 = self.length_cm * self.width_cm;
        let leak = self.model.steady_state_resistance_ohm_cm2.recip();
        let through = conducting.steady_state_resistance_ohm_cm2.recip();
        let at_rest_c = drive.baseline_v * conducting.total_capacitance_f_per_cm2() * area_cm2;
        let passed = conducting.charge_c(drive, area_cm2, time_s);
        // What the leak takes is what its own voltage, the source's less that across the series resistance, drives.
        let leaked = |(passed_c, flux): (&f64, &f64)| {
            let current_time_c = area_cm2 * flux * through + passed_c - at_rest_c;
            leak * (area_cm2 * flux - series_ohm_cm2 * current_time_c)
        };
        Parts {
            current_a: conducting.current_a(drive, area_cm2, time_s),
            charge_c: charging.charge_c(drive, area_cm2, time_s),
            leaked_charge_c: passed.iter().zip(flux_vs).map(leaked).collect(),
            curvature_per_cm: charging.curvature_per_cm(drive, area_cm2, time_s),
        }
    }

    /// The laminate behind a resistance, as two lumped circuits with the same rates: one that stores its charge, and
    /// one that draws its current.
    fn behind(&self, series_ohm_cm2: f64) -> (LumpedModel, LumpedModel) {
        let branches = &self.model.branches;
        let steady = self.model.steady_state_resistance_ohm_cm2;
        let conductance = |k: usize| branches[k].resistance_ohm_cm2.recip();
        let root = |k: usize| branches[k].capacitance_f_per_cm2.sqrt();
        let all: f64 = (0..branches.len()).map(conductance).sum::<f64>() + steady.recip();
        let raised = 1.0 + series_ohm_cm2 * all;
        let entry = |j: usize, k: usize| {
            let own = if j == k {
                conductance(k) / branches[k].capacitance_f_per_cm2
            } else {
                0.0
            };
            own - series_ohm_cm2 / raised * conductance(j) * conductance(k) / (root(j) * root(k))
        };
        let (rates, vectors) = Symmetric::from_fn(branches.len(), entry).eigen();
        let least = NEGLIGIBLE * self.model.total_capacitance_f_per_cm2();
        let (mut charging, mut conducting) = (Vec::new(), Vec::new());
        for (m, &rate) in rates.iter().enumerate() {
            let of = |weight: &dyn Fn(usize) -> f64| -> f64 {
                (0..branches.len()).map(|k| weight(k) * vectors[k][m]).sum()
            };
            let driven = of(&|k| conductance(k) / (raised * root(k)));
            let branch = |capacitance: f64| Branch {
                resistance_ohm_cm2: (rate * capacitance).recip(),
                capacitance_f_per_cm2: capacitance,
            };
            let stored = of(&root) * driven / rate;
            let drawn = (driven / rate).powi(2);
            charging.extend((stored.abs() > least).then(|| branch(stored)));
            conducting.extend((drawn > least).then(|| branch(drawn)));
        }
        let circuit = |branches, steady_state_resistance_ohm_cm2| LumpedModel {
            branches,
            steady_state_resistance_ohm_cm2,
            ..self.model.clone()
        };
        (
            circuit(charging, f64::INFINITY),
            circuit(conducting, steady + series_ohm_cm2),
        )
    }
}

/// Adds `share` of how `mode` differs from `even`.
fn add(to: &mut [f64], share: f64, mode: &[f64], even: &[f64]) {
    for ((to, mode), even) in to.iter_mut().zip(mode).zip(even) {
        *to += share * (mode - even);
    }
}

/// Integral of a held drive's voltage from its first segment to `time_s`, V s; zero before it.
pub fn voltage_time_integral(drive: &Drive, time_s: f64) -> f64 {
    let ends = drive.segments.iter().skip(1).map(|segment| segment.start_s());
    let of_segment = |((start_s, volts), end): ((f64, Option<f64>), f64)| {
        volts.unwrap_or(0.0) * (end.min(time_s) - start_s).max(0.0)
    };
    drive
        .levels()
        .zip(ends.chain([f64::INFINITY]))
        .map(of_segment)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::super::{Ladder, Laminate};
    use super::*;
    use crate::coupling::{ActiveArea, CurvaturePerTotalCharge};
    use crate::effects::{Applied, effect};
    use crate::extended::{ExtendedModel, RunContext};
    use ieap_domain::Segment;

    const OF: ActiveArea = ActiveArea {
        length_cm: 4.5,
        width_cm: 0.3,
    };

    fn model(branches: &[(f64, f64)]) -> LumpedModel {
        LumpedModel {
            branches: branches
                .iter()
                .map(|&(resistance_ohm_cm2, capacitance_f_per_cm2)| Branch {
                    resistance_ohm_cm2,
                    capacitance_f_per_cm2,
                })
                .collect(),
            steady_state_resistance_ohm_cm2: 42.9,
            charge_to_curvature_per_c_cm: 2.0,
            relaxation_rate_per_s: 0.02,
        }
    }

    fn pulses() -> Drive {
        let segment = |&(start_s, volts): &(f64, f64)| Segment::at(start_s, Level::Voltage(volts));
        Drive {
            baseline_v: 0.3,
            segments: [(1.0, 1.5), (3.0, -0.5), (6.0, 0.8)]
                .iter()
                .map(segment)
                .collect(),
        }
    }

    fn strip(model: &LumpedModel, per_sq: f64) -> BranchedStrip<'_> {
        BranchedStrip {
            model,
            electrode_resistance_ohm_per_sq: per_sq,
            length_cm: OF.length_cm,
            width_cm: OF.width_cm,
        }
    }

    #[test]
    fn one_branch_is_the_ladder_of_cells_under_every_drive() {
        let model = model(&[(3.0, 0.0197)]);
        let laminate = Laminate {
            electrode_resistance_ohm_per_sq: 4.5,
            branch: model.branches[0],
            steady_state_resistance_ohm_cm2: 42.9,
            coupling: CurvaturePerTotalCharge(2.0).areal(&OF),
            relaxation_rate_per_s: 0.02,
        };
        let distributed = laminate.strip(&OF);
        let cells = 300;
        let ladder = Ladder::new(&distributed, cells).unwrap();
        let times = [1.01, 1.3, 2.9, 3.2, 5.5, 6.5, 20.0];
        let expected = ladder.respond(&pulses(), &times, 1e-9);
        let found = strip(&model, 4.5)
            .respond(&pulses(), &expected.arc_length_cm, &times)
            .unwrap();
        for (k, time) in times.iter().enumerate() {
            let current = expected.clamp_current_a[k];
            assert!((found.current_a[k] / current - 1.0).abs() < 2e-3, "{time}");
            let profile = expected.curvature_per_cm.profile(k);
            let largest = profile.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
            for (a, b) in found.curvature_per_cm.profile(k).iter().zip(profile) {
                assert!((a - b).abs() < 2e-3 * largest, "{time}: {a} {b}");
            }
            let charge: f64 =
                expected.charge_c_per_cm.profile(k).iter().sum::<f64>() * OF.length_cm / cells as f64;
            assert!(
                (found.charge_c[k] - charge).abs() < 1e-3 * 0.0197 * 1.35 * 1.5,
                "{time}"
            );
            let mean = profile.iter().sum::<f64>() / cells as f64;
            assert!((found.mean_curvature_per_cm[k] - mean).abs() < 1e-3 * largest);
        }
    }

    #[test]
    fn two_branches_are_the_stepped_line_of_the_effect() {
        let model = model(&[(3.0, 0.02), (15.0, 0.1)]);
        let drive = Drive::step(2.0);
        let run = RunContext {
            index: 0,
            drive: &drive,
            area_cm2: OF.area_cm2(),
            length_cm: Some(OF.length_cm),
            duration_s: 60.0,
            resolved_s: None,
            tags: &[],
            channels: &[],
        };
        let extended = ExtendedModel {
            base: model.clone(),
            effects: vec![Applied {
                effect: effect("lengthwise-resistance").unwrap(),
                variant: 0,
                parameters: vec![0.5],
            }],
        };
        let times = [0.05, 0.3, 2.0, 10.0, 60.0];
        let expected = extended.responses(&run, &times, &times);
        let found = strip(&model, 0.5).respond(&drive, &[], &times).unwrap();
        for k in 0..times.len() {
            assert!(
                (found.current_a[k] / expected.current_a[k] - 1.0).abs() < 1e-2,
                "{k}"
            );
            let bent = expected.curvature_per_cm[k];
            assert!((found.mean_curvature_per_cm[k] / bent - 1.0).abs() < 1e-2, "{k}");
        }
    }

    #[test]
    fn perfect_electrodes_make_a_lumped_strip_and_an_open_circuit_is_not_answered() {
        let model = model(&[(3.0, 0.02), (15.0, 0.1)]);
        let times = [0.5, 2.0, 4.0, 9.0];
        let found = strip(&model, 0.0).respond(&pulses(), &[1.0], &times).unwrap();
        let expected = model.curvature_per_cm(&pulses(), OF.area_cm2(), &times);
        for (k, expected) in expected.iter().enumerate() {
            assert!((found.curvature_per_cm.at(k, 0) - expected).abs() < 1e-12);
        }
        let mut open = pulses();
        open.segments[1].level = Level::OpenCircuit;
        assert_eq!(strip(&model, 4.5).respond(&open, &[], &times), None);
    }

    #[test]
    fn what_flows_in_is_stored_or_leaks() {
        let model = model(&[(3.0, 0.02), (15.0, 0.1)]);
        let drive = Drive::step(1.5);
        // Even steps of the square root of time, for the first current is the steepest.
        let (steps, end_s) = (3000, 40.0);
        let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(steps);
        let times: Vec<f64> = (0..steps).map(|k| end_s * middle(k).powi(2)).collect();
        for per_sq in [0.0, 4.5] {
            let strip = strip(&model, per_sq);
            let current = strip.respond(&drive, &[], &times).unwrap().current_a;
            let weighted = current
                .iter()
                .zip(0..)
                .map(|(current, k)| 2.0 * middle(k) * current);
            let flowed = weighted.sum::<f64>() * end_s / f64::from(steps);
            let end = strip.respond(&drive, &[], &[end_s]).unwrap();
            let kept = end.charge_c[0] + end.leaked_charge_c[0];
            assert!((flowed / kept - 1.0).abs() < 1e-3, "{per_sq}: {flowed} {kept}");
        }
    }
}
