//! Every effect of the catalogue, in every form: absent at strength 0, growing from there, and seen in the channel that
//! it is said to act on.

use super::super::catalogue::{KNOWN, KnownEffect};
use super::*;

/// Channels an effect acts on: current, curvature. A leak bends only through the charge that it drains while the
/// circuit is open.
fn acts_on(id: &str) -> (bool, bool) {
    match id {
        "outliers" | "quantisation" | "uneven-noise" => (false, false),
        "current-offset" | "x-current-oscillation" => (true, false),
        "x-staircase" | "x-polarity-coupling" | "x-even-answer" => (false, true),
        "partial-relaxation"
        | "second-relaxation"
        | "fractional-relaxation"
        | "modulus-drift"
        | "creep"
        | "resonance"
        | "mechanical-lag"
        | "softening"
        | "friction"
        | "exposure-smoothing"
        | "camera-delay"
        | "unequal-coupling"
        | "counter-flow"
        | "quadratic-coupling"
        | "leak-coupling"
        | "coupling-saturation"
        | "threshold-relaxation"
        | "moisture-bending"
        | "precurvature"
        | "camera-zero"
        | "clock-rate"
        | "tip-formula"
        | "noncircular-shape"
        | "x-charge-hysteresis" => (false, true),
        _ => (true, true),
    }
}

/// The effect at that share of the example's strength; one that saturates hard does nothing at that.
pub(super) fn hidden(entry: &KnownEffect, variant: Option<&str>, share: f64) -> HiddenEffect {
    let hard = variant.is_some_and(|variant| variant.ends_with("/hard"));
    let share = if hard { 5.0 * share } else { share };
    let parameters: Vec<(&str, f64)> = entry
        .parameters
        .iter()
        .enumerate()
        .map(|(k, p)| (p.key, if k == 0 { share * p.example } else { p.example }))
        .collect();
    effect(entry.id, variant, &parameters)
}

/// Variants by the effect's own law, and the first of them in every foreign form.
fn variants(entry: &KnownEffect) -> Vec<Option<String>> {
    let own: Vec<Option<String>> = match entry.variants {
        [] => vec![None],
        variants => variants
            .iter()
            .map(|variant| Some((*variant).to_owned()))
            .collect(),
    };
    let first = entry.variants.first().copied().unwrap_or_default();
    let foreign = entry.forms.iter().map(|form| Some(format!("{first}/{form}")));
    own.into_iter().chain(foreign).collect()
}

/// Charged, left open, reversed, and shorted, so that each effect has its chance.
fn rich() -> Drive {
    let levels = [
        (0.0, Some(2.0)),
        (250.0, None),
        (320.0, Some(-1.5)),
        (470.0, Some(0.0)),
    ];
    drive(0.0, &levels)
}

#[test]
fn an_effect_of_strength_zero_changes_nothing() {
    let base = respond(&truth(), &rich(), &times());
    for entry in KNOWN.iter().filter(|entry| entry.id != "current-limit") {
        for variant in variants(entry) {
            let found = respond(&with(hidden(entry, variant.as_deref(), 0.0)), &rich(), &times());
            assert_eq!(found, base, "{} {variant:?}", entry.id);
        }
    }
}

#[test]
fn an_effect_changes_the_channels_that_it_acts_on_and_no_other() {
    let base = respond(&truth(), &rich(), &times());
    for entry in KNOWN {
        for variant in variants(entry) {
            let variant = variant.as_deref();
            let found = respond(&with(hidden(entry, variant, 1.0)), &rich(), &times());
            let current = apart(&found.current_a, &base.current_a);
            let curvature = apart(&found.curvature_per_cm, &base.curvature_per_cm);
            let (on_current, mut on_curvature) = acts_on(entry.id);
            let mut acts_on_current = on_current;
            // Relaxing water and a broken coupling leave the circuit alone.
            if matches!(variant, Some("relaxation" | "coupling")) {
                acts_on_current = false;
            }
            on_curvature |= matches!(variant, Some("relaxation" | "coupling"));
            if entry.id == "x-event" {
                (acts_on_current, on_curvature) = (variant == Some("current"), variant == Some("curvature"));
            }
            let name = format!(
                "{} {variant:?}: current {current:e}, curvature {curvature:e}",
                entry.id
            );
            assert_eq!(current > 1e-3, acts_on_current, "{name}");
            assert_eq!(curvature > 1e-3, on_curvature, "{name}");
            assert!(acts_on_current || current < 2e-7, "{name}");
            assert!(on_curvature || curvature < 2e-7, "{name}");
            assert!(current < 20.0 && curvature < 20.0, "{name}");
        }
    }
}

/// Those that are not small for a small strength, or not at all instants: a spike where the source clips or rises.
const NOT_GRADUAL: [&str; 8] = [
    "current-limit",
    "source-rise",
    "resonance",
    "camera-delay",
    "exposure-smoothing",
    "x-dead-time",
    "fast-branch",
    "mechanical-lag",
];

#[test]
fn an_effect_grows_gradually_from_nothing() {
    let base = respond(&truth(), &rich(), &times());
    for entry in KNOWN.iter().filter(|entry| !NOT_GRADUAL.contains(&entry.id)) {
        for variant in variants(entry) {
            let of = |share: f64| {
                let hidden = hidden(entry, variant.as_deref(), share);
                let found = respond(&with(hidden), &rich(), &times());
                let current = apart(&found.current_a, &base.current_a);
                current.max(apart(&found.curvature_per_cm, &base.curvature_per_cm))
            };
            let (small, large) = (of(0.02), of(1.0));
            assert!(
                small <= 0.1 * large + 1e-7,
                "{} {variant:?}: {small:e} {large:e}",
                entry.id
            );
        }
    }
}
