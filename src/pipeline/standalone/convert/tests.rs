//! Conversions against numbers by hand.

use super::*;

fn strip() -> MeasuredStrip {
    MeasuredStrip {
        length_mm: Some(Measured::exact(5.0)),
        width_mm: Some(Measured::exact(2.0)),
        thickness_mm: Some(Measured::exact(0.22)),
        modulus_mpa: Some(Measured::exact(460.0)),
        ..MeasuredStrip::default()
    }
}

fn value(document: &ConversionDocument, key: &str) -> Estimate {
    let found = document.values.iter().find(|(name, _)| name == key);
    found.unwrap_or_else(|| panic!("{key}")).1.clone()
}

#[test]
fn a_displacement_becomes_every_measure_by_hand() {
    let document = convert("displacement=1.2mm", &strip()).unwrap();
    let curvature = 20.0 * 1.2 / (25.0 + 1.44);
    let close = |key: &str, expected: f64| {
        let found = value(&document, key).value.unwrap();
        assert!(
            (found / expected - 1.0).abs() < 1e-12,
            "{key}: {found} {expected}"
        );
    };
    close("curvature_per_cm", curvature);
    close("displacement_mm", 1.2);
    close(
        "tangent_angle_deg",
        curvature * 0.5 * 180.0 / std::f64::consts::PI,
    );
    close(
        "strain_difference_percent",
        100.0 * 2.0 * 0.22 * 1.2 / (25.0 + 1.44),
    );
    close("bending_strain_percent", 100.0 * 0.22 * 1.2 / (25.0 + 1.44));
    let second_moment = 2.0 * 0.22_f64.powi(3) / 12.0;
    close(
        "bending_moment_mn_mm",
        1e3 * 460.0 * second_moment * curvature / 10.0,
    );
    close(
        "strain_energy_uj",
        0.5e3 * 460.0 * second_moment * 5.0 * (curvature / 10.0).powi(2),
    );
    let back = value(&document, "strain_energy_uj").value.unwrap();
    let again = convert(&format!("energy={back}uJ"), &strip()).unwrap();
    assert!((value(&again, "displacement_mm").value.unwrap() - 1.2).abs() < 1e-9);
}

#[test]
fn errors_of_value_and_dimensions_enter_where_they_count() {
    let mut measured = strip();
    measured.thickness_mm = Some(Measured {
        value: 0.22,
        standard_error: 0.0022,
    });
    let document = convert("curvature=0.5±0.01/cm", &measured).unwrap();
    let relative = |key: &str| {
        let found = value(&document, key);
        found.standard_error.unwrap() / found.value.unwrap()
    };
    assert!((relative("curvature_per_cm") - 0.02).abs() < 1e-9);
    assert!((relative("bending_strain_percent") - 0.02_f64.hypot(0.01)).abs() < 1e-9);
    assert!((relative("bending_moment_mn_mm") - 0.02_f64.hypot(0.03)).abs() < 1e-4);
}

#[test]
fn what_is_missing_is_said_in_its_place_and_elsewhere_refused() {
    let bare = MeasuredStrip {
        length_mm: Some(Measured::exact(5.0)),
        ..MeasuredStrip::default()
    };
    let document = convert("tip_displacement=1mm", &bare).unwrap();
    let moment = value(&document, "bending_moment_mn_mm");
    assert_eq!(
        (moment.value, moment.reason.as_deref()),
        (None, Some("needs the width"))
    );
    for given in [
        "moment=1mNmm",
        "tip-displacement=4mm",
        "displacement=1V",
        "bend=1mm",
        "displacement",
    ] {
        assert!(convert(given, &bare).is_err(), "{given}");
    }
    let mut flat = bare;
    flat.length_mm = Some(Measured::exact(0.0));
    assert!(convert("curvature=1/cm", &flat).is_err());
}

#[test]
fn a_mean_elongation_parts_the_exact_strain_from_the_small_one() {
    let mut long = strip();
    long.mean_elongation = Some(Measured::exact(0.02));
    let document = convert("curvature=1/cm", &long).unwrap();
    let exact = value(&document, "strain_difference_percent").value.unwrap();
    let small = value(&document, "strain_difference_small_percent").value.unwrap();
    assert!((exact / small - 1.02).abs() < 1e-12);
}
