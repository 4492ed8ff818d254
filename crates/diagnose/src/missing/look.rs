//! A misfit looked at: everything weighed, what leads held out, the account of the error, and what is told.

use super::account::{Account, account};
use super::columns::columns;
use super::held_out::held_out;
use super::policy::{BETTER_PARTS, DIFFER_PART, LEFT_PART, MOST_LISTED, SURE};
use super::told::{Told, told};
use super::weighed::{Asked, Says};
use crate::cause::selection_input::SelectionInput;
use crate::fitting::base_fit::refit;
use crate::fitting::fitted::Fitted;
use crate::fitting::scale::scale;
use crate::fitting::without_outliers::with_base;
use crate::levels::{RIGHT_FROM, WRONG_BELOW};
use crate::misfit::misfit_size::misfit_percent;
use crate::misfit::residual_bins::residual_bins;
use crate::misfit::signature::signatures;
use crate::options::DiagnoseOptions;
use crate::readings::group::{RunGroup, RunInput};

/// What is found of a group.
#[derive(Debug, Clone, Default)]
pub struct Looked {
    /// `right`, `undecided`, `differs`, `law`, `instrument`, `unexplained`, `data-problem`.
    pub verdict: &'static str,
    /// Chance of such a misfit.
    pub p_misfit: f64,
    /// Place, law, variable and name.
    pub told: Told,
    /// Percent of the squared error: noise, between runs, within runs, unexplained.
    pub account: [f64; 4],
    /// Largest misfit, percent of a range.
    pub misfit_percent: f64,
    /// Probability of each kind: curves, equations, differing runs, slow noise, runs' own.
    pub kinds: [f64; 5],
    /// Hypotheses in words with their probabilities, the most probable first.
    pub leading: Vec<(String, f64, f64)>,
    /// Held-out parts that come out better, of how many, and the fall.
    pub held_out: (usize, usize, f64),
}

/// Looks at runs that one parameter set of the base model describes.
pub fn look(runs: &[RunInput], options: &DiagnoseOptions) -> Looked {
    let raw = RunGroup::new(runs);
    let found = with_base(&raw, options.model, |group, base| of_group(group, base, options));
    found.unwrap_or(Looked {
        verdict: "data-problem",
        ..Looked::default()
    })
}

fn of_group(group: &RunGroup, base: Fitted, options: &DiagnoseOptions) -> Looked {
    let first = asked(group, &base, options);
    if first.verdict == "right" {
        return first;
    }
    let model = base.problem.model(&base.at);
    // Runs that scatter by a few per cent are no misfit.
    let beside = group
        .with_scatter(&model)
        .filter(|own| own.scatter().is_some_and(|s| !s.taken.is_empty()));
    if let Some(scattered) = beside
        && let Some(base) = refit(&scattered, &base)
    {
        let again = asked(&scattered, &base, options);
        if again.verdict == "right" || again.verdict == "undecided" {
            return again;
        }
    }
    first
}

fn asked(group: &RunGroup, base: &Fitted, options: &DiagnoseOptions) -> Looked {
    let scale = scale(group, &base.problem, &base.at);
    let signatures = signatures(&base.problem, &base.at, &scale);
    let bins = residual_bins(group, base);
    let input = SelectionInput {
        group,
        base,
        signatures: &signatures,
        bins: &bins,
        draws: options.draws,
        seed: options.seed,
        of_several: options.of_several,
    };
    let (null, directions) = input.null(base, 0);
    let residuals = base.residuals();
    let observed = null.observe(group, &residuals, &directions);
    let calibration = input.calibration(&null, &observed, &directions);
    let p_misfit = null.p_misfit(&observed, calibration.as_ref());
    let size = misfit_percent(group, base);
    let mut looked = Looked {
        p_misfit,
        misfit_percent: size.current.unwrap_or(0.0).max(size.curvature.unwrap_or(0.0)),
        ..Looked::default()
    };
    if p_misfit >= WRONG_BELOW {
        looked.verdict = if p_misfit >= RIGHT_FROM {
            "right"
        } else {
            "undecided"
        };
        return looked;
    }
    let laws = columns(&base.problem, &base.at, &scale);
    let weighed = Asked {
        group,
        current: base,
        residuals: &residuals,
        signatures: &signatures,
        directions: &directions,
        laws: &laws,
        model: options.model,
    }
    .weigh();
    let masses = weighed.masses();
    let mut order: Vec<usize> = (0..masses.len()).collect();
    order.sort_by(|&a, &b| masses[b].total_cmp(&masses[a]));
    for &k in &order {
        looked.kinds[kind(weighed.all[k].says)] += masses[k];
    }
    let words = |k: usize| {
        let own = &weighed.all[k];
        let name = match own.says {
            Says::Curve(law) => {
                let law = &laws[law].law;
                format!("{} {} by {}", law.place.law, law.place.of, law.place.variable)
            }
            Says::Equation(id) => id.to_owned(),
            other => format!("{other:?}"),
        };
        (name, masses[k], own.fall)
    };
    looked.leading = order.iter().take(MOST_LISTED).map(|&k| words(k)).collect();
    let lead = order
        .iter()
        .map(|&k| &weighed.all[k])
        .find(|own| own.fitted.is_some());
    let law = lead.and_then(|own| own.fitted.as_ref());
    let own = weighed.varying.as_ref().map(|varying| varying.own_square());
    let account = account(group, base, law, own);
    looked.account = percent(&account);
    looked.told = told(&weighed, &masses);
    if let Some(law) = law {
        let held = held_out(group, base, law);
        let (better, parts) = held.better();
        looked.held_out = (better, parts, held.fall());
    }
    let (better, parts, fall) = looked.held_out;
    let pays = fall > 0.0 && better as f64 >= BETTER_PARTS * parts as f64;
    looked.verdict = match () {
        () if looked.kinds[kind(Says::SlowNoise)] >= SURE => "instrument",
        () if looked.kinds[kind(Says::Differ)] >= SURE
            || account.share(account.between_runs) >= DIFFER_PART =>
        {
            "differs"
        }
        () if looked.told.site.is_none() || !pays || account.share(account.unexplained) > LEFT_PART => {
            "unexplained"
        }
        () => "law",
    };
    looked
}

/// Place of a kind of hypothesis in [`Looked::kinds`].
fn kind(says: Says) -> usize {
    match says {
        Says::Curve(_) => 0,
        Says::Equation(_) => 1,
        Says::Differ => 2,
        Says::SlowNoise => 3,
        Says::Unnamed => 4,
    }
}

fn percent(account: &Account) -> [f64; 4] {
    let whole = account.noise + account.beyond();
    [
        account.noise,
        account.between_runs,
        account.within_runs,
        account.unexplained,
    ]
    .map(|part| 100.0 * part / whole)
}
