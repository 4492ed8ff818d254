//! Time constants that grow with the length of the record, where a power law describes the current better than they do.

use ieap_domain::number::fixed;
use ieap_domain::number::seconds::seconds;
use ieap_domain::{Estimate, Fit, Quantity};
use ieap_fit::{FitOptions, fit_run, without_outliers};
use ieap_model::FitModel;
use ieap_numerics::robust::median_step;
use ieap_numerics::student::quantile_95;
use ieap_numerics::sums;

use crate::readings::group::{GroupRun, RunGroup};
use crate::readings::policy::{GROWN_FACTOR, LONGER_RECORD_FACTOR};
use crate::readings::power_law::{self, PowerLaw};

/// One run described both ways.
struct Described {
    duration_s: f64,
    tau_s: f64,
    /// The power law; none where the run has no current that one could describe.
    law: Option<PowerLaw>,
    /// Root mean square of what the exponentials leave of the current, A.
    rms_a: f64,
}

/// A sentence where the slowest determined time constant of every run alone grows with the length of its record, and a power
/// law leaves less of the currents than the exponentials do, which have more parameters.
pub(crate) fn remark(group: &RunGroup, model: &'static FitModel) -> Option<String> {
    let options = FitOptions {
        model,
        ..FitOptions::default()
    };
    let fits = group.runs.iter().filter_map(|run| {
        let fit = fit_run(&run.given.input, &options).ok()?;
        described(run, &fit, model)
    });
    let mut found: Vec<Described> = fits.collect();
    let lengths: Vec<(f64, f64)> = found.iter().map(|own| (own.duration_s, own.tau_s)).collect();
    if !grows(&lengths) || !is_better(&found) {
        return None;
    }
    found.sort_by(|a, b| a.duration_s.total_cmp(&b.duration_s));
    let said = |own: &Described| format!("{} s in {} s", seconds(own.tau_s), seconds(own.duration_s));
    let ends = [found.first(), found.last()].into_iter().flatten().map(said);
    Some(format!(
        "time constants grow with the length of the record ({}), and a power law describes the currents better: the current \
         falls as t to the power -{}, as by diffusion, and as no sum of exponentials",
        ends.collect::<Vec<_>>().join(", "),
        exponent(&found)
    ))
}

fn described(run: &GroupRun, fit: &Fit, model: &FitModel) -> Option<Described> {
    let value = |k: usize| {
        let estimate: &Estimate = fit.parameter(&format!("tau{k}_s"))?;
        estimate.value
    };
    let of_current = fit.noise.iter().find(|noise| noise.quantity == Quantity::Current);
    let cleaned = without_outliers(run.given.input.channels, run.given.input.drive);
    let mut current = cleaned.channels.iter();
    let law = current
        .find(|channel| channel.is_whole(Quantity::Current))
        .and_then(|channel| {
            let (time_s, current_a) = channel.included();
            let step_s = median_step(&time_s)?;
            power_law::fitted(&time_s, &current_a, run.drive(), step_s)
        });
    Some(Described {
        duration_s: run.duration_s,
        tau_s: (1..=model.branches).rev().find_map(value)?,
        law,
        rms_a: of_current.map_or(0.0, |noise| noise.residual_rms),
    })
}

/// Whether the power law leaves less than the exponentials, over all runs.
fn is_better(found: &[Described]) -> bool {
    let each = found.iter().map(|own| Some((own.law?.rms_a / own.rms_a).ln()));
    each.sum::<Option<f64>>().is_some_and(|sum| sum < 0.0)
}

/// The exponent over the runs, with the 95 % interval that their scatter gives.
fn exponent(found: &[Described]) -> String {
    let each: Vec<f64> = found
        .iter()
        .filter_map(|own| own.law)
        .map(|law| law.exponent)
        .collect();
    let count = each.len() as f64;
    let mean = sums::mean(&each);
    let off = quantile_95(count - 1.0) * sums::standard_deviation(&each) / count.sqrt();
    format!(
        "{} (95 % interval {} to {}, from {} runs)",
        fixed(mean, 2),
        fixed(mean - off, 2),
        fixed(mean + off, 2),
        each.len()
    )
}

/// Whether every clearly longer record (duration, time constant) has a clearly larger time constant.
fn grows(found: &[(f64, f64)]) -> bool {
    let pairs = found.iter().flat_map(|a| found.iter().map(move |b| (a, b)));
    let mut longer = pairs.filter(|(a, b)| b.0 > LONGER_RECORD_FACTOR * a.0).peekable();
    longer.peek().is_some() && longer.all(|(a, b)| b.1 > GROWN_FACTOR * a.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn described(duration_s: f64, exponent: f64, of_law_a: f64, of_exponentials_a: f64) -> Described {
        Described {
            duration_s,
            tau_s: 0.3 * duration_s,
            law: Some(PowerLaw {
                exponent,
                rms_a: of_law_a,
            }),
            rms_a: of_exponentials_a,
        }
    }

    #[test]
    fn a_power_law_is_said_only_where_it_leaves_less() {
        let worse = [described(2.0, 0.4, 5e-6, 1e-6), described(50.0, 0.5, 2e-6, 1e-6)];
        let better = [
            described(2.0, 0.45, 1e-6, 3e-6),
            described(50.0, 0.55, 2e-6, 1e-6),
        ];
        assert!(!is_better(&worse) && is_better(&better));
        assert!(exponent(&better).starts_with("0.50 (95 % interval "));
        let [first, mut other] = better;
        other.law = None;
        assert!(!is_better(&[first, other]));
    }

    #[test]
    fn growth_needs_records_of_different_lengths_that_all_agree() {
        assert!(grows(&[(2.0, 0.4), (50.0, 10.0), (200.0, 60.0), (200.0, 40.0)]));
        assert!(!grows(&[(200.0, 60.0), (200.0, 40.0)]), "one length");
        assert!(!grows(&[(2.0, 0.4), (50.0, 0.41)]), "none grows");
        assert!(!grows(&[(2.0, 0.4), (50.0, 10.0), (200.0, 9.0)]), "not all agree");
    }
}
