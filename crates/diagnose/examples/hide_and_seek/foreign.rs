//! Foreign forms of the library's effects, and causes that no library holds: what a diagnosis makes of equations that
//! are not its own.

use std::collections::BTreeMap;

use ieap_diagnose::sigmas_after_refit;
use ieap_model::effects::{Effect, Limits};
use ieap_model::extended::Responses;
use ieap_truth::HiddenEffect;
use ieap_truth::catalogue::{Bounds, KnownEffect, known};
use rand::RngExt;

use crate::case::{Case, truly};
use crate::hidden::{HIDEABLE, Outside, hidden_variants, scale, strength_bounds};
use crate::reach::{Range, reach};

fn has_forms(effect: &dyn Effect) -> bool {
    known(effect.about().id).is_some_and(|entry| !entry.forms.is_empty())
}

/// Effects that have foreign forms.
pub fn with_forms() -> Vec<&'static dyn Effect> {
    HIDEABLE
        .iter()
        .copied()
        .filter(|effect| has_forms(*effect))
        .collect()
}

/// What is hidden.
pub enum Cause {
    /// A foreign form of an effect of the library.
    Form(&'static dyn Effect),
    /// What no library holds.
    Outside(Outside),
}

impl Cause {
    /// Responses with it.
    pub fn hidden(&self, case: &mut Case, d: f64) -> Option<Vec<Responses>> {
        match self {
            Cause::Form(effect) => {
                let forms = known(effect.about().id)?.forms;
                let form = forms[case.generator.random_range(0..forms.len())];
                hidden_form(case, *effect, form, d)
            }
            Cause::Outside(outside) => hidden_outside(case, *outside, d),
        }
    }
}

/// Responses with a foreign form of a random variant and shape.
fn hidden_form(case: &mut Case, effect: &'static dyn Effect, form: &str, d: f64) -> Option<Vec<Responses>> {
    let entry = known(effect.about().id)?;
    let variant = case.generator.random_range(0..hidden_variants(effect)?);
    let search = effect.search(variant, &scale(case));
    if search.probes.is_empty() {
        return None;
    }
    let probe = search.probes[case.generator.random_range(0..search.probes.len())].clone();
    let with = |case: &Case, strength: f64| {
        truly(
            case,
            vec![in_form(entry, effect, variant, form, &probe, strength)],
        )
    };
    let limits = search.limits[0];
    if limits.held {
        // A law without free strength: the noise is made to fit instead.
        let found = with(case, 1.0)?;
        let factor = sigmas_after_refit(&case.base, &case.design, &found, case.noise) / d;
        if factor <= 0.0 {
            return None;
        }
        case.noise.current_a *= factor;
        case.noise.curvature_per_cm *= factor;
        Some(found)
    } else {
        let range = range(limits, strength_bounds(entry.id), probe[0], search.absent);
        Some(reach(case, d, range, |strength| with(case, strength))?.1)
    }
}

fn in_form(
    entry: &KnownEffect,
    effect: &dyn Effect,
    variant: usize,
    form: &str,
    probe: &[f64],
    strength: f64,
) -> HiddenEffect {
    let about = effect.about();
    let own = entry.variants.get(variant).copied().unwrap_or_default();
    let keys = about.parameters.iter().map(|parameter| parameter.key.to_owned());
    let mut parameters: BTreeMap<String, f64> = keys.zip(probe.iter().copied()).collect();
    parameters.insert(entry.parameters[0].key.to_owned(), strength);
    HiddenEffect {
        id: entry.id.to_owned(),
        variant: Some(format!("{own}/{form}")),
        parameters,
    }
}

/// The library's limits where the truth simulator takes them.
fn range(limits: Limits, bounds: Bounds, start: f64, absent: f64) -> Range {
    let (low, high) = match bounds {
        Bounds::Real => (f64::NEG_INFINITY, f64::INFINITY),
        Bounds::Above(low) => (low + 1e-6 * limits.high.abs(), f64::INFINITY),
        Bounds::AtLeast(low) => (low, f64::INFINITY),
        Bounds::Between(low, high) => (low, high),
    };
    Range {
        start,
        low: limits.low.max(low),
        high: limits.high.min(high),
        falls: absent == f64::INFINITY,
    }
}

/// The same of a cause that no library holds: a random variant, its shape within a factor of two of the usual.
fn hidden_outside(case: &mut Case, (id, key, start, other): Outside, d: f64) -> Option<Vec<Responses>> {
    let variants = known(id)?.variants;
    let variant = match variants {
        [] => None,
        some => Some(some[case.generator.random_range(0..some.len())]),
    };
    let about = case.generator.random_range(-0.7..0.7_f64).exp();
    let range = range(Limits::linear(-1e3, 1e3), strength_bounds(id), start, 0.0);
    let hidden = |strength: f64| HiddenEffect {
        id: id.to_owned(),
        variant: variant.map(str::to_owned),
        parameters: other
            .iter()
            .map(|(key, value)| ((*key).to_owned(), value * about))
            .chain([(key.to_owned(), strength)])
            .collect(),
    };
    Some(reach(case, d, range, |strength| truly(case, vec![hidden(strength)]))?.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Plan, case};
    use crate::hidden::OUTSIDE;

    /// What leaves less than d = 16 within the candidates' limits in five drives read once a second, as in the published
    /// tables, and what leaves more at once: a dead time moves readings behind the edges.
    const OUT_OF_REACH: [&str; 5] = [
        "series-resistance",
        "current-limit",
        "source-rise",
        "sensing-feedback",
        "x-dead-time",
    ];

    #[test]
    #[ignore = "slow: cargo test --example hide_and_seek -- --ignored --nocapture"]
    fn every_form_and_every_cause_outside_can_be_hidden() {
        let mut never = Vec::new();
        for &effect in HIDEABLE.iter() {
            let id = effect.about().id;
            for form in known(id).map_or(&[][..], |entry| entry.forms) {
                let reached = (0..3).filter(|&seed| {
                    let mut case = case(seed, Plan::default());
                    hidden_form(&mut case, effect, form, 16.0).is_some()
                });
                let reached = reached.count();
                println!("{id} {form}: {reached} of 3");
                if reached == 0 && !OUT_OF_REACH.contains(&id) {
                    never.push(format!("{id} {form}"));
                }
            }
        }
        for kind in OUTSIDE {
            let reached = (0..3).filter(|&seed| {
                let mut case = case(seed, Plan::default());
                hidden_outside(&mut case, kind, 16.0).is_some()
            });
            let reached = reached.count();
            println!("{}: {reached} of 3", kind.0);
            if reached == 0 && !OUT_OF_REACH.contains(&kind.0) {
                never.push(kind.0.to_owned());
            }
        }
        assert!(never.is_empty(), "{never:?}");
    }
}
