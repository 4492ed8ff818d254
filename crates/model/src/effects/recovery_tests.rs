//! Every form finds the strength that its own readings were made with.

use super::tests::{between, drives, forms, of, scale, times};
use super::{Effect, Scale, Search};
use crate::extended::tests::drive;

/// Both channels under the drives, each in terms of the base's peak, at a part of the way between the strength's limits.
fn stacked(
    effect: &'static dyn Effect,
    variant: usize,
    search: &Search,
    part: f64,
    scale: &Scale,
) -> Vec<f64> {
    let time_s = times(200);
    let parameters = between(search, part, 0.4);
    let under = |levels: &Vec<(f64, Option<f64>)>| {
        let found = of(effect, variant, &parameters, &drive(levels), &time_s);
        let current = found.current_a.into_iter().map(|i| i / scale.current_a);
        let curvature = found
            .curvature_per_cm
            .into_iter()
            .map(|k| k / scale.curvature_per_cm);
        current.chain(curvature).collect::<Vec<f64>>()
    };
    drives()[1..].iter().flat_map(under).collect()
}

/// A search from beside it finds the strength that the readings were made with.
#[test]
fn every_form_recovers_its_own_strength() {
    const TRUE: f64 = 0.35;
    let scale = scale();
    let mut failed = Vec::new();
    for (effect, variant, search) in forms() {
        if search.limits[0].held {
            continue;
        }
        let readings = stacked(effect, variant, &search, TRUE, &scale);
        let left = |part: f64| -> Vec<f64> {
            let found = stacked(effect, variant, &search, part, &scale);
            found.iter().zip(&readings).map(|(a, b)| a - b).collect()
        };
        let square = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
        let mut part = 0.31;
        for _ in 0..12 {
            let own = left(part);
            let slope: Vec<f64> = left(part + 1e-5)
                .iter()
                .zip(&own)
                .map(|(a, b)| (a - b) / 1e-5)
                .collect();
            let along: f64 = slope.iter().zip(&own).map(|(s, r)| s * r).sum();
            let step = -along / square(&slope).max(f64::MIN_POSITIVE);
            let tried = (0..8).map(|k| part + step * 0.5_f64.powi(k));
            let better = tried.into_iter().find(|next| square(&left(*next)) < square(&own));
            match better {
                Some(next) if (next - part).abs() > 1e-7 => part = next,
                _ => break,
            }
        }
        if (part - TRUE).abs() > 1e-3 {
            failed.push(format!("{} {variant}: {part} for {TRUE}", effect.about().id));
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}
