//! Simpler circuits: one that is the truth is enough, one that is not shows what it gets wrong.

use std::sync::Arc;

use super::*;
use crate::{Circuit, Reduction, reductions};
use ieap_domain::testing::branch;

fn found(model: &LumpedModel, relative: f64, every_s: f64, seed: u64) -> Vec<Reduction> {
    let time_s: Arc<[f64]> = (0..600).map(|k| f64::from(k) * every_s).collect();
    let drive = Drive::step(1.5);
    let channels = channels(model, &drive, &time_s, relative, 0.0, seed);
    let input = FitInput {
        channels: &channels,
        drive: &drive,
        area_cm2: AREA_CM2,
    };
    let found = reductions(&input).unwrap();
    assert!(found.full_leaves < 1.5, "{found:?}");
    found.circuits
}

fn strip(branches: Vec<ieap_model::Branch>, rss: f64) -> LumpedModel {
    LumpedModel {
        branches,
        steady_state_resistance_ohm_cm2: rss,
        charge_to_curvature_per_c_cm: 12.0,
        relaxation_rate_per_s: 4e-3,
    }
}

#[test]
fn a_circuit_that_is_the_truth_is_seldom_refused() {
    let one = strip(vec![branch(120.0, 0.1)], 2500.0);
    let draws = counted(20, 200);
    let refused = (0..draws).filter(|seed| {
        let every_s = [0.5, 1.0, 2.0][*seed as usize % 3];
        let found = found(&one, 0.003, every_s, 40 + seed);
        let own = found
            .iter()
            .find(|own| own.circuit == Circuit::OneBranch)
            .unwrap();
        assert_eq!(own.parameters_saved, 2);
        assert!(own.current_differs_percent < 1.0);
        own.p < 0.05
    });
    let refused = refused.count() as f64 / draws as f64;
    println!(
        "one branch, which is the truth: refused in {:.1} % of {draws}",
        100.0 * refused
    );
    // A branch that is not there has no place of its own: its share of chance is not exactly a chi square's.
    assert!(refused <= 0.2, "{refused}");
}

#[test]
fn a_circuit_that_lacks_something_shows_what_it_gets_wrong() {
    let two = strip(vec![branch(120.0, 0.05), branch(400.0, 0.2)], 2500.0);
    let found = found(&two, 0.003, 1.0, 7);
    assert_eq!(
        found.iter().map(|own| own.parameters_saved).collect::<Vec<_>>(),
        [1, 2, 3]
    );
    for own in &found {
        assert!(own.p < 1e-6 && own.chi_square_rise > 50.0, "{own:?}");
        assert!(
            own.current_differs_percent > 0.3 && own.curvature_differs_percent.is_some(),
            "{own:?}"
        );
    }
    assert!(found[2].chi_square_rise > found[1].chi_square_rise);
    assert!(found[1].elements.is_some() && found[2].elements.is_none());
}
