//! Runs that tell apart what changed together, as the study has it: of two conditions of which one was always measured
//! before the other, the first is measured again after it.

use std::collections::BTreeMap;

use super::proposed::Proposal;
use super::words;
use crate::conditions::nominal_voltage_v;
use crate::laws::Covariate;
use crate::laws::facts::{RunFacts, facts};
use crate::study::{Answer, Study};
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, RunRecord};

/// Names of how far a strip was used, the nearest to a cause first.
const USE: [Covariate; 3] = [Covariate::Cycle, Covariate::Age, Covariate::RunOrder];

/// The runs, those first that the most answers of the study wait for.
pub fn untying(study: &Study, runs: &[RunRecord], campaign: &Campaign) -> Vec<Proposal> {
    let facts = facts(runs, campaign);
    let of_run: BTreeMap<usize, &RunFacts> = facts.iter().map(|fact| (fact.run, fact)).collect();
    let asked: Vec<&Answer> = study.asked().filter(|own| own.value.is_some()).collect();
    let mut found: Vec<(Proposal, usize)> = Vec::new();
    for answer in &asked {
        let Some((first, by)) = measured_first(answer, &of_run) else {
            continue;
        };
        let proposal = again(answer, (&runs[first], of_run[&first]), by);
        let same = found.iter_mut().find(|(known, _)| {
            (&known.sample, &known.environment) == (&proposal.sample, &proposal.environment)
        });
        match same {
            Some((known, count)) => {
                *count += 1;
                for why in proposal.why {
                    if !known.why.contains(&why) {
                        known.why.push(why);
                    }
                }
            }
            None => found.push((proposal, 1)),
        }
    }
    let all = asked.len().max(1) as f64;
    let closing = |(proposal, count): (Proposal, usize)| Proposal {
        closes: count as f64 / all,
        ..proposal
    };
    found.into_iter().map(closing).collect()
}

/// The run that was made first of the side of which all runs were made before all of the other, and by what that is known;
/// none where neither was.
fn measured_first(answer: &Answer, facts: &BTreeMap<usize, &RunFacts>) -> Option<(usize, Covariate)> {
    let (upper, lower) = answer.of_runs.split_at_checked(answer.runs.0)?;
    let number = |run: &usize, by| Some((facts.get(run)?.numbers.get(&by)?.value, *run));
    USE.iter().find_map(|&by| {
        let side = |runs: &[usize]| -> Option<Vec<(f64, usize)>> {
            let mut all: Vec<(f64, usize)> = runs.iter().map(|run| number(run, by)).collect::<Option<_>>()?;
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            Some(all)
        };
        let (upper, lower) = (side(upper)?, side(lower)?);
        let before = |a: &[(f64, usize)], b: &[(f64, usize)]| a.last()?.0.lt(&b.first()?.0).then_some(a[0].1);
        let first = before(&lower, &upper).or_else(|| before(&upper, &lower))?;
        Some((first, by))
    })
}

/// A run as it was made, once more.
fn again(answer: &Answer, (run, fact): (&RunRecord, &RunFacts), by: Covariate) -> Proposal {
    let last = |found: f64, time: f64| found.max(time);
    let duration_s = run.channels.iter().filter_map(|own| own.last_time_s).reduce(last);
    let drive = run.drive.as_ref().zip(duration_s);
    let number = |of: Covariate| fact.numbers.get(&of).map(|known| known.value);
    Proposal {
        sample: fact.sample.clone(),
        material: fact.material.clone(),
        environment: run.tag(keys::ENVIRONMENT).map(str::to_owned),
        relative_humidity_percent: number(Covariate::RelativeHumidity),
        temperature_c: number(Covariate::Temperature),
        voltage_v: nominal_voltage_v(run),
        rest_before_s: number(Covariate::RestBefore),
        drive: drive.map_or_else(String::new, |(drive, duration_s)| words::drive(drive, duration_s)),
        splits: vec![Covariate::Environment.key().to_owned(), by.key().to_owned()],
        set_size: None,
        expected_set_size: None,
        why: vec![format!(
            "made again now, it tells {} over {} from the {}",
            answer.upper,
            answer.lower,
            by.label()
        )],
        closes: 0.0,
    }
}
