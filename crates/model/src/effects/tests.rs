//! What every effect must keep.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::tree::MECHANISMS;
use super::{
    ALL, Applied, Effect, Limits, Scale, Search, Site, effect, mechanism_of, place_of, place_of_form,
};
use crate::extended::tests::{base, context, drive};
use crate::extended::{ExtendedModel, Responses};
use ieap_domain::{Channel, ClimateQuantity, Drive, Quantity};

/// Responses of the tests' base with effects: ids, variants, parameters.
pub(super) fn respond(
    effects: &[(&str, usize, &[f64])],
    levels: &[(f64, Option<f64>)],
    current_s: &[f64],
    curvature_s: &[f64],
) -> Responses {
    let applied = |&(id, variant, parameters): &(&str, usize, &[f64])| Applied {
        effect: effect(id).unwrap(),
        variant,
        parameters: parameters.to_vec(),
    };
    let model = ExtendedModel {
        base: base(),
        effects: effects.iter().map(applied).collect(),
    };
    model.responses(&context(&drive(levels)), current_s, curvature_s)
}

const END_S: f64 = 300.0;

/// A step, a reversal, a discharge and a pulse train.
pub(super) fn drives() -> [Vec<(f64, Option<f64>)>; 4] {
    let pulse = |k: u32| {
        (
            f64::from(k) * 10.0,
            Some(if k.is_multiple_of(2) { 2.0 } else { 0.0 }),
        )
    };
    [
        vec![(0.0, Some(2.0))],
        vec![(0.0, Some(2.0)), (100.0, Some(-2.0))],
        vec![(0.0, Some(2.0)), (120.0, Some(0.0))],
        (0..30).map(pulse).collect(),
    ]
}

pub(super) fn times(count: u32) -> Vec<f64> {
    (0..=count)
        .map(|k| END_S * f64::from(k) / f64::from(count))
        .collect()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, v| most.max(v.abs()))
}

/// What sensors beside the strip read: waves between these ends.
const LOGGED: (f64, f64) = (20.0, 60.0);

pub(super) fn logged() -> Vec<Channel> {
    let wave = |t: &f64| 40.0 + 20.0 * (t / 40.0).sin();
    let of = |quantity| {
        let time_s = times(300);
        let values: Vec<f64> = time_s.iter().map(wave).collect();
        Channel::new(quantity, time_s.into(), values.into())
    };
    [
        Quantity::RelativeHumidity,
        Quantity::Temperature,
        Quantity::Pressure,
        Quantity::Oxygen,
        Quantity::Water,
    ]
    .map(of)
    .to_vec()
}

/// Sizes of what the base gives under these drives.
pub(super) fn scale() -> Scale {
    let time_s = times(600);
    let (mut current_a, mut curvature_per_cm) = (0.0_f64, 0.0_f64);
    for levels in drives() {
        let plain = respond(&[], &levels, &time_s, &time_s);
        current_a = current_a.max(largest(&plain.current_a));
        curvature_per_cm = curvature_per_cm.max(largest(&plain.curvature_per_cm));
    }
    Scale {
        base: base(),
        area_cm2: 0.1,
        length_cm: Some(0.5),
        durations_s: vec![END_S; 4],
        shortest_s: 0.5,
        voltage_v: 2.0,
        current_a,
        curvature_per_cm,
        charge_c: 0.1 * 0.7 * 2.0,
        edges: 30,
        logged: logged()
            .iter()
            .map(|own| {
                (
                    ClimateQuantity::measured(own.quantity).unwrap(),
                    LOGGED.0,
                    LOGGED.1,
                )
            })
            .collect(),
    }
}

/// Every effect in every variant.
pub(super) fn forms() -> impl Iterator<Item = (&'static dyn Effect, usize, Search)> {
    let scale = scale();
    ALL.iter().flat_map(move |&effect| {
        let scale = scale.clone();
        (0..effect.about().variants.len().max(1))
            .map(move |variant| (effect, variant, effect.search(variant, &scale)))
    })
}

pub(super) fn of(
    effect: &'static dyn Effect,
    variant: usize,
    parameters: &[f64],
    drive: &Drive,
    time_s: &[f64],
) -> Responses {
    let model = ExtendedModel {
        base: base(),
        effects: vec![Applied {
            effect,
            variant,
            parameters: parameters.to_vec(),
        }],
    };
    model.responses(&context(drive), time_s, time_s)
}

/// Largest difference in each channel, in terms of the second one's peak.
fn apart(left: &Responses, right: &Responses) -> [f64; 2] {
    let of = |left: &[f64], right: &[f64]| {
        let most = left
            .iter()
            .zip(right)
            .fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        most / largest(right)
    };
    [
        of(&left.current_a, &right.current_a),
        of(&left.curvature_per_cm, &right.curvature_per_cm),
    ]
}

/// A strength, `part` of the way between the limits, with the shape parameters at `place` between theirs.
pub(super) fn between(search: &Search, part: f64, place: f64) -> Vec<f64> {
    let inside = |(k, limits): (usize, &Limits)| {
        let part = if k == 0 { part } else { place };
        match (limits.held, limits.logarithmic) {
            (true, _) => search.probes[0][k],
            (_, true) => limits.low * (limits.high / limits.low).powf(part),
            _ => limits.low + part * (limits.high - limits.low),
        }
    };
    search.limits.iter().enumerate().map(inside).collect()
}

#[test]
fn every_effect_is_absent_at_its_absent_strength() {
    let time_s = times(150);
    for (effect, variant, search) in forms() {
        for place in [0.2, 0.7] {
            let mut parameters = between(&search, 0.0, place);
            parameters[0] = search.absent;
            for levels in drives() {
                let drive = drive(&levels);
                let with = of(effect, variant, &parameters, &drive, &time_s);
                let without = respond(&[], &levels, &time_s, &time_s);
                let apart = apart(&with, &without);
                let id = effect.about().id;
                assert!(
                    apart.iter().all(|a| *a < 1e-9),
                    "{id} {variant}: {apart:?} under {levels:?}"
                );
            }
        }
    }
}

#[test]
fn every_effect_is_seen_at_its_probes() {
    let time_s = times(600);
    for (effect, variant, search) in forms() {
        let id = effect.about().id;
        assert!(!search.probes.is_empty(), "{id} {variant}");
        for probe in &search.probes {
            assert_eq!(probe.len(), effect.about().parameters.len(), "{id}");
            assert_eq!(search.limits.len(), probe.len(), "{id}");
            for (value, limits) in probe.iter().zip(&search.limits) {
                assert!(
                    limits.held || (limits.low..=limits.high).contains(value),
                    "{id} {variant}: {probe:?} {search:?}"
                );
            }
            let mut most = [0.0_f64; 2];
            for levels in drives() {
                let with = of(effect, variant, probe, &drive(&levels), &time_s);
                let apart = apart(&with, &respond(&[], &levels, &time_s, &time_s));
                most = [most[0].max(apart[0]), most[1].max(apart[1])];
            }
            if effect.acts_in(probe, 0) {
                if std::env::var_os("IEAP_SHOW").is_some() {
                    eprintln!(
                        "{id} {variant} {probe:.4?}: {:.2} % {:.2} %",
                        100.0 * most[0],
                        100.0 * most[1]
                    );
                }
                assert!(most[0].max(most[1]) > 1e-4, "{id} {variant} {probe:?}: {most:?}");
            }
        }
    }
}

/// The error of a step is small against what the effect itself changes.
#[test]
fn halving_all_steps_changes_little() {
    let (coarse_s, fine_s) = (times(300), times(600));
    let every_second = |values: &[f64]| values.iter().copied().step_by(2).collect();
    let mut failed = Vec::new();
    for (effect, variant, search) in forms() {
        for (part, place) in [(0.15, 0.5), (0.9, 0.3)] {
            let parameters = between(&search, part, place);
            for levels in drives() {
                let drive = drive(&levels);
                let coarse = of(effect, variant, &parameters, &drive, &coarse_s);
                let fine = of(effect, variant, &parameters, &drive, &fine_s);
                let fine = Responses {
                    current_a: every_second(&fine.current_a),
                    curvature_per_cm: every_second(&fine.curvature_per_cm),
                    ..Responses::default()
                };
                let changed = apart(&coarse, &respond(&[], &levels, &coarse_s, &coarse_s));
                let left = apart(&coarse, &fine);
                for k in 0..2 {
                    if left[k] > 2e-3 * changed[k] + 1e-9 {
                        let id = effect.about().id;
                        failed.push(format!(
                            "{id} {variant} {parameters:?} channel {k}: {:.1e} of {:.1e} {} edges",
                            left[k],
                            changed[k],
                            levels.len()
                        ));
                    }
                }
            }
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}

/// Every shape costs a simulation of the group in every diagnosis.
#[test]
fn few_shapes_are_asked_for() {
    let scale = scale();
    let runs = scale.durations_s.len();
    let mut whole = 0.0;
    for (effect, variant, search) in forms() {
        // Shapes of one run cost a run.
        let of_one = search.probes.iter().any(|probe| !effect.acts_in(probe, 0));
        let shapes = search.probes.len() as f64 / if of_one { runs as f64 } else { 1.0 };
        let id = effect.about().id;
        if std::env::var_os("IEAP_SHOW").is_some() {
            eprintln!(
                "{id} {variant}: {} probes, {shapes} of a group",
                search.probes.len()
            );
        }
        assert!(shapes <= 10.0, "{id} {variant}: {shapes}");
        whole += shapes;
    }
    assert!(whole <= 280.0, "{whole}");
}

#[test]
fn everything_is_said_of_every_effect() {
    for effect in ALL.iter() {
        let about = effect.about();
        let texts = [
            about.id,
            about.code,
            about.summary,
            about.equation,
            about.vanishes,
            about.signature,
            about.separated_by,
            about.sources,
        ];
        assert!(texts.iter().all(|text| !text.trim().is_empty()), "{}", about.id);
        assert!(
            !about.parameters.is_empty() && !about.twins.is_empty(),
            "{}",
            about.id
        );
        for twin in about.twins {
            assert!(
                super::effect(twin).is_some() && *twin != about.id,
                "{}: {twin}",
                about.id
            );
        }
        for parameter in about.parameters {
            assert!(
                !parameter.symbol.is_empty() && !parameter.meaning.is_empty(),
                "{}",
                about.id
            );
            let unit = parameter
                .unit
                .to_lowercase()
                .replace("1/", "per_")
                .replace('/', "_per_");
            let unit = unit
                .replace("sqrt(s)", "sqrt_s")
                .replace(['(', ')'], "")
                .replace(' ', "_");
            // The one key whose unit is named otherwise: the curvature's centimetre stands before the charge.
            let said = parameter.key.ends_with(&unit) || parameter.key == "quadratic_cm_per_c2";
            assert!(said, "{}: {} in {}", about.id, parameter.key, parameter.unit);
        }
    }
}

#[test]
fn effects_stand_in_the_order_of_the_catalogue() {
    let place = |e: &&dyn Effect| {
        let (class, number) = e.about().code.split_at(1);
        ("EMKNG".find(class).unwrap(), number.parse::<u32>().unwrap())
    };
    assert!(ALL.is_sorted_by_key(place));
    assert_eq!(ALL.len(), 56);
}

#[test]
fn every_effect_has_its_place_and_every_mechanism_its_effects() {
    for effect in ALL.iter() {
        assert!(place_of(effect.about().id).is_some(), "{}", effect.about().id);
        let forms = 0..effect.about().variants.len();
        let of_form = |form| place_of_form(effect.about().id, form);
        assert!(forms.clone().all(|form| of_form(form).is_some()));
    }
    for own in MECHANISMS {
        let is_of = |effect: &&dyn Effect| mechanism_of(effect.about().id) == Some(own);
        assert!(ALL.iter().any(is_of) || own.site == Site::Runs, "{own:?}");
    }
    let site = |effect| mechanism_of(effect).map(|own| own.site);
    assert_eq!(site("follows:batch"), Some(Site::Runs));
    assert_eq!(site("no-such-effect"), None);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, rng_seed: RngSeed::Fixed(7), ..ProptestConfig::default() })]

    /// Alone, and three at a time, at the ends of their limits and between.
    #[test]
    fn responses_are_finite_within_the_limits(
        parts in proptest::collection::vec((prop_oneof![Just(0.0), Just(1.0), 0.0..1.0], 0.0..=1.0), 3),
        shift in 0usize..100,
    ) {
        let time_s = times(40);
        let all: Vec<_> = forms().collect();
        for k in 0..all.len() {
            let three = [k, (k + shift + 1) % all.len(), (k + 2 * shift + 5) % all.len()];
            let applied = |(&k, &(part, place)): (&usize, &(f64, f64))| Applied {
                effect: all[k].0,
                variant: all[k].1,
                parameters: between(&all[k].2, part, place),
            };
            let effects: Vec<Applied> = three.iter().zip(&parts).map(applied).collect();
            let names: Vec<_> = effects.iter().map(|e| (e.effect.about().id, e.variant, e.parameters.clone())).collect();
            let drive = drive(&drives()[k % 4]);
            for effects in [effects[..1].to_vec(), effects] {
                let model = ExtendedModel { base: base(), effects };
                let found = model.responses(&context(&drive), &time_s, &time_s);
                let finite = found.current_a.iter().chain(&found.curvature_per_cm).all(|y| y.is_finite());
                prop_assert!(finite, "{names:?}");
            }
        }
    }
}
