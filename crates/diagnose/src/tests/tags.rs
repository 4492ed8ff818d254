//! Runs of a group that differ as a tag says.

use super::*;
use crate::cause::between::p_dealt;
use crate::readings::tags::not_asked;
use ieap_model::effects::{TagAt, tag_places};

/// Readings that are kept of each run: enough for R_ss, and short.
const READINGS: usize = 150;

/// A group of runs under one step, each with its own factor on R_ss, and the tag `pre_charge_s` of each.
struct Tagged {
    runs: Vec<Runs>,
    tags: Vec<Vec<TagAt>>,
}

impl Tagged {
    fn new(factors: &[f64], pre_charge_s: &[f64], seed: u64) -> Tagged {
        let of_run = |(k, factor): (usize, &f64)| {
            let mut own = base();
            own.steady_state_resistance_ohm_cm2 *= factor;
            let mut runs = Runs::beside(&own, &[], &[STEP], 1000 * seed + k as u64);
            for channel in &mut runs.channels[0] {
                channel.time_s = channel.time_s[..READINGS].into();
                channel.values = channel.values[..READINGS].into();
            }
            runs
        };
        Tagged {
            runs: factors.iter().enumerate().map(of_run).collect(),
            tags: places(pre_charge_s),
        }
    }

    fn inputs<'a>(&'a self) -> Vec<RunInput<'a>> {
        const NAMES: [&str; 8] = ["a", "b", "c", "d", "e", "f", "g", "h"];
        let of_run = |((runs, tags), name): ((&'a Runs, &'a Vec<TagAt>), &'static str)| RunInput {
            name,
            tags,
            ..runs.inputs()[0]
        };
        self.runs.iter().zip(&self.tags).zip(NAMES).map(of_run).collect()
    }

    fn diagnosed(&self, draws: usize) -> GroupDiagnosis {
        let options = DiagnoseOptions {
            draws,
            ..DiagnoseOptions::default()
        };
        diagnose_group("group", &self.inputs(), &options)
    }
}

fn places(pre_charge_s: &[f64]) -> Vec<Vec<TagAt>> {
    let stated: Vec<String> = pre_charge_s.iter().map(f64::to_string).collect();
    let stated: Vec<Option<&str>> = stated.iter().map(|value| Some(value.as_str())).collect();
    tag_places("pre_charge_s", &stated)
}

/// Groups in which a tag follows nothing.
const GROUPS: u64 = 300;
/// Values of the tag in an order that goes with nothing else.
const PRE_CHARGE_S: [f64; 8] = [600.0, 0.0, 300.0, 900.0, 60.0, 1200.0, 150.0, 750.0];

#[test]
fn a_resistance_that_follows_a_tag_is_told_with_its_size() {
    let factors = PRE_CHARGE_S.map(|s| 1.5_f64.powf((s - 495.0) / 1200.0));
    let found = Tagged::new(&factors, &PRE_CHARGE_S, 1).diagnosed(199);
    assert!(found.verdict.names_a_cause(), "{}", found.sentence);
    let own = &found.effects[0];
    assert_eq!(own.effect, "follows:pre_charge_s", "{}", found.sentence);
    assert_eq!(own.variant.as_deref(), Some("r-ss"));
    assert!(own.p < 0.01 && found.set.len() == 1, "{} {:?}", own.p, found.set);
    let size = &own.parameters[0].estimate;
    assert!(
        size.low_95.unwrap() < 0.5 && 0.5 < size.high_95.unwrap(),
        "{size:?}"
    );
    assert!(
        found
            .sentence
            .contains("follows pre_charge_s from run to run) in r-ss: "),
        "{}",
        found.sentence
    );
}

/// R_ss scatters from run to run by far more than the noise, and goes with nothing: in 300 groups no more are below a level
/// than the level says. The chance is that of any order, not of the readings' noise, by which every group would be told.
#[test]
fn a_tag_beside_which_runs_only_scatter_is_told_at_its_stated_rate() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut scatter = || -> f64 {
        let own: f64 = StandardNormal.sample(&mut random);
        (0.05 * own).exp()
    };
    let factors: Vec<f64> = (0..8).map(|_| scatter()).collect();
    let tagged = Tagged::new(&factors, &PRE_CHARGE_S, 2);
    let inputs = tagged.inputs();
    let raw = group::RunGroup::new(&inputs);
    let fitted = base_fit::base_fit(&raw, DiagnoseOptions::default().model).unwrap();
    let mut values = PRE_CHARGE_S;
    let mut shuffle = ChaCha8Rng::seed_from_u64(8);
    let mut below = [0.0; 2];
    for seed in 0..GROUPS {
        for k in (1..values.len()).rev() {
            values.swap(k, rand::RngExt::random_range(&mut shuffle, 0..=k));
        }
        let tags = places(&values);
        let mut group = raw.clone();
        for (run, tags) in group.runs.iter_mut().zip(&tags) {
            run.given.tags = tags;
        }
        let [(_, p)] = p_dealt(&group, &fitted, 199, seed).try_into().unwrap();
        for (count, level) in below.iter_mut().zip([0.01, 0.2]) {
            *count += f64::from(u8::from(p < level));
        }
    }
    for (count, level) in below.into_iter().zip([0.01, 0.2]) {
        let due = level * GROUPS as f64;
        let range = 3.0 * (due * (1.0 - level)).sqrt();
        assert!((count - due).abs() < range, "{count} of {GROUPS} below {level}");
    }
}

impl Tagged {
    /// The chance of the tag beside the base.
    fn p(&self, seed: u64) -> f64 {
        let inputs = self.inputs();
        let raw = group::RunGroup::new(&inputs);
        let model = DiagnoseOptions::default().model;
        let first = base_fit::base_fit(&raw, model).unwrap();
        let [(_, p)] = p_dealt(&raw, &first, 199, seed).try_into().unwrap();
        p
    }
}

#[test]
fn with_nothing_hidden_a_tag_is_not_told() {
    for seed in 0..3 {
        let found = Tagged::new(&[1.0; 8], &PRE_CHARGE_S, 20 + seed).diagnosed(199);
        assert!(
            found.set.is_empty() && found.effects.is_empty(),
            "{}",
            found.sentence
        );
        assert!(found.p_misfit.unwrap() >= 0.01, "{}", found.sentence);
        // It was among the questions.
        let asked = |own: &ieap_domain::Candidate| own.effect == "follows:pre_charge_s";
        assert!(found.candidates.len() >= 20 || found.candidates.iter().any(asked));
    }
}

#[test]
fn values_that_go_with_the_voltage_or_differ_in_too_few_runs_are_not_told() {
    // Resistances that fall with the voltage, beside a tag that rises with it: it could be either.
    let mut tagged = Tagged::new(
        &[1.3, 1.2, 1.1, 1.0, 0.9, 0.8],
        &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
        3,
    );
    for (k, runs) in tagged.runs.iter_mut().enumerate() {
        runs.drives[0].segments[0].level = Level::Voltage(0.5 + 0.3 * k as f64);
    }
    assert!(tagged.p(1) > 0.5);
    let few = Tagged::new(&[1.0; 4], &[1.0, 2.0, 3.0, 4.0], 4);
    let inputs = few.inputs();
    let said = not_asked(&group::RunGroup::new(&inputs));
    assert_eq!(said.len(), 1);
    assert!(said[0].contains("4 runs in 24 orders"), "{said:?}");
}
