//! What the simulation gets wrong: shown, named, put right, and the gain measured.
//!
//! A group of runs of one sample in one condition is fitted with one parameter set of the base model. The refitted
//! residuals are asked for every candidate effect's signature and for any smooth shape; how large the answers become
//! by chance is simulated. Candidates that promise most are fitted in full, taken one after another under strict
//! rules, proved on held-out readings, and named only where no other explains the readings as well.
//!
//! The rooms in this order, each of which uses those before it: `readings`, `fitting`, `misfit`, `cause`, `outcome`. Beside
//! them `extended`, where the effects are given, and `benchmark`, what a diagnosis is held against.

mod benchmark;
mod cause;
mod extended;
mod fitting;
mod misfit;
mod outcome;
mod readings;
#[cfg(test)]
mod tests;

use ieap_domain::{CondemnedRun, GroupDiagnosis, Verdict};
use ieap_model::FitModel;

pub use benchmark::effect_size::{
    DesignRun, KnownNoise, base_columns, in_units_of_noise, sigmas_after_refit,
};
pub use benchmark::known_cause::known_cause_gain;
pub use benchmark::textbook::{ForwardStep, Textbook, textbook};
pub use cause::evidence::{by_evidence, set_of};
use cause::select;
pub use extended::fits::{fit_extended, model_version};
pub use extended::from_others::{FromOthersFall, fall_from_others};
use fitting::{base_fit, fitted};
use misfit::{odd_scale, signature, stretch};
pub use outcome::lengthwise::with_places;
pub use outcome::next_run::proposals;
use outcome::{finding, per_run, varying};
pub use readings::group::RunInput;
use readings::{group, outliers};

/// Version of the procedure; a change makes earlier diagnoses out of date.
pub const VERSION: u32 = 23;

/// How to diagnose.
#[derive(Debug, Clone, Copy)]
pub struct DiagnoseOptions {
    /// The base model.
    pub model: &'static FitModel,
    /// Draws of what chance does; 999 tell a p-value of 0.001 from none.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Whether this is a run of a group of several, which is diagnosed too and can say more of the cause.
    pub of_several: bool,
}

impl Default for DiagnoseOptions {
    fn default() -> DiagnoseOptions {
        DiagnoseOptions {
            model: ieap_fit::FitOptions::default().model,
            draws: 999,
            seed: 1,
            of_several: false,
        }
    }
}

/// Diagnoses runs that one parameter set of the base model describes.
///
/// It is a pure function of its input and options: the same readings give the same result at any number of threads.
pub fn diagnose_group(name: &str, runs: &[RunInput], options: &DiagnoseOptions) -> GroupDiagnosis {
    let raw = group::Group::new(runs);
    let odd = odd_scale::odd_runs(&raw, options.model);
    if !odd.is_empty() {
        return without(name, runs, odd, options);
    }
    let found = with_base(&raw, options.model, |group, base| {
        diagnosed(name, group, base, options)
    });
    let mut found = found.unwrap_or_else(|| finding::nothing(name, runs, options));
    let may_vary = varying::leads(&found);
    if runs.len() > 1 && (may_vary || found.verdict == Verdict::Unknown) {
        let alone = per_run::alone(runs, options);
        match may_vary && varying::are_described(&alone) {
            true => varying::say(&mut found, &alone),
            false => found.remarks.extend(per_run::in_words(&alone)),
        }
        found.alone = alone;
    }
    found
}

/// The runs that a diagnosis of this group condemns, which it finds out first of all: it takes a fit of each run, where
/// the whole may take hours.
pub fn condemned(runs: &[RunInput], model: &'static FitModel) -> Vec<CondemnedRun> {
    let mut found: Vec<CondemnedRun> = Vec::new();
    loop {
        let is_odd = |run: &&RunInput| found.iter().any(|odd| odd.run == run.name);
        let rest: Vec<RunInput> = runs.iter().filter(|run| !is_odd(run)).copied().collect();
        let odd = odd_scale::odd_runs(&group::Group::new(&rest), model);
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

/// Calls `then` with the group, its noise found beside the base model, and the base model fitted to it; none where no
/// run gives a start.
fn with_base<R>(
    raw: &group::Group,
    model: &'static FitModel,
    then: impl FnOnce(&group::Group, fitted::Fitted) -> R,
) -> Option<R> {
    let first = base_fit::base_fit(raw, model)?;
    without_strays(raw, &first, STRAY_LOOKS, Box::new(then))
}

/// What is made of a group and the base model fitted to it. In a box: looks for strays are nested, and a type of its own for
/// each would have no end.
type Then<'t, R> = Box<dyn FnOnce(&group::Group, fitted::Fitted) -> R + 't>;

/// Strays disturb the fit beside which they are seen: it is made again without them, and looked at again.
const STRAY_LOOKS: usize = 3;

/// Calls `then` as [`with_base`] does, from a first fit of the base model and without the readings that are far off it.
fn without_strays<R>(raw: &group::Group, first: &fitted::Fitted, looks: usize, then: Then<R>) -> Option<R> {
    let model = first.problem.model(&first.at);
    if let Some(cleaned) = outliers::without(raw, &model).filter(|_| looks > 0) {
        let again = base_fit::refit(&cleaned, first)?;
        return without_strays(&cleaned, &again, looks - 1, then);
    }
    // The noise that the readings alone show holds what is fast in them; a first fit takes that out.
    let once = raw.renoised(&first.problem.model(&first.at));
    let second = base_fit::refit(&once, first)?;
    let group = once.renoised(&second.problem.model(&second.at));
    let base = base_fit::refit(&group, &second)?;
    Some(then(&group, base))
}

fn diagnosed(
    name: &str,
    group: &group::Group,
    base: fitted::Fitted,
    options: &DiagnoseOptions,
) -> GroupDiagnosis {
    let scale = signature::scale(group, &base.problem, &base.at);
    let signatures = signature::signatures(&base.problem, &base.at, &scale);
    let stretches = stretch::stretches(group, &base);
    let ground = select::Ground {
        group,
        base: &base,
        signatures: &signatures,
        stretches: &stretches,
        draws: options.draws,
        seed: options.seed,
        of_several: options.of_several,
    };
    let (null, directions) = ground.null(&base, 0);
    let residuals = base.residuals();
    let observed = null.observe(group, &residuals, &directions);
    let calibration = ground.calibration(&null, &observed, &directions);
    let shown = finding::Shown {
        name,
        group,
        base: &base,
        null: &null,
        directions: &directions,
        signatures: &signatures,
        stretches: &stretches,
        residuals: &residuals,
        p_misfit: null.p_misfit(&observed, calibration.as_ref()),
        options,
    };
    if shown.p_misfit >= finding::WRONG {
        return shown.without_cause();
    }
    let selection = ground.select(&null, &directions);
    shown.with_cause(&selection)
}
