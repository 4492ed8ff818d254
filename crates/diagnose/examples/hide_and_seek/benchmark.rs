//! Every method on the same groups: clean ones, single causes, pairs and triples, causes outside the library, faults of
//! the data, and the run that is proposed next.

use ieap_diagnose::{DesignRun, DiagnoseOptions, diagnose_group, proposals};
use ieap_model::effects::Applied;
use rand::RngExt;
use rayon::prelude::*;

use crate::case::{AREA, Case, Drives, Plan, Readings, case, inputs, measured, responses, true_responses};
use crate::details::{Detail, ignorance, strengths_and_gains};
use crate::faults::faults;
use crate::figure;
use crate::hidden::{HIDEABLE, OUTSIDE, PUBLISHED, hidden, outside};
use crate::methods::{METHODS, ORACLE, OURS, Said, ask, judged};
use crate::oracle::oracle;

/// Strengths in the table and the figure.
const STRENGTHS: [f64; 5] = [4.0, 8.0, 16.0, 32.0, 64.0];
/// Strength of each of several causes.
const TOGETHER: f64 = 32.0;

/// What is done, and how often.
pub struct Extent {
    /// Groups of every effect, design and strength.
    pub each: u64,
    /// First seed: development and final seeds differ.
    pub first: u64,
    /// Parts that are run; all where empty.
    pub only: Vec<String>,
    /// Where the figure goes.
    pub figure: Option<std::path::PathBuf>,
}

/// Runs the benchmark and prints its tables in Markdown.
pub fn benchmark(extent: &Extent) {
    let wants = |part: &str| extent.only.is_empty() || extent.only.iter().any(|only| only == part);
    println!("Seeds from {} on, {} of each.\n", extent.first, extent.each);
    if wants("clean") {
        clean(extent);
    }
    if wants("single") {
        let (table, details) = single(extent);
        println!("{table}\n{details}");
        let svg = figure::svg(&figure::of_table(&table));
        let written = extent.figure.as_ref().map(|path| std::fs::write(path, svg));
        if let Some(Err(error)) = written {
            eprintln!("the figure could not be written: {error}");
        }
    }
    if wants("several") {
        several(extent, 2);
        several(extent, 3);
    }
    if wants("outside") {
        without(extent);
    }
    if wants("faults") {
        faults(extent);
    }
    if wants("next") {
        next(extent);
    }
}

/// Does `what` to each on all threads, in the order given. A few at a time: a thread that waits for its parts would
/// begin another one, and another, and keep them all.
pub fn each<T: Sync, R: Send>(items: &[T], what: impl Fn(&T) -> Option<R> + Sync) -> Vec<R> {
    let together = 2 * rayon::current_num_threads();
    let mut found = Vec::new();
    for (done, some) in items.chunks(together).enumerate() {
        if items.len() > 10 * together && done % 10 == 0 {
            eprintln!("{} of {}", done * together, items.len());
        }
        let these: Vec<Option<R>> = some.par_iter().map(&what).collect();
        found.extend(these.into_iter().flatten());
    }
    found
}

/// What a method made of groups.
#[derive(Debug, Clone, Copy, Default)]
pub struct Tally {
    pub groups: usize,
    pub seen: usize,
    /// The hidden cause is the one name.
    right: usize,
    /// Another one is.
    wrong: usize,
    /// The hidden cause is among those given.
    within: usize,
    /// Groups with causes given, and how many these are in all.
    given: usize,
    causes: usize,
}

impl Tally {
    fn add(&mut self, said: &Said, truth: Option<&str>) {
        self.groups += 1;
        self.seen += usize::from(said.seen);
        if let Some(name) = &said.name {
            *(if Some(name.as_str()) == truth {
                &mut self.right
            } else {
                &mut self.wrong
            }) += 1;
        }
        self.within += usize::from(truth.is_some_and(|truth| said.causes.iter().any(|c| c == truth)));
        self.given += usize::from(!said.causes.is_empty());
        self.causes += said.causes.len();
    }
}

pub fn percent(part: usize, of: usize) -> String {
    match of {
        0 => "-".to_owned(),
        _ => format!("{:.1}", 100.0 * part as f64 / of as f64),
    }
}

pub fn tallied(all: &[(Vec<Said>, Option<&str>)]) -> Vec<Tally> {
    let mut tallies = vec![Tally::default(); METHODS.len()];
    for (said, truth) in all {
        for (tally, said) in tallies.iter_mut().zip(said) {
            tally.add(said, *truth);
        }
    }
    tallies
}

/// Groups in which nothing is hidden, by the kind of noise.
fn clean(extent: &Extent) {
    let plan = |readings, autocorrelation| Plan {
        readings,
        autocorrelation: Some(autocorrelation),
        ..Plan::default()
    };
    let kinds = [
        ("white", plan(Readings::Even, 0.0)),
        ("correlation 0.3", plan(Readings::Even, 0.3)),
        ("correlation 0.6", plan(Readings::Even, 0.6)),
        ("correlation 0.8", plan(Readings::Even, 0.8)),
        ("uneven readings, 0.3", plan(Readings::Uneven, 0.3)),
        ("steps of one sigma, 0.3", plan(Readings::Quantised, 0.3)),
        (
            "1 % outliers, 0.3",
            Plan {
                outliers: 0.01,
                ..plan(Readings::Even, 0.3)
            },
        ),
    ];
    println!("### Nothing hidden: said to be wrong, in percent (given one name)\n");
    println!("| noise | groups | {} |", METHODS[..ORACLE].join(" | "));
    println!("|---|---|{}", "---|".repeat(ORACLE));
    for (name, plan) in kinds {
        let seeds: Vec<u64> = (0..10 * extent.each).collect();
        let all: Vec<(Vec<Said>, Option<&str>)> = each(&seeds, |seed| {
            let mut case = case(extent.first + seed, plan);
            let plain = responses(&case, &[]);
            Some((ask(&mut case, &plain).1, None))
        });
        let cells: Vec<String> = tallied(&all)[..ORACLE]
            .iter()
            .map(|tally| {
                let named = percent(tally.wrong, tally.groups);
                format!("{} ({named})", percent(tally.seen, tally.groups))
            })
            .collect();
        println!("| {name} | {} | {} |", all.len(), cells.join(" | "));
    }
    println!();
}

/// What was hidden and what was made of it.
struct Hunted {
    said: Vec<Said>,
    truth: &'static str,
    detail: Detail,
}

/// Single causes by design and strength, as a table, and a second one on what only this diagnosis states.
fn single(extent: &Extent) -> (String, String) {
    let designs = [
        ("+2 V", Drives::Step),
        ("+2 V; +2 V then 0 V", Drives::Discharge),
        ("five drives", Drives::Five),
    ];
    let mut table = format!(
        "### One cause hidden: right name / wrong name (seen), in percent\n\n| drives | d | groups | {} | truth in our set | our mean set | oracle's |\n|---|---|---|{}---|---|---|\n",
        METHODS.join(" | "),
        "---|".repeat(METHODS.len())
    );
    let asked = |what: &str, value: &str| {
        std::env::var(what).map_or(true, |asked| asked.split(',').any(|a| a == value))
    };
    let mut details = strengths_and_gains();
    let mut risks = String::new();
    for (name, drives) in designs {
        let mut of_design = Vec::new();
        for d in STRENGTHS {
            if !asked("DRIVES", key(drives)) || !asked("STRENGTHS", &d.to_string()) {
                continue;
            }
            let hunted = hunted(extent, drives, d);
            let all: Vec<(Vec<Said>, Option<&str>)> = hunted
                .iter()
                .map(|hunted| (hunted.said.clone(), Some(hunted.truth)))
                .collect();
            let tallies = tallied(&all);
            let row = Detail::row(name, d, &hunted.iter().map(|h| &h.detail).collect::<Vec<_>>());
            eprintln!("{row}");
            details += &row;
            of_design.extend(all);
            let cells: Vec<String> = tallies
                .iter()
                .map(|tally| {
                    let of = |part| percent(part, tally.groups);
                    format!("{} / {} ({})", of(tally.right), of(tally.wrong), of(tally.seen))
                })
                .collect();
            let mean = |tally: &Tally| tally.causes as f64 / tally.given.max(1) as f64;
            let row = format!(
                "| {name} | {d} | {} | {} | {} of {} | {:.1} | {:.1} |",
                tallies[OURS].groups,
                cells.join(" | "),
                tallies[OURS].within,
                tallies[OURS].given,
                mean(&tallies[OURS]),
                mean(&tallies[ORACLE]),
            );
            eprintln!("{row}");
            table += &row;
            table.push('\n');
        }
        risks += &ignorance(name, &of_design);
    }
    (table, details + &risks)
}

fn key(drives: Drives) -> &'static str {
    match drives {
        Drives::Step => "step",
        Drives::Same => "same",
        Drives::Voltages => "voltages",
        Drives::Three => "three",
        Drives::Discharge => "discharge",
        Drives::Repeated => "repeated",
        Drives::Five => "five",
        Drives::Moving => "moving",
        Drives::Sine => "sine",
        Drives::StepsAndSine => "steps-and-sine",
        Drives::Steps => "steps",
        Drives::Pulses => "pulses",
    }
}

fn hunted(extent: &Extent, drives: Drives, d: f64) -> Vec<Hunted> {
    let wanted: Vec<(usize, u64)> = (0..HIDEABLE.len())
        .flat_map(|effect| (0..extent.each).map(move |seed| (effect, seed)))
        .collect();
    each(&wanted, |&(effect, seed)| {
        let plan = Plan {
            drives,
            ..Plan::default()
        };
        let mut case = case(extent.first + 1000 + 50 * seed + effect as u64, plan);
        let (applied, _) = hidden(&mut case, HIDEABLE[effect], d)?;
        let with = true_responses(&case, std::slice::from_ref(&applied))?;
        let channels = measured(&mut case, &with);
        let (found, mut said) = judged(&inputs(&case, &channels));
        let detail = Detail::of(&found, &applied, d, &inputs(&case, &channels));
        let ceiling = oracle(&mut case, &applied, &with);
        said.push(Said {
            seen: ceiling.seen,
            name: match ceiling.set.as_slice() {
                [one] => Some((*one).to_owned()),
                _ => None,
            },
            causes: ceiling.set.iter().map(|id| (*id).to_owned()).collect(),
            confidence: ceiling.margin,
        });
        Some(Hunted {
            said,
            truth: HIDEABLE[effect].about().id,
            detail,
        })
    })
}

/// Pairs or triples of causes.
fn several(extent: &Extent, count: usize) {
    let seeds: Vec<u64> = (0..20 * extent.each).collect();
    let found: Vec<(Vec<Said>, Vec<&'static str>)> = each(&seeds, |seed| {
        let mut case = case(extent.first + 100_000 + seed, Plan::default());
        let mut applied: Vec<Applied> = Vec::new();
        while applied.len() < count {
            let effect = HIDEABLE[case.generator.random_range(0..HIDEABLE.len())];
            if applied.iter().any(|a| a.effect.about().id == effect.about().id) {
                continue;
            }
            // Laws without free strength fit the noise to themselves, which two of them cannot.
            let before = case.noise;
            let one = hidden(&mut case, effect, TOGETHER);
            if case.noise == before {
                applied.extend(one.map(|(one, _)| one));
            }
            case.noise = before;
        }
        let with = true_responses(&case, &applied)?;
        let truth: Vec<&'static str> = applied.iter().map(|a| a.effect.about().id).collect();
        let (found, said) = ask(&mut case, &with);
        if std::env::var_os("SHOW").is_some() {
            println!(
                "{truth:?} -> {} {:?} {:?} leftover {:?} held out {:?}",
                found.verdict.key(),
                found
                    .effects
                    .iter()
                    .map(|e| (&e.effect, &e.twins))
                    .collect::<Vec<_>>(),
                found.set,
                found.p_leftover,
                found.gain.as_ref().map(|gain| gain.proof.deviance)
            );
            println!("    {}", found.sentence);
        }
        Some((said, truth))
    });
    println!(
        "### {count} causes hidden, d = {TOGETHER} each, five drives, {} groups\n",
        found.len()
    );
    println!(
        "| method | seen, % | all of them among the causes given, % | one at least, % | a cause given that is not there, mean |"
    );
    println!("|---|---|---|---|---|");
    for (k, name) in METHODS[..ORACLE].iter().enumerate() {
        let n = found.len();
        let holds = |said: &Said, id: &str| said.causes.iter().any(|c| c == id);
        let all = found
            .iter()
            .filter(|(said, truth)| truth.iter().all(|id| holds(&said[k], id)))
            .count();
        let one = found
            .iter()
            .filter(|(said, truth)| truth.iter().any(|id| holds(&said[k], id)))
            .count();
        let seen = found.iter().filter(|(said, _)| said[k].seen).count();
        let false_causes: usize = found
            .iter()
            .map(|(said, truth)| {
                let causes = said[k].causes.iter();
                causes.filter(|c| !truth.contains(&c.as_str())).count()
            })
            .sum();
        println!(
            "| {name} | {} | {} | {} | {:.2} |",
            percent(seen, n),
            percent(all, n),
            percent(one, n),
            false_causes as f64 / n.max(1) as f64
        );
    }
    println!();
}

/// Causes that no library holds.
fn without(extent: &Extent) {
    println!("### A cause outside the library, five drives: given one (wrong) name, in percent (seen)\n");
    println!(
        "| d | groups | {} | ours said to be unknown |",
        METHODS[..ORACLE].join(" | ")
    );
    println!("|---|---|{}---|", "---|".repeat(ORACLE));
    for d in [16.0, 64.0] {
        let wanted: Vec<(usize, u64)> = (0..PUBLISHED)
            .flat_map(|kind| (0..5 * extent.each).map(move |seed| (kind, seed)))
            .collect();
        let found: Vec<(Vec<Said>, bool)> = each(&wanted, |&(kind, seed)| {
            let mut case = case(extent.first + 200_000 + seed, Plan::default());
            let with = outside(&case, OUTSIDE[kind], d)?;
            let (found, said) = ask(&mut case, &with);
            Some((said, found.verdict == ieap_domain::Verdict::Unknown))
        });
        let unknown = found.iter().filter(|(_, unknown)| *unknown).count();
        let all: Vec<(Vec<Said>, Option<&str>)> = found.into_iter().map(|(said, _)| (said, None)).collect();
        let cells: Vec<String> = tallied(&all)[..ORACLE]
            .iter()
            .map(|t| format!("{} ({})", percent(t.wrong, t.groups), percent(t.seen, t.groups)))
            .collect();
        println!(
            "| {d} | {} | {} | {} |",
            all.len(),
            cells.join(" | "),
            percent(unknown, all.len())
        );
    }
    println!();
}

/// The run that is proposed is made, and the group is diagnosed again.
fn next(extent: &Extent) {
    println!("### The proposed run, made\n");
    println!(
        "| drives before | d | groups with a set | mean set before | expected after | after | truth kept |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (name, drives) in [("+2 V", Drives::Step), ("+2 V; +2 V then 0 V", Drives::Discharge)] {
        for d in [16.0, 32.0] {
            let wanted: Vec<(usize, u64)> = (0..HIDEABLE.len())
                .flat_map(|effect| (0..extent.each).map(move |seed| (effect, seed)))
                .collect();
            let found: Vec<[f64; 4]> = each(&wanted, |&(effect, seed)| {
                let plan = Plan {
                    drives,
                    ..Plan::default()
                };
                let case = case(extent.first + 300_000 + 50 * seed + effect as u64, plan);
                proposed(case, effect, d)
            });
            let mean = |k: usize| found.iter().map(|row| row[k]).sum::<f64>() / found.len().max(1) as f64;
            println!(
                "| {name} | {d} | {} | {:.2} | {:.2} | {:.2} | {:.0} % |",
                found.len(),
                mean(0),
                mean(1),
                mean(2),
                100.0 * mean(3)
            );
        }
    }
    println!();
}

/// Sizes of the set before, as expected after, and after the proposed run, and whether the truth stayed in it.
fn proposed(mut case: Case, effect: usize, d: f64) -> Option<[f64; 4]> {
    let (applied, _) = hidden(&mut case, HIDEABLE[effect], d)?;
    let with = true_responses(&case, std::slice::from_ref(&applied))?;
    let mut channels = measured(&mut case, &with);
    let options = DiagnoseOptions::default();
    let found = diagnose_group("case", &inputs(&case, &channels), &options);
    let next = found.next_run.as_ref()?;
    let (_, drive, duration_s) = proposals(2.0, 600.0)
        .into_iter()
        .find(|(words, ..)| *words == next.drive)?;
    let step_s = (duration_s / 1200.0).max(1.0);
    let time_s: Vec<f64> = (1..=(duration_s / step_s) as usize)
        .map(|k| step_s * k as f64)
        .collect();
    case.design.push(DesignRun {
        drive,
        area_cm2: AREA,
        current_time_s: time_s.clone(),
        curvature_time_s: time_s,
    });
    let with = true_responses(&case, std::slice::from_ref(&applied))?;
    let more = measured(&mut case, &with).pop()?;
    channels.push(more);
    let again = diagnose_group("case", &inputs(&case, &channels), &options);
    let kept = again.set.iter().any(|id| id == HIDEABLE[effect].about().id);
    Some([
        found.set.len() as f64,
        next.expected_set_size,
        again.set.len() as f64,
        f64::from(u8::from(kept)),
    ])
}
