//! Foreign forms of the library's effects, and causes that no library holds: what a diagnosis makes of equations that
//! are not its own.

use std::collections::BTreeMap;

use ieap::diagnose::in_units_of_noise;
use ieap::domain::GroupDiagnosis;
use ieap::model::effects::{ALL, Applied, Effect, Limits};
use ieap::model::extended::Responses;
use ieap::model::truth::HiddenEffect;
use ieap::model::truth::catalogue::{Bounds, KnownEffect, known};
use rand::RngExt;

use crate::benchmark::each;
use crate::case::{Case, Plan, case, diagnose, responses, truly};
use crate::hidden::{OUTSIDE, Outside, scale, strength_bounds};
use crate::oracle::{basis, dot, remove};
use crate::reach::{Range, reach};
use crate::verdicts::Count;

/// A foreign trace is near where its cosine with one of its own effect's is above this.
const NEAR: f64 = 0.95;
/// Every effect has seeds of its own.
const SEEDS_OF_AN_EFFECT: u64 = 1000;

/// A group of either kind, judged.
struct Judged {
    kind: &'static str,
    d: f64,
    /// Id of the cause, and the form or variant.
    id: &'static str,
    form: String,
    found: GroupDiagnosis,
}

/// Hides `count` foreign groups of every effect and cause at every strength; `only` these ids where some are named.
pub fn foreign(first: u64, count: u64, strengths: &[f64], only: &[String]) {
    let wanted = |id: &str| only.is_empty() || only.iter().any(|only| only == id);
    let mut all: Vec<Judged> = Vec::new();
    let mut missed: BTreeMap<String, u64> = BTreeMap::new();
    for &d in strengths {
        let forms = ALL.iter().zip(0..).filter(|(effect, _)| {
            let id = effect.about().id;
            wanted(id) && known(id).is_some_and(|entry| !entry.forms.is_empty())
        });
        let forms = forms.map(|(&effect, place)| (Cause::Form(effect), place));
        let outside = OUTSIDE.iter().zip(500..).filter(|(kind, _)| wanted(kind.0));
        let causes: Vec<(Cause, u64)> = forms
            .chain(outside.map(|(&kind, place)| (Cause::Outside(kind), place)))
            .collect();
        for (at, (cause, place)) in causes.iter().enumerate() {
            let seeds: Vec<u64> = (0..count)
                .map(|k| first + SEEDS_OF_AN_EFFECT * place + k)
                .collect();
            let judged = each(&seeds, |&seed| cause.judged(seed, d));
            *missed.entry(cause.id().to_owned()).or_default() += count - judged.len() as u64;
            eprintln!(
                "d = {d}: {} of {}, {}: {} of {count} groups",
                at + 1,
                causes.len(),
                cause.id(),
                judged.len()
            );
            all.extend(judged);
        }
    }
    print_tables(&all, strengths);
    missed.retain(|_, count| *count > 0);
    println!("\nGroups in which the strength could not be reached: {missed:?}");
}

fn print_tables(all: &[Judged], strengths: &[f64]) {
    let truth = |judged: &Judged| (judged.kind != "outside").then_some(judged.id);
    println!("{}", Count::heading_with("hidden, d", &[]));
    for kind in ["near", "far", "outside"] {
        for &d in strengths {
            let mut count = Count::default();
            for judged in all.iter().filter(|judged| judged.kind == kind && judged.d == d) {
                count.add(&judged.found, truth(judged));
            }
            println!("{}", count.row(&format!("{kind}, {d}")));
        }
    }
    let mut forms: BTreeMap<(&str, String), Count> = BTreeMap::new();
    for judged in all {
        let name = format!("{} {} ({})", judged.id, judged.form, judged.kind);
        let count = forms.entry((judged.kind, name)).or_default();
        count.add(&judged.found, truth(judged));
    }
    println!("\n{}", Count::short_heading("form or cause, all d"));
    for ((_, name), count) in &forms {
        println!("{}", count.short_row(name));
    }
}

/// What is hidden.
enum Cause {
    Form(&'static dyn Effect),
    Outside(Outside),
}

impl Cause {
    fn id(&self) -> &'static str {
        match self {
            Cause::Form(effect) => effect.about().id,
            Cause::Outside(kind) => kind.0,
        }
    }

    fn judged(&self, seed: u64, d: f64) -> Option<Judged> {
        let mut case = case(seed, Plan::default());
        let (kind, form, with) = match self {
            Cause::Form(effect) => hidden_form(&mut case, *effect, d)?,
            Cause::Outside(outside) => hidden_outside(&mut case, *outside, d)?,
        };
        let found = diagnose(&mut case, &with);
        if std::env::var_os("SHOW").is_some() {
            println!(
                "{} {form} {kind}, d = {d}, seed {seed}: {} {:?} {}",
                self.id(),
                found.verdict.key(),
                found.set,
                found.sentence
            );
        }
        Some(Judged {
            kind,
            d,
            id: self.id(),
            form,
            found,
        })
    }
}

/// Near or far, the form, and the responses with a random foreign form of a random shape.
fn hidden_form(
    case: &mut Case,
    effect: &'static dyn Effect,
    d: f64,
) -> Option<(&'static str, String, Vec<Responses>)> {
    let entry = known(effect.about().id)?;
    let variant = case
        .generator
        .random_range(0..effect.about().variants.len().max(1));
    let search = effect.search(variant, &scale(case));
    if search.probes.is_empty() {
        return None;
    }
    let probe = search.probes[case.generator.random_range(0..search.probes.len())].clone();
    let form = entry.forms[case.generator.random_range(0..entry.forms.len())];
    let with = |case: &Case, strength: f64| {
        truly(
            case,
            vec![in_form(entry, effect, variant, form, &probe, strength)],
        )
    };
    let limits = search.limits[0];
    let found = if limits.held {
        // A law without free strength: the noise is made to fit instead.
        let found = with(case, 1.0)?;
        let factor = ieap::diagnose::sigmas_after_refit(&case.base, &case.design, &found, case.noise) / d;
        if factor <= 0.0 {
            return None;
        }
        case.noise.current_a *= factor;
        case.noise.curvature_per_cm *= factor;
        found
    } else {
        let range = range(limits, strength_bounds(entry.id), probe[0], search.absent);
        reach(case, d, range, |strength| with(case, strength))?.1
    };
    let near = cosine(case, effect, &found, d) > NEAR;
    Some((if near { "near" } else { "far" }, form.to_owned(), found))
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
    let own = about.variants.get(variant).copied().unwrap_or_default();
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

/// Largest cosine of what `found` leaves after the refit with what the effect's own forms leave: at every probe, and
/// from the best on at the same strength, with each shape parameter moved towards what fits.
fn cosine(case: &Case, effect: &'static dyn Effect, found: &[Responses], d: f64) -> f64 {
    let plain = in_units_of_noise(&responses(case, &[]), case.noise);
    let basis = basis(case);
    let left = |with: &[Responses]| -> Vec<f64> {
        let mut change: Vec<f64> = in_units_of_noise(with, case.noise)
            .iter()
            .zip(&plain)
            .map(|(with, plain)| with - plain)
            .collect();
        remove(&basis, &mut change);
        change
    };
    let trace = left(found);
    let alike = |own: &Applied, both_signs: bool| {
        let own = left(&responses(case, std::slice::from_ref(own)));
        let cosine = dot(&own, &trace) / (dot(&own, &own) * dot(&trace, &trace)).sqrt();
        let cosine = if both_signs { cosine.abs() } else { cosine };
        if cosine.is_nan() { 0.0 } else { cosine }
    };
    let scale = scale(case);
    let mut best: Option<(f64, Applied, Vec<Limits>)> = None;
    for variant in 0..effect.about().variants.len().max(1) {
        let search = effect.search(variant, &scale);
        for probe in search.probes {
            let own = Applied {
                effect,
                variant,
                parameters: probe,
            };
            let found = alike(&own, search.limits[0].low < 0.0 && !search.limits[0].held);
            if best.as_ref().is_none_or(|(best, ..)| found > *best) {
                best = Some((found, own, search.limits.clone()));
            }
        }
    }
    let Some((mut most, mut own, limits)) = best else {
        return 0.0;
    };
    if !limits[0].held {
        let range = Range {
            start: own.parameters[0],
            low: limits[0].low,
            high: limits[0].high,
            falls: effect.search(own.variant, &scale).absent == f64::INFINITY,
        };
        let with = |strength: f64| {
            let mut moved = own.clone();
            moved.parameters[0] = strength;
            Some(responses(case, &[moved]))
        };
        if let Some((strength, _)) = reach(case, d, range, with) {
            own.parameters[0] = strength;
        }
    }
    let both_signs = limits[0].low < 0.0;
    most = most.max(alike(&own, both_signs));
    for factor in [1.5, 1.2, 1.07] {
        for (k, limit) in limits.iter().enumerate().skip(1).filter(|(_, limit)| !limit.held) {
            for by in [factor, 1.0 / factor] {
                let mut moved = own.clone();
                moved.parameters[k] = (moved.parameters[k] * by).clamp(limit.low, limit.high);
                let found = alike(&moved, both_signs);
                if found > most {
                    (most, own) = (found, moved);
                }
            }
        }
    }
    most
}

/// The same of a cause that no library holds: a random variant, its shape within a factor of two of the usual.
fn hidden_outside(
    case: &mut Case,
    (id, key, start, other): Outside,
    d: f64,
) -> Option<(&'static str, String, Vec<Responses>)> {
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
    let (_, found) = reach(case, d, range, |strength| truly(case, vec![hidden(strength)]))?;
    Some(("outside", variant.unwrap_or_default().to_owned(), found))
}
