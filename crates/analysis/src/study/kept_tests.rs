//! Answers that were kept are those that would be made, and only what changed is made anew.

use ieap_domain::RunRecord;

use super::curves_tests::drawn;
use super::tests::{BALANCED, nothing, simulated};
use super::*;
use crate::cache::Cache;
use crate::laws::doubt::Doubts;
use crate::model_free::curves::StepCurves;

/// Measures and channels, of each of which answers are kept for each material, and for the second held against the first.
const KEPT_OF_EACH: usize = 9;

/// A study whose answers are kept, and what it kept.
fn asked(of: (&[RunRecord], &[StepCurves]), cache: &Cache) -> Study {
    let campaign = simulated(BALANCED, nothing, 1).1;
    let evidence = Evidence {
        runs: of.0,
        campaign: &campaign,
        doubts: &Doubts::default(),
        curves: of.1,
    };
    let study = Study::kept(evidence, cache);
    assert_eq!(study, Study::of(evidence));
    study
}

/// How many of the kept answers are those of before, and how many there are, once these runs are asked.
fn of_before(before: &Cache, runs: &[RunRecord], curves: &[StepCurves]) -> (usize, usize) {
    let now = Cache::read(&before.bytes(), "p").unwrap();
    asked((runs, curves), &now);
    let hashes = now.hashes();
    (hashes.intersection(&before.hashes()).count(), hashes.len())
}

#[test]
fn only_answers_of_what_changed_are_made_anew() {
    let (runs, _) = simulated(BALANCED, nothing, 1);
    let curves = drawn(&runs, BALANCED, true, 2);
    let first = Cache::by("p");
    asked((&runs, &curves), &first);
    let all = 3 * KEPT_OF_EACH;
    assert_eq!(of_before(&first, &runs, &curves), (all, all));
    let (first_of_second, last) = (runs.len() / 2, runs.len() - 1);
    assert_eq!(runs[first_of_second].tag("sample"), Some("CPvf-0"));
    // What no answer is made from changes none of them.
    let mut noted = runs.clone();
    noted[last]
        .tags
        .push(ieap_domain::testing::tag("note", "looked at"));
    assert_eq!(of_before(&first, &noted, &curves), (all, all));
    // A run of the second material less: that of the first stays, though all runs after it have other numbers.
    let (mut fewer, mut of_fewer) = (runs.clone(), curves.clone());
    fewer.remove(first_of_second);
    of_fewer.remove(first_of_second);
    assert_eq!(of_before(&first, &fewer, &of_fewer), (KEPT_OF_EACH, all));
    // The same of the first: the second by itself stays.
    fewer.clone_from(&runs);
    of_fewer.clone_from(&curves);
    fewer.remove(0);
    of_fewer.remove(0);
    assert_eq!(of_before(&first, &fewer, &of_fewer), (KEPT_OF_EACH, all));
    // A curve that changed changes the answers about curves of its channel, by itself and against the first.
    let mut other = curves.clone();
    other[last].bending[0].value += 1e-12;
    assert_eq!(of_before(&first, &runs, &other), (all - 2, all));
}

#[test]
fn a_run_elsewhere_moves_the_numbers_of_runs_and_nothing_else() {
    let (runs, _) = simulated(BALANCED, nothing, 1);
    let curves = drawn(&runs, BALANCED, true, 2);
    let first = Cache::by("p");
    asked((&runs, &curves), &first);
    let mut more = runs.clone();
    let mut untagged = runs[0].clone();
    (untagged.path, untagged.fit) = ("0".to_owned(), None);
    untagged.tags.clear();
    more.insert(0, untagged);
    let mut of_more = curves.clone();
    of_more.insert(0, StepCurves::default());
    let all = 3 * KEPT_OF_EACH;
    assert_eq!(of_before(&first, &more, &of_more), (all, all));
}
