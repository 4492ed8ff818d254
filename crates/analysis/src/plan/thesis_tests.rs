//! Plans for designs that are known to be tied.

use std::collections::BTreeMap;

use super::deconfound::plan;
use super::policy::MOST_RUNS;
use super::words;
use crate::laws::covariate::Covariate;
use crate::laws::design::{Level, rows};
use crate::laws::facts::{Known, RunFacts};
use crate::laws::find::TiedSet;
use ieap_domain::testing::campaign;
use ieap_domain::{Campaign, Sample};

fn fact(sample: &str, numbers: &[(Covariate, f64)], names: &[(Covariate, &str)]) -> RunFacts {
    let known = |&(covariate, value): &(Covariate, f64)| {
        let standard_error = None;
        (
            covariate,
            Known {
                value,
                standard_error,
            },
        )
    };
    RunFacts {
        run: 0,
        sample: sample.to_owned(),
        material: "m".to_owned(),
        numbers: numbers.iter().map(known).collect(),
        names: names.iter().map(|&(c, name)| (c, name.to_owned())).collect(),
    }
}

/// Environments one after the other, voltages rising in each.
fn thesis(samples: &[&str], humid: bool) -> Vec<RunFacts> {
    let mut facts = Vec::new();
    for sample in samples {
        for (e, environment) in ["vacuum", "inert", "air"].iter().enumerate() {
            for (v, volts) in ["1.20", "2.00", "2.50"].iter().enumerate() {
                let cycle = (3 * e + v + 1) as f64;
                let mut numbers = vec![(Covariate::Cycle, cycle), (Covariate::RunOrder, cycle)];
                if humid {
                    numbers.push((Covariate::RelativeHumidity, [0.0, 1.0, 34.0][e]));
                }
                let names = [
                    (Covariate::Environment, *environment),
                    (Covariate::Voltage, *volts),
                ];
                facts.push(fact(sample, &numbers, &names));
            }
        }
    }
    facts
}

fn tied_of(facts: &[RunFacts], level: Level) -> Vec<TiedSet> {
    let places: Vec<usize> = (0..facts.len()).collect();
    let levels = rows(facts, &places);
    let of_level = levels.iter().find(|rows| rows.level == level).unwrap();
    let several = of_level.sets.iter().filter(|set| set.len() > 1);
    several
        .map(|set| TiedSet {
            material: "m".to_owned(),
            level,
            covariates: set.clone(),
        })
        .collect()
}

fn planned(facts: &[RunFacts], campaign: &Campaign, level: Level) -> super::Deconfounding {
    let sets = tied_of(facts, level);
    assert_eq!(sets.len(), 1, "{sets:?}");
    plan(&sets[0], facts, &(0..facts.len()).collect::<Vec<_>>(), campaign)
}

/// Sets that are tied when the runs of a plan have been made, other than names of use.
fn tied_after(facts: &[RunFacts], plan: &super::Deconfounding, campaign: &Campaign) -> Vec<Vec<Covariate>> {
    let mut facts = facts.to_vec();
    let mut places: Vec<usize> = (0..facts.len()).collect();
    let material = super::future::Material::of("m", campaign, &facts, &places);
    for step in &plan.steps {
        material.append(&mut facts, &mut places, &step.setting);
    }
    let sets = rows(&facts, &places).into_iter().flat_map(|rows| rows.sets);
    sets.filter(|set| {
        let mut classes: Vec<Covariate> = set.iter().map(|one| super::ties::class(*one)).collect();
        classes.dedup();
        classes.len() > 1
    })
    .collect()
}

#[test]
fn the_order_of_the_thesis_is_untied_by_going_back() {
    let facts = thesis(&["CNaf-01"], false);
    let found = planned(&facts, &campaign(), Level::Within);
    assert!(found.inflation_before > 5.0 && found.is_reached(), "{found:#?}");
    assert!((1..=4).contains(&found.steps.len()), "{:#?}", found.steps);
    assert!(found.left.is_empty(), "{:?}", found.left);
    // The first run goes back: to the first environment, or to the lowest voltage.
    let first = &found.steps[0].setting.names;
    assert!(
        first[&Covariate::Environment] == "vacuum" || first[&Covariate::Voltage] == "1.20",
        "{first:?}"
    );
    assert_eq!(
        tied_after(&facts, &found, &campaign()),
        Vec::<Vec<Covariate>>::new()
    );
}

#[test]
fn every_run_of_a_plan_loosens_and_is_said_by_how_much() {
    let facts = thesis(&["CNaf-01", "CNaf-02"], false);
    let found = planned(&facts, &campaign(), Level::Within);
    for pair in found.steps.windows(2) {
        assert_eq!(pair[0].inflation_after, pair[1].inflation_before);
    }
    assert!(found.steps.len() <= MOST_RUNS);
    assert!(found.inflation_after < found.inflation_before, "{found:#?}");
    assert!(
        found.steps.iter().all(|step| !step.splits.is_empty()),
        "{found:#?}"
    );
    let sentence = words::reached(&found).remove(0);
    assert!(
        sentence.contains(" more to tell ") && !sentence.contains("infinity"),
        "{sentence}"
    );
}

#[test]
fn a_humidity_that_is_the_environment_needs_another_humidity() {
    let facts = thesis(&["CNaf-01"], true);
    let found = planned(&facts, &campaign(), Level::Within);
    assert!(found.is_reached() && found.left.is_empty(), "{found:#?}");
    // In the environment that is not dry, a third of the way from 0 (of which 1 is no other level) to 34 %.
    let mut new = found.steps.iter().filter(|step| step.setting.is_new_humidity);
    let step = new.next().unwrap_or_else(|| panic!("{found:#?}"));
    assert_eq!(step.setting.names[&Covariate::Environment], "air");
    assert_eq!(step.setting.numbers[&Covariate::RelativeHumidity], 11.0);
    assert_eq!(
        tied_after(&facts, &found, &campaign()),
        Vec::<Vec<Covariate>>::new()
    );
}

/// Where every environment is dry no new humidity is asked for, and the list says what would tell them apart.
#[test]
fn what_is_kept_dry_is_not_made_humid() {
    let mut facts = thesis(&["CNaf-01"], false);
    for fact in &mut facts {
        let humidity = match fact.names[&Covariate::Environment].as_str() {
            "vacuum" => 0.0,
            "inert" => 1.0,
            _ => 3.0,
        };
        let exact = Known {
            value: humidity,
            standard_error: None,
        };
        fact.numbers.insert(Covariate::RelativeHumidity, exact);
    }
    for found in tied_of(&facts, Level::Within)
        .iter()
        .map(|set| plan(set, &facts, &(0..facts.len()).collect::<Vec<_>>(), &campaign()))
    {
        assert!(
            found.steps.iter().all(|step| !step.setting.is_new_humidity),
            "{found:#?}"
        );
    }
}

#[test]
fn a_batch_at_each_humidity_is_untied_by_one_at_both() {
    let mut campaign = campaign();
    campaign.samples = Default::default();
    let mut facts = Vec::new();
    for (batch, humidity) in [("A", 20.0), ("B", 80.0)] {
        for k in 0..2 {
            let sample = format!("{batch}{k}");
            for volts in ["1.20", "2.00"] {
                let names = [
                    (Covariate::Environment, "air"),
                    (Covariate::Voltage, volts),
                    (Covariate::Batch, batch),
                ];
                facts.push(fact(&sample, &[(Covariate::RelativeHumidity, humidity)], &names));
            }
            campaign.samples.push(Sample {
                id: sample,
                material: "m".to_owned(),
                batch: Some(batch.to_owned()),
                ..campaign_sample()
            });
        }
    }
    let found = planned(&facts, &campaign, Level::Between);
    assert_eq!(found.inflation_before, f64::INFINITY);
    assert!(found.is_reached() && !found.steps.is_empty(), "{found:#?}");
    let mut at: BTreeMap<String, f64> = BTreeMap::new();
    for step in &found.steps {
        at.insert(
            step.setting.sample.clone(),
            step.setting.numbers[&Covariate::RelativeHumidity],
        );
    }
    // Each goes to the humidity that it was not measured at.
    for (sample, humidity) in at {
        assert_eq!(
            humidity,
            if sample.starts_with('A') { 80.0 } else { 20.0 },
            "{sample}"
        );
    }
}

/// Where no run at hand unties a batch from its humidity, the list says which sample would.
#[test]
fn a_batch_that_no_run_unties_asks_for_another_sample_of_it() {
    let set = TiedSet {
        material: "m".to_owned(),
        level: Level::Between,
        covariates: vec![Covariate::RelativeHumidity, Covariate::Batch],
    };
    let fact_of = |sample: &str, batch: &str, humidity| {
        fact(
            sample,
            &[(Covariate::RelativeHumidity, humidity)],
            &[(Covariate::Batch, batch)],
        )
    };
    let facts = [fact_of("A0", "A", 20.0), fact_of("B0", "B", 80.0)];
    let pair = (Covariate::RelativeHumidity, Covariate::Batch);
    assert_eq!(
        words::would(&set, &facts, &[0, 1], &[pair]),
        [
            "no run in a condition of the design tells relative humidity from batch: another sample of batch B, measured at relative humidity 20 % RH, would."
        ]
    );
}

fn campaign_sample() -> Sample {
    campaign().samples[0].clone()
}

#[test]
fn an_unused_sample_is_taken_from_the_other_end() {
    let mut campaign = campaign();
    for id in ["m-1", "m-2"] {
        campaign.samples.push(Sample {
            id: id.to_owned(),
            material: "m".to_owned(),
            ..campaign_sample()
        });
    }
    // One voltage only, two environments: nothing but another order tells them from age.
    let facts: Vec<RunFacts> = [("vacuum", 1.0), ("air", 2.0)]
        .map(|(environment, cycle)| {
            let numbers = [(Covariate::Cycle, cycle), (Covariate::RunOrder, cycle)];
            let names = [
                (Covariate::Environment, environment),
                (Covariate::Voltage, "2.00"),
            ];
            fact("m-1", &numbers, &names)
        })
        .to_vec();
    let found = planned(&facts, &campaign, Level::Within);
    assert!(found.is_reached(), "{found:#?}");
    let made: Vec<(&str, &str)> = found
        .steps
        .iter()
        .map(|step| {
            (
                step.setting.sample.as_str(),
                step.setting.names[&Covariate::Environment].as_str(),
            )
        })
        .collect();
    assert!(
        made == [("m-2", "air"), ("m-2", "vacuum")] || made.first() == Some(&("m-1", "vacuum")),
        "{made:?}"
    );
}

#[test]
fn names_of_use_alone_need_no_run_but_a_rest() {
    let facts: Vec<RunFacts> = (1..=4)
        .map(|k| {
            let numbers = [
                (Covariate::Cycle, f64::from(k)),
                (Covariate::RunOrder, f64::from(k)),
            ];
            fact(
                "m-1",
                &numbers,
                &[(Covariate::Voltage, ["1.20", "2.00"][k as usize % 2])],
            )
        })
        .collect();
    let set = TiedSet {
        material: "m".to_owned(),
        level: Level::Within,
        covariates: vec![Covariate::Cycle, Covariate::RunOrder],
    };
    let found = plan(&set, &facts, &[0, 1, 2, 3], &campaign());
    assert!(found.steps.is_empty());
    assert!(
        words::reached(&found)[0].contains("left unused"),
        "{:?}",
        words::reached(&found)
    );
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_thousand_runs_are_planned_as_well() {
    let names: Vec<String> = (0..111).map(|k| format!("CNaf-{k:03}")).collect();
    let samples: Vec<&str> = names.iter().map(String::as_str).collect();
    let facts = thesis(&samples, false);
    let begun = std::time::Instant::now();
    let found = planned(&facts, &campaign(), Level::Within);
    println!("{} runs planned in {:?}", facts.len(), begun.elapsed());
    // Six runs among a thousand loosen little, and that is said.
    assert_eq!(found.steps.len(), MOST_RUNS);
    assert!(found.inflation_after < found.inflation_before, "{found:#?}");
    let sentence = words::reached(&found).remove(0);
    assert_eq!(
        found.is_reached(),
        !sentence.contains("that is a start"),
        "{sentence}"
    );
}
