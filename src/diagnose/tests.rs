//! Groups with known truth, and what each part of a diagnosis makes of them.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::beside::Beside;
use super::signature::{directions, scale, signatures};
use super::*;
use crate::domain::{Channel, Drive, Level, Quantity, Segment, Verdict};
use crate::fit::FitInput;
use crate::model::truth::{HiddenEffect, Truth, simulate};
use crate::model::{Branch, LumpedModel};

const AREA_CM2: f64 = 0.1;
const LENGTH_CM: f64 = 0.5;
/// Standard deviation of the noise in parts of the largest current and of the bending of the whole charge.
const NOISE: [f64; 2] = [0.004, 0.006];

/// Steps of the voltage: start, s, and V.
type Levels = &'static [(f64, f64)];

const STEP: Levels = &[(0.0, 2.0)];
const HALF: Levels = &[(0.0, 1.0)];
const REVERSED: Levels = &[(0.0, -2.0)];
const DISCHARGED: Levels = &[(0.0, 2.0), (300.0, 0.0)];

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

fn base() -> LumpedModel {
    let branch = |resistance_ohm_cm2, capacitance_f_per_cm2| Branch {
        resistance_ohm_cm2,
        capacitance_f_per_cm2,
    };
    LumpedModel {
        branches: vec![branch(30.0, 0.03), branch(120.0, 0.15)],
        steady_state_resistance_ohm_cm2: 3000.0,
        charge_to_curvature_per_c_cm: 20.0,
        relaxation_rate_per_s: 0.01,
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
        let base = base();
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
        let of_drive = |levels: &Levels| Drive {
            baseline_v: 0.0,
            segments: levels
                .iter()
                .map(|&(start_s, v)| Segment {
                    start_s,
                    level: Level::Voltage(v),
                })
                .collect(),
        };
        let drives: Vec<Drive> = drives.iter().map(of_drive).collect();
        let peak_a = AREA_CM2 * 2.0 * (1.0 / 30.0 + 1.0 / 120.0);
        let bend_per_cm = AREA_CM2 * 2.0 * 0.18 * 20.0;
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
        const NAMES: [&str; 4] = ["first", "second", "third", "fourth"];
        let each = self.drives.iter().zip(&self.channels).zip(NAMES);
        each.map(|((drive, channels), name)| RunInput {
            name,
            input: FitInput {
                channels,
                drive,
                area_cm2: AREA_CM2,
            },
            length_cm: Some(LENGTH_CM),
        })
        .collect()
    }

    fn diagnosed(&self) -> GroupDiagnosis {
        diagnose_group("group", &self.inputs(), &DiagnoseOptions::default())
    }
}

/// The base with that effect, searched from its best probe to the end, and what was forecast there.
fn from_best_probe<'g>(
    base: &fitted::Fitted<'g>,
    scale: &crate::model::effects::Scale,
    id: &str,
) -> Option<(f64, fitted::Fitted<'g>)> {
    let all = signatures(&base.problem, &base.at, scale);
    let (_, tangent) = base.tangent();
    let residuals = base.residuals();
    let best = directions(&all, &tangent)
        .into_iter()
        .filter(|direction| direction.effect == id)
        .max_by(|a, b| null::gain(a, &residuals).total_cmp(&null::gain(b, &residuals)))?;
    let signature = &all[best.signature];
    let strength = signature.part * crate::numerics::sums::dot(&best.unit, &residuals) / best.norm;
    let fitted = Beside::of(base).extended(signature, strength)?.arrived();
    Some((null::gain(&best, &residuals), fitted))
}

/// Falls of the sum of squares by a full search for each effect, from its best probe to the end: id, forecast,
/// fall.
fn searched(runs: &Runs, ids: &[&str]) -> Vec<(String, f64, f64)> {
    let inputs = runs.inputs();
    let raw = group::Group::new(&inputs);
    with_base(&raw, DiagnoseOptions::default().model, |group, base| {
        let scale = scale(group, &base.problem, &base.at);
        let of = |id: &&str| {
            let (forecast, fitted) = from_best_probe(&base, &scale, id)?;
            Some(((*id).to_owned(), forecast, base.square - fitted.square))
        };
        ids.iter().filter_map(of).collect()
    })
    .unwrap()
}

/// Under one step a refit takes up nine tenths of these: from the strength alone the search ended at a third of the fall.
#[test]
fn a_strong_effect_that_a_refit_takes_up_is_found_from_where_the_others_made_room() {
    let hidden: Hidden = ("partial-relaxation", None, &[("fraction", 0.2)]);
    let runs = Runs::with(Some(hidden), &[STEP], 3);
    let found = searched(&runs, &["partial-relaxation", "moisture-bending", "creep"]);
    assert_eq!(found.len(), 3);
    let (_, forecast, truth) = &found[0];
    assert!(*forecast > 1000.0 && *truth > *forecast, "{found:?}");
    // Nothing explains more than the truth does but for the noise that a further parameter takes up.
    for (id, _, other) in &found[1..] {
        assert!(*other < truth + 12.0, "{id}: {found:?}");
    }
}

/// Only the free twin agrees: the law without free strength is contradicted by more than two standard errors.
#[test]
fn a_law_without_free_strength_does_not_win_against_readings_that_contradict_it() {
    let hidden: Hidden = ("partial-relaxation", None, &[("fraction", 0.15)]);
    let found = Runs::with(Some(hidden), &[STEP, HALF], 4).diagnosed();
    assert!(
        found.set.iter().any(|id| id == "partial-relaxation"),
        "{:?} {}",
        found.set,
        found.sentence
    );
}

/// Two stretches of one run's time do not decide between causes that explain all of it as well.
#[test]
fn from_one_step_a_strong_cause_is_a_set_that_holds_it() {
    for seed in 0..3 {
        let hidden: Hidden = ("partial-relaxation", None, &[("fraction", 0.2)]);
        let found = Runs::with(Some(hidden), &[STEP], 20 + seed).diagnosed();
        assert_eq!(found.verdict, Verdict::Set, "{}", found.sentence);
        assert!(
            found.set.iter().any(|id| id == "partial-relaxation"),
            "{:?}",
            found.set
        );
    }
}

#[test]
fn a_clean_group_is_consistent_and_says_what_it_could_not_have_seen() {
    let found = Runs::with(None, &[STEP, REVERSED], 5).diagnosed();
    assert_eq!(found.verdict, Verdict::Consistent, "{}", found.sentence);
    assert!(found.effects.is_empty() && found.set.is_empty());
    assert!(found.candidates.len() > 10 && found.candidates.iter().all(|c| !c.accepted));
    assert!(found.candidates.iter().all(|c| c.detectable_strength != 0.0));
}

/// The fall is counted from the base refitted without the part: where the base is right neither predicts better.
#[test]
fn without_a_cause_the_nameless_answer_predicts_no_better_than_the_base() {
    let runs = Runs::with(None, &[STEP, HALF, REVERSED, DISCHARGED], 6);
    let inputs = runs.inputs();
    let raw = group::Group::new(&inputs);
    let falls = with_base(&raw, DiagnoseOptions::default().model, |group, base| {
        let before = held_out::parts(&base, group);
        discrepancy::falls(&base, group, &before)
    })
    .unwrap();
    assert_eq!(falls.len(), 4);
    assert!(falls.iter().sum::<f64>() < select::BEATEN, "{falls:?}");
}

/// A capacitance that follows the voltage is no linear memory of it: half a voltage tells nothing of the whole.
#[test]
fn a_cause_beats_the_nameless_answer_where_a_voltage_was_not_seen() {
    let hidden: Hidden = (
        "voltage-dependent-capacitance",
        None,
        &[("quadratic_per_v2", 0.05)],
    );
    let found = Runs::with(Some(hidden), &[STEP, HALF, REVERSED, DISCHARGED], 7).diagnosed();
    let gain = found
        .gain
        .as_ref()
        .unwrap_or_else(|| panic!("{}", found.sentence));
    assert!(
        gain.deviance > gain.nameless_deviance + select::BEATEN,
        "{gain:?}"
    );
    assert!(
        found.set.iter().any(|id| id == "voltage-dependent-capacitance"),
        "{}",
        found.sentence
    );
}

/// Eight voltages; the noise of the current rises a hundredfold with them, as bubbles would have it.
#[test]
fn noise_that_grows_with_the_voltage_is_remarked_and_even_noise_is_not() {
    let time_s: Vec<f64> = (1..=100).map(f64::from).collect();
    let drives: Vec<Drive> = (0..8)
        .map(|k| Drive {
            baseline_v: 0.0,
            segments: vec![Segment {
                start_s: 0.0,
                level: Level::Voltage(-0.1 * f64::from(k + 1)),
            }],
        })
        .collect();
    let remarked = |growth: f64| {
        let mut random = ChaCha8Rng::seed_from_u64(9);
        let channels: Vec<Vec<Channel>> = drives
            .iter()
            .map(|drive| {
                let v = drive.segments[0].start_s - drive.nominal_step_v();
                let sd = 1e-6 * growth.powf(v / 0.8);
                let values: Vec<f64> = time_s
                    .iter()
                    .map(|t| {
                        let own: f64 = StandardNormal.sample(&mut random);
                        1e-3 * v * ((-t / 8.0).exp() + 0.01) + sd * own
                    })
                    .collect();
                vec![Channel::new(
                    Quantity::Current,
                    time_s.clone().into(),
                    values.into(),
                )]
            })
            .collect();
        let inputs: Vec<RunInput> = drives
            .iter()
            .zip(&channels)
            .map(|(drive, channels)| RunInput {
                name: "run",
                input: FitInput {
                    channels,
                    drive,
                    area_cm2: AREA_CM2,
                },
                length_cm: None,
            })
            .collect();
        let group = group::Group::new(&inputs);
        louder::remarks(&group)
    };
    let [remark] = remarked(100.0).try_into().unwrap();
    assert!(
        remark.starts_with("the noise of the current grows with the voltage: from"),
        "{remark}"
    );
    assert!(remarked(1.0).is_empty());
}

const FOUR: &[Levels] = &[STEP, HALF, REVERSED, DISCHARGED];

impl Runs {
    /// The same with one channel (current 0, bending 1) of a run times `factor`.
    fn scaled(mut self, run: usize, channel: usize, factor: f64) -> Runs {
        let values = &mut self.channels[run][channel].values;
        *values = values.iter().map(|v| factor * v).collect();
        self
    }
}

#[test]
fn a_wrong_unit_and_a_turned_sign_are_faults_of_the_readings() {
    for (run, channel, factor, said) in [
        (1, 0, 1000.0, "The current of second is 1000 times"),
        (2, 1, 0.01, "The bending of third is 0.01 times"),
        (1, 1, -1.0, "The bending of second has the sign opposite"),
        (3, 0, -1.0, "The current of fourth has the sign opposite"),
    ] {
        let found = Runs::with(None, FOUR, 7).scaled(run, channel, factor).diagnosed();
        assert_eq!(found.verdict, Verdict::DataProblem, "{}", found.sentence);
        assert!(found.sentence.starts_with(said), "{}", found.sentence);
        assert!(found.set.is_empty() && found.p_misfit.is_none());
    }
}

#[test]
fn what_a_strip_can_do_is_no_fault_of_the_readings() {
    let odd = |runs: &Runs| {
        let inputs = runs.inputs();
        let group = group::Group::new(&inputs);
        odd_scale::found("group", &group, DiagnoseOptions::default().model).map(|found| found.sentence)
    };
    // Twice as much is no unit; and the only run to the other side may bend as a strip does that bends one way only.
    for (run, channel, factor) in [(1, 0, 2.0), (1, 1, 0.5), (2, 1, -1.0)] {
        assert_eq!(odd(&Runs::with(None, FOUR, 7).scaled(run, channel, factor)), None);
    }
    let one_way: Hidden = ("quadratic-coupling", None, &[("quadratic_cm_per_c2", 2000.0)]);
    assert_eq!(odd(&Runs::with(Some(one_way), FOUR, 7)), None);
    // Two runs cannot say which of them is the odd one.
    assert_eq!(
        odd(&Runs::with(None, &[STEP, HALF], 7).scaled(1, 0, 1000.0)),
        None
    );
}

#[test]
fn a_strength_that_its_threshold_makes_up_for_is_no_doubt_of_the_cause() {
    // At 2 V 0.5 from 1.3 V on acts as 0.27 from 1 V on, and at 1 V neither does.
    let hidden: Hidden = (
        "threshold-relaxation",
        None,
        &[("steepness", 0.5), ("threshold_v", 1.3)],
    );
    let found = Runs::with(Some(hidden), &[STEP, HALF, REVERSED, DISCHARGED], 31).diagnosed();
    let own = found
        .effects
        .iter()
        .find(|own| own.effect == "threshold-relaxation");
    let own = own.expect("it is the cause that was fitted");
    hold(own, &[0.5, 1.3]);
}

/// What intervals are stated hold these values.
fn hold(finding: &crate::domain::EffectFinding, truths: &[f64]) {
    for (parameter, &truth) in finding.parameters.iter().zip(truths) {
        let estimate = &parameter.estimate;
        assert!(estimate.low_95.is_none_or(|low| low <= truth), "{parameter:?}");
        assert!(estimate.high_95.is_none_or(|high| high >= truth), "{parameter:?}");
    }
}

/// A leak that sets in between the levels of the drives.
const LEAK: Hidden = (
    "faradaic-leak",
    Some("terminal"),
    &[
        ("leak_current_a_per_cm2", 1e-5),
        ("onset_v", 1.2),
        ("slope_v", 0.2),
    ],
);

/// Two voltages tell one number of a leak's three: its valley crosses ten decades of the scale, and ends nowhere on the way.
#[test]
fn a_leak_of_two_voltages_has_no_scale() {
    let found = Runs::with(Some(LEAK), FOUR, 60).diagnosed();
    let own = found.effects.iter().find(|own| own.effect == "faradaic-leak");
    let own = own.unwrap_or_else(|| panic!("{}", found.sentence));
    hold(own, &[1e-5, 1.2, 0.2]);
    assert!(own.parameters[0].estimate.value.is_none(), "{:?}", own.parameters);
}

/// Searches from every probe end where the readings are explained as well, however far that is from the best: onsets of a
/// leak lie far apart. An effect with one parameter has one place.
#[test]
fn searches_from_every_probe_end_in_places_that_explain_as_well() {
    let runs = Runs::with(Some(LEAK), FOUR, 60);
    let inputs = runs.inputs();
    let raw = group::Group::new(&inputs);
    with_base(&raw, DiagnoseOptions::default().model, |group, base| {
        let scale = scale(group, &base.problem, &base.at);
        let fitted = |id: &str| from_best_probe(&base, &scale, id).unwrap().1;
        let leaking = fitted("faradaic-leak");
        let found = modes::modes(group, &leaking, 0, &scale);
        assert!(found.len() > 2, "{}", found.len());
        for mode in &found {
            let parameters = vec![mode.model.effects[0].parameters.clone()];
            let at = leaking.problem.coordinates(&mode.model.base, &parameters);
            let rise = (leaking.problem.square(&at) - leaking.square).max(0.0);
            assert!(
                (rise - mode.rise).abs() < 1e-3 * (1.0 + rise),
                "{rise} {}",
                mode.rise
            );
        }
        let onsets = || found.iter().map(|mode| mode.model.effects[0].parameters[1]);
        let (low, high) = (
            onsets().fold(f64::INFINITY, f64::min),
            onsets().fold(0.0, f64::max),
        );
        assert!(high - low > 0.3, "{low} {high}");
        assert!(modes::modes(group, &fitted("softening"), 0, &scale).is_empty());
    })
    .expect("the base is fitted");
}

#[test]
fn two_hidden_causes_are_both_needed() {
    let offset: Hidden = ("current-offset", None, &[("offset_a", 4e-5)]);
    let curved: Hidden = ("quadratic-coupling", None, &[("quadratic_cm_per_c2", 60.0)]);
    let found = Runs::hiding(&[offset, curved], FOUR, 51).diagnosed();
    let ids: Vec<&str> = found.effects.iter().map(|own| own.effect.as_str()).collect();
    assert_eq!(ids.len(), 2, "{}", found.sentence);
    for id in ["current-offset", "quadratic-coupling"] {
        assert!(found.set.iter().any(|own| own == id), "{:?}", found.set);
    }
}

/// Current and mean bending of a strip that charges from its clamp are much like those of one more branch.
#[test]
fn electrodes_that_resist_along_the_strip_are_found_without_places() {
    let hidden: Hidden = (
        "lengthwise-resistance",
        None,
        &[("electrode_resistance_ohm_per_sq", 2000.0)],
    );
    let found = Runs::with(Some(hidden), FOUR, 41).diagnosed();
    assert!(
        found.set.iter().any(|id| id == "lengthwise-resistance"),
        "{:?} {}",
        found.set,
        found.sentence
    );
    let own = &found.effects[0].parameters[0].estimate;
    assert!(
        own.low_95.unwrap() < 2000.0 && 2000.0 < own.high_95.unwrap(),
        "{own:?}"
    );
}

/// The p of what a right extension leaves is even: asked in the noise beside the base, which holds some of its misfit, it
/// was nearly always near 1. As many groups as the statement deserves with `IEAP_LONG=1`.
#[test]
fn what_a_right_extension_leaves_is_chance() {
    let groups: u64 = match std::env::var_os("IEAP_LONG") {
        Some(_) => 160,
        None => 16,
    };
    let hidden: Hidden = ("current-offset", None, &[("offset_a", 4e-5)]);
    let left = |seed| {
        let found = Runs::with(Some(hidden), &[STEP, REVERSED], 500 + seed).diagnosed();
        assert_eq!(found.effects[0].effect, "current-offset", "{}", found.sentence);
        found.p_leftover.unwrap()
    };
    let p: Vec<f64> = (0..groups).map(left).collect();
    for limit in [0.05, 0.5] {
        let below = p.iter().filter(|p| **p < limit).count() as f64;
        let due = limit * groups as f64;
        // Three standard deviations, and one group more where few are due.
        let range = 3.0 * (due * (1.0 - limit)).sqrt() + f64::from(due < 3.0);
        assert!(
            (below - due).abs() < range,
            "{below} of {groups} below {limit}, {due} due"
        );
    }
}

/// A resistance that comes and goes leaves no mean over any stretch and is like no effect of the library: it is seen by how
/// unequally the edges are answered.
#[test]
fn what_wanders_from_edge_to_edge_is_seen_and_not_named() {
    let wandering: Hidden = ("x-limit-cycle", None, &[("modulation", 0.05), ("period_s", 80.0)]);
    let found = Runs::with(Some(wandering), &[STEP, PULSES], 5).diagnosed();
    assert_eq!(found.verdict, Verdict::Unknown, "{}", found.sentence);
    assert!(
        found
            .sentence
            .contains("the current answers the 30 edges of the drive of second unequally"),
        "{}",
        found.sentence
    );
    let clean = Runs::with(None, &[STEP, PULSES], 5).diagnosed();
    assert_eq!(clean.verdict, Verdict::Consistent, "{}", clean.sentence);
}

/// Answers to edges are asked where there are many, each over its own readings, none twice.
#[test]
fn every_reading_after_an_edge_is_of_one_answer() {
    let runs = Runs::with(None, &[DISCHARGED, PULSES], 1);
    let inputs = runs.inputs();
    let raw = group::Group::new(&inputs);
    with_base(&raw, DiagnoseOptions::default().model, |group, base| {
        let all = stretch::stretches(group, &base);
        let answers = all.iter().filter(|own| own.kind == stretch::Kind::Answer);
        let mut rows: Vec<usize> = answers.clone().flat_map(|own| own.rows.clone()).collect();
        assert_eq!(answers.clone().count(), 60);
        assert!(answers.clone().all(|own| group.blocks[own.block].run == 1));
        let squares = all
            .iter()
            .map(|own| own.weights.iter().map(|w| w * w).sum::<f64>());
        assert!(squares.into_iter().all(|square| (square - 1.0).abs() < 1e-9));
        rows.sort_unstable();
        assert!(rows.windows(2).all(|pair| pair[0] + 1 == pair[1]));
        assert_eq!(rows.len(), 1200);
    })
    .expect("the base is fitted");
}

/// Correlations of the noise of the current in every run, and whether they share it.
fn correlations(runs: &Runs) -> Vec<(f64, bool)> {
    let inputs = runs.inputs();
    let raw = group::Group::new(&inputs);
    let found = with_base(&raw, DiagnoseOptions::default().model, |group, _| {
        let currents = group.runs.iter().filter_map(|run| run.channels[0].as_ref());
        let of = |channel: &crate::fit::WhitenedChannel| {
            let first = channel.character().autoregression.first().copied();
            (first.unwrap_or(0.0), channel.is_shared())
        };
        currents.map(of).collect()
    });
    found.unwrap_or_default()
}

/// Noise of one instrument has one memory, which is known better from all runs; where a run's is another, each keeps its own.
#[test]
fn runs_share_the_memory_of_their_noise_unless_it_differs() {
    let mut runs = Runs::with(None, &[STEP, HALF, DISCHARGED], 8);
    let alike = correlations(&runs);
    assert_eq!(alike.len(), 3);
    assert!(alike.iter().all(|own| own.1 && *own == alike[0]), "{alike:?}");
    assert!(alike[0].0.abs() < 0.08, "{alike:?}");

    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut state = 0.0;
    let slow = |value: &f64| -> f64 {
        let fresh: f64 = StandardNormal.sample(&mut random);
        state = 0.8 * state + fresh;
        value + 1e-3 * state
    };
    let current = &mut runs.channels[1][0];
    current.values = current.values.iter().map(slow).collect::<Vec<f64>>().into();
    let different = correlations(&runs);
    assert!(different.iter().all(|own| !own.1), "{different:?}");
    assert!(different[1].0 > different[0].0 + 0.2, "{different:?}");
}
