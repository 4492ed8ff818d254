//! Every law against its differential equation, and against the closed forms of single steps.

use ieap_domain::testing::branch;
use ieap_domain::{Drive, Level, Segment};
use ieap_numerics::ode::integrate;

use super::*;
use crate::circuit::EquivalentCircuit;
use crate::classical::ClassicalModel;
use crate::lumped::{Branch, LumpedModel};
use crate::registry::fit_models;

const AREA_CM2: f64 = 0.1;

fn circuit() -> EquivalentCircuit {
    EquivalentCircuit {
        branches: vec![branch(521.4, 0.098), branch(2629.9, 0.13)],
        steady_state_resistance_ohm_cm2: 5660.0,
    }
}

fn model() -> LumpedModel {
    circuit().with_relaxation(1.0, 0.0)
}

fn pulses() -> Drive {
    let segment = |start_s, v| Segment::at(start_s, Level::Voltage(v));
    Drive {
        baseline_v: 0.5,
        segments: vec![segment(0.0, 2.0), segment(300.0, -1.0), segment(800.0, 0.0)],
    }
}

fn times() -> Vec<f64> {
    (-5..150).map(|k| 10.0 * f64::from(k)).collect()
}

/// The law of `state` integrated beside the branches' charges: `rate(q, q', state, elapsed)` gives the state's slope,
/// `curvature(q, state, elapsed)` what it makes of them. Charges count from those at rest.
fn integrated(
    drive: &Drive,
    time_s: &[f64],
    rate: impl Fn(f64, f64, f64) -> f64,
    curvature: impl Fn(f64, f64, f64) -> f64,
) -> Vec<f64> {
    let branches = circuit().branches;
    let (mut state, mut level_v, mut now) = (vec![0.0; branches.len() + 1], drive.baseline_v, 0.0);
    let n = branches.len();
    let mut upcoming = drive.segments.iter().peekable();
    let advance = |state: &mut [f64], from: f64, to: f64, level_v: f64| {
        let slopes = |_: f64, y: &[f64], out: &mut [f64]| {
            for (k, b) in branches.iter().enumerate() {
                let voltage = drive.baseline_v + y[k] / b.capacitance_f_per_cm2;
                out[k] = (level_v - voltage) / b.resistance_ohm_cm2;
            }
            let charge = AREA_CM2 * y[..n].iter().sum::<f64>();
            let charging = AREA_CM2 * out[..n].iter().sum::<f64>();
            out[n] = rate(charge, charging, y[n]);
        };
        integrate(slopes, from, to, state, 1e-11, 1e-18);
    };
    let mut found = Vec::new();
    for &t in time_s {
        if t < 0.0 {
            found.push(0.0);
            continue;
        }
        while let Some(segment) = upcoming.next_if(|segment| segment.start_s() <= t) {
            advance(&mut state, now, segment.start_s(), level_v);
            now = segment.start_s();
            if let Level::Voltage(v) = segment.level {
                level_v = v;
            }
        }
        advance(&mut state, now, t, level_v);
        now = t;
        found.push(curvature(AREA_CM2 * state[..n].iter().sum::<f64>(), state[n], t));
    }
    found
}

#[track_caller]
fn assert_alike(found: &[f64], expected: &[f64], within: f64) {
    let scale = expected.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(scale > 0.0);
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < within * scale, "{a} {b}");
    }
}

fn closed(model_id: &str, drive: &Drive, couplings: &[f64], shapes: &[f64]) -> Vec<f64> {
    let charge = ChargeCourse::new(&model(), drive, AREA_CM2, &times());
    curvature_per_cm(bending_law(model_id).unwrap(), &charge, couplings, shapes)
}

#[test]
fn every_law_is_its_differential_equation_under_several_levels() {
    let (drive, time_s, alpha, r) = (pulses(), times(), 13.88, 1.0 / 400.0);
    let own = |rate: &dyn Fn(f64, f64, f64) -> f64| integrated(&drive, &time_s, rate, |_, k, _| k);
    let thesis = own(&|_, charging, k| alpha * charging - r * k);
    assert_alike(&closed("lumped-2", &drive, &[alpha], &[r]), &thesis, 1e-8);
    let voigt = own(&|q, _, k| r * (alpha * q - k));
    assert_alike(&closed("kelvin-voigt", &drive, &[alpha], &[r]), &voigt, 1e-8);
    let maxwell = own(&|q, charging, _| alpha * (charging + r * q));
    assert_alike(&closed("maxwell", &drive, &[alpha], &[r]), &maxwell, 1e-8);
    let k2 = 3.0;
    let bao = own(&|q, charging, k| alpha * charging - r * (k - k2 * q));
    assert_alike(&closed("bao-two-way", &drive, &[alpha, k2], &[r]), &bao, 1e-8);
    // Springs and dashpot of figure 9C themselves, their stress the charge: the state is the dashpot's extension.
    let (e1, e2, eta) = (55.0, 15.0, 9000.0);
    let strain = |q: f64, dashpot: f64| (q + e2 * dashpot) / (e1 + e2);
    let solid = integrated(
        &drive,
        &time_s,
        |q, _, dashpot| e2 * (strain(q, dashpot) - dashpot) / eta,
        |q, dashpot, _| strain(q, dashpot),
    );
    let shapes = [e1 * e2 / ((e1 + e2) * eta), e2 / e1];
    let found = closed("standard-linear-solid", &drive, &[1.0 / (e1 + e2)], &shapes);
    assert_alike(&found, &solid, 1e-8);
}

#[test]
fn a_changing_modulus_divides_the_moment() {
    let drive = Drive::step(2.0);
    let (a, b, rate) = (0.02, 0.4, 0.004);
    // (d/dt + rate)^2 (E - 1) = 0 is two equations; one state suffices for w = (E - 1) e^(rate t), w' = a.
    let expected = integrated(
        &drive,
        &times(),
        |_, _, _| a,
        |q, grown, t| 13.88 * q / (1.0 + (b + grown) * (-rate * t).exp()),
    );
    let found = closed("yagasaki-tamagawa", &drive, &[13.88], &[a, b, rate]);
    assert_alike(&found, &expected, 1e-8);
    let law = rival_law("yagasaki-tamagawa").unwrap();
    assert!(law.refuses(&drive).is_none() && law.refuses(&pulses()).is_some());
}

#[test]
fn two_way_transport_without_equilibrium_bending_is_the_model_of_the_thesis() {
    let bao = |k2: f64| closed("bao-two-way", &pulses(), &[13.88, k2], &[1.0 / 400.0]);
    let thesis = closed("lumped-2", &pulses(), &[13.88], &[1.0 / 400.0]);
    assert_alike(&bao(0.0), &thesis, 1e-14);
    // With K2 = K1 nothing relaxes.
    let stays = closed("lumped-2", &pulses(), &[13.88], &[0.0]);
    assert_alike(&bao(13.88), &stays, 1e-12);
}

/// A circuit that charges at once puts on a moment that is then held: the curvature is the solid's creep.
#[test]
fn at_once_charged_the_solids_creep_as_their_compliances() {
    let at_once = EquivalentCircuit {
        branches: vec![Branch {
            resistance_ohm_cm2: 1e-9,
            capacitance_f_per_cm2: 0.1,
        }],
        steady_state_resistance_ohm_cm2: f64::INFINITY,
    };
    let time_s: Vec<f64> = (1..200).map(|k| 5.0 * f64::from(k)).collect();
    let charge = ChargeCourse::new(
        &at_once.with_relaxation(1.0, 0.0),
        &Drive::step(2.0),
        AREA_CM2,
        &time_s,
    );
    let stress_mpa = 2.0 * 0.1 * AREA_CM2;
    let (modulus_mpa, viscosity_mpa_s) = (70.0, 9000.0);
    let rate = modulus_mpa / viscosity_mpa_s;
    let (e1, e2) = (55.0, 15.0);
    let cases: [(&str, ClassicalModel, f64, Vec<f64>); 3] = [
        (
            "kelvin-voigt",
            ClassicalModel::KelvinVoigt {
                modulus_mpa,
                viscosity_mpa_s,
            },
            1.0 / modulus_mpa,
            vec![rate],
        ),
        (
            "maxwell",
            ClassicalModel::Maxwell {
                modulus_mpa,
                viscosity_mpa_s,
            },
            1.0 / modulus_mpa,
            vec![rate],
        ),
        (
            "standard-linear-solid",
            ClassicalModel::StandardLinearSolid {
                equilibrium_modulus_mpa: e1,
                arm_modulus_mpa: e2,
                viscosity_mpa_s,
            },
            1.0 / (e1 + e2),
            vec![e1 * e2 / ((e1 + e2) * viscosity_mpa_s), e2 / e1],
        ),
    ];
    for (id, solid, coupling, shapes) in cases {
        let found = curvature_per_cm(rival_law(id).unwrap(), &charge, &[coupling], &shapes);
        let creep = |t: &f64| stress_mpa * solid.creep_compliance_per_mpa(*t);
        let expected: Vec<f64> = time_s.iter().map(creep).collect();
        assert_alike(&found, &expected, 1e-7);
    }
}

#[test]
fn no_solid_that_is_driven_from_outside_bends_back() {
    let drive = Drive::step(2.0);
    for (id, shapes) in [
        ("kelvin-voigt", vec![0.01]),
        ("maxwell", vec![0.001]),
        ("standard-linear-solid", vec![0.01, 0.5]),
    ] {
        let bent = closed(id, &drive, &[10.0], &shapes);
        assert!(bent.windows(2).all(|pair| pair[1] >= pair[0]), "{id}");
    }
    for (id, couplings, shapes) in [
        ("lumped-2", vec![10.0], vec![0.01]),
        ("bao-two-way", vec![10.0, 2.0], vec![0.01]),
        ("yagasaki-tamagawa", vec![10.0], vec![0.057, 0.43, 0.002]),
    ] {
        let bent = closed(id, &drive, &couplings, &shapes);
        assert!(bent.windows(2).any(|pair| pair[1] < pair[0]), "{id}");
    }
}

#[test]
fn every_rival_has_its_parameters_in_the_registry() {
    for model in fit_models() {
        let Some(law) = rival_law(model.id) else { continue };
        for reported in law.reported() {
            assert!(
                model.parameters.iter().any(|own| own.key == reported.key),
                "{}: {}",
                model.id,
                reported.key
            );
        }
    }
    assert_eq!(
        fit_models()
            .iter()
            .filter(|model| rival_law(model.id).is_some())
            .count(),
        LAWS.len()
    );
    assert!(bending_law("lumped-3").is_some() && bending_law("distributed").is_none());
}

#[test]
fn couplings_and_shapes_follow_from_what_a_law_reports() {
    let laws = fit_models().iter().filter_map(|model| bending_law(model.id));
    for law in laws {
        let natural: Vec<f64> = (1..=law.couplings() + law.shapes().len())
            .map(|k| 0.3 / k as f64)
            .collect();
        let value = |own: &Reported| match own.stated {
            Stated::Time => (own.of)(&natural).recip(),
            _ => (own.of)(&natural),
        };
        let reported: Vec<f64> = law.reported().iter().take(natural.len()).map(value).collect();
        let again = law.natural(&reported);
        assert_eq!(again.len(), natural.len());
        for (one, other) in natural.iter().zip(&again) {
            assert!(
                (one - other).abs() < 1e-15,
                "{}: {natural:?} {again:?}",
                law.about().equation
            );
        }
    }
}
