//! What is predicted of readings that took no part in a fit.

use super::*;

/// The fall is counted from the base refitted without the part: where the base is right neither predicts better.
#[test]
fn without_a_cause_the_nameless_answer_predicts_no_better_than_the_base() {
    let runs = Runs::with(None, &[STEP, HALF, REVERSED, DISCHARGED], 6);
    let inputs = runs.inputs();
    let raw = group::Group::new(&inputs);
    let falls = with_base(&raw, DiagnoseOptions::default().model, |group, base| {
        let before = held_out::parts(&base, group);
        discrepancy::falls(&base, group, &before)
    })
    .unwrap();
    assert_eq!(falls.len(), 4);
    assert!(falls.iter().sum::<f64>() < select::BEATEN, "{falls:?}");
}
