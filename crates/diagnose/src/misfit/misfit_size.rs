//! How large a misfit is in what a user compares: percent of current, curvature and charge.

use ieap_domain::MisfitPercent;

use crate::fitting::fitted::Fitted;
use crate::readings::group::{GroupRun, RunGroup};
use crate::readings::tolerance::{most_charge, passed};

/// Of the base model.
pub(crate) fn misfit_percent(group: &RunGroup, base: &Fitted) -> MisfitPercent {
    let model = base.problem.model(&base.at);
    let mut charge: Option<f64> = None;
    let mut squares = [(0.0, 0.0); 2];
    let mut ranges = [0.0_f64; 2];
    for block in &group.blocks {
        let run = &group.runs[block.run];
        let Some(channel) = group.channel(block) else {
            continue;
        };
        let fitted = &run.fitted(&model, &run.context(block.run, None))[block.channel];
        let off: Vec<f64> = channel.values().iter().zip(fitted).map(|(y, f)| y - f).collect();
        let noise: f64 = channel.standard_deviation().iter().map(|sd| sd * sd).sum();
        let square: f64 = off.iter().map(|off| off * off).sum();
        let (sum, count) = squares[block.channel];
        squares[block.channel] = (sum + square - noise, count + off.len() as f64);
        ranges[block.channel] = ranges[block.channel].max(range(channel.values()));
        if block.channel == 0 {
            let own = charge_error(run, &off);
            charge = charge.into_iter().chain(own).reduce(f64::max);
        }
    }
    let percent = |k: usize| {
        let (sum, count): (f64, f64) = squares[k];
        (count > 0.0 && ranges[k] > 0.0).then(|| 100.0 * (sum / count).max(0.0).sqrt() / ranges[k])
    };
    MisfitPercent {
        current: percent(0),
        curvature: percent(1),
        charge,
    }
}

pub(crate) fn range(values: &[f64]) -> f64 {
    let ends = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(*v), high.max(*v))
        });
    ends.1 - ends.0
}

/// Error of the charge at the end of a run, in percent of the largest charge on the way.
fn charge_error(run: &GroupRun, off: &[f64]) -> Option<f64> {
    let missed = passed(run.times(0), off).last()?;
    let most = most_charge(run);
    (most > 0.0).then(|| 100.0 * missed.abs() / most)
}
