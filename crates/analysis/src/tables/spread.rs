//! Where the uncertainty of a mean comes from: fits, runs, samples; one row a condition and parameter.

use super::TableInput;
use super::of_condition::{OfCondition, Own, of_conditions};
use crate::conditions::conditions;
use ieap_domain::parameters::{PARAMETERS, ParameterInfo};
use ieap_show::quantities::{Quantity, RUNS, SAMPLES};
use ieap_show::{Combined, Content, Pooled, Table, Value};

/// Digits of a spread: few repeats know it to one or two.
const DIGITS: i32 = 2;
const PARAMETER: Quantity = Quantity::plain("parameter", "Parameter", "parameter");
const UNIT: Quantity = Quantity::plain("unit", "Unit", "unit of the row");
const MEAN: Quantity = Quantity::plain("mean", "Mean", "random-effects mean");
const FROM_FITS: Quantity = Quantity::plain(
    "from_fits",
    "Fits",
    "standard error that the fits alone would leave",
);
const BETWEEN_RUNS: Quantity = Quantity::plain(
    "between_runs",
    "Between runs",
    "standard deviation between runs of a sample, the fits' errors taken out",
);
const BETWEEN_SAMPLES: Quantity = Quantity::plain(
    "between_samples",
    "Between samples",
    "standard deviation between samples, all else taken out",
);
const REMARK: &str = "Standard deviations by the method of moments (DerSimonian and Laird); 0 means that the runs differ by no more than the fits' errors explain. A single sample says nothing of the spread between samples.";

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let found = conditions(input.runs, input.campaign);
    type Of<'a> = Own<'a, (&'a ParameterInfo, Combined)>;
    fn pooled<V: Into<Value>>((_, (_, mean)): &Of, of: impl Fn(Pooled) -> V) -> Option<Value> {
        match mean.content {
            Content::Measured(measured) => Some(of(measured.pooled?).into()),
            _ => None,
        }
    }
    let rough = |number| Value::Rough(number, DIGITS);
    let repeated = found.measured.iter().filter(|own| own.runs.len() > 1);
    let rows = repeated.flat_map(|own| {
        let of = OfCondition::new(input, &found, own);
        PARAMETERS.iter().map(move |info| {
            let mean = of.runs.parameter(info.key);
            (of.clone(), (info, mean))
        })
    });
    let title = "Means over repeats, and where their uncertainty comes from";
    of_conditions::<(&ParameterInfo, Combined)>("spread", 6, title)
        .remarks(REMARK, "No condition has more than one run.")
        .called(|(of, (info, _))| format!("{}, {}", of.label(), info.key))
        .made_from(|(_, (_, mean))| mean.sources.clone())
        .column(PARAMETER, |(_, (info, _))| info.symbol)
        .column(UNIT, |(_, (info, _))| info.unit())
        .column(MEAN, |(_, (_, mean))| mean.clone())
        .column(FROM_FITS, move |row| {
            pooled(row, |mean| rough(mean.fit_standard_error))
        })
        .column(BETWEEN_RUNS, move |row| {
            pooled(row, |mean| mean.between_runs.map(rough))
        })
        .column(BETWEEN_SAMPLES, move |row| {
            pooled(row, |mean| mean.between_samples.map(rough))
        })
        .column(
            SAMPLES.called("Samples", "number of samples that determine it"),
            |row| pooled(row, |mean| mean.samples),
        )
        .column(RUNS.called("Runs", "number of runs that determine it"), |row| {
            pooled(row, |mean| mean.runs)
        })
        .over(rows)
}
