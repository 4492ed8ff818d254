//! Lives with seasons, counted: what alarms are raised where nothing stays, and where a step or a drift does.

use ieap_domain::Alarm;
use ieap_domain::testing::{campaign, fit, known, run, tag};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{Evidence, monitor};
use crate::laws::doubt::Doubts;
use crate::laws::facts::facts;
use crate::parameters::COMPARED;

const MONTHS: usize = 48;

/// Monthly runs of a strip: two parameters follow the humidity and one the temperature, each with 2 % from run to run; beside
/// that lambda changes by `stays` of the month.
fn alarms(seed: u64, stays: impl Fn(usize) -> f64) -> Vec<Alarm> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let phase: f64 = random.random_range(0.0..1.0);
    let runs: Vec<_> = (0..MONTHS)
        .map(|month| {
            let season = (std::f64::consts::TAU * (month as f64 / 12.0 + phase)).sin();
            let mut draw = |size: f64| {
                let by: f64 = StandardNormal.sample(&mut random);
                size * by
            };
            let (humidity, warmth) = (3.0 * season + draw(0.5), 1.5 * season + draw(0.3));
            let of = [
                0.0,
                0.03 * humidity + stays(month),
                0.01 * warmth,
                0.0,
                -0.025 * humidity,
            ];
            let found: Vec<_> = (COMPARED.iter().zip(of))
                .map(|(key, y)| (*key, known(f64::exp(y + draw(0.02)), 0.005)))
                .collect();
            let mut own = run(&format!("m{month:02}"), "S1", "air", Some(35.0 + humidity), 2.0);
            own.fit = Some(fit(&found));
            own.tags.push(tag("temperature_c", &(22.0 + warmth).to_string()));
            let start = format!("{}-{:02}-05T12:00:00Z", 2024 + month / 12, 1 + month % 12);
            own.tags.push(tag("started_at", &start));
            own
        })
        .collect();
    let mut campaign = campaign();
    let wanted = [
        ("environment", "air"),
        ("voltage_v", "2.0"),
        ("relative_humidity_percent", "35"),
    ];
    campaign.monitoring.reference = wanted
        .map(|(key, value)| (key.to_owned(), value.to_owned()))
        .into();
    let facts = facts(&runs, &campaign);
    let doubts = Doubts::default();
    monitor(Evidence {
        runs: &runs,
        campaign: &campaign,
        facts: &facts,
        doubts: &doubts,
    })
    .alarms
}

/// Campaigns with an alarm of lambda, and with one of another parameter.
fn counted(seeds: std::ops::Range<u64>, stays: impl Fn(usize) -> f64) -> (usize, usize) {
    let all: Vec<Vec<Alarm>> = seeds.map(|seed| alarms(seed, &stays)).collect();
    let with = |is: &dyn Fn(&str) -> bool| {
        let has = |own: &&Vec<Alarm>| {
            let mut signs = own.iter().flat_map(|alarm| &alarm.shown_by);
            signs.any(|sign| is(&sign.parameter))
        };
        all.iter().filter(has).count()
    };
    (with(&|key| key == COMPARED[1]), with(&|key| key != COMPARED[1]))
}

#[test]
fn seasons_raise_no_alarm_and_what_stays_does() {
    let (lambda, others) = counted(0..5, |_| 0.0);
    assert!(lambda + others <= 1, "{lambda} {others}");
    let (step, _) = counted(0..5, |month| if month < 24 { 0.0 } else { 0.2 });
    let (drift, _) = counted(0..5, |month| 0.004 * month as f64);
    assert_eq!((step, drift), (5, 5));
}

/// `cargo test -p ieap-analysis --lib season_tests -- --include-ignored --nocapture`
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn counts_of_seasons() {
    println!("nothing: {:?}", counted(9000..9100, |_| 0.0));
    println!(
        "step by 20 %: {:?}",
        counted(9000..9100, |month| if month < 24 { 0.0 } else { 0.2 })
    );
    println!(
        "drift by 0.4 % a run: {:?}",
        counted(9000..9100, |month| 0.004 * month as f64)
    );
}
