//! Hides effects in simulated groups of runs and counts what a diagnosis makes of them.
//!
//! `cargo run --release --example hide_and_seek -- null 500 [first seed]`, `-- effects 5 8,16,32 [id ...]`, `-- outside 8 16,64`, or
//! `-- short`, which fails where a few groups of each kind come out worse than chance would have them.
//!
//! Environment: `SHOW=1` and `NOISE=1` print details, `GROWING=1` lets the noise at the largest signal of a run be
//! `sqrt(1 + GROWING^2)` times that at none.

use std::collections::BTreeMap;

use ieap::diagnose::{DesignRun, DiagnoseOptions, KnownNoise, RunInput, diagnose_group, sigmas_after_refit};
use ieap::domain::{Channel, Drive, Level, Quantity, Segment, Verdict};
use ieap::fit::FitInput;
use ieap::model::effects::{ALL, Applied, Effect, Scale};
use ieap::model::extended::{ExtendedModel, Responses, RunContext};
use ieap::model::truth::{HiddenEffect, Truth, simulate};
use ieap::model::{Branch, LumpedModel};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let count: u64 = arguments.get(1).and_then(|n| n.parse().ok()).unwrap_or(20);
    match arguments.first().map(String::as_str) {
        Some("null") => {
            let first = arguments.get(2).and_then(|n| n.parse().ok()).unwrap_or(0);
            let _ = nulls(first, count);
        }
        Some("short") => short(),
        Some("outside") => {
            let strengths = arguments
                .get(2)
                .map_or("16", String::as_str)
                .split(',')
                .filter_map(|d| d.parse().ok());
            strengths.for_each(|d| outside(count, d));
        }
        Some("effects") => {
            let strengths: Vec<f64> = arguments
                .get(2)
                .map_or("16", String::as_str)
                .split(',')
                .filter_map(|d| d.parse().ok())
                .collect();
            let _ = effects(count, &strengths, &arguments[3.min(arguments.len())..]);
        }
        _ => eprintln!(
            "usage: hide_and_seek null N [FIRST SEED] | effects N 8,16,32 [id ...] | outside N 16,64 | short"
        ),
    }
}

/// The short form, on fixed seeds: limits that the long form passes by far.
fn short() {
    let (false_alarms, named) = nulls(0, 60);
    // 5 % of 60 are 3: other seeds would give 11 or more by chance in less than 1 of 3,000 runs.
    let mut failed = Vec::new();
    if false_alarms > 10 || named > 1 {
        failed.push(format!(
            "{false_alarms} of 60 clean groups had p < 0.05, {named} were given a name"
        ));
    }
    let ids = [
        "faradaic-leak",
        "voltage-dependent-capacitance",
        "partial-relaxation",
        "softening",
        "slow-branch",
    ];
    let total = effects(3, &[32.0], &ids.map(str::to_owned));
    let [hidden, seen, in_set, _, wrong, ..] = total;
    if hidden < 12 || seen < hidden || 10 * in_set < 8 * hidden || wrong > 1 {
        failed.push(format!(
            "of {hidden} hidden effects {seen} were seen, {in_set} in the set, {wrong} given a wrong name"
        ));
    }
    failed
        .iter()
        .for_each(|what| eprintln!("hide and seek failed: {what}"));
    std::process::exit(i32::from(!failed.is_empty()));
}

const AREA: f64 = 0.1;
const LENGTH: f64 = 0.5;

struct Case {
    base: LumpedModel,
    design: Vec<DesignRun>,
    noise: KnownNoise,
    generator: ChaCha8Rng,
}

fn case(seed: u64) -> Case {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    let mut about = |value: f64| value * generator.random_range(-0.7..0.7_f64).exp();
    let (r1, c1, r2, c2) = (about(30.0), about(0.03), about(120.0), about(0.15));
    let base = LumpedModel {
        branches: vec![
            Branch {
                resistance_ohm_cm2: r1,
                capacitance_f_per_cm2: c1,
            },
            Branch {
                resistance_ohm_cm2: r2,
                capacitance_f_per_cm2: c2.max(3.0 * r1 * c1 / r2),
            },
        ],
        steady_state_resistance_ohm_cm2: about(3000.0),
        charge_to_curvature_per_c_cm: about(20.0),
        relaxation_rate_per_s: about(0.01),
    };
    let time_s: Vec<f64> = (1..=600).map(f64::from).collect();
    let pulses: Vec<(f64, f64)> = (0..30)
        .map(|k| (20.0 * f64::from(k), if k % 2 == 0 { 2.0 } else { 0.0 }))
        .collect();
    let drives = [
        vec![(0.0, 2.0)],
        vec![(0.0, 1.0)],
        vec![(0.0, -2.0)],
        vec![(0.0, 2.0), (300.0, 0.0)],
        pulses,
    ];
    let of = |levels: &Vec<(f64, f64)>| DesignRun {
        drive: Drive {
            baseline_v: 0.0,
            segments: levels
                .iter()
                .map(|&(start_s, v)| Segment {
                    start_s,
                    level: Level::Voltage(v),
                })
                .collect(),
        },
        area_cm2: AREA,
        current_time_s: time_s.clone(),
        curvature_time_s: time_s.clone(),
    };
    let peak_a = AREA * 2.0 * (1.0 / r1 + 1.0 / r2);
    let charge = AREA * 2.0 * (c1 + base.branches[1].capacitance_f_per_cm2);
    let noise = KnownNoise {
        current_a: 0.004 * peak_a,
        curvature_per_cm: 0.006 * charge * base.charge_to_curvature_per_c_cm,
        autocorrelation: [0.0, 0.3, 0.6, 0.8][(seed % 4) as usize],
    };
    Case {
        base,
        design: drives.iter().map(of).collect(),
        noise,
        generator,
    }
}

fn responses(case: &Case, applied: &[Applied]) -> Vec<Responses> {
    let model = ExtendedModel {
        base: case.base.clone(),
        effects: applied.to_vec(),
    };
    let each = case.design.iter().enumerate().map(|(index, run)| {
        let context = RunContext {
            index,
            drive: &run.drive,
            area_cm2: AREA,
            length_cm: Some(LENGTH),
            duration_s: 600.0,
            resolved_s: None,
        };
        model.responses(&context, &run.current_time_s, &run.curvature_time_s)
    });
    each.collect()
}

/// The same by the truth simulator, which shares no code with the library.
fn true_responses(case: &Case, applied: &Applied) -> Option<Vec<Responses>> {
    let about = applied.effect.about();
    let keys = about.parameters.iter().map(|p| p.key.to_owned());
    let hidden = HiddenEffect {
        id: about.id.to_owned(),
        variant: about.variants.get(applied.variant).map(|v| (*v).to_owned()),
        parameters: keys.zip(applied.parameters.iter().copied()).collect(),
    };
    truly(case, hidden)
}

fn truly(case: &Case, hidden: HiddenEffect) -> Option<Vec<Responses>> {
    let truth = Truth {
        branches: case.base.branches.clone(),
        steady_state_resistance_ohm_cm2: case.base.steady_state_resistance_ohm_cm2,
        charge_to_curvature_per_c_cm: case.base.charge_to_curvature_per_c_cm,
        relaxation_rate_per_s: case.base.relaxation_rate_per_s,
        area_cm2: AREA,
        length_cm: Some(LENGTH),
        width_cm: None,
        effects: vec![hidden.clone()],
    };
    let each = case.design.iter().enumerate().map(|(index, run)| {
        let found = simulate(
            &truth,
            &run.drive,
            &run.current_time_s,
            &run.curvature_time_s,
            index,
        );
        let found = found.map_err(|error| eprintln!("{}: {error}", hidden.id)).ok()?;
        Some(Responses {
            current_a: found.current_a,
            curvature_per_cm: found.curvature_per_cm,
        })
    });
    each.collect()
}

fn noisy(values: &[f64], sd: f64, rho: f64, generator: &mut impl Rng) -> Vec<f64> {
    let mut state: f64 = StandardNormal.sample(generator);
    let new = (1.0 - rho * rho).sqrt();
    let peak = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let growing: f64 = std::env::var("GROWING")
        .ok()
        .and_then(|g| g.parse().ok())
        .unwrap_or(0.0);
    let each = values.iter().map(|v| {
        let sd = sd * (1.0 + (growing * v / peak).powi(2)).sqrt();
        let out = v + sd * state;
        let next: f64 = StandardNormal.sample(generator);
        state = rho * state + new * next;
        out
    });
    each.collect()
}

fn diagnose(case: &mut Case, responses: &[Responses]) -> ieap::domain::GroupDiagnosis {
    let rho = case.noise.autocorrelation;
    let channels: Vec<Vec<Channel>> = case
        .design
        .iter()
        .zip(responses)
        .map(|(run, response)| {
            let current = noisy(
                &response.current_a,
                case.noise.current_a,
                rho,
                &mut case.generator,
            );
            let bent = noisy(
                &response.curvature_per_cm,
                case.noise.curvature_per_cm,
                rho,
                &mut case.generator,
            );
            vec![
                Channel::new(
                    Quantity::Current,
                    run.current_time_s.as_slice().into(),
                    current.into(),
                ),
                Channel::new(
                    Quantity::Curvature,
                    run.curvature_time_s.as_slice().into(),
                    bent.into(),
                ),
            ]
        })
        .collect();
    let names = ["+2 V", "+1 V", "-2 V", "discharge", "pulses"];
    let runs: Vec<RunInput> = case
        .design
        .iter()
        .zip(&channels)
        .zip(names)
        .map(|((run, channels), name)| RunInput {
            name,
            input: FitInput {
                channels,
                drive: &run.drive,
                area_cm2: AREA,
            },
            length_cm: Some(LENGTH),
        })
        .collect();
    let found = diagnose_group("case", &runs, &DiagnoseOptions::default());
    if std::env::var_os("NOISE").is_some() {
        for n in &found.noise {
            let sd = if n.channel == "current" {
                case.noise.current_a
            } else {
                case.noise.curvature_per_cm
            };
            println!(
                "rho {rho} {:10} {:10} prop {:.2} sd/true {:.3} {:?} per independent {:.2} rms {:.3}",
                n.run,
                n.channel,
                n.proportional / sd,
                n.standard_deviation / sd,
                n.autoregression,
                n.readings as f64 / n.independent_readings,
                n.residual_rms_sigma
            );
        }
    }
    found
}

/// Groups with p below 0.05, and groups that were given a name, among so many clean ones from seed `first` on.
fn nulls(first: u64, count: u64) -> (usize, usize) {
    let mut found: Vec<(f64, Verdict)> = (first..first + count)
        .into_par_iter()
        .map(|seed| {
            let mut case = case(seed);
            let plain = responses(&case, &[]);
            let found = diagnose(&mut case, &plain);
            if std::env::var_os("SHOW").is_some() && found.p_misfit.is_some_and(|p| p < 0.05) {
                println!("seed {seed} p {:?} {}", found.p_misfit, found.sentence);
                for n in found.noise.iter().filter(|_| seed % 4 == 3) {
                    println!(
                        "    {} {} {:?} growing {}",
                        n.run, n.channel, n.autoregression, n.proportional
                    );
                }
            }
            (found.p_misfit.unwrap_or(f64::NAN), found.verdict)
        })
        .collect();
    for rho in 0..4 {
        let of: Vec<f64> = found.iter().skip(rho).step_by(4).map(|(p, _)| *p).collect();
        let below = |limit: f64| of.iter().filter(|p| **p < limit).count() as f64 / of.len() as f64;
        println!(
            "rho {rho}: p<0.01 {:.3}  p<0.05 {:.3}  p<0.5 {:.3}",
            below(0.01),
            below(0.05),
            below(0.5)
        );
    }
    let mut verdicts: BTreeMap<&str, usize> = BTreeMap::new();
    for (_, verdict) in &found {
        *verdicts.entry(verdict.key()).or_default() += 1;
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let n = found.len() as f64;
    let ks = found
        .iter()
        .enumerate()
        .map(|(k, (p, _))| (p - (k as f64 + 0.5) / n).abs())
        .fold(0.0, f64::max);
    println!(
        "{verdicts:?}  KS distance {ks:.3} (5 % point {:.3})",
        1.36 / n.sqrt()
    );
    (
        found.iter().filter(|(p, _)| *p < 0.05).count(),
        found
            .iter()
            .filter(|(_, verdict)| verdict.names_a_cause())
            .count(),
    )
}

/// Parameters of a random form of the effect, with a strength that gives about `d` sigmas after refit.
fn hidden(case: &mut Case, effect: &'static dyn Effect, d: f64) -> Option<(Applied, f64)> {
    let scale = scale(case);
    let variants = effect.about().variants.len().max(1);
    let variant = case.generator.random_range(0..variants);
    let search = effect.search(variant, &scale);
    if search.probes.is_empty() {
        return None;
    }
    let probe = search.probes[case.generator.random_range(0..search.probes.len())].clone();
    let mut applied = Applied {
        effect,
        variant,
        parameters: probe.clone(),
    };
    let at = |case: &Case, applied: &Applied| {
        sigmas_after_refit(
            &case.base,
            &case.design,
            &responses(case, std::slice::from_ref(applied)),
            case.noise,
        )
    };
    let limits = search.limits[0];
    if limits.held {
        // A law without free strength: the noise is made to fit instead.
        applied.parameters[0] = 1.0;
        let factor = at(case, &applied) / d;
        case.noise.current_a *= factor;
        case.noise.curvature_per_cm *= factor;
        return (factor > 0.0).then_some((applied, d));
    }
    for _ in 0..8 {
        let now = at(case, &applied);
        if now <= 0.0 {
            return None;
        }
        let wanted = applied.parameters[0] * (d / now).clamp(0.2, 30.0);
        applied.parameters[0] = wanted.clamp(limits.low, limits.high);
    }
    let reached = at(case, &applied);
    ((reached / d - 1.0).abs() < 0.15).then_some((applied, reached))
}

fn scale(case: &Case) -> Scale {
    let plain = responses(case, &[]);
    let peak = |values: &[f64]| values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let mut scale = Scale {
        base: case.base.clone(),
        area_cm2: AREA,
        length_cm: Some(LENGTH),
        durations_s: vec![600.0; 5],
        shortest_s: 1.0,
        voltage_v: 2.0,
        current_a: plain.iter().map(|r| peak(&r.current_a)).fold(0.0, f64::max),
        curvature_per_cm: plain
            .iter()
            .map(|r| peak(&r.curvature_per_cm))
            .fold(0.0, f64::max),
        charge_c: 0.0,
    };
    scale.charge_c = scale.capacitance_f_per_cm2() * 2.0 * AREA;
    scale
}

/// How far the two simulators are apart, in sigmas after refit.
fn apart(case: &Case, truth: &[Responses], library: &[Responses]) -> f64 {
    let plain = responses(case, &[]);
    let difference = |plain: &[f64], a: &[f64], b: &[f64]| -> Vec<f64> {
        plain.iter().zip(a).zip(b).map(|((p, a), b)| p + a - b).collect()
    };
    let each = plain
        .iter()
        .zip(truth)
        .zip(library)
        .map(|((plain, truth), library)| Responses {
            current_a: difference(&plain.current_a, &truth.current_a, &library.current_a),
            curvature_per_cm: difference(
                &plain.curvature_per_cm,
                &truth.curvature_per_cm,
                &library.curvature_per_cm,
            ),
        });
    sigmas_after_refit(&case.base, &case.design, &each.collect::<Vec<_>>(), case.noise)
}

/// Groups, seen, in the set, uniquely named, wrongly named, unknown, strengths stated and covered, at the last strength.
fn effects(count: u64, strengths: &[f64], only: &[String]) -> [usize; 8] {
    let mut last = [0; 8];
    println!(
        "{:30} {:>4} {:>3} {:>5} {:>5} {:>6} {:>6} {:>5} {:>6} {:>5}",
        "effect", "d", "n", "seen", "inset", "unique", "wrong", "unkn", "stated", "cover"
    );
    for &d in strengths {
        let mut total = [0usize; 8];
        for &effect in ALL {
            let id = effect.about().id;
            if !only.is_empty() && !only.iter().any(|o| o == id) {
                continue;
            }
            let began = std::time::Instant::now();
            let found: Vec<_> = (0..count)
                .into_par_iter()
                .filter_map(|seed| {
                    let mut case = case(1000 + seed);
                    let (applied, _) = hidden(&mut case, effect, d)?;
                    let with = true_responses(&case, &applied)?;
                    let library = responses(&case, std::slice::from_ref(&applied));
                    let apart = apart(&case, &with, &library);
                    Some((diagnose(&mut case, &with), applied, apart))
                })
                .collect();
            let mut row = [0usize; 8];
            let worst = found.iter().map(|(_, _, apart)| *apart).fold(0.0, f64::max);
            for (found, applied, _) in &found {
                row[0] += 1;
                row[1] += usize::from(found.p_misfit.is_some_and(|p| p < 0.05));
                let inset = found.set.iter().any(|s| s == id);
                row[2] += usize::from(inset);
                row[3] += usize::from(inset && found.set.len() == 1);
                row[4] += usize::from(!inset && found.set.len() == 1);
                row[5] += usize::from(found.verdict == Verdict::Unknown);
                let own = found.effects.iter().find(|own| own.effect == id);
                let strength = own
                    .and_then(|own| own.parameters.first())
                    .map(|own| &own.estimate);
                if let Some((low, high)) = strength.and_then(|s| s.low_95.zip(s.high_95)) {
                    row[6] += 1;
                    row[7] += usize::from(low <= applied.parameters[0] && applied.parameters[0] <= high);
                }
                if std::env::var_os("SHOW").is_some() {
                    println!(
                        "    {:?} -> {} {:?} {} {:?}",
                        applied.parameters,
                        found.verdict.key(),
                        found.set,
                        found.sentence,
                        found.gain.as_ref().map(|g| (g.deviance, g.parts.clone()))
                    );
                    for c in found.candidates.iter().take(8) {
                        println!(
                            "        {:30} forecast {:8.1} fitted {:?} +{} left {:.3}",
                            c.effect, c.forecast_gain, c.fitted_gain, c.extra_parameters, c.left_after_refit
                        );
                    }
                }
            }
            println!(
                "{id:30} {d:>4} {:>3} {:>5} {:>5} {:>6} {:>6} {:>5} {:>6} {:>5}   simulators {worst:.2} sigma apart, {:.1} s",
                row[0],
                row[1],
                row[2],
                row[3],
                row[4],
                row[5],
                row[6],
                row[7],
                began.elapsed().as_secs_f64()
            );
            for (t, r) in total.iter_mut().zip(row) {
                *t += r;
            }
        }
        println!(
            "{:30} {d:>4} {:>3} {:>5} {:>5} {:>6} {:>6} {:>5} {:>6} {:>5}",
            "all", total[0], total[1], total[2], total[3], total[4], total[5], total[6], total[7]
        );
        last = total;
    }
    last
}

/// Id, key of the strength, first strength to try, and another parameter.
type Outside = (&'static str, &'static str, f64, Option<(&'static str, f64)>);

/// Effects that no library holds: they must come back unknown.
fn outside(count: u64, d: f64) {
    let kinds: [Outside; 4] = [
        (
            "x-current-oscillation",
            "amplitude_a",
            1e-5,
            Some(("period_s", 50.0)),
        ),
        ("x-charge-hysteresis", "width_c_per_cm2", 1e-3, None),
        ("x-dead-time", "dead_time_s", 0.5, None),
        ("x-limit-cycle", "modulation", 0.05, Some(("period_s", 80.0))),
    ];
    for (id, key, start, other) in kinds {
        let found: Vec<_> = (0..count)
            .into_par_iter()
            .filter_map(|seed| {
                let mut case = case(5000 + seed);
                let mut strength = start;
                let hidden = |strength: f64| HiddenEffect {
                    id: id.to_owned(),
                    variant: None,
                    parameters: other
                        .iter()
                        .map(|(k, v)| ((*k).to_owned(), *v))
                        .chain([(key.to_owned(), strength)])
                        .collect(),
                };
                let size = |case: &Case, with: &[Responses]| {
                    sigmas_after_refit(&case.base, &case.design, with, case.noise)
                };
                for _ in 0..6 {
                    let with = truly(&case, hidden(strength))?;
                    strength *= (d / size(&case, &with)).clamp(0.1, 10.0);
                    if id == "x-limit-cycle" {
                        strength = strength.min(0.85);
                    }
                }
                let with = truly(&case, hidden(strength))?;
                let reached = size(&case, &with);
                if (reached / d - 1.0).abs() > 0.2 {
                    return None;
                }
                Some(diagnose(&mut case, &with))
            })
            .collect();
        let mut verdicts: BTreeMap<&str, usize> = BTreeMap::new();
        for found in &found {
            *verdicts.entry(found.verdict.key()).or_default() += 1;
            if std::env::var_os("SHOW").is_some() {
                println!(
                    "    {} {:?} leftover {:?} {}",
                    found.verdict.key(),
                    found.set,
                    found.p_leftover,
                    found.sentence
                );
            }
        }
        println!("{id:25} d {d:>4} n {:>3} {verdicts:?}", found.len());
    }
}
