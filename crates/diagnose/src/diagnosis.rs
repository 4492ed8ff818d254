//! A diagnosis from its readings to what is told: the rooms in their order.

use ieap_domain::finding_words::say;
use ieap_domain::{Account, CondemnedRun, GroupDiagnosis, Verdict};
use ieap_model::FitModel;
use ieap_model::effects::summary;
use ieap_numerics::sums::dot;

use crate::cause::selection_input::SelectionInput;
use crate::fitting::base_fit::refit;
use crate::fitting::edges;
use crate::fitting::fitted::Fitted;
use crate::fitting::scale::scale;
use crate::fitting::without_outliers::with_base;
use crate::levels::{RIGHT_FROM, WRONG_BELOW};
use crate::misfit::misfit_size::misfit_percent;
use crate::misfit::odd_scale::odd_runs;
use crate::misfit::residual_bins::residual_bins;
use crate::misfit::signature::signatures;
use crate::missing::look::look;
use crate::options::DiagnoseOptions;
use crate::outcome::finding::{FindingBuilder, nothing};
use crate::readings::group::{Block, RunGroup, RunInput};
use crate::readings::scatter;

/// Diagnoses runs that one parameter set of the base model describes.
///
/// It is a pure function of its input and options: the same readings give the same result at any number of threads.
pub fn diagnose_group(name: &str, runs: &[RunInput], options: &DiagnoseOptions) -> GroupDiagnosis {
    let mut found = of_runs(name, runs, options);
    say(&mut found, &summary);
    found
}

fn of_runs(name: &str, runs: &[RunInput], options: &DiagnoseOptions) -> GroupDiagnosis {
    let raw = RunGroup::new(runs);
    let odd = odd_runs(&raw, options.model);
    if !odd.is_empty() {
        return without(name, runs, odd, options);
    }
    let found = with_base(&raw, options.model, |group, base| {
        diagnosed(name, group, base, options)
    });
    found.unwrap_or_else(|| nothing(name, runs, options))
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
    looked(name, group, base, options, None)
}

/// The diagnosis; `on_edges` where the edges are those that an extended model has: the mean square by which it misses what was held
/// out on the edges of the base. What misses it by more there is not told.
fn looked(
    name: &str,
    group: &RunGroup,
    base: Fitted,
    options: &DiagnoseOptions,
    on_edges: Option<f64>,
) -> GroupDiagnosis {
    let scattered = group.with_scatter(&base.problem.model(&base.at));
    let beside_own = scattered.as_ref().unwrap_or(group);
    let scatter = beside_own
        .scatter()
        .map(|_| scatter::told(beside_own, &base.problem.model(&base.at)));
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
        absent: options.absent,
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
        scatter: scatter.as_deref().unwrap_or_default(),
        options,
    };
    if builder.p_misfit >= RIGHT_FROM {
        return builder.without_cause();
    }
    let beside = |group: Option<RunGroup>| diagnosed_beside(name, &group?, &base, options);
    if let Some(found) = beside(scattered) {
        return found;
    }
    if builder.p_misfit >= WRONG_BELOW {
        return builder.without_cause();
    }
    let model = base.problem.model(&base.at);
    let plain = builder.of_size(misfit_percent(group, &base));
    if plain.verdict == Verdict::DataProblem {
        return plain;
    }
    let missing = look(&input, &directions, options.model);
    let held_out = missing.held_out_square(group);
    if let (Some(there), Some(here)) = (on_edges, held_out)
        && here > there
    {
        return plain;
    }
    let extended = missing.lead.as_ref().map(|lead| lead.model.clone());
    // Edges that the base model found hide a part of what it misses. A bending that is late is no witness of them: of what is
    // wrong with it alone the causes are held against each other on the edges that the base has. Nor is a model that leaves a
    // misfit itself.
    if on_edges.is_none()
        && let Some(extended) = &extended
        && is_of_current(group, &base, extended)
        && let Some((moved, at)) = edges::settled(group, extended)
    {
        let moved = moved.renoised(&extended.problem.model(&at));
        let again = refit(&moved, &base).map(|base| looked(name, &moved, base, options, held_out));
        if let Some(found) = again.filter(|again| !again.verdict.is_misfit() || again.verdict == Verdict::Law)
        {
            return found;
        }
    }
    let may_be_noise = missing.may_be_noise;
    let found = builder.with_law(missing);
    // Slow noise that readings beside it refute is none, and what was found without it stands.
    let slow = may_be_noise
        .then(|| beside(group.with_slow_noise(&model)))
        .flatten();
    match slow.filter(|slow| !slow.verdict.is_misfit()) {
        Some(slow) => of_slow_noise(found, slow),
        None => by_size(plain, found),
    }
}

/// What is found, where more than is tolerated is left; else that the simulation is right, and what is known of the rest.
fn by_size(plain: GroupDiagnosis, found: GroupDiagnosis) -> GroupDiagnosis {
    match (plain.verdict, found.verdict) {
        (Verdict::Right, Verdict::Law) => GroupDiagnosis {
            account: found.account,
            missing: found.missing,
            posterior: found.posterior,
            p_leftover: found.p_leftover,
            ..plain
        },
        (Verdict::Right, _) => plain,
        _ => found,
    }
}

/// That the instrument's slow noise leaves the misfit: beside it nothing more is left.
fn of_slow_noise(found: GroupDiagnosis, slow: GroupDiagnosis) -> GroupDiagnosis {
    let account = found.account.map(|own| Account {
        noise: own.noise,
        instrument: own.beyond_noise(),
        ..Account::default()
    });
    GroupDiagnosis {
        verdict: Verdict::Instrument,
        p_misfit: found.p_misfit,
        account,
        posterior: found.posterior,
        ..slow
    }
}

/// Whether most of what an extended model explains beyond the base is in the current.
fn is_of_current(group: &RunGroup, base: &Fitted, extended: &Fitted) -> bool {
    let (before, after) = (base.residuals(), extended.residuals());
    let fall = |block: &Block| {
        let rows = block.first..block.end;
        dot(&before[rows.clone()], &before[rows.clone()]) - dot(&after[rows.clone()], &after[rows])
    };
    let of = |channel: usize| {
        group
            .blocks
            .iter()
            .filter(|block| block.channel == channel)
            .map(fall)
            .sum::<f64>()
    };
    of(0) > of(1).max(0.0)
}

/// The same beside other noise; none where it takes no scatter that was asked for.
fn diagnosed_beside(
    name: &str,
    group: &RunGroup,
    base: &Fitted,
    options: &DiagnoseOptions,
) -> Option<GroupDiagnosis> {
    if group.scatter().is_some_and(|scatter| scatter.taken.is_empty()) {
        return None;
    }
    Some(diagnosed(name, group, refit(group, base)?, options))
}
