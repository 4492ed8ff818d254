//! What a diagnosis makes of many groups, counted.

use std::collections::BTreeMap;

use ieap_domain::{Estimate, GroupDiagnosis, Verdict};
use ieap_model::effects::Applied;
use rand::RngExt;
use rayon::prelude::*;

use crate::case::{Plan, case, diagnose, responses, true_responses};
use crate::hidden::{HIDEABLE, Outside, apart, hidden, outside};
use crate::oracle::oracle;
use crate::verdicts::{Count, in_short};

/// Every effect has noise and base parameters of its own: shared ones would make one unlucky noise count as many.
const SEEDS_OF_AN_EFFECT: usize = 1000;

/// Groups, seen, in the set, uniquely named, wrongly named, unknown, strengths stated and covered, at the last strength;
/// beside them in the table the median fall of the held-out deviance where a cause was accepted.
pub fn effects(first: u64, count: u64, strengths: &[f64], only: &[String]) -> [usize; 8] {
    let mut last = [0; 8];
    println!(
        "{:30} {:>4} {:>3} {:>5} {:>5} {:>6} {:>6} {:>5} {:>6} {:>5} {:>8}",
        "effect", "d", "n", "seen", "inset", "unique", "wrong", "unkn", "stated", "cover", "held out"
    );
    for &d in strengths {
        let mut total = [0usize; 8];
        let (mut left, mut further) = (Vec::new(), 0);
        let mut all = Held::default();
        let mut said = Count::default();
        for (&effect, own) in HIDEABLE.iter().zip((first..).step_by(SEEDS_OF_AN_EFFECT)) {
            let id = effect.about().id;
            if !only.is_empty() && !only.iter().any(|o| o == id) {
                continue;
            }
            let began = std::time::Instant::now();
            let found: Vec<_> = (own..own + count)
                .into_par_iter()
                .filter_map(|seed| {
                    let mut case = case(seed, Plan::default());
                    let (applied, _) = hidden(&mut case, effect, d)?;
                    let with = true_responses(&case, std::slice::from_ref(&applied))?;
                    let library = responses(&case, std::slice::from_ref(&applied));
                    let apart = apart(&case, &with, &library);
                    Some((diagnose(&mut case, &with), applied, apart, case.base))
                })
                .collect();
            let mut row = [0usize; 8];
            let gain = |found: &GroupDiagnosis| found.gain.as_ref().map(|gain| gain.proof.deviance);
            let mut gains: Vec<f64> = found.iter().filter_map(|(found, ..)| gain(found)).collect();
            let worst = found.iter().map(|(_, _, apart, _)| *apart).fold(0.0, f64::max);
            for (found, applied, _, base) in &found {
                said.add(found, Some(id));
                row[0] += 1;
                if found.effects.first().is_some_and(|first| first.effect == id) {
                    match found.effects.len() {
                        1 => left.extend(found.p_leftover),
                        _ => further += 1,
                    }
                }
                row[1] += usize::from(found.p_misfit.is_some_and(|p| p < 0.05));
                let inset = found.set.iter().any(|s| s == id);
                row[2] += usize::from(inset);
                row[3] += usize::from(inset && found.set.len() == 1);
                row[4] += usize::from(!inset && found.set.len() == 1);
                row[5] += usize::from(found.verdict == Verdict::Unknown);
                show_proof(id, found, inset);
                let own = found.effects.iter().find(|own| own.effect == id);
                for (parameter, truth) in own
                    .iter()
                    .flat_map(|own| own.parameters.iter().zip(&applied.parameters))
                {
                    all.add(&parameter.estimate, *truth);
                }
                let strength = own
                    .and_then(|own| own.parameters.first())
                    .map(|own| &own.estimate);
                if let Some((low, high)) = strength.and_then(|s| s.low_95.zip(s.high_95)) {
                    row[6] += 1;
                    let covers = low <= applied.parameters[0] && applied.parameters[0] <= high;
                    row[7] += usize::from(covers);
                    if !covers && std::env::var("SHOW").as_deref() == Ok("strength") {
                        let value = strength.and_then(|s| s.value).unwrap_or(f64::NAN);
                        println!(
                            "    {:?} -> {value:.4} [{low:.4}, {high:.4}] in {:?}, p of what is left {:?}",
                            applied.parameters, found.set, found.p_leftover
                        );
                    }
                }
                let shown = match std::env::var("SHOW").as_deref() {
                    Ok("wrong") => !inset && found.set.len() == 1,
                    Ok("strength" | "proof") => false,
                    other => other.is_ok(),
                };
                if shown {
                    println!(
                        "    {id} d = {d} {:?} -> {}; {} {:?}",
                        applied.parameters,
                        in_short(found),
                        found.sentence,
                        found
                            .gain
                            .as_ref()
                            .map(|g| (g.proof.deviance, g.proof.parts.clone()))
                    );
                    println!("        beside {base:?}");
                    for h in found.posterior.iter().take(6) {
                        println!("        {h:?}");
                    }
                    for c in found.candidates.iter().take(8) {
                        println!(
                            "        {:30} forecast {:8.1} fitted {:?} +{} left {:.3}",
                            c.effect, c.forecast_gain, c.fitted_gain, c.extra_parameters, c.left_after_refit
                        );
                    }
                }
            }
            println!(
                "{id:30} {d:>4} {:>3} {:>5} {:>5} {:>6} {:>6} {:>5} {:>6} {:>5} {:>8.0}   simulators {worst:.2} sigma apart, {:.1} s",
                row[0],
                row[1],
                row[2],
                row[3],
                row[4],
                row[5],
                row[6],
                row[7],
                median(&mut gains),
                began.elapsed().as_secs_f64()
            );
            for (t, r) in total.iter_mut().zip(row) {
                *t += r;
            }
        }
        println!(
            "{:30} {d:>4} {:>3} {:>5} {:>5} {:>6} {:>6} {:>5} {:>6} {:>5}",
            "all", total[0], total[1], total[2], total[3], total[4], total[5], total[6], total[7]
        );
        println!("{}", Count::heading_with("hidden, d", &[]));
        println!("{}", said.row(&format!("own, {d}")));
        let below = |limit: f64| left.iter().filter(|p| **p < limit).count() as f64 / left.len() as f64;
        println!(
            "what the truth leaves: p<0.01 {:.3}  p<0.05 {:.3}  p<0.2 {:.3}  p<0.5 {:.3} of {}; a further cause taken in {further}",
            below(0.01),
            below(0.05),
            below(0.2),
            below(0.5),
            left.len()
        );
        println!(
            "all parameters of the truth: {} intervals, {} hold it; {} bounds, {} hold it; nothing stated of {}",
            all.intervals, all.within, all.bounds, all.behind, all.nothing
        );
        last = total;
    }
    last
}

/// How many hidden effects are seen at best: by who knows the noise and the base parameters and sees to first order.
pub fn ceilings(first: u64, count: u64, strengths: &[f64]) {
    for &d in strengths {
        let seeds = (first..).step_by(SEEDS_OF_AN_EFFECT);
        let all = HIDEABLE
            .iter()
            .zip(seeds)
            .flat_map(|(&effect, own)| (own..own + count).map(move |seed| (effect, seed)));
        let said: Vec<_> = all
            .collect::<Vec<_>>()
            .into_par_iter()
            .filter_map(|(effect, seed)| {
                let mut case = case(seed, Plan::default());
                let (applied, _) = hidden(&mut case, effect, d)?;
                let with = responses(&case, std::slice::from_ref(&applied));
                Some(oracle(&mut case, &applied, &with))
            })
            .collect();
        println!(
            "d {d}: of {} groups the oracle sees {} by the best effect, {} by all together",
            said.len(),
            said.iter().filter(|said| said.seen).count(),
            said.iter().filter(|said| said.seen_by_all).count()
        );
    }
}

/// With `SHOW=proof`, what a finding's acceptance rests on, a line for each group.
fn show_proof(id: &str, found: &GroupDiagnosis, inset: bool) {
    if std::env::var("SHOW").as_deref() != Ok("proof") {
        return;
    }
    let Some(gain) = &found.gain else {
        println!("proof,{id},{},{inset},,,,,,,,", found.verdict.key());
        return;
    };
    let accepted = found.candidates.iter().filter(|candidate| candidate.accepted);
    let fitted: f64 = accepted.filter_map(|candidate| candidate.fitted_gain).sum();
    let falls: Vec<String> = gain
        .proof
        .parts
        .iter()
        .map(|(_, fall)| format!("{fall:.1}"))
        .collect();
    let taken: Vec<&str> = found.effects.iter().map(|own| own.effect.as_str()).collect();
    println!(
        "proof,{id},{},{inset},{},{:.1},{:.1},{:.1},{},{fitted:.1},{:?},{}",
        found.verdict.key(),
        found.set.len(),
        gain.proof.deviance,
        gain.proof.standard_error,
        gain.nameless_deviance,
        falls.join(" "),
        found.p_leftover,
        taken.join(" ")
    );
}

/// What is stated of parameters, and how often it holds the truth.
#[derive(Default)]
struct Held {
    intervals: usize,
    within: usize,
    bounds: usize,
    behind: usize,
    nothing: usize,
}

impl Held {
    fn add(&mut self, estimate: &Estimate, truth: f64) {
        let holds = estimate.low_95.is_none_or(|low| low <= truth)
            && estimate.high_95.is_none_or(|high| truth <= high);
        if !holds && std::env::var("SHOW").as_deref() == Ok("parameters") {
            println!(
                "    {truth:.4e} not in {:?} to {:?}, best {:?}",
                estimate.low_95, estimate.high_95, estimate.value
            );
        }
        let (count, held) = match (estimate.low_95, estimate.high_95) {
            (Some(_), Some(_)) => (&mut self.intervals, &mut self.within),
            (None, None) => {
                self.nothing += 1;
                return;
            }
            _ => (&mut self.bounds, &mut self.behind),
        };
        *count += 1;
        *held += usize::from(holds);
    }
}

/// NaN of none.
fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Groups with causes of these strengths at once: how many there are, and whose finding holds all causes.
pub fn together(first: u64, count: u64, strengths: &[f64]) -> [usize; 2] {
    let found: Vec<_> = (first..first + count)
        .into_par_iter()
        .filter_map(|seed| {
            let mut case = case(seed, Plan::default());
            let mut applied: Vec<Applied> = Vec::new();
            while applied.len() < strengths.len() {
                let effect = HIDEABLE[case.generator.random_range(0..HIDEABLE.len())];
                let is_there = applied.iter().any(|a| a.effect.about().id == effect.about().id);
                // Laws without free strength fit the noise to themselves, which two of them cannot.
                let before = case.noise;
                let one = (!is_there)
                    .then(|| hidden(&mut case, effect, strengths[applied.len()]))
                    .flatten();
                if case.noise == before {
                    applied.extend(one.map(|(one, _)| one));
                }
                case.noise = before;
            }
            let with = true_responses(&case, &applied)?;
            Some((diagnose(&mut case, &with), applied))
        })
        .collect();
    let mut verdicts: BTreeMap<&str, usize> = BTreeMap::new();
    let (mut whole, mut one, mut beside) = (0, 0, 0);
    for (found, applied) in &found {
        let is_given = |a: &&Applied| found.set.iter().any(|id| id == a.effect.about().id);
        let given = applied.iter().filter(is_given).count();
        whole += usize::from(given == applied.len());
        one += usize::from(given > 0);
        beside += found.set.len() - given;
        *verdicts.entry(found.verdict.key()).or_default() += 1;
        let ids: Vec<&str> = applied.iter().map(|a| a.effect.about().id).collect();
        show_proof(&ids.join(" "), found, given == applied.len());
    }
    println!(
        "{strengths:?}: {} groups, all given in {whole}, one at least in {one}, {beside} given that are not there; {verdicts:?}",
        found.len()
    );
    [found.len(), whole]
}

/// Groups with an effect that no library holds, which must come back unknown: how many there are, are unknown, and are given
/// one name.
pub fn outsides(kinds: &[Outside], first: u64, count: u64, d: f64) -> [usize; 3] {
    let mut total = [0; 3];
    for &kind in kinds {
        let found: Vec<_> = (0..count)
            .into_par_iter()
            .filter_map(|seed| {
                let mut case = case(first + seed, Plan::default());
                let with = outside(&case, kind, d)?;
                Some(diagnose(&mut case, &with))
            })
            .collect();
        let mut verdicts: BTreeMap<&str, usize> = BTreeMap::new();
        let mut said = Count::default();
        for found in &found {
            said.add(found, None);
            *verdicts.entry(found.verdict.key()).or_default() += 1;
            show_proof(kind.0, found, false);
            if std::env::var("SHOW").as_deref() == Ok("1") {
                println!(
                    "    {} {:?} leftover {:?} {}",
                    found.verdict.key(),
                    found.set,
                    found.p_leftover,
                    found.sentence
                );
            }
        }
        println!("{:25} d {d:>4} n {:>3} {verdicts:?}", kind.0, found.len());
        println!("{}", said.row(&format!("{}, {d}", kind.0)));
        let unknown = verdicts.get(Verdict::Unknown.key()).copied().unwrap_or(0);
        let named = found.iter().filter(|found| found.set.len() == 1).count();
        total = [total[0] + found.len(), total[1] + unknown, total[2] + named];
    }
    let [groups, unknown, named] = total;
    println!("of {groups} groups {unknown} are unknown, {named} given one name");
    total
}
