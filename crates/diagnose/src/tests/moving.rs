//! Groups whose voltage moves all the time: what fits is called so, and what is hidden is seen.

use super::*;

/// A sine of 2 V and a triangle of 1 V, in levels about so many places a second.
fn waves(per_second: u32) -> Vec<Drive> {
    let time_s: Vec<f64> = (0..=600 * per_second)
        .map(|k| f64::from(k) / f64::from(per_second))
        .collect();
    let sine = |t: &f64| 2.0 * (std::f64::consts::TAU * t / 75.0).sin();
    let triangle = |t: &f64| 4.0 * ((t / 120.0 + 0.25).fract() - 0.5).abs() - 1.0;
    let of = |volts: Vec<f64>| Drive::staircase(&time_s, &volts, 0.0);
    vec![
        of(time_s.iter().map(sine).collect()),
        of(time_s.iter().map(triangle).collect()),
    ]
}

/// The runs as they truly move, told by the readings of the voltage at the time of the others.
fn read(hidden: &[Hidden], seed: u64) -> Runs {
    Runs {
        drives: waves(1),
        ..Runs::under(&base(), hidden, waves(16), seed)
    }
}

#[test]
fn where_nothing_is_hidden_the_simulation_is_right() {
    let found = read(&[], 3).diagnosed();
    assert_eq!(found.verdict, Verdict::Right, "{}", found.sentence);
}

#[test]
fn a_leak_is_found_and_told_without_a_level() {
    let leak: Hidden = (
        "faradaic-leak",
        Some("terminal"),
        &[
            ("leak_current_a_per_cm2", 3e-4),
            ("onset_v", 1.2),
            ("slope_v", 0.15),
        ],
    );
    let found = read(&[leak], 4).diagnosed();
    assert!(
        found.set.iter().any(|id| id == "faradaic-leak"),
        "{} {:?}",
        found.sentence,
        found.set
    );
    let text = &found
        .whereabouts
        .as_ref()
        .map(|own| own.text.clone())
        .unwrap_or_default();
    assert!(!text.contains("edges of the drive"), "{text}");
}
