//! The conditions that were measured: how often, and the two sums that the thesis's figure 26 shows.

use super::TableInput;
use super::of_condition::{OfCondition, of_conditions};
use super::of_several::pooled_remark;
use crate::conditions::conditions;
use crate::parameters::{PARAMETERS, ParameterInfo};
use ieap_show::Table;
use ieap_show::quantities::{Quantity, RUNS, SAMPLES};

/// The sums stand last among the parameters.
const FIRST_SUM: usize = 7;
const FITTED: Quantity = Quantity::plain("fitted", "Fitted", "number of runs with a fit");

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let found = conditions(input.runs, input.campaign);
    let sums: Vec<Quantity> = PARAMETERS[FIRST_SUM..]
        .iter()
        .map(ParameterInfo::quantity)
        .collect();
    of_conditions("conditions", 4, "Conditions that were measured")
        .said([pooled_remark()])
        .column(SAMPLES, |(of, ())| of.runs.sample_count())
        .column(RUNS, |(of, ())| of.runs.at.len())
        .column(FITTED, |(of, ())| {
            of.runs.records().filter(|run| run.fit.is_some()).count()
        })
        .columns(&sums, |(of, ()), number| of.runs.shown(number))
        .over(
            found
                .measured
                .iter()
                .map(|own| (OfCondition::new(input, &found, own), ())),
        )
}
