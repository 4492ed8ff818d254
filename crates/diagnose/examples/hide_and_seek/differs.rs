//! Groups in which nothing is hidden but a parameter that is not one number: it differs from run to run.

use ieap_diagnose::sigmas_after_refit;
use ieap_domain::GroupDiagnosis;
use ieap_model::LumpedModel;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use crate::benchmark::each;
use crate::case::{Case, Drives, Plan, case, diagnose, responses_of};
use crate::verdicts::Count;

/// R and C of both branches, R_ss, alpha and lambda.
const PARAMETERS: usize = 7;
/// Standard deviation of a parameter's logarithm among the runs.
const SIZES: [f64; 3] = [0.05, 0.1, 0.3];

/// Counts `count` groups of every design, choice of parameters and size.
pub fn differs(first: u64, count: u64) {
    let designs: &[(&str, Drives)] = match std::env::var_os("DRIVES") {
        Some(_) => &[("as DRIVES says", Drives::Five)],
        None => &[("five drives", Drives::Five), ("three voltages", Drives::Three)],
    };
    let choices = [
        ("one", 1..2),
        ("several", 2..4),
        ("all", PARAMETERS..PARAMETERS + 1),
    ];
    let mut rows = Vec::new();
    for (at, (design, drives)) in designs.iter().enumerate() {
        for (kind, (name, range)) in choices.iter().enumerate() {
            for (size, sd) in SIZES.iter().enumerate() {
                let own = first + 100_000 * at as u64 + 10_000 * kind as u64 + 1000 * size as u64;
                let seeds: Vec<u64> = (own..own + count).collect();
                let found = each(&seeds, |&seed| {
                    let mut plan = Plan::default();
                    if std::env::var_os("DRIVES").is_none() {
                        plan.drives = *drives;
                    }
                    let mut case = case(seed, plan);
                    let chosen = case.generator.random_range(range.clone());
                    Some(differing(&mut case, chosen, *sd))
                });
                let what = format!("{design}: {name}, {} %", 100.0 * sd);
                eprintln!("{what}: {} groups", found.len());
                rows.push(row(&what, &found));
            }
        }
    }
    println!(
        "{}",
        Count::heading_with("what differs", &["median d", "wrong names"])
    );
    rows.iter().for_each(|row| println!("{row}"));
}

fn row(what: &str, found: &[(GroupDiagnosis, f64)]) -> String {
    let mut count = Count::default();
    let mut sizes: Vec<f64> = Vec::new();
    for (found, d) in found {
        count.add(found, None);
        sizes.push(*d);
    }
    sizes.sort_unstable_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(f64::NAN);
    format!("{} {median:.0} | {} |", count.row(what), count.called())
}

/// A group of which so many parameters differ by that much, diagnosed, and what the differences leave after the refit.
/// The parameters of every run, so many of which differ by that much.
pub fn differing_bases(case: &mut Case, chosen: usize, sd: f64) -> Vec<LumpedModel> {
    let mut which: Vec<usize> = (0..PARAMETERS).collect();
    while which.len() > chosen {
        let out = case.generator.random_range(0..which.len());
        which.remove(out);
    }
    let runs = case.design.len();
    (0..runs)
        .map(|_| {
            let mut base = case.base.clone();
            for &parameter in &which {
                let by: f64 = StandardNormal.sample(&mut case.generator);
                *place(&mut base, parameter) *= (sd * by).exp();
            }
            base
        })
        .collect()
}

fn differing(case: &mut Case, chosen: usize, sd: f64) -> (GroupDiagnosis, f64) {
    let bases = differing_bases(case, chosen, sd);
    let with = responses_of(case, &bases);
    let d = sigmas_after_refit(&case.base, &case.design, &with, case.noise);
    let found = diagnose(case, &with);
    if std::env::var_os("SHOW").is_some() {
        eprintln!(
            "{chosen} by {sd}, d = {d:.0}: {} {:?} {}",
            found.verdict.key(),
            found.set,
            found.sentence
        );
    }
    (found, d)
}

fn place(base: &mut LumpedModel, parameter: usize) -> &mut f64 {
    match parameter {
        0 | 1 => &mut base.branches[parameter].resistance_ohm_cm2,
        2 | 3 => &mut base.branches[parameter - 2].capacitance_f_per_cm2,
        4 => &mut base.steady_state_resistance_ohm_cm2,
        5 => &mut base.charge_to_curvature_per_c_cm,
        _ => &mut base.relaxation_rate_per_s,
    }
}
