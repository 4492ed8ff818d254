//! A diagnosis from its readings to what is told: the rooms in their order.

use rayon::prelude::*;

use ieap_domain::{CondemnedRun, GroupDiagnosis, RunAlone, Verdict};
use ieap_model::FitModel;

use crate::cause::evidence::is_slow_noise;
use crate::cause::selection_input::SelectionInput;
use crate::fitting::base_fit::refit;
use crate::fitting::fitted::Fitted;
use crate::fitting::scale::scale;
use crate::fitting::without_outliers::with_base;
use crate::levels::WRONG;
use crate::misfit::odd_scale::odd_runs;
use crate::misfit::residual_bins::residual_bins;
use crate::misfit::signature::signatures;
use crate::options::DiagnoseOptions;
use crate::outcome::finding::{FindingBuilder, nothing};
use crate::outcome::per_run::in_words;
use crate::outcome::varying;
use crate::readings::group::{RunGroup, RunInput};

/// Diagnoses runs that one parameter set of the base model describes.
///
/// It is a pure function of its input and options: the same readings give the same result at any number of threads.
pub fn diagnose_group(name: &str, runs: &[RunInput], options: &DiagnoseOptions) -> GroupDiagnosis {
    let raw = RunGroup::new(runs);
    let odd = odd_runs(&raw, options.model);
    if !odd.is_empty() {
        return without(name, runs, odd, options);
    }
    let found = with_base(&raw, options.model, |group, base| {
        diagnosed(name, group, base, options)
    });
    let mut found = found.unwrap_or_else(|| nothing(name, runs, options));
    let may_vary = varying::leads(&found);
    if runs.len() > 1 && (may_vary || found.verdict == Verdict::Unknown) {
        let per_run = per_run(runs, options);
        match may_vary && varying::are_described(&per_run) {
            true => varying::say(&mut found, &per_run),
            false => found.remarks.extend(in_words(&per_run)),
        }
        found.alone = per_run;
    }
    found
}

/// Every run diagnosed as a group of its own.
fn per_run(runs: &[RunInput], options: &DiagnoseOptions) -> Vec<RunAlone> {
    let options = DiagnoseOptions {
        of_several: true,
        ..*options
    };
    let of_run = |run: &RunInput| {
        let found = diagnose_group(run.name, &[*run], &options);
        RunAlone {
            run: run.name.to_owned(),
            verdict: found.verdict,
            gains_clearly: found.gains_clearly(),
            p_misfit: found.p_misfit,
            set: found.set,
        }
    };
    runs.par_iter().map(of_run).collect()
}

/// The runs that a diagnosis of this group condemns, which it finds out first of all: it takes a fit of each run, where
/// the whole may take hours.
pub fn condemned(runs: &[RunInput], model: &'static FitModel) -> Vec<CondemnedRun> {
    let mut found: Vec<CondemnedRun> = Vec::new();
    loop {
        let is_odd = |run: &&RunInput| found.iter().any(|odd| odd.run == run.name);
        let rest: Vec<RunInput> = runs.iter().filter(|run| !is_odd(run)).copied().collect();
        let odd = odd_runs(&RunGroup::new(&rest), model);
        if odd.is_empty() {
            return found;
        }
        found.extend(odd);
    }
}

/// The diagnosis of the runs that are not among `odd`, which are named beside it.
fn without(
    name: &str,
    runs: &[RunInput],
    mut odd: Vec<CondemnedRun>,
    options: &DiagnoseOptions,
) -> GroupDiagnosis {
    let is_odd = |run: &&RunInput| odd.iter().any(|odd| odd.run == run.name);
    let rest: Vec<RunInput> = runs.iter().filter(|run| !is_odd(run)).copied().collect();
    let mut found = diagnose_group(name, &rest, options);
    let said = odd
        .iter()
        .map(|odd| format!("{} is set aside: {}", odd.run, odd.reason));
    found.remarks.splice(0..0, said);
    odd.append(&mut found.condemned);
    found.condemned = odd;
    found
}

fn diagnosed(name: &str, group: &RunGroup, base: Fitted, options: &DiagnoseOptions) -> GroupDiagnosis {
    let scale = scale(group, &base.problem, &base.at);
    let signatures = signatures(&base.problem, &base.at, &scale);
    let bins = residual_bins(group, &base);
    let input = SelectionInput {
        group,
        base: &base,
        signatures: &signatures,
        bins: &bins,
        draws: options.draws,
        seed: options.seed,
        of_several: options.of_several,
    };
    let (null, directions) = input.null(&base, 0);
    let residuals = base.residuals();
    let observed = null.observe(group, &residuals, &directions);
    let calibration = input.calibration(&null, &observed, &directions);
    let builder = FindingBuilder {
        name,
        group,
        base: &base,
        null: &null,
        directions: &directions,
        signatures: &signatures,
        bins: &bins,
        residuals: &residuals,
        p_misfit: null.p_misfit(&observed, calibration.as_ref()),
        options,
    };
    if builder.p_misfit >= WRONG {
        return builder.without_cause();
    }
    let selection = input.select(&null, &directions);
    let found = builder.with_cause(&selection);
    match is_slow_noise(&found.posterior) {
        true => beside_slow_noise(name, group, &base, options).unwrap_or(found),
        false => found,
    }
}

/// The same beside slow noise, where that is what is behind the misfit and leaves none; none where it was taken already.
fn beside_slow_noise(
    name: &str,
    group: &RunGroup,
    base: &Fitted,
    options: &DiagnoseOptions,
) -> Option<GroupDiagnosis> {
    let slow = group.with_slow_noise(&base.problem.model(&base.at))?;
    let base = refit(&slow, base)?;
    let found = diagnosed(name, &slow, base, options);
    (!found.verdict.is_misfit()).then_some(found)
}
