//! A model that is extended begins at its base: whatever it is extended by, it describes the readings no worse.

use super::*;
use crate::extended::fits::extend;
use ieap_model::ModelChoice;
use ieap_model::effects::smooth_laws::SMOOTH_LAWS;
use ieap_model::effects::{ALL, Effect, Scale};
use rand::RngExt;

use crate::fitting::scale::scale;

/// Drawn sizes of one of these, which the extended models do not hold, in a group of two drives.
fn drawn(seed: u64) -> Runs {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let part = |random: &mut ChaCha8Rng| random.random_range(0.2..1.0);
    let branches = [30.0, 0.03, 120.0, 0.15].map(|own| own * (0.5 + part(&mut random)));
    let base = sample(
        branches,
        3000.0 * part(&mut random),
        20.0,
        0.02 * part(&mut random),
    );
    let filling: Hidden = (
        "voltage-dependent-capacitance",
        Some("all"),
        &[("quadratic_per_v2", 0.3)],
    );
    let curved: Hidden = ("quadratic-coupling", None, &[("quadratic_cm_per_c2", 60.0)]);
    let hidden = [filling, curved];
    let chosen = random.random_range(0..2_usize);
    let drives: [&[Levels]; 3] = [&[STEP, DISCHARGED], &[HALF, REVERSED], &[STEP, HALF, PULSES]];
    Runs::beside(
        &base,
        &hidden[chosen..=chosen],
        drives[random.random_range(0..3_usize)],
        seed,
    )
}

/// Whether an effect has a strength that can be none in these data.
fn is_nested(effect: &dyn Effect, scale: &Scale) -> bool {
    let forms = effect.about().variants.len().max(1);
    (0..forms).all(|form| {
        effect
            .search(form, scale)
            .limits
            .first()
            .is_none_or(|own| !own.held)
    })
}

/// Extended models of drawn groups that describe them worse than the base does.
fn worse(seeds: std::ops::Range<u64>, every: usize) -> (usize, Vec<String>) {
    let (mut tried, mut found) = (0, Vec::new());
    for seed in seeds {
        let runs = drawn(seed);
        let inputs = runs.inputs();
        let choice = ModelChoice::parse("lumped-2").unwrap();
        let laws = SMOOTH_LAWS.iter().map(|law| *law as &'static dyn Effect);
        let all: Vec<&'static dyn Effect> = ALL.iter().copied().chain(laws).collect();
        with_base(&group::RunGroup::new(&inputs), choice.base, |group, base| {
            let scale = scale(group, &base.problem, &base.at);
            for &effect in all.iter().skip(seed as usize % every).step_by(every) {
                if !is_nested(effect, &scale) {
                    continue;
                }
                let choice = ModelChoice {
                    effects: vec![effect],
                    ..choice.clone()
                };
                if let Some(extended) = extend(group, base.clone(), &choice) {
                    tried += 1;
                    let more = extended.square - base.square;
                    if more > 1e-6 * base.square {
                        found.push(format!(
                            "{seed}: {} {more:.1} of {:.1}",
                            effect.about().id,
                            base.square
                        ));
                    }
                }
            }
        })
        .unwrap();
    }
    (tried, found)
}

#[test]
fn an_extended_model_is_never_worse_than_its_base() {
    let (seeds, every) = match std::env::var_os("IEAP_LONG") {
        Some(_) => (300..312, 4),
        None => (309..310, 1),
    };
    let (tried, worse) = worse(seeds, every);
    println!("{tried} extended models, {} worse", worse.len());
    assert!(tried > 20 && worse.is_empty(), "of {tried}: {worse:#?}");
}
