//! Strips in views drawn at random, in another way than those of `frames`: `examples/random_strips` tells how well many
//! are traced, here a few are held against what is promised. `IEAP_LONG=1` asks many.

#[allow(dead_code)]
#[path = "../../examples/random_strips/optics.rs"]
mod optics;
#[allow(dead_code)]
#[path = "../../examples/random_strips/paint.rs"]
mod paint;
#[allow(dead_code)]
#[path = "../../examples/random_strips/scene.rs"]
mod scene;

use ieap::strip::{Gray, Trace, trace};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use scene::{HEIGHT, View, WIDTH};

fn traced(view: &View) -> (Trace, (f64, f64)) {
    let (line, before) = view.painted.line(&|s| view.curvature(s));
    let light = view.painted.light(WIDTH, HEIGHT, &line, before);
    let values = view
        .camera
        .picture(&light, &mut ChaCha8Rng::seed_from_u64(view.seed ^ 0x5eed));
    let values = values.iter().map(|value| f32::from(*value) / 255.0).collect();
    let gray = Gray::new(WIDTH, HEIGHT, values).unwrap();
    let found = trace(&gray, &ieap::strip::View::default());
    let found = found.unwrap_or_else(|refusal| panic!("view {}: {refusal}", view.seed));
    (found, line[line.len() - 1].0)
}

/// Error over tolerance (1 % or 0.005/cm of a strip of 45 mm) and over the stated error, of each of 19 joints.
fn errors(view: &View, found: &Trace) -> Vec<(f64, f64)> {
    let length = view.painted.length_px;
    (1..20)
        .map(|k| {
            let s = length * f64::from(k) / 20.0;
            let (value, error) = found.curvature_per_px(s);
            let truth = view.curvature(s);
            let off = (value - truth).abs();
            (off / (0.01 * truth.abs()).max(0.0225 / length), off / error)
        })
        .collect()
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn clean_views_keep_what_is_promised_or_say_that_they_do_not_know() {
    let views = match std::env::var_os("IEAP_LONG") {
        Some(_) => 200,
        None => 12,
    };
    let each: Vec<_> = (9000..9000 + views)
        .into_par_iter()
        .map(|seed| {
            let view = View::random(seed, true);
            let (found, tip) = traced(&view);
            let at = found.tip_px();
            (seed, errors(&view, &found), (at.0 - tip.0).hypot(at.1 - tip.1))
        })
        .collect();
    let (mut beyond, mut joints, mut unsaid) = (0, 0, 0);
    for (seed, errors, tip) in &each {
        // A camera's gamma makes a dark strip shorter by a good part of the blur.
        assert!(*tip < 1.2, "view {seed}: tip off by {tip:.2} px");
        joints += errors.len();
        beyond += errors.iter().filter(|error| error.0 > 1.0).count();
        unsaid += errors
            .iter()
            .filter(|error| error.0 > 1.0 && error.1 > 3.0)
            .count();
    }
    assert!(
        beyond as f64 <= 0.05 * joints as f64,
        "{beyond} of {joints} joints"
    );
    assert!(
        unsaid as f64 <= 0.01 * joints as f64,
        "{unsaid} of {joints} joints"
    );
}

/// Something shines along an edge over a fifth of the length: the other edge tells where the strip is.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_shine_along_an_edge_does_not_bend_the_line() {
    for seed in [5015, 5027, 5101, 5111] {
        let view = View::random(seed, false);
        assert!(view.painted.shine.is_some());
        let (found, tip) = traced(&view);
        let at = found.tip_px();
        let off = (at.0 - tip.0).hypot(at.1 - tip.1);
        assert!(off < 0.8, "view {seed}: tip off by {off:.2} px");
        for (k, (by_tolerance, by_error)) in errors(&view, &found).into_iter().enumerate() {
            assert!(
                by_tolerance < 1.0 || by_error < 5.0,
                "view {seed}, joint {}: {by_tolerance:.1} of the tolerance, {by_error:.1} of the error",
                k + 1
            );
        }
    }
}
