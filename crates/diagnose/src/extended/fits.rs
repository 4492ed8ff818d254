//! Fits of the extended model: one parameter set for the runs of a group, effects among it.

use ieap_domain::number::{fixed, significant};
use ieap_domain::{Fit, Issue, Parameter};
use ieap_fit::{BaseKnowledge, fit_of_run};
use ieap_model::effects::smooth_laws::smooth_law;
use ieap_model::{FitModel, ModelChoice};
use ieap_numerics::student::quantile_95;
use ieap_numerics::symmetric::Symmetric;

use crate::cause::candidates::added;
use crate::extended::laws::place;
use crate::extended::policy::{SHIFT_SIGMAS, WIDENED_FROM};
use crate::fitting::fitted::Fitted;
use crate::fitting::problem::FreeEffect;
use crate::fitting::scale::scale;
use crate::fitting::without_outliers::with_base;
use crate::misfit::signature::{directions, signatures_of};
use crate::missing::weighed::with_law;
use crate::options::VERSION;
use crate::readings::group::{RunGroup, RunInput};

/// Fits the base model with the effects of `choice` to all runs at once.
///
/// The fits have the place of their run in `runs`; runs without enough readings have none. None at all where the base
/// model cannot be fitted to any run, or an effect cannot act in these runs. A pure function of its input: the same readings give the same numbers at any
/// number of threads.
pub fn fit_extended(runs: &[RunInput], choice: &ModelChoice) -> Vec<(usize, Fit)> {
    let raw = RunGroup::new(runs);
    let found = with_base(&raw, choice.base, |group, base| {
        let extended = extend(group, base.clone(), choice);
        extended.map_or_else(Vec::new, |extended| fits(group, &base, &extended, choice, runs))
    });
    found.unwrap_or_default()
}

/// Adds the effects one after another, each from its most promising shapes, and settles them together; none where one
/// has no shape that acts in these runs.
pub(crate) fn extend<'g>(
    group: &'g RunGroup<'g>,
    base: Fitted<'g>,
    choice: &ModelChoice,
) -> Option<Fitted<'g>> {
    let scale = scale(group, &base.problem, &base.at);
    choice.effects.iter().try_fold(base, |model, &effect| {
        // A law without an equation is known by how large it is likely to be.
        if let Some(law) = smooth_law(effect.about().id) {
            return with_law(&model, law, &scale);
        }
        let signatures = signatures_of(&[effect], &model.problem, &model.at, &scale);
        let (_, tangent) = model.tangent();
        let directions = directions(&signatures, &tangent);
        let residuals = model.residuals();
        let before = model.evaluations;
        let mut with = added(&model, &residuals, &signatures, &directions)?
            .exhausted()
            .in_own_limits();
        with.evaluations += before;
        Some(with)
    })
}

fn fits<'g>(
    group: &'g RunGroup<'g>,
    base: &Fitted<'g>,
    extended: &Fitted<'g>,
    choice: &ModelChoice,
    runs: &[RunInput],
) -> Vec<(usize, Fit)> {
    let searched = extended.at.len();
    let freedom = (group.effective_readings() - searched as f64).max(1.0);
    // What even the extended model leaves beyond the noise widens every interval.
    let rows = (group.rows() as f64 - searched as f64).max(1.0);
    let wider = (extended.square / rows).sqrt().max(1.0);
    let knowledge = knowledge(extended, wider, quantile_95(freedom));
    let of_effects = effect_parameters(extended, group, wider);
    let model = extended.problem.model(&extended.at);
    let issues = issues(base, extended, choice, group, wider);
    let of_run = |(place, run): (usize, &crate::readings::group::GroupRun)| {
        let index = runs.iter().position(|given| given.name == run.given.name)?;
        let mut parameters = knowledge.parameters(choice.base, run.drive());
        parameters.extend(of_effects.clone());
        let head = head(choice, extended, wider, parameters, issues.clone());
        let context = run.context(place, None);
        let predict = |current_s: &[f64], curvature_s: &[f64]| {
            let found = model.responses(&context, current_s, curvature_s);
            [found.current_a, found.curvature_per_cm]
        };
        Some((index, fit_of_run(&run.input(), searched, head, &predict)))
    };
    group.runs.iter().enumerate().filter_map(of_run).collect()
}

fn head(
    choice: &ModelChoice,
    extended: &Fitted,
    wider: f64,
    parameters: Vec<Parameter>,
    issues: Vec<Issue>,
) -> Fit {
    let runs = extended.problem.runs.len();
    Fit {
        extended: Some(place(extended, wider)),
        model: choice.to_string(),
        model_version: model_version(choice.base),
        method: format!(
            "simultaneous least squares over {runs} runs of the group, weighted by the noise{}",
            forms(extended)
        ),
        converged: extended.stop.converged(),
        why_stopped: extended.stop.words().to_owned(),
        n_samples: 0,
        parameters,
        nuisances: Vec::new(),
        r_squared_current: None,
        r_squared_curvature: None,
        noise: Vec::new(),
        curves: Vec::new(),
        along: Vec::new(),
        issues,
        evaluations: extended.evaluations,
    }
}

/// The form that each effect took, where it has several: without it its parameters are not known.
fn forms(extended: &Fitted) -> String {
    let of = |free_effect: &FreeEffect| {
        let about = free_effect.effect.about();
        let form = about.variants.get(free_effect.variant)?;
        Some(format!("; {} as {form}", about.id))
    };
    extended.problem.effects.iter().filter_map(of).collect()
}

/// Version of an extended model's fits: of the base, and of the procedure that extends it.
pub fn model_version(base: &FitModel) -> u32 {
    base.version * 100 + VERSION
}

/// Place and covariance of the base parameters, branches by time constant.
fn knowledge(extended: &Fitted, wider: f64, quantile: f64) -> BaseKnowledge {
    let (slope, _) = extended.problem.slope(&extended.at);
    let inverse = slope.normal.inverse(1e-12);
    let mut base = extended.base();
    let n = base.branches.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| {
        let tau_s = |k: usize| base.branches[k].time_constant_s();
        tau_s(a).total_cmp(&tau_s(b))
    });
    base.branches = order.iter().map(|&k| base.branches[k]).collect();
    let len = extended.problem.base_len();
    let local = BaseKnowledge::place(&base, len > 2 * n + 1);
    // Coordinate of each local parameter, and the local parameter's size of one coordinate unit.
    let units = extended.problem.units();
    let coordinate = |k: usize| match k {
        k if k < n => (order[k], 1.0),
        k if k < 2 * n => (n + order[k - n], 1.0),
        k => (k, units[k - 2 * n]),
    };
    let covariance = Symmetric::from_fn(len, |a, b| {
        let ((i, by_i), (j, by_j)) = (coordinate(a), coordinate(b));
        wider * wider * by_i * by_j * inverse.get(i, j)
    });
    BaseKnowledge {
        branches: n,
        local,
        covariance,
        quantile,
    }
}

/// Parameters of the effects, `faradaic-leak.onset_v`.
fn effect_parameters(extended: &Fitted, group: &RunGroup, wider: f64) -> Vec<Parameter> {
    let of_effects = extended.effect_parameters_widened(group, wider);
    let named = extended
        .problem
        .effects
        .iter()
        .zip(of_effects)
        .flat_map(|(free_effect, own)| {
            let id = free_effect.effect.about().id;
            own.into_iter().map(move |parameter| Parameter {
                key: format!("{id}.{}", parameter.key),
                estimate: parameter.estimate,
            })
        });
    named.collect()
}

/// What a reader of one run's fit must know: what it shares, and how wrong the base model's parameters were.
fn issues(
    base: &Fitted,
    extended: &Fitted,
    choice: &ModelChoice,
    group: &RunGroup,
    wider: f64,
) -> Vec<Issue> {
    let mut issues = vec![Issue::note(
        "shared-parameters",
        format!(
            "one parameter set for the {} of its group; the effects lower the weighted sum of squares from {} to {} \
             ({} readings)",
            counted(group.runs.len()),
            fixed(base.square, 0),
            fixed(extended.square, 0),
            group.rows()
        ),
    )];
    let before = base.base_parameters();
    for (key, after, standard_error) in extended.base_parameters() {
        let Some((_, was, _)) = before.iter().find(|(other, ..)| *other == key) else {
            continue;
        };
        let errors = (after - was).abs() / (wider * standard_error);
        if errors > SHIFT_SIGMAS && after != 0.0 && errors.is_finite() {
            let percent = 100.0 * (was - after).abs() / after.abs();
            let percent = significant(percent, 2);
            let side = if *was < after { "small" } else { "large" };
            issues.push(Issue::note(
                "base-parameter-was-wrong",
                format!(
                    "{key} was {percent} % too {side} with {}: {} standard errors",
                    choice.base.id,
                    fixed(errors, 0)
                ),
            ));
        }
    }
    if wider > WIDENED_FROM {
        issues.push(Issue::warning(
            "misfit-left",
            format!(
                "the extended model leaves {} times the noise; intervals are widened by it",
                fixed(wider, 1)
            ),
        ));
    }
    issues
}

fn counted(runs: usize) -> String {
    match runs {
        1 => "only run".to_owned(),
        n => format!("{n} runs"),
    }
}
