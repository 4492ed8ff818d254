//! The conditions that were measured: how often, the two sums that the thesis's figure 26 shows, and for files mean and
//! spread of every parameter.

use std::collections::BTreeSet;

use super::TableInput;
use super::fits::parameter_keys;
use super::of_condition::{OfCondition, Own, of_conditions};
use super::of_several::{Runs, pooled_remark};
use crate::conditions::conditions;
use crate::one_fit::SharedEstimate;
use crate::parameters::usable;
use ieap_domain::parameters::PARAMETERS;
use ieap_numerics::sums;
use ieap_show::Made;
use ieap_show::quantities::{Quantity, RUNS, SAMPLES};

/// The sums stand last among the parameters.
const FIRST_SUM: usize = 7;
const FITTED: Quantity = Quantity::plain("runs_fitted", "Fitted", "number of runs with a fit");

/// Makes the table. In files: per parameter how many runs determine it, the mean of their values and their standard deviation
/// (empty for fewer than two). Fits that did not converge are left out; runs with the one parameter set of a group count as one.
pub fn make<M: Made>(input: &TableInput) -> M {
    let found = conditions(input.runs, input.campaign);
    let sums: Vec<Quantity> = PARAMETERS[FIRST_SUM..].iter().map(Quantity::from).collect();
    let humidity = |own: &OfCondition| own.surroundings().humidity;
    type Of<'a> = Own<'a, ()>;
    let sheet = of_conditions("conditions", 4, "Conditions that were measured")
        .said([pooled_remark()])
        .in_files(|sheet| {
            sheet
                .plain("relative_humidity_low_percent", move |(of, ()): &Of| {
                    Some(humidity(of)?.low_percent)
                })
                .plain("relative_humidity_high_percent", move |(of, ())| {
                    Some(humidity(of)?.high_percent)
                })
        })
        .column(SAMPLES, |(of, ())| of.runs.sample_count())
        .column(RUNS, |(of, ())| of.runs.at.len())
        .column(FITTED, |(of, ())| {
            of.runs.records().filter(|run| run.fit.is_some()).count()
        })
        .columns(&sums, |(of, ()), number| of.runs.parameter(number.key));
    let sheet = parameter_keys(input.runs).into_iter().fold(sheet, |sheet, key| {
        let (mean_of, spread_of) = (key.clone(), key.clone());
        sheet.in_files(|sheet| {
            let names = ["runs", "mean", "standard_deviation"].map(|end| format!("{key}_{end}"));
            sheet
                .plain(&names[0], move |(of, ()): &Of| determined(&of.runs, &key).len())
                .plain(&names[1], move |(of, ())| mean(&determined(&of.runs, &mean_of)))
                .plain(&names[2], move |(of, ())| {
                    standard_deviation(&determined(&of.runs, &spread_of))
                })
        })
    });
    sheet.made(
        found
            .measured
            .iter()
            .map(|own| (OfCondition::new(input, &found, own), ())),
    )
}

/// Determined values of a condition's runs; one that the fit of a group gave to several of them counts once.
fn determined(runs: &Runs, key: &str) -> Vec<f64> {
    let mut counted = BTreeSet::new();
    let value = |run| {
        let estimate = usable(run, key)?;
        let is_new = SharedEstimate::of(run, estimate).is_none_or(|shared| counted.insert(shared));
        estimate.value.filter(|_| is_new)
    };
    runs.records().filter_map(value).collect()
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Between runs, with n - 1.
fn standard_deviation(values: &[f64]) -> Option<f64> {
    (values.len() > 1).then(|| sums::standard_deviation(values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::doubt::Doubts;
    use ieap_domain::testing::{campaign, fit, known, run};
    use ieap_domain::{Estimate, RunRecord};
    use ieap_show::{Frame, FrameCells, FrameColumn};

    fn frame(runs: &[RunRecord]) -> Frame {
        make(&TableInput::new(&campaign(), runs, &Doubts::default()))
    }

    fn fitted(name: &str, alpha: Estimate) -> RunRecord {
        let mut fitted = run(name, "CNaf-01", "air", Some(34.0), 2.5);
        fitted.fit = Some(fit(&[
            ("r1_ohm_cm2", known(100.0, 0.01)),
            ("alpha_per_c_cm", alpha),
        ]));
        fitted
    }

    fn cells<'t>(table: &'t [FrameColumn], name: &str) -> &'t FrameCells {
        &table.iter().find(|column| column.name == name).unwrap().cells
    }

    #[test]
    fn conditions_count_runs_and_spread_needs_two() {
        let runs = [
            fitted("a", known(10.0, 0.1)),
            fitted("b", known(14.0, 0.1)),
            fitted("c", Estimate::below(3.0, "search limit")),
            run("d", "CPvf-01", "air", Some(34.0), 2.5),
        ];
        let table = frame(&runs);
        let cells = |name| cells(&table, name);
        assert_eq!(
            cells("alpha_per_c_cm_mean"),
            &FrameCells::Numbers(vec![Some(12.0), None])
        );
        assert_eq!(
            cells("alpha_per_c_cm_standard_deviation"),
            &FrameCells::Numbers(vec![Some(8f64.sqrt()), None])
        );
        assert_eq!(
            cells("alpha_per_c_cm_runs"),
            &FrameCells::Counts(vec![Some(2), Some(0)])
        );
    }

    #[test]
    fn one_parameter_set_of_a_group_counts_once() {
        let mut runs = [10.0, 10.0, 14.0].map(|value| fitted("a", known(value, 0.1)));
        for run in &mut runs[..2] {
            run.fit.as_mut().unwrap().model = "lumped-2 + faradaic-leak".to_owned();
        }
        let table = frame(&runs);
        assert_eq!(
            cells(&table, "alpha_per_c_cm_runs"),
            &FrameCells::Counts(vec![Some(2)])
        );
        assert_eq!(
            cells(&table, "alpha_per_c_cm_mean"),
            &FrameCells::Numbers(vec![Some(12.0)])
        );
    }
}
