//! Runs of a group that differ as a tag says.

use super::*;
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
            tolerance_percent: 0.0,
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

/// Values of the tag in an order that goes with nothing else.
const PRE_CHARGE_S: [f64; 8] = [600.0, 0.0, 300.0, 900.0, 60.0, 1200.0, 150.0, 750.0];

#[test]
fn a_resistance_that_follows_a_tag_is_told_with_its_size() {
    let factors = PRE_CHARGE_S.map(|s| 1.5_f64.powf((s - 495.0) / 1200.0));
    let found = Tagged::new(&factors, &PRE_CHARGE_S, 1).diagnosed(199);
    assert_eq!(found.verdict, Verdict::Differs, "{}", found.sentence);
    let own = &found.differs[0];
    assert_eq!(
        (own.key.as_str(), own.with.as_str()),
        ("rss_ohm_cm2", "follows:pre_charge_s"),
        "{:#?}",
        found.posterior
    );
    assert!(own.share_percent > 80.0, "{own:?}");
    // From 0 to 1200 s.
    let ratio = own.ratio.unwrap();
    assert!(
        ratio.low_95 < 1.5 && 1.5 < ratio.high_95 && ratio.low_95 > 1.1,
        "{ratio:?}"
    );
    assert!(found.sentence.contains("with pre_charge_s"), "{}", found.sentence);
}

#[test]
fn runs_that_only_differ_follow_no_tag() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let factors: Vec<f64> = (0..8)
        .map(|_| {
            let own: f64 = StandardNormal.sample(&mut random);
            (0.8 * own).exp()
        })
        .collect();
    let found = Tagged::new(&factors, &PRE_CHARGE_S, 2).diagnosed(199);
    assert_eq!(found.verdict, Verdict::Differs, "{}", found.sentence);
    assert_eq!(found.differs[0].with, "run", "{:#?}", found.posterior);
}

#[test]
fn with_nothing_hidden_a_tag_is_not_told() {
    for seed in 0..3 {
        let found = Tagged::new(&[1.0; 8], &PRE_CHARGE_S, 20 + seed).diagnosed(199);
        assert!(
            found.set.is_empty() && found.differs.is_empty(),
            "{}",
            found.sentence
        );
        assert!(found.p_misfit.unwrap() >= 0.01, "{}", found.sentence);
    }
}
