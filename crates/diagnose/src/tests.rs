//! Groups with known truth, and what each part of a diagnosis makes of them.

mod causes;
mod climate;
mod edge_responses;
mod laboratory;
mod missing;
mod moving;
mod nested;
mod noise;
mod one_fit;
mod predicted;
mod readings;
mod tags;
mod varies;
mod zeros;

use ieap_domain::testing::branch;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::*;
use crate::cause::proof::{held_out, later};
use crate::fitting::without_outliers::with_base;
use crate::fitting::{fitted, modes};
use crate::misfit::{odd_scale, residual_bins};
use crate::readings::{group, louder};
use ieap_domain::{Channel, Drive, GroupDiagnosis, Level, Quantity, Segment, Verdict};
use ieap_fit::FitInput;
use ieap_model::{Branch, LumpedModel};
use ieap_truth::{HiddenEffect, Truth, simulate};

const AREA_CM2: f64 = 0.1;
const LENGTH_CM: f64 = 0.5;
/// Standard deviation of the noise in parts of the largest current and of the bending of the whole charge.
const NOISE: [f64; 2] = [0.004, 0.006];

/// Misfits are told however small they are.
pub(super) fn every_misfit() -> DiagnoseOptions {
    DiagnoseOptions {
        tolerance_percent: 0.0,
        ..DiagnoseOptions::default()
    }
}

/// Steps of the voltage: start, s, and V.
pub(super) type Levels = &'static [(f64, f64)];

const STEP: Levels = &[(0.0, 2.0)];
const HALF: Levels = &[(0.0, 1.0)];
const REVERSED: Levels = &[(0.0, -2.0)];
const DISCHARGED: Levels = &[(0.0, 2.0), (300.0, 0.0)];
pub(super) const FOUR: &[Levels] = &[STEP, HALF, REVERSED, DISCHARGED];

/// 2 V and none in turn, 20 s each.
const PULSES: Levels = &{
    let mut levels = [(0.0, 2.0); 30];
    let mut k = 0;
    while k < 30 {
        levels[k] = (20.0 * k as f64, if k % 2 == 0 { 2.0 } else { 0.0 });
        k += 1;
    }
    levels
};

/// An effect: id, variant, parameters with their keys.
pub(super) type Hidden = (&'static str, Option<&'static str>, &'static [(&'static str, f64)]);

pub(super) fn base() -> LumpedModel {
    sample([30.0, 0.03, 120.0, 0.15], 3000.0, 20.0, 0.01)
}

/// Resistances and capacitances of both branches in turn, the steady-state resistance, alpha and lambda.
fn sample([r1, c1, r2, c2]: [f64; 4], rss: f64, alpha: f64, lambda: f64) -> LumpedModel {
    LumpedModel {
        branches: vec![branch(r1, c1), branch(r2, c2)],
        steady_state_resistance_ohm_cm2: rss,
        charge_to_curvature_per_c_cm: alpha,
        relaxation_rate_per_s: lambda,
    }
}

/// Runs of 600 readings, one a second, by the truth simulator.
pub(super) struct Runs {
    drives: Vec<Drive>,
    channels: Vec<Vec<Channel>>,
}

impl Runs {
    pub(super) fn with(hidden: Option<Hidden>, drives: &[Levels], seed: u64) -> Runs {
        Runs::hiding(hidden.as_slice(), drives, seed)
    }

    /// With several effects at once.
    fn hiding(hidden: &[Hidden], drives: &[Levels], seed: u64) -> Runs {
        Runs::beside(&base(), hidden, drives, seed)
    }

    /// Of a sample with those base parameters.
    fn beside(base: &LumpedModel, hidden: &[Hidden], drives: &[Levels], seed: u64) -> Runs {
        let of_drive = |levels: &Levels| Drive {
            baseline_v: 0.0,
            segments: levels
                .iter()
                .map(|&(start_s, v)| Segment::at(start_s, Level::Voltage(v)))
                .collect(),
        };
        Runs::under(base, hidden, drives.iter().map(of_drive).collect(), seed)
    }

    /// Under any drives.
    fn under(base: &LumpedModel, hidden: &[Hidden], drives: Vec<Drive>, seed: u64) -> Runs {
        let effects = hidden.iter().map(|&(id, variant, parameters)| HiddenEffect {
            id: id.to_owned(),
            variant: variant.map(str::to_owned),
            parameters: parameters.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect(),
        });
        let truth = Truth {
            branches: base.branches.clone(),
            steady_state_resistance_ohm_cm2: base.steady_state_resistance_ohm_cm2,
            charge_to_curvature_per_c_cm: base.charge_to_curvature_per_c_cm,
            relaxation_rate_per_s: base.relaxation_rate_per_s,
            area_cm2: AREA_CM2,
            length_cm: Some(LENGTH_CM),
            width_cm: None,
            effects: effects.collect(),
        };
        let time_s: Vec<f64> = (1..=600).map(f64::from).collect();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut noisy = |quantity, values: &[f64], sd: f64| {
            let noise = |v: &f64| -> f64 {
                let own: f64 = StandardNormal.sample(&mut random);
                v + sd * own
            };
            let values: Vec<f64> = values.iter().map(noise).collect();
            Channel::new(quantity, time_s.clone().into(), values.into())
        };
        let first_s: f64 = base.branches.iter().map(|b| b.resistance_ohm_cm2.recip()).sum();
        let whole_f: f64 = base.branches.iter().map(|b| b.capacitance_f_per_cm2).sum();
        let peak_a = AREA_CM2 * 2.0 * first_s;
        let bend_per_cm = AREA_CM2 * 2.0 * whole_f * base.charge_to_curvature_per_c_cm;
        let channels = drives
            .iter()
            .enumerate()
            .map(|(index, drive)| {
                let found = simulate(&truth, drive, &time_s, &time_s, index).unwrap();
                vec![
                    noisy(Quantity::Current, &found.current_a, NOISE[0] * peak_a),
                    noisy(
                        Quantity::Curvature,
                        &found.curvature_per_cm,
                        NOISE[1] * bend_per_cm,
                    ),
                ]
            })
            .collect();
        Runs { drives, channels }
    }

    pub(super) fn inputs(&self) -> Vec<RunInput<'_>> {
        const NAMES: [&str; 6] = ["first", "second", "third", "fourth", "fifth", "sixth"];
        let each = self.drives.iter().zip(&self.channels).zip(NAMES);
        each.map(|((drive, channels), name)| RunInput {
            name,
            input: FitInput {
                channels,
                drive,
                area_cm2: AREA_CM2,
            },
            length_cm: Some(LENGTH_CM),
            is_right: false,
            tags: &[],
        })
        .collect()
    }

    fn diagnosed(&self) -> GroupDiagnosis {
        diagnose_group("group", &self.inputs(), &every_misfit())
    }
}
