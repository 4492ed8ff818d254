//! Without effects the simulator is the closed form.

use super::*;

fn compare(truth: &Truth, drive: &Drive) {
    let time_s = times();
    let found = respond(truth, drive, &time_s);
    let closed = model(truth);
    let current = closed.current_a(drive, truth.area_cm2, &time_s);
    let curvature = closed.curvature_per_cm(drive, truth.area_cm2, &time_s);
    let (i, k) = (
        apart(&found.current_a, &current),
        apart(&found.curvature_per_cm, &curvature),
    );
    assert!(i < 1e-6 && k < 1e-6, "current {i:e}, curvature {k:e}, {drive:?}");
}

fn drives() -> Vec<Drive> {
    let pulses: Vec<(f64, Option<f64>)> = (0..20)
        .map(|k| (15.0 * f64::from(k), Some(if k % 2 == 0 { 2.0 } else { 0.0 })))
        .collect();
    vec![
        Drive::step(2.0),
        Drive::step(-1.2),
        drive(2.0, &[(0.0, Some(0.0))]),
        drive(0.0, &[(0.0, Some(2.0)), (200.0, Some(-2.0))]),
        drive(0.5, &[(3.0, Some(2.0)), (120.5, Some(0.0)), (300.0, Some(-0.5))]),
        drive(0.0, &pulses),
        drive(0.0, &[(0.0, Some(2.0)), (120.0, None), (400.0, Some(1.0))]),
        drive(1.0, &[(0.0, None)]),
    ]
}

#[test]
fn without_effects_it_is_the_closed_form_in_every_drive() {
    for drive in drives() {
        compare(&truth(), &drive);
    }
}

#[test]
fn one_branch_no_leak_no_relaxation_and_a_fast_branch() {
    let mut one = truth();
    one.branches.truncate(1);
    let mut sealed = truth();
    sealed.steady_state_resistance_ohm_cm2 = f64::INFINITY;
    sealed.relaxation_rate_per_s = 0.0;
    let mut fast = truth();
    fast.branches[0] = Branch {
        resistance_ohm_cm2: 1.0,
        capacitance_f_per_cm2: 0.005,
    };
    for sample in [one, sealed, fast] {
        for drive in drives() {
            compare(&sample, &drive);
        }
    }
}

#[test]
fn the_channels_have_times_of_their_own_in_any_order() {
    let drive = Drive::step(2.0);
    let (current_s, camera_s) = ([30.0, 2.0, -1.0, 30.0], [5.0, 100.0]);
    let found = simulate(&truth(), &drive, &current_s, &camera_s, 0).unwrap();
    let closed = model(&truth());
    assert!(apart(&found.current_a, &closed.current_a(&drive, 0.1, &current_s)) < 1e-6);
    assert!(
        apart(
            &found.curvature_per_cm,
            &closed.curvature_per_cm(&drive, 0.1, &camera_s)
        ) < 1e-6
    );
}
