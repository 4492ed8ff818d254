//! A plan in sentences, answer first.

use super::asked::Preflight;
use super::document::{ChangeEntry, PlanDocument, PlannedParameter, Verdict};
use super::trial::Trial;
use crate::domain::number::seconds::seconds;
use crate::domain::number::significant;
use crate::domain::words::{capital, in_a_row};

/// The answer: what is determined, what is not and why, what mends it.
pub(super) fn answer(
    plan: &Preflight,
    parameters: &[PlannedParameter],
    changes: &[ChangeEntry],
) -> Vec<String> {
    let determined: Vec<String> = parameters
        .iter()
        .filter(|of| of.is_determined())
        .map(to_percent)
        .collect();
    let mut said = vec![if determined.is_empty() {
        "This run determines nothing.".to_owned()
    } else {
        format!("This run determines {}.", in_a_row(&determined))
    }];
    let mut open: Vec<(Vec<&str>, String, String)> = Vec::new();
    for of in parameters.iter().filter(|of| !of.is_determined()) {
        let (state, cure) = (state(plan, of), cure(of.key, changes));
        match open
            .iter_mut()
            .find(|(_, other, mends)| *other == state && *mends == cure)
        {
            Some((names, ..)) => names.push(of.symbol),
            None => open.push((vec![of.symbol], state, cure)),
        }
    }
    let all_determined = open.is_empty();
    said.extend(open.into_iter().map(|(names, state, cure)| {
        let (stays, them) = match names.len() {
            1 => ("stays", "it"),
            _ => ("stay", "them"),
        };
        let state = state.replace("{stays}", stays);
        format!("{} {state}. {}", in_a_row(&names), cure.replace("{them}", them))
    }));
    if all_determined {
        said.extend([slower(changes), known_start(changes)].into_iter().flatten());
    }
    said
}

/// A table of the plan, its first row and column the heads: what is simulated, and what each way to make the run gives.
pub fn table(document: &PlanDocument) -> Vec<Vec<String>> {
    let planned = &document.parameters;
    let row = |name: &str, cell: &dyn Fn(&PlannedParameter) -> String, of: &[PlannedParameter]| {
        std::iter::once(name.to_owned())
            .chain(of.iter().map(cell))
            .collect()
    };
    let outcome = |of: &PlannedParameter| outcome(of, document.draws);
    let mut rows: Vec<Vec<String>> = vec![
        row("", &|of| of.symbol.to_owned(), planned),
        row("simulated", &|of| significant(of.value, 3), planned),
        row("as planned", &outcome, planned),
    ];
    rows.extend(
        document
            .changes
            .iter()
            .map(|change| row(&change.change, &outcome, &change.parameters)),
    );
    rows
}

/// `3.1 %`, or in how many of the draws there is a value.
fn outcome(of: &PlannedParameter, draws: usize) -> String {
    match (of.verdict, of.interval_percent) {
        (Verdict::Determined, Some(percent)) => format!("{} %", significant(percent, 2)),
        (Verdict::TooNarrow, _) => "too narrow".to_owned(),
        (Verdict::OneSided, _) => "one side".to_owned(),
        _ => format!("{} of {draws}", of.determined),
    }
}

/// What the answer rests on.
pub(super) fn remarks(plan: &Preflight) -> Vec<String> {
    let bending = match plan.subject.curvature_noise {
        Some(noise) => format!("{} /cm of curvature", significant(noise.standard_deviation, 2)),
        None => "no bending is read".to_owned(),
    };
    let mut remarks = plan.subject.remarks.clone();
    remarks.push(format!(
        "Parameters and noise are those of {}: {} A of current, {bending} in a reading, however fast it is read.",
        plan.subject.told_by,
        significant(plan.subject.current_noise.standard_deviation, 2)
    ));
    let remark = if plan.trial.start_is_known {
        "When the drive begins is stated."
    } else {
        "When the drive begins is known between two readings only, which is in the percent; where the instrument states it, give --start-known."
    };
    remarks.push(remark.to_owned());
    remarks.push(format!(
        "Counted in {} simulated runs (seed {}), each fitted as the run will be. They follow the model: what the strip does beyond it is not in the answer.",
        plan.draws, plan.seed
    ));
    remarks
}

/// A change in words: `a reading every 0.025 s`.
pub(super) fn change(kind: &str, trial: &Trial) -> String {
    match kind {
        "longer" => format!("a record of {} s", plain(trial.for_s)),
        "start" => "a stated start of the drive".to_owned(),
        "voltage" => format!("{} V", plain(trial.drive.largest_v())),
        _ => reading(trial),
    }
}

fn reading(trial: &Trial) -> String {
    if trial.every_s == trial.bending_every_s {
        format!("a reading every {} s", plain(trial.every_s))
    } else {
        format!(
            "a reading every {} s, of the bending every {} s",
            plain(trial.every_s),
            plain(trial.bending_every_s)
        )
    }
}

/// `R1 to 3 %`.
fn to_percent(of: &PlannedParameter) -> String {
    match of.interval_percent {
        Some(percent) => format!("{} to {} %", of.symbol, significant(percent, 2)),
        None => of.symbol.to_owned(),
    }
}

/// What becomes of a parameter that is not determined, and why.
fn state(plan: &Preflight, of: &PlannedParameter) -> String {
    let why =
        too_fast_or_slow(plan, of.key).or_else(|| of.reason.as_deref().map(|why| with_symbols(plan, why)));
    let why = why.map_or(String::new(), |why| format!(": {why}"));
    match of.verdict {
        Verdict::TooNarrow => format!(
            "would come out with an interval that is too narrow (it holds the value in {} of {} draws){why}",
            of.held, of.determined
        ),
        Verdict::OneSided => format!("{{stays}} open to one side{why}"),
        _ if of.determined > 0 => format!(
            "{{stays}} open, left to chance (determined in {} of {} draws, rightly in {}){why}",
            of.determined, plan.draws, of.held
        ),
        _ => format!("{{stays}} open{why}"),
    }
}

/// A reason of the fit with symbols in place of stored keys.
fn with_symbols(plan: &Preflight, reason: &str) -> String {
    let described = plan.subject.options.model.parameters.iter();
    described.fold(reason.to_owned(), |said, of| said.replace(of.key, of.symbol))
}

/// Where the sampling or the length shows by itself why.
fn too_fast_or_slow(plan: &Preflight, key: &str) -> Option<String> {
    let (subject, trial) = (&plan.subject, &plan.trial);
    let is_slow = |tau_s: f64| tau_s > trial.for_s;
    if key == "lambda_per_s" {
        let back_s = 1.0 / subject.model.relaxation_rate_per_s;
        return is_slow(back_s).then(|| {
            format!(
                "relaxing back takes {} s, longer than the record",
                seconds(back_s)
            )
        });
    }
    let tau_s = *subject.taus_s().get(subject.branch_of(key)?)?;
    let branch = if tau_s < 1.0 {
        format!("the branch of {} ms", significant(1e3 * tau_s, 2))
    } else {
        format!("the branch of {} s", seconds(tau_s))
    };
    match () {
        () if tau_s < trial.every_s => Some(format!(
            "{branch} is faster than a reading every {} s",
            plain(trial.every_s)
        )),
        () if is_slow(tau_s) => Some(format!(
            "{branch} is slower than the record of {} s",
            plain(trial.for_s)
        )),
        () => None,
    }
}

/// Which single change determines a parameter, the smallest of each kind.
fn cure(key: &str, changes: &[ChangeEntry]) -> String {
    let of = |change: &ChangeEntry| change.parameters.iter().find(|of| of.key == key).cloned();
    let mut cures: Vec<(&str, String)> = Vec::new();
    for change in changes
        .iter()
        .filter(|change| of(change).is_some_and(|of| of.is_determined()))
    {
        if cures.iter().all(|(kind, _)| *kind != change.kind) {
            let percent = of(change).and_then(|of| of.interval_percent);
            let percent = percent.map_or(String::new(), |percent| {
                format!(" (to {} %)", significant(percent, 2))
            });
            cures.push((change.kind, format!("{}{percent}", change.change)));
        }
    }
    let cures: Vec<String> = cures.into_iter().map(|(_, words)| words).collect();
    if !cures.is_empty() {
        return format!("{} determines {{them}}.", capital(&cures.join(", or ")));
    }
    let tried: Vec<&str> = changes.iter().map(|change| change.change.as_str()).collect();
    if tried.is_empty() {
        "No change was tried.".to_owned()
    } else {
        format!(
            "No single change that was tried determines {{them}}: {}.",
            tried.join("; ")
        )
    }
}

/// How much slower the readings may be, where everything is determined.
fn slower(changes: &[ChangeEntry]) -> Option<String> {
    let still = |change: &&ChangeEntry| {
        change.kind == "slower" && change.parameters.iter().all(PlannedParameter::is_determined)
    };
    let slowest = changes.iter().rfind(still)?;
    let each: Vec<String> = slowest.parameters.iter().map(to_percent).collect();
    Some(format!(
        "{} would still determine all: {}.",
        capital(&slowest.change),
        in_a_row(&each)
    ))
}

/// What a stated start of the drive adds, where everything is determined without.
fn known_start(changes: &[ChangeEntry]) -> Option<String> {
    let change = changes.iter().find(|change| change.kind == "start")?;
    let each: Vec<String> = change
        .parameters
        .iter()
        .filter(|of| of.is_determined())
        .map(to_percent)
        .collect();
    Some(format!(
        "{} would give {}.",
        capital(&change.change),
        in_a_row(&each)
    ))
}

/// A number with the digits that it was given.
fn plain(number: f64) -> String {
    ((number * 1e9).round() / 1e9).to_string()
}
