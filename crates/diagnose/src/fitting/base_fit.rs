//! The base model fitted to a whole group: one parameter set for all of its runs.

use ieap_domain::Estimate;
use ieap_fit::{FitOptions, fit_run, least_squares_place};
use ieap_model::{Branch, FitModel, LumpedModel};

use crate::fitting::fitted::Fitted;
use crate::fitting::policy::HIDDEN_BRANCHES;
use crate::fitting::problem::ExtendedProblem;
use crate::readings::group::{GroupRun, RunGroup};

/// Fits the base: from the parameters of every run alone, and from a guess by the record's length.
pub(crate) fn base_fit<'g>(group: &'g RunGroup<'g>, model: &'static FitModel) -> Option<Fitted<'g>> {
    let is_whole = |start: &LumpedModel| start.branches.len() == model.branches;
    let each = of_each_run(group, model).into_iter().flatten();
    let mut starts: Vec<LumpedModel> = each.filter(is_whole).collect();
    if starts.is_empty() {
        starts.extend(of_moving_runs(group, model));
    }
    starts.push(guess(group, model.branches)?);
    let problem = ExtendedProblem::new(group, starts.first()?, Vec::new());
    let at: Vec<Vec<f64>> = starts
        .iter()
        .map(|start| problem.coordinates(start, &[]))
        .collect();
    let best = Fitted::search(problem, &at, &[])?.polished();
    // Sizes are measured anew by what was found.
    let problem = ExtendedProblem::new(group, &best.base(), Vec::new());
    let at = problem.coordinates(&best.base(), &[]);
    Fitted::search(problem, &[at], &[]).map(Fitted::polished)
}

/// The parameters of every run by itself, in the order of runs, with the branches that its readings show; none where it shows
/// none.
pub(crate) fn of_each_run(group: &RunGroup, model: &'static FitModel) -> Vec<Option<LumpedModel>> {
    let options = FitOptions {
        model,
        ..FitOptions::default()
    };
    let guess = guess(group, model.branches);
    let of_run = |run: &GroupRun| {
        let fit = fit_run(&run.given.input, &options).ok()?;
        start_of(&|key: &str| fit.parameter(key).and_then(best), guess.as_ref()?)
    };
    group.runs.iter().map(of_run).collect()
}

/// Places from which to search where the voltage moves all the time: such a run alone often determines no branch.
fn of_moving_runs(group: &RunGroup, model: &'static FitModel) -> Vec<LumpedModel> {
    let options = FitOptions {
        model,
        ..FitOptions::default()
    };
    let moving = group.runs.iter().filter(|run| run.drive().moves());
    let places = moving.filter_map(|run| least_squares_place(&run.given.input, &options));
    places
        .flat_map(|place| with_branches(place, model.branches))
        .collect()
}

/// The place with as many branches, those that it lacks beside its first one.
fn with_branches(place: LumpedModel, branches: usize) -> Vec<LumpedModel> {
    let shown = place.branches[0];
    if place.branches.len() >= branches {
        return vec![place];
    }
    let with = |(longer, larger): (f64, f64)| {
        let mut place = place.clone();
        for k in place.branches.len()..branches {
            let resistance_ohm_cm2 = larger * shown.resistance_ohm_cm2;
            place.branches.push(Branch {
                resistance_ohm_cm2,
                capacitance_f_per_cm2: longer.powi(k as i32) * shown.time_constant_s() / resistance_ohm_cm2,
            });
        }
        place
    };
    HIDDEN_BRANCHES.into_iter().map(with).collect()
}

/// The base fitted to the same readings with another noise, from where it was.
pub(crate) fn refit<'g>(group: &'g RunGroup<'g>, from: &Fitted) -> Option<Fitted<'g>> {
    refit_from(group, &from.base())
}

/// The base fitted from those parameters.
pub(crate) fn refit_from<'g>(group: &'g RunGroup<'g>, start: &LumpedModel) -> Option<Fitted<'g>> {
    let problem = ExtendedProblem::new(group, start, Vec::new());
    let at = problem.coordinates(start, &[]);
    Fitted::search(problem, &[at], &[]).map(Fitted::polished)
}

/// The value, or the middle of what an interval leaves.
fn best(estimate: &Estimate) -> Option<f64> {
    estimate.value.or(estimate.low_95).or(estimate.high_95)
}

fn start_of(value: &dyn Fn(&str) -> Option<f64>, guess: &LumpedModel) -> Option<LumpedModel> {
    let mut start = guess.clone();
    let branch = |k: usize| {
        let positive = |key: String| value(&key).filter(|value| *value > 0.0);
        Some(Branch {
            resistance_ohm_cm2: positive(format!("r{k}_ohm_cm2"))?,
            capacitance_f_per_cm2: positive(format!("c{k}_f_per_cm2"))?,
        })
    };
    start.branches = (1..=guess.branches.len()).filter_map(branch).collect();
    if start.branches.is_empty() {
        return None;
    }
    if let Some(rss) = value("rss_ohm_cm2").filter(|rss| *rss > 0.0) {
        start.steady_state_resistance_ohm_cm2 = rss;
    }
    if let Some(alpha) = value("alpha_per_c_cm") {
        start.charge_to_curvature_per_c_cm = alpha;
    }
    if let Some(lambda) = value("lambda_per_s").filter(|lambda| *lambda >= 0.0) {
        start.relaxation_rate_per_s = lambda;
    }
    Some(start)
}

/// A model of the record's own sizes: the first current, the length, the bending reached.
fn guess(group: &RunGroup, branches: usize) -> Option<LumpedModel> {
    let longest_s = group.runs.iter().map(|run| run.duration_s).fold(0.0, f64::max);
    let mut per_volt: f64 = 0.0;
    let mut bending = 0.0;
    for run in &group.runs {
        let step_v = run.drive().nominal_step_v().abs();
        if step_v == 0.0 {
            continue;
        }
        let peak = |k: usize| {
            let values = run.channels[k].as_ref().map(|channel| channel.values().clone());
            values.map_or(0.0, |values| {
                values
                    .iter()
                    .fold(0.0, |most: f64, v| if v.abs() > most.abs() { *v } else { most })
            })
        };
        per_volt = per_volt.max(peak(0).abs() / step_v / run.given.input.area_cm2);
        bending = if bending == 0.0 {
            peak(1) / run.drive().nominal_step_v()
        } else {
            bending
        };
    }
    let longest_s = longest_s.max(1e-6);
    let per_volt = if per_volt > 0.0 { per_volt } else { 1e-3 };
    let branch = |k: usize| {
        let resistance_ohm_cm2 = 2.0_f64.powi(k as i32) * 1.5 / per_volt;
        let tau_s = longest_s * 0.02 * 12.0_f64.powi(k as i32);
        Branch {
            resistance_ohm_cm2,
            capacitance_f_per_cm2: tau_s / resistance_ohm_cm2,
        }
    };
    let branches: Vec<Branch> = (0..branches.max(1)).map(branch).collect();
    let capacitance: f64 = branches.iter().map(|b| b.capacitance_f_per_cm2).sum();
    let area_cm2 = group.runs.first()?.given.input.area_cm2;
    Some(LumpedModel {
        steady_state_resistance_ohm_cm2: 50.0 / per_volt,
        charge_to_curvature_per_c_cm: if bending == 0.0 {
            1.0
        } else {
            bending / (capacitance * area_cm2)
        },
        relaxation_rate_per_s: 1.0 / longest_s,
        branches,
    })
}
