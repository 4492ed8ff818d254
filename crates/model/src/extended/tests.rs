//! The extended model against the closed form of the base.

use super::*;
use crate::LumpedModel;
use crate::effects::{ALL, Applied, effect};
use ieap_domain::Drive;
use ieap_domain::testing::{self, branch};

pub(crate) fn base() -> LumpedModel {
    LumpedModel {
        branches: vec![branch(3.0, 0.1), branch(15.0, 0.6)],
        steady_state_resistance_ohm_cm2: 300.0,
        charge_to_curvature_per_c_cm: 1.2,
        relaxation_rate_per_s: 0.012,
    }
}

pub(crate) fn drive(levels: &[(f64, Option<f64>)]) -> Drive {
    testing::drive(0.0, levels)
}

pub(crate) fn context(drive: &Drive) -> RunContext<'_> {
    RunContext {
        index: 0,
        drive,
        area_cm2: 0.1,
        length_cm: Some(0.5),
        duration_s: 300.0,
        resolved_s: None,
        tags: &[],
        channels: &[],
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, v| most.max(v.abs()))
}

fn apart(left: &[f64], right: &[f64]) -> f64 {
    let worst = left
        .iter()
        .zip(right)
        .fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    worst / largest(right).max(1e-30)
}

#[test]
fn without_effects_it_is_the_closed_form() {
    let time_s: Vec<f64> = (0..300).map(f64::from).collect();
    let camera_s: Vec<f64> = (0..60).map(|k| 5.0 * f64::from(k) + 0.3).collect();
    for (levels, exact) in [
        (vec![(0.0, Some(2.0))], 1e-9),
        (
            vec![(10.0, Some(2.0)), (100.0, Some(0.0)), (180.0, Some(-1.5))],
            1e-9,
        ),
        (vec![(0.0, Some(2.0)), (100.5, None), (200.0, Some(0.0))], 2e-4),
    ] {
        let drive = drive(&levels);
        let model = ExtendedModel {
            base: base(),
            effects: Vec::new(),
        };
        let found = model.responses(&context(&drive), &time_s, &camera_s);
        let current = base().current_a(&drive, 0.1, &time_s);
        let curvature = base().curvature_per_cm(&drive, 0.1, &camera_s);
        assert!(
            apart(&found.current_a, &current) < exact,
            "{levels:?} {}",
            apart(&found.current_a, &current)
        );
        assert!(
            apart(&found.curvature_per_cm, &curvature) < exact,
            "{levels:?} {}",
            apart(&found.curvature_per_cm, &curvature)
        );
    }
}

#[test]
fn partial_relaxation_leaves_a_plateau() {
    let drive = drive(&[(0.0, Some(2.0))]);
    let model = ExtendedModel {
        base: base(),
        effects: vec![Applied {
            effect: effect("partial-relaxation").unwrap(),
            variant: 0,
            parameters: vec![0.25],
        }],
    };
    let found = model.responses(&context(&drive), &[2000.0], &[2000.0]);
    let plateau = 0.25 * 1.2 * 0.1 * 0.7 * 2.0;
    assert!(
        (found.curvature_per_cm[0] / plateau - 1.0).abs() < 1e-6,
        "{found:?}"
    );
}

#[test]
fn every_effect_has_its_own_id_and_code() {
    let mut ids: Vec<&str> = ALL.iter().flat_map(|e| [e.about().id, e.about().code]).collect();
    let all = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), all);
}

#[test]
fn dense_readings_are_answered_as_sparse_ones() {
    let drive = drive(&[(0.0, Some(2.0)), (61.003, Some(-1.0))]);
    let few: Vec<f64> = (-3..100).map(f64::from).collect();
    let many: Vec<f64> = (-300..9901).map(|k| 0.01 * f64::from(k)).collect();
    for (id, parameters) in [
        ("faradaic-leak", vec![1e-4, 1.5, 0.1]),
        ("contact-break", vec![0.5, 30.017, 0.0]),
        ("joule-heating", vec![0.05, 50.0]),
        ("partial-relaxation", vec![0.4]),
    ] {
        let effect = effect(id).unwrap();
        let count = effect.about().parameters.len();
        let parameters = parameters.into_iter().chain([0.01; 4]).take(count).collect();
        let effects = vec![Applied {
            effect,
            variant: 0,
            parameters,
        }];
        let model = ExtendedModel {
            base: base(),
            effects,
        };
        let sparse = model.responses(&context(&drive), &few, &few);
        let dense = model.responses(&context(&drive), &many, &many);
        let every = |values: &[f64]| -> Vec<f64> { values.iter().copied().step_by(100).collect() };
        let current = apart(&every(&dense.current_a), &sparse.current_a);
        let curvature = apart(&every(&dense.curvature_per_cm), &sparse.curvature_per_cm);
        assert!(
            current < 1e-4 && curvature < 1e-4,
            "{id}: {current:e} {curvature:e}"
        );
    }
}
