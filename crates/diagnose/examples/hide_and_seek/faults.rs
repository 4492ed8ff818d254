//! Faults of the data that no cause in the strip explains: what is made of them, and whether the strip is blamed.

use ieap_diagnose::RunInput;
use ieap_domain::{Channel, Verdict};
use ieap_model::effects::ALL;
use rand::RngExt;

use crate::benchmark::{Extent, each, percent};
use crate::case::{Case, Plan, case, inputs, measured, responses};
use crate::methods::{METHODS, ORACLE, OURS, Said, judged};

/// Name of a fault, and how a channel's values are changed: by the case's noise, current (0) or curvature (1), run.
type Fault = (&'static str, fn(&mut Case, &mut [Vec<Channel>]));

/// Causes beside those of geometry and camera that lie in the instrument and not in the strip.
const OF_INSTRUMENT: [&str; 4] = [
    "current-limit",
    "source-rise",
    "current-offset",
    "residual-charge",
];

const FAULTS: [Fault; 8] = [
    ("one run's current in the wrong unit (x 1000)", |_, runs| {
        change(&mut runs[1], 0, |v| v * 1000.0);
    }),
    ("the sign of one run's bending turned", |_, runs| {
        change(&mut runs[1], 1, |v| -v)
    }),
    ("the bending of two runs exchanged", |_, runs| {
        let (first, second) = (runs[0][1].clone(), runs[3][1].clone());
        (runs[0][1], runs[3][1]) = (second, first);
    }),
    ("the step of one run 5 s late", |_, runs| {
        let n = runs[0][0].values.len();
        for channel in &mut runs[0] {
            let old = channel.values.to_vec();
            let first = old[0];
            channel.values = (0..n)
                .map(|k| if k < 5 { 0.1 * first } else { old[k - 5] })
                .collect();
        }
    }),
    ("spikes of 30 sigmas in one reading of 20", |case, runs| {
        let sd = [case.noise.current_a, case.noise.curvature_per_cm];
        for run in runs {
            for (channel, sd) in run.iter_mut().zip(sd) {
                let spiked = channel.values.iter().map(|v| {
                    if case.generator.random_bool(0.05) {
                        v + 30.0
                            * sd
                            * if case.generator.random_bool(0.5) {
                                1.0
                            } else {
                                -1.0
                            }
                    } else {
                        *v
                    }
                });
                channel.values = spiked.collect();
            }
        }
    }),
    ("a third of one run's bending frozen", |_, runs| {
        let old = runs[3][1].values.to_vec();
        let frozen = |k: usize| (200..400).contains(&k);
        runs[3][1].values = (0..old.len())
            .map(|k| if frozen(k) { old[200] } else { old[k] })
            .collect();
    }),
    ("the current of one run cut off at half its peak", |_, runs| {
        let peak = runs[2][0].values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        change(&mut runs[2], 0, |v| v.clamp(-0.5 * peak, 0.5 * peak));
    }),
    ("the camera's clock 2 % fast", |_, runs| {
        for run in runs {
            let fast: Vec<f64> = run[1].time_s.iter().map(|t| 1.02 * t).collect();
            run[1].time_s = fast.into();
        }
    }),
];

fn change(run: &mut [Channel], channel: usize, to: impl Fn(f64) -> f64) {
    run[channel].values = run[channel].values.iter().map(|v| to(*v)).collect();
}

/// Whether a cause lies in the instrument, the camera or the geometry.
fn is_of_instrument(id: &str) -> bool {
    let of_camera = |code: &str| code.starts_with('G');
    let about = ALL
        .iter()
        .map(|effect| effect.about())
        .find(|about| about.id == id);
    OF_INSTRUMENT.contains(&id) || about.is_some_and(|about| of_camera(about.code))
}

/// Counts what is made of every fault.
pub fn faults(extent: &Extent) {
    println!("### A fault of the data, five drives: the strip is blamed by one name, in percent (seen)\n");
    println!(
        "| fault | groups | {} | ours: a cause of the instrument, or a data problem, given | ours: unknown |",
        METHODS[..ORACLE].join(" | ")
    );
    println!("|---|---|{}---|---|", "---|".repeat(ORACLE));
    for (name, fault) in FAULTS {
        let seeds: Vec<u64> = (0..10 * extent.each).collect();
        let found: Vec<(Vec<Said>, [bool; 2])> = each(&seeds, |seed| {
            let mut case = case(extent.first + 400_000 + seed, Plan::default());
            let plain = responses(&case, &[]);
            let mut channels = measured(&mut case, &plain);
            fault(&mut case, &mut channels);
            let runs: Vec<RunInput> = inputs(&case, &channels);
            let (found, said) = judged(&runs);
            let of_instrument = found.set.iter().any(|id| is_of_instrument(id));
            let told = found.verdict == Verdict::DataProblem || of_instrument;
            Some((said, [told, found.verdict == Verdict::Unknown]))
        });
        let n = found.len();
        let blamed = |said: &Said| said.name.as_deref().is_some_and(|id| !is_of_instrument(id));
        let cells: Vec<String> = (OURS..ORACLE)
            .map(|k| {
                let count =
                    |what: &dyn Fn(&Said) -> bool| found.iter().filter(|(said, _)| what(&said[k])).count();
                format!(
                    "{} ({})",
                    percent(count(&blamed), n),
                    percent(count(&|said| said.seen), n)
                )
            })
            .collect();
        let of = |k: usize| percent(found.iter().filter(|(_, flags)| flags[k]).count(), n);
        println!("| {name} | {n} | {} | {} | {} |", cells.join(" | "), of(0), of(1));
    }
    println!();
}
