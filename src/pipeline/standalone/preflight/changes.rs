//! Changes of the run, tried one at a time.

use super::asked::Preflight;
use super::document::{ChangeEntry, PlannedParameter};
use super::judged::judged;
use super::trial::Trial;
use super::words;
use crate::pipeline::Observer;

/// How many times faster, or slower, readings are tried: a decade in three steps.
const RATES: [f64; 3] = [2.0, 5.0, 10.0];
/// How many times longer records are tried.
const LENGTHS: [f64; 2] = [2.0, 5.0];
/// A voltage is another where it differs by more than this part: what a source is set to is met to 1 %.
const ANOTHER_VOLTAGE: f64 = 0.01;

/// Tries changes, the smallest of each kind first: of each kind until every parameter that is open is determined by one;
/// where all are, slower readings as long as they stay so,
/// and what a stated start of the drive adds.
pub(super) fn tried(
    plan: &Preflight,
    planned: &[PlannedParameter],
    observer: &dyn Observer,
) -> Vec<ChangeEntry> {
    let is_open = |of: &PlannedParameter| !of.is_determined();
    let needs_change = planned.iter().any(is_open);
    let mut all = Vec::new();
    for (kind, trials) in kinds(plan, needs_change) {
        let mut open: Vec<&str> = planned.iter().filter(|of| is_open(of)).map(|of| of.key).collect();
        for trial in trials.into_iter().filter(Trial::is_feasible) {
            let words = words::change(kind, &trial);
            observer.begin(&format!("trying {words}"), plan.draws as u64);
            let parameters = judged(&plan.subject, &trial, (plan.draws, plan.seed), observer);
            observer.end();
            open.retain(|key| parameters.iter().any(|of| of.key == *key && is_open(of)));
            let stays = !parameters.iter().any(is_open);
            all.push(ChangeEntry {
                change: words,
                kind,
                every_s: trial.every_s,
                bending_every_s: trial.bending_every_s,
                for_s: trial.for_s,
                largest_voltage_v: trial.drive.largest_v(),
                parameters,
            });
            if (needs_change && open.is_empty()) || (!needs_change && !stays) {
                break;
            }
        }
    }
    all
}

/// The kinds of change with the ways to make the run, from small to large.
fn kinds(plan: &Preflight, needs_change: bool) -> Vec<(&'static str, Vec<Trial>)> {
    let trial = &plan.trial;
    let known_start: Vec<Trial> = (!trial.start_is_known)
        .then(|| trial.with_known_start())
        .into_iter()
        .collect();
    if !needs_change {
        let slower = RATES.iter().map(|factor| trial.read_faster(1.0 / factor));
        let slower = slower.filter(|slower| slower.check().is_ok()).collect();
        return vec![("slower", slower), ("start", known_start)];
    }
    let factor = plan.max_voltage_v / trial.drive.largest_v();
    let higher = (factor.is_finite() && factor > 1.0 + ANOTHER_VOLTAGE).then(|| trial.at_voltage(factor));
    vec![
        (
            "faster",
            RATES.iter().map(|factor| trial.read_faster(*factor)).collect(),
        ),
        (
            "longer",
            LENGTHS.iter().map(|factor| trial.longer(*factor)).collect(),
        ),
        ("voltage", higher.into_iter().collect()),
        ("start", known_start),
    ]
}
