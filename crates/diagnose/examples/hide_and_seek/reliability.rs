//! Whether what is stated is as sure as it says: probabilities of causes against how often they are right, 95 % intervals
//! against how often they hold, and p against how often chance passes it.

use std::collections::BTreeMap;
use std::fmt::Write;

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::{Estimate, GroupDiagnosis, HypothesisKind};
use rand::RngExt;

use crate::benchmark::each;
use crate::case::{Plan, case, diagnose, responses, true_responses};
use crate::foreign::{Cause, with_forms};
use crate::hidden::{HIDEABLE, OUTSIDE, hidden};

/// Strengths that are drawn from, standard deviations after a refit.
const STRENGTHS: [f64; 4] = [8.0, 16.0, 32.0, 64.0];
/// Ends of the bins of stated probability; below the first a cause is hardly spoken of.
const BINS: [f64; 6] = [0.02, 0.2, 0.5, 0.8, 0.95, 1.0 + 1e-9];
/// Where p is looked at.
const LEVELS: [f64; 7] = [0.01, 0.05, 0.1, 0.2, 0.5, 0.8, 0.95];

/// Where the cause of a group comes from.
const KINDS: [&str; 4] = ["own", "foreign", "outside", "none"];

/// What a group says that can be held against the truth.
#[derive(Default)]
struct Said {
    kind: usize,
    /// Stated probability that a cause is there, or that there is one without a name, and whether it is.
    masses: Vec<(f64, bool)>,
    /// Whether each stated 95 % interval holds the truth.
    held: Vec<bool>,
    /// Of the misfit, where nothing is hidden.
    p: Option<f64>,
}

/// A share with what it is counted from.
#[derive(Debug, Clone, Copy)]
struct Share {
    /// Mean of what is stated.
    stated: f64,
    found: usize,
    of: usize,
}

impl Share {
    fn value(self) -> f64 {
        self.found as f64 / self.of.max(1) as f64
    }

    /// Wilson's 95 % interval.
    fn interval(self) -> (f64, f64) {
        let n = self.of.max(1) as f64;
        let (p, z2) = (self.value(), NORMAL_95 * NORMAL_95 / n);
        let middle = (p + z2 / 2.0) / (1.0 + z2);
        let half = (p * (1.0 - p) / n + z2 / (4.0 * n)).sqrt() * NORMAL_95 / (1.0 + z2);
        (middle - half, middle + half)
    }

    fn row(self, first: &str) -> String {
        let (low, high) = self.interval();
        format!(
            "| {first} | {} | {:.1} | {:.1} | {:.1} to {:.1} |",
            self.of,
            100.0 * self.stated,
            100.0 * self.value(),
            100.0 * low,
            100.0 * high
        )
    }
}

/// Diagnoses `count` groups of each kind from seed `first` on; tables on stdout, the diagram where `figure` says.
pub fn reliability(first: u64, count: u64, figure: Option<&str>) {
    let wanted: Vec<(usize, u64)> = (0..count)
        .flat_map(|seed| (0..KINDS.len()).map(move |kind| (kind, seed)))
        .collect();
    let said = each(&wanted, |&(kind, seed)| {
        group(kind, first + 100_000 * kind as u64 + seed)
    });
    let masses = |kinds: &[usize]| -> Vec<(f64, bool)> {
        let of = said.iter().filter(|said| kinds.contains(&said.kind));
        of.flat_map(|said| said.masses.iter().copied()).collect()
    };
    let heading = |first: &str, what: &str| {
        println!("\n| {first} | counted | stated, % | {what}, % | 95 % interval |\n|---|---|---|---|---|");
    };
    let mut panels = Vec::new();
    for (name, kinds) in [
        ("own forms", &[0][..]),
        ("foreign forms and causes outside", &[1, 2]),
    ] {
        let shares = binned(&masses(kinds));
        heading(&format!("probability of a cause, {name}"), "true");
        for ((low, high), share) in &shares {
            println!(
                "{}",
                share.row(&format!("{:.0} to {:.0} %", 100.0 * low, 100.0 * high))
            );
        }
        panels.push((
            name,
            shares.into_iter().map(|(_, share)| share).collect::<Vec<_>>(),
        ));
    }
    heading("intervals of the hidden cause, own forms", "hold the truth");
    let held: Vec<bool> = said.iter().flat_map(|said| said.held.iter().copied()).collect();
    let intervals = Share {
        stated: 0.95,
        found: held.iter().filter(|held| **held).count(),
        of: held.len(),
    };
    println!("{}", intervals.row("95 %"));
    heading("p, nothing hidden", "of groups below");
    let p: Vec<f64> = said.iter().filter_map(|said| said.p).collect();
    let below = LEVELS.map(|level| Share {
        stated: level,
        found: p.iter().filter(|p| **p < level).count(),
        of: p.len(),
    });
    below
        .iter()
        .for_each(|share| println!("{}", share.row(&format!("below {}", share.stated))));
    panels.push(("p where nothing is hidden", below.to_vec()));
    if let Some(path) = figure
        && let Err(error) = std::fs::write(path, svg(&panels))
    {
        eprintln!("{path}: {error}");
    }
}

/// A group of that kind, with a cause of a random strength.
fn group(kind: usize, seed: u64) -> Option<Said> {
    let mut case = case(seed, Plan::default());
    let d = STRENGTHS[case.generator.random_range(0..STRENGTHS.len())];
    let mut said = Said {
        kind,
        ..Said::default()
    };
    match KINDS[kind] {
        "own" => {
            let effect = HIDEABLE[case.generator.random_range(0..HIDEABLE.len())];
            let (applied, _) = hidden(&mut case, effect, d)?;
            let with = true_responses(&case, std::slice::from_ref(&applied))?;
            let found = diagnose(&mut case, &with);
            let id = effect.about().id;
            said.masses = masses(&found, Some(id));
            let own = found.effects.iter().filter(|own| own.effect == id);
            let parameters = own.flat_map(|own| own.parameters.iter().zip(&applied.parameters));
            said.held = parameters
                .filter_map(|(parameter, truth)| holds(&parameter.estimate, *truth))
                .collect();
        }
        "none" => {
            let plain = responses(&case, &[]);
            said.p = diagnose(&mut case, &plain).p_misfit;
        }
        kind => {
            let forms = with_forms();
            let cause = match kind {
                "foreign" => Cause::Form(forms[case.generator.random_range(0..forms.len())]),
                _ => Cause::Outside(OUTSIDE[case.generator.random_range(0..OUTSIDE.len())]),
            };
            let (_, _, with) = cause.hidden(&mut case, d)?;
            let truth = (kind == "foreign").then(|| cause.id());
            said.masses = masses(&diagnose(&mut case, &with), truth);
        }
    }
    Some(said)
}

/// Whether an interval holds the truth; none where no interval is stated.
fn holds(estimate: &Estimate, truth: f64) -> Option<bool> {
    let (low, high) = estimate.low_95.zip(estimate.high_95)?;
    Some(low <= truth && truth <= high)
}

/// Every cause with its probability in all hypotheses that hold it, and what has no name with its own.
fn masses(found: &GroupDiagnosis, truth: Option<&str>) -> Vec<(f64, bool)> {
    let mut causes: BTreeMap<&str, f64> = BTreeMap::new();
    let mut unnamed = 0.0;
    for hypothesis in &found.posterior {
        for effect in &hypothesis.effects {
            *causes.entry(effect).or_default() += hypothesis.mass;
        }
        if hypothesis.kind == HypothesisKind::Unnamed {
            unnamed += hypothesis.mass;
        }
    }
    let mut said: Vec<(f64, bool)> = causes
        .into_iter()
        .map(|(id, mass)| (mass, Some(id) == truth))
        .collect();
    if !found.posterior.is_empty() {
        said.push((unnamed, truth.is_none()));
    }
    said.retain(|(mass, _)| *mass >= BINS[0]);
    said
}

fn binned(masses: &[(f64, bool)]) -> Vec<((f64, f64), Share)> {
    let bin = |ends: &[f64]| {
        let (low, high) = (ends[0], ends[1]);
        let within: Vec<&(f64, bool)> = masses
            .iter()
            .filter(|(mass, _)| (low..high).contains(mass))
            .collect();
        let share = Share {
            stated: within.iter().map(|(mass, _)| mass).sum::<f64>() / within.len().max(1) as f64,
            found: within.iter().filter(|(_, is_true)| *is_true).count(),
            of: within.len(),
        };
        (share.of > 0).then_some(((low, high.min(1.0)), share))
    };
    BINS.windows(2).filter_map(bin).collect()
}

/// Side of a panel, left edge of the first, and distance between them.
const SIDE: f64 = 220.0;
const LEFT: f64 = 56.0;
const PITCH: f64 = 290.0;
const TOP: f64 = 34.0;

/// Stated against found, a panel each, with the diagonal on which they agree.
fn svg(panels: &[(&str, Vec<Share>)]) -> String {
    let (width, height) = (PITCH * panels.len() as f64, TOP + SIDE + 50.0);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\" role=\"img\">\n<title>What is stated against how often it is so</title>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    for (place, (title, shares)) in panels.iter().enumerate() {
        let left = LEFT + PITCH * place as f64;
        let x = |part: f64| left + SIDE * part;
        let y = |part: f64| TOP + SIDE * (1.0 - part);
        let _ = writeln!(
            out,
            "<text x=\"{:.0}\" y=\"{:.0}\" text-anchor=\"middle\">{title}</text>",
            x(0.5),
            TOP - 14.0
        );
        for percent in [0.0, 25.0, 50.0, 75.0, 100.0] {
            let part = percent / 100.0;
            let _ = writeln!(
                out,
                "<path d=\"M{:.1} {:.1}h{SIDE}\" stroke=\"#dddddd\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{percent}</text><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{percent}</text>",
                x(0.0),
                y(part),
                x(0.0) - 6.0,
                y(part) + 4.0,
                x(part),
                y(0.0) + 16.0
            );
        }
        let _ = writeln!(
            out,
            "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"#999999\" stroke-dasharray=\"5 4\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">stated, %</text><text transform=\"translate({:.1} {:.1}) rotate(-90)\" text-anchor=\"middle\">found, %</text>",
            x(0.0),
            y(0.0),
            x(1.0),
            y(1.0),
            x(0.5),
            y(0.0) + 36.0,
            x(0.0) - 36.0,
            y(0.5)
        );
        for share in shares {
            let (low, high) = share.interval();
            let _ = writeln!(
                out,
                "<path d=\"M{0:.1} {1:.1}V{2:.1}\" stroke=\"#0072B2\" stroke-width=\"1.5\"/><circle cx=\"{0:.1}\" cy=\"{3:.1}\" r=\"4\" fill=\"#0072B2\"/>",
                x(share.stated),
                y(low),
                y(high),
                y(share.value())
            );
        }
    }
    out.push_str("</svg>\n");
    out
}
