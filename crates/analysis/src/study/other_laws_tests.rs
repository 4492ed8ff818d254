//! Laws of what differs beside what the study compares, with a known truth; and parameters brought from one place to another.

use ieap_domain::testing::{campaign, fit, known, run, tag};
use ieap_domain::{Campaign, RunRecord, Sample};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use super::*;
use crate::laws::Covariate;
use crate::laws::doubt::Doubts;

/// Three strips, eight runs each at two voltages: the temperature goes up and down, every other run is with instrument B.
/// The logarithm of lambda is `of` of the temperature and of the instrument.
fn simulated(seed: u64, of: impl Fn(f64, bool) -> f64) -> (Vec<RunRecord>, Campaign) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, 0.05).unwrap();
    let mut draw = || normal.sample(&mut random);
    let mut campaign = campaign();
    let (mut runs, like) = (Vec::new(), campaign.samples[0].clone());
    campaign.samples = Vec::new().into();
    for s in 0..3 {
        let id = format!("T{s}");
        campaign.samples.push(Sample {
            id: id.clone(),
            ..like.clone()
        });
        let level = 4.0 * draw();
        for (k, celsius) in [20.0, 32.0, 24.0, 36.0, 28.0, 20.0, 32.0, 24.0]
            .into_iter()
            .enumerate()
        {
            let is_b = (k / 2 + s) % 2 == 1;
            let y = level + of(celsius, is_b) + draw();
            let volts = [1.0, 1.0, 2.0, 2.0, 1.0, 2.0, 2.0, 1.0][k];
            let mut own = run(&format!("{id}-{k}"), &id, "air", Some(35.0), volts);
            own.fit = Some(fit(&[("lambda_per_s", known(1e-4 * f64::exp(y), 1e-6))]));
            own.tags.push(tag("temperature_c", &celsius.to_string()));
            own.tags.push(tag("cycle", &(k + 1).to_string()));
            own.tags.push(tag("instrument", if is_b { "B" } else { "A" }));
            runs.push(own);
        }
    }
    (runs, campaign)
}

fn others(runs: &[RunRecord], campaign: &Campaign) -> Vec<Answer> {
    let doubts = Doubts::default();
    let study = Study::of(Evidence {
        runs,
        campaign,
        doubts: &doubts,
        curves: &[],
    });
    let is_other = |own: &Answer| own.kind == Kind::OtherLaw && own.parameter == "lambda_per_s";
    study.answers.into_iter().filter(is_other).collect()
}

#[test]
fn temperature_and_instrument_are_told_and_use_is_not() {
    let (runs, campaign) = simulated(3, |celsius, is_b| {
        0.04 * (celsius - 28.0) + f64::from(u8::from(is_b)) * 0.3
    });
    let found = others(&runs, &campaign);
    let of = |key: &str| {
        let own = found.iter().find(|own| own.covariate == Some(key));
        own.unwrap_or_else(|| {
            panic!(
                "{key}: {:?}",
                found.iter().map(|own| own.covariate).collect::<Vec<_>>()
            )
        })
    };
    let holds = |own: &Answer, truth: f64| own.low_95.unwrap() <= truth && truth <= own.high_95.unwrap();
    let (temperature, instrument, cycle) = (of("temperature_c"), of("instrument"), of("cycle"));
    assert!(
        temperature.verdict == Verdict::Differs && holds(temperature, 0.04),
        "{temperature:#?}"
    );
    assert_eq!(temperature.from_to, Some((20.0, 36.0)));
    assert!(
        instrument.verdict == Verdict::Differs && holds(instrument, 0.3),
        "{instrument:#?}"
    );
    assert_eq!(
        (instrument.upper.as_str(), instrument.lower.as_str()),
        ("instrument B", "A")
    );
    assert!(
        cycle.verdict != Verdict::Differs && holds(cycle, 0.0),
        "{cycle:#?}"
    );
    // What is set is asked about, what tells how a strip was used is a detail.
    let asked = found.iter().filter(|own| own.is_of_study);
    assert!(asked.eq([temperature]));
}

#[test]
fn where_nothing_is_followed_little_is_claimed() {
    let claims = |seed: u64| {
        let (runs, campaign) = simulated(100 + seed, |_, _| 0.0);
        let found = others(&runs, &campaign);
        assert!(
            found.len() >= 3 && found.iter().all(|own| own.p.is_some()),
            "{found:#?}"
        );
        found.iter().filter(|own| own.verdict == Verdict::Differs).count()
    };
    let told = (0..40).filter(|&seed| claims(seed) > 0).count();
    // At 5 % more than six of 40 come by chance in 1 of 50 such counts.
    assert!(told <= 6, "{told} of 40");
}

#[test]
fn a_course_that_bends_is_followed_and_its_error_holds_what_is_left() {
    let truth = |celsius: f64| (1.0_f64 + 0.15 * (celsius - 20.0)).ln();
    let mut held = 0;
    for seed in 0..40 {
        let (runs, campaign) = simulated(200 + seed, |celsius, _| truth(celsius));
        let evidence = Evidence {
            runs: &runs,
            campaign: &campaign,
            doubts: &Doubts::default(),
            curves: &[],
        };
        let all = courses(&evidence, "CNaf", Covariate::Temperature);
        let [course] = &all[..] else {
            panic!("{all:?}");
        };
        assert_eq!(course.directions(), 3);
        let factor = course.factor(20.0, 30.0);
        let error: f64 = (course.factors_one_error_off(20.0, 30.0).iter())
            .map(|off| (off / factor).ln().powi(2))
            .sum();
        held += usize::from((factor.ln() - truth(30.0)).abs() < 2.0 * error.sqrt());
    }
    assert!(held >= 33, "{held} of 40");
}

/// A condition that nobody named in `[study]` is asked about, and told; one that somebody left out is not.
#[test]
fn a_condition_of_ones_own_is_asked_about_where_the_study_is_left_open() {
    let (mut runs, mut campaign) = simulated(5, |celsius, _| 0.06 * (celsius - 28.0));
    // The temperature under a name that campaign.toml declares.
    campaign.extra_tags = vec!["bath_c".to_owned()];
    for own in &mut runs {
        let celsius = own
            .tags
            .iter_mut()
            .find(|tag| tag.key == "temperature_c")
            .unwrap();
        celsius.key = "bath_c".to_owned();
    }
    let asked = |campaign: &Campaign| {
        let doubts = Doubts::default();
        let study = Study::of(Evidence {
            runs: &runs,
            campaign,
            doubts: &doubts,
            curves: &[],
        });
        (study.other_conditions(), first_screen(&study, None).join(" "))
    };
    let (conditions, said) = asked(&campaign);
    assert_eq!(conditions, ["bath_c"]);
    assert!(
        said.contains("With the bath_c from 20 to 36") && said.contains("λ rises"),
        "{said}"
    );
    campaign.study.compare = vec![ieap_domain::Factor::Voltage];
    let (conditions, said) = asked(&campaign);
    assert!(conditions.is_empty() && !said.contains("bath_c"), "{said}");
}
