//! How well drawn strips come back from their pictures: `cargo run --release --example traced_truth -- 400 1`
//!
//! Random scenes: thickness, blur, noise, light, dust, reflections, sides, tones, arcs and unevenly bent strips. Errors
//! are told in tolerances (1 % or 0.005 /cm, whichever is more, of a strip of 45 mm; 0.3 pixel at the tip) and in the
//! standard errors that the trace states. The first number says how many scenes are drawn, the second is the seed; a
//! third word `worst` lists the worst scenes.

#[allow(dead_code)]
#[path = "../tests/it/rendered.rs"]
mod rendered;

use ieap::strip::{Gray, Trace, View, trace};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use rendered::{Held, Scene};

/// Length of the strip in cm, for the tolerance.
const LENGTH_CM: f64 = 4.5;
const JOINTS: usize = 19;

/// A scene with the shape in it: curvature at the clamp and beyond, 1/pixel, and the length over which it falls.
#[derive(Debug, Clone)]
struct Case {
    scene: Scene,
    length_px: f64,
    at_clamp: f64,
    beyond: f64,
    falls_px: f64,
}

impl Case {
    /// Drawn from a seed; none where the strip would leave the picture.
    fn of(seed: u64) -> Option<Case> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        let length_px = between(500.0, 1100.0);
        let turn = between(-1.6, 1.6);
        let uneven = between(0.0, 1.0) < 0.5;
        let case = Case {
            length_px,
            at_clamp: turn / length_px * if uneven { between(1.5, 3.0) } else { 1.0 },
            beyond: turn / length_px * if uneven { between(0.0, 0.5) } else { 1.0 },
            falls_px: length_px * between(0.15, 0.6),
            scene: Scene {
                held: [Held::Left, Held::Right, Held::Top, Held::Bottom][between(0.0, 4.0) as usize],
                root: between(0.15, 0.85),
                tilt_rad: between(-0.25, 0.25),
                thickness: 4.0 * 8f64.powf(between(0.0, 1.0)),
                dark: between(0.0, 1.0) < 0.5,
                blur: between(0.6, 1.8),
                noise: between(1.0, 4.0),
                uneven: between(0.0, 0.6),
                dust: if between(0.0, 1.0) < 0.4 { 30 } else { 0 },
                reflection: between(0.0, 1.0) < 0.3,
                seed,
                ..Scene::default()
            },
        };
        case.is_in_view().then_some(case)
    }

    fn curvature(&self, s: f64) -> f64 {
        self.beyond + (self.at_clamp - self.beyond) * (-s / self.falls_px).exp()
    }

    /// Whether the strip stays well within the picture, followed in coarse steps.
    fn is_in_view(&self) -> bool {
        let scene = &self.scene;
        let (w, h) = (scene.width as f64, scene.height as f64);
        let quarter = std::f64::consts::FRAC_PI_2;
        let (mut x, mut y, straight) = match scene.held {
            Held::Left => (0.0, scene.root * h, 0.0),
            Held::Right => (w, scene.root * h, 2.0 * quarter),
            Held::Top => (scene.root * w, 0.0, quarter),
            Held::Bottom => (scene.root * w, h, -quarter),
        };
        let mut angle = straight - scene.tilt_rad;
        let margin = scene.thickness + 20.0;
        let steps = self.length_px as usize;
        (0..steps).all(|k| {
            x += angle.cos();
            y += angle.sin();
            angle -= self.curvature(k as f64);
            let far = k as f64 > 2.0 * margin;
            !far || (margin..w - margin).contains(&x) && (margin..h - margin).contains(&y)
        })
    }
}

/// One joint of a traced scene: its number, the error in tolerances and in standard errors.
struct Joint {
    number: usize,
    in_tolerances: f64,
    in_errors: f64,
}

struct Found {
    case: Case,
    joints: Vec<Joint>,
    tip_px: f64,
}

fn traced(case: &Case) -> Result<Trace, String> {
    let frame = case.scene.draw(case.length_px, |s| case.curvature(s));
    let values = frame.pixels.iter().map(|v| f32::from(*v) / 255.0).collect();
    let gray = Gray::new(frame.width, frame.height, values).ok_or("no picture")?;
    trace(&gray, &View::default()).map_err(|refusal| refusal.to_string())
}

fn found(case: Case) -> Result<Found, String> {
    let tip = case.scene.draw(case.length_px, |s| case.curvature(s)).tip;
    let traced = traced(&case)?;
    let px_per_cm = case.length_px / LENGTH_CM;
    let joint = |number: usize| {
        let s = case.length_px * number as f64 / (JOINTS + 1) as f64;
        let (value, error) = traced.curvature_per_px(s);
        let off = (value - case.curvature(s)) * px_per_cm;
        Joint {
            number,
            in_tolerances: off / (0.01 * case.curvature(s).abs() * px_per_cm).max(0.005),
            in_errors: off / (error * px_per_cm),
        }
    };
    let (x, y) = traced.tip_px();
    Ok(Found {
        joints: (1..=JOINTS).map(joint).collect(),
        tip_px: (x - tip.0).hypot(y - tip.1),
        case,
    })
}

fn line(name: &str, all: &[Found], keep: impl Fn(&Found, &Joint) -> bool) {
    let joints = all
        .iter()
        .flat_map(|found| found.joints.iter().map(move |joint| (found, joint)));
    let kept: Vec<&Joint> = joints
        .filter(|(found, joint)| keep(found, joint))
        .map(|(_, joint)| joint)
        .collect();
    let n = kept.len().max(1) as f64;
    let share =
        |is: &dyn Fn(&Joint) -> bool| 100.0 * kept.iter().filter(|joint| is(joint)).count() as f64 / n;
    let rms = (kept.iter().map(|joint| joint.in_errors.powi(2)).sum::<f64>() / n).sqrt();
    let worst = kept
        .iter()
        .map(|joint| joint.in_tolerances.abs())
        .fold(0.0, f64::max);
    println!(
        "| {name} | {} | {:.1} | {worst:.2} | {rms:.2} | {:.1} |",
        kept.len(),
        share(&|joint| joint.in_tolerances.abs() <= 1.0),
        share(&|joint| joint.in_errors.abs() <= 1.96)
    );
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Vec<u64> = words.iter().filter_map(|text| text.parse().ok()).collect();
    let (scenes, seed) = (
        numbers.first().copied().unwrap_or(400),
        numbers.get(1).copied().unwrap_or(1),
    );
    let cases: Vec<Case> = (seed * 1_000_000..)
        .filter_map(Case::of)
        .take(scenes as usize)
        .collect();
    let outcomes: Vec<Result<Found, String>> = cases.into_par_iter().map(found).collect();
    let (mut all, mut refused) = (Vec::new(), Vec::new());
    for outcome in outcomes {
        match outcome {
            Ok(found) => all.push(found),
            Err(reason) => refused.push(reason),
        }
    }
    println!("{scenes} scenes from seed {seed}, {} traced", all.len());
    refused.iter().for_each(|reason| println!("  refused: {reason}"));
    let mut tips: Vec<f64> = all.iter().map(|found| found.tip_px).collect();
    tips.sort_by(f64::total_cmp);
    let within = tips.iter().filter(|off| **off < 0.3).count();
    println!(
        "tips within 0.3 px: {within} of {}, worst {:.2} px",
        tips.len(),
        tips.last().copied().unwrap_or(0.0)
    );
    println!(
        "\n| joints | number | within tolerance, % | worst, tolerances | rms error, stated errors | within 1.96, % |"
    );
    println!("|---|---|---|---|---|---|");
    line("all", &all, |_, _| true);
    line("1", &all, |_, joint| joint.number == 1);
    line("2 and 3", &all, |_, joint| (2..=3).contains(&joint.number));
    line("4 to 16", &all, |_, joint| (4..=16).contains(&joint.number));
    line("17 and 18", &all, |_, joint| (17..=18).contains(&joint.number));
    line("19", &all, |_, joint| joint.number == 19);
    line("thinner than 10 px", &all, |found, _| {
        found.case.scene.thickness < 10.0
    });
    line("thicker than 20 px", &all, |found, _| {
        found.case.scene.thickness > 20.0
    });
    line("with reflections", &all, |found, _| found.case.scene.reflection);
    line("without reflections or dust", &all, |found, _| {
        !found.case.scene.reflection && found.case.scene.dust == 0
    });
    if words.iter().any(|word| word == "worst") {
        let worst = |found: &Found| {
            found
                .joints
                .iter()
                .map(|j| j.in_tolerances.abs())
                .fold(0.0, f64::max)
        };
        all.sort_by(|a, b| worst(b).total_cmp(&worst(a)));
        for found in all.iter().take(12) {
            println!("\n{:?}\ntip {:.2} px", found.case, found.tip_px);
            let told = found
                .joints
                .iter()
                .map(|j| format!("{:.1}({:.1})", j.in_tolerances, j.in_errors));
            println!(
                "errors in tolerances (in stated errors): {}",
                told.collect::<Vec<_>>().join(" ")
            );
        }
    }
}
