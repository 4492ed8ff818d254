//! Edges that are answered unequally.

use super::*;

/// A resistance that comes and goes leaves no mean over any stretch and is like no effect of the library: it is seen by how
/// unequally the edges are answered.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn what_wanders_from_edge_to_edge_is_seen_and_not_named() {
    let wandering: Hidden = ("x-limit-cycle", None, &[("modulation", 0.05), ("period_s", 80.0)]);
    let found = Runs::with(Some(wandering), &[STEP, PULSES], 5).diagnosed();
    assert_eq!(found.verdict, Verdict::Unexplained, "{}", found.sentence);
    assert!(
        found
            .sentence
            .contains("the current answers the 30 edges of the drive of second unequally"),
        "{}",
        found.sentence
    );
    let clean = Runs::with(None, &[STEP, PULSES], 5).diagnosed();
    assert_eq!(clean.verdict, Verdict::Right, "{}", clean.sentence);
}

/// Answers to edges are asked where there are many, each over its own readings, none twice.
#[test]
fn every_reading_after_an_edge_is_of_one_answer() {
    let runs = Runs::with(None, &[DISCHARGED, PULSES], 1);
    let inputs = runs.inputs();
    let raw = group::RunGroup::new(&inputs);
    with_base(&raw, DiagnoseOptions::default().model, |group, base| {
        let all = residual_bins::residual_bins(group, &base);
        let edge_responses = all
            .iter()
            .filter(|own| own.kind == residual_bins::Kind::EdgeResponse);
        let mut rows: Vec<usize> = edge_responses.clone().flat_map(|own| own.rows.clone()).collect();
        assert_eq!(edge_responses.clone().count(), 60);
        assert!(edge_responses.clone().all(|own| group.blocks[own.block].run == 1));
        let squares = all
            .iter()
            .map(|own| own.weights.iter().map(|w| w * w).sum::<f64>());
        assert!(squares.into_iter().all(|square| (square - 1.0).abs() < 1e-9));
        rows.sort_unstable();
        assert!(rows.windows(2).all(|pair| pair[0] + 1 == pair[1]));
        assert_eq!(rows.len(), 1200);
    })
    .expect("the base is fitted");
}
