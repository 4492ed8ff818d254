//! How large a misfit is in what a user compares: percent of current, curvature and charge.

use ieap_domain::MisfitPercent;

use crate::fitting::fitted::Fitted;
use crate::readings::charges::{most_charge, passed};
use crate::readings::group::RunGroup;

/// Of the base model: of current and curvature the root mean square beyond noise in the largest range of all runs, of the charge
/// the largest error at the end of a run in the largest charge of all.
pub(crate) fn misfit_percent(group: &RunGroup, base: &Fitted) -> MisfitPercent {
    let model = base.problem.model(&base.at);
    let mut missed: Option<f64> = None;
    let mut most = 0.0_f64;
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
            let own = passed(run.times(0), &off).last().map(f64::abs);
            missed = missed.into_iter().chain(own).reduce(f64::max);
            most = most.max(most_charge(run));
        }
    }
    let percent = |k: usize| {
        let (sum, count): (f64, f64) = squares[k];
        (count > 0.0 && ranges[k] > 0.0).then(|| 100.0 * (sum / count).max(0.0).sqrt() / ranges[k])
    };
    MisfitPercent {
        current: percent(0),
        curvature: percent(1),
        charge: missed.filter(|_| most > 0.0).map(|missed| 100.0 * missed / most),
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
