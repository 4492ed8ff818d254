//! What parameters that differ are worth on runs that were not measured: as laws of the voltage they predict the drive left out.

use ieap_domain::number::significant;
use ieap_numerics::sums;

use crate::cause::proof::held_out::{HeldOut, drives, left_out_by, predicted_part};
use crate::fitting::fitted::Fitted;
use crate::readings::group::RunGroup;

use super::policy::{FEWEST_VOLTAGES, SAME_VOLTAGE_PART};
use super::shared;

/// Every drive in turn predicted by the base without it, and by parameters `own` that lie on lines over the logarithm of the
/// voltage of the others; none of fewer than three voltages. `starts` are the places of all runs by themselves.
pub(super) fn held_out(
    group: &RunGroup,
    base: &Fitted,
    own: &[usize],
    starts: &[Vec<f64>],
) -> Option<HeldOut> {
    let volts = log_volts(group);
    if distinct(group)?.len() < FEWEST_VOLTAGES {
        return None;
    }
    let (mut before, mut after) = (Vec::new(), Vec::new());
    for out in drives(group) {
        before.push(left_out_by(base, group, &out));
        let kept: Vec<usize> = (0..group.runs.len()).filter(|run| !out.contains(run)).collect();
        let of_kept: Vec<Vec<f64>> = kept.iter().map(|&run| starts[run].clone()).collect();
        let found = shared::fit(base, own, &kept, &of_kept);
        let over: Vec<f64> = kept.iter().map(|&run| volts[run]).collect();
        let mut at = found.at.first()?.clone();
        for &k in own {
            let values: Vec<f64> = found.at.iter().map(|at| at[k]).collect();
            let known: Vec<f64> = (found.standard_errors.iter()).map(|errors| errors[k]).collect();
            at[k] = on_line(&over, &values, &known, volts[*out.first()?])?;
        }
        let limits = |k: usize| base.problem.limits_of(k);
        (0..at.len()).for_each(|k| at[k] = at[k].clamp(limits(k).0, limits(k).1));
        after.push(predicted_part(&base.problem, &at, group, &out, None));
    }
    Some(HeldOut { before, after })
}

/// Which voltage would tell best whether parameters follow it: the middle of the widest gap.
pub(crate) fn next_in_words(group: &RunGroup) -> Option<String> {
    let volts = distinct(group)?;
    let gaps = volts
        .windows(2)
        .map(|pair| (pair[1] - pair[0], 0.5 * (pair[0] + pair[1])));
    let (_, middle) = gaps.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "whether these are laws of the voltage a run at {} V would tell best: it lies in the widest gap between those measured",
        significant(middle.exp(), 3)
    ))
}

/// Logarithms of the voltages of all runs.
fn log_volts(group: &RunGroup) -> Vec<f64> {
    let runs = group.runs.iter();
    runs.map(|run| run.drive().nominal_step_v().abs().ln()).collect()
}

/// The different ones in rising order; none where a run has no voltage.
fn distinct(group: &RunGroup) -> Option<Vec<f64>> {
    let mut found = log_volts(group);
    found.sort_by(f64::total_cmp);
    found.dedup_by(|a, b| (*a - *b).abs() < SAME_VOLTAGE_PART);
    found.iter().all(|volts| volts.is_finite()).then_some(found)
}

/// The value at `x` of the line through `values` over `over`, each as far off it as all are alike or as its own error says; none
/// where all lie at one place.
fn on_line(over: &[f64], values: &[f64], errors: &[f64], x: f64) -> Option<f64> {
    let middle = sums::mean(errors);
    let weight = |k: usize| {
        (middle * middle + errors[k] * errors[k])
            .max(f64::MIN_POSITIVE)
            .recip()
    };
    let sum = |of: &dyn Fn(usize) -> f64| (0..over.len()).map(|k| weight(k) * of(k)).sum::<f64>();
    let whole = sum(&|_| 1.0);
    let (mean_x, mean) = (sum(&|k| over[k]) / whole, sum(&|k| values[k]) / whole);
    let spread = sum(&|k| (over[k] - mean_x).powi(2));
    let rise = sum(&|k| (over[k] - mean_x) * (values[k] - mean)) / spread;
    rise.is_finite().then_some(mean + rise * (x - mean_x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_lies_on_the_line_of_the_others_and_one_place_tells_no_line() {
        let line = on_line(&[0.0, 1.0, 2.0], &[1.0, 3.0, 5.0], &[0.1, 0.2, 0.1], 3.0);
        assert!((line.unwrap() - 7.0).abs() < 1e-12);
        assert_eq!(on_line(&[1.0, 1.0], &[1.0, 3.0], &[0.1, 0.1], 3.0), None);
    }
}
