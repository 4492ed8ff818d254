//! What a run's readings along the strip are asked: the distributed model, and whether it is needed.

use super::outcome::{Outcome, not_fitted};
use crate::domain::{Channel, Fit, Issue, Quantity};
use crate::fit::FitOptions;
use crate::fit::distributed::{Decision, DistributedInput, Strip, decide, fit_distributed, given_resistance};
use crate::model::coupling::CurvaturePerLineCharge;
use crate::model::distributed::DistributedModel;
use crate::store::FitTask;

/// Fits what was measured along the strip with the distributed model.
pub(crate) fn fit(task: &FitTask, channels: &[Channel], options: &FitOptions) -> Outcome {
    let Some(strip) = strip(task) else {
        let message = "the distributed model needs the sample's free length";
        return Err(Issue::warning("not-fitted", message).mend("give the sample length_mm in campaign.toml"));
    };
    let input = DistributedInput {
        channels,
        drive: &task.drive,
        strip,
    };
    fit_distributed(&input, options.steps).map_err(not_fitted)
}

fn strip(task: &FitTask) -> Option<Strip> {
    task.length_cm.map(|length_cm| Strip {
        length_cm,
        width_cm: task.area_cm2 / length_cm,
        electrode_resistance_ohm_per_sq: task.electrode_resistance_ohm_per_sq,
        electrode_resistance_error_ohm_per_sq: task.electrode_resistance_error_ohm_per_sq,
    })
}

/// Lumped or distributed, for a run with readings at several places.
pub(crate) fn decision(task: &FitTask, channels: &[Channel]) -> Option<Decision> {
    let places = |quantity: Quantity| {
        let of = |channel: &&Channel| channel.quantity == quantity && channel.position_mm.is_some();
        channels.iter().filter(of).count()
    };
    if places(Quantity::Voltage).max(places(Quantity::Curvature)) < 2 {
        return None;
    }
    let strip = strip(task)?;
    decide(&DistributedInput {
        channels,
        drive: &task.drive,
        strip,
    })
}

/// The note that a lumped fit carries: from places along the strip, else from the electrodes' resistance where that is
/// given with the sample.
pub(crate) fn lumped_or_distributed(task: &FitTask, channels: &[Channel], fit: &Fit) -> Option<Issue> {
    if let Some(decision) = decision(task, channels) {
        return Some(decision.issue());
    }
    let along = task.electrode_resistance_ohm_per_sq?;
    let strip = strip(task)?;
    let value = |key: &str| fit.parameter(key).and_then(|estimate| estimate.value);
    // What the branches conduct together at first is what matters of them here.
    let across = value("r_parallel_ohm_cm2").or_else(|| value("r1_ohm_cm2"))?;
    let model = DistributedModel {
        electrode_resistance_ohm_per_cm: along / strip.width_cm,
        branch_resistance_ohm_cm: across / strip.width_cm,
        capacitance_f_per_cm: 1.0,
        steady_state_resistance_ohm_cm: value("rss_ohm_cm2").unwrap_or(f64::INFINITY) / strip.width_cm,
        length_cm: strip.length_cm,
        coupling: CurvaturePerLineCharge(1.0),
        relaxation_rate_per_s: 0.0,
    };
    let given = given_resistance(along, task.electrode_resistance_error_ohm_per_sq);
    Some(Decision::by_criterion(&model, given).issue())
}
