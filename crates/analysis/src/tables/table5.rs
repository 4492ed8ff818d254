//! The thesis's table 5: parameters of the lumped model, one row a condition.

use super::TableInput;
use super::extended::with_effects;
use super::of_condition::{OfCondition, of_conditions};
use super::of_several::pooled_remark;
use crate::conditions::conditions;
use ieap_domain::parameters::PARAMETERS;
use ieap_domain::words::counted;
use ieap_show::Table;
use ieap_show::quantities::{Quantity, R_SQUARED_CURRENT, R_SQUARED_CURVATURE, RUNS, SAMPLES};

/// Number of parameters that are identified from the current; they stand first among [`PARAMETERS`].
const ELECTRICAL: usize = 5;
/// Number of parameters shown: the two sums of figure 26 are left to other tables.
const SHOWN: usize = 7;

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let found = conditions(input.runs, input.campaign);
    let shown: Vec<Quantity> = PARAMETERS[..SHOWN].iter().map(Quantity::from).collect();
    let (electrical, mechanical) = shown.split_at(ELECTRICAL);
    let left_out = (!found.unplaced.is_empty()).then(|| {
        format!(
            "{} without sample, environment or held voltage, or with fewer than 10 readings, left out.",
            counted(found.unplaced.len(), "run")
        )
    });
    let sheet = of_conditions(
        "table5",
        4,
        "Fitted values of the electromechanical equivalent circuit",
    )
    .said([pooled_remark(), "N: samples, n: runs.".to_owned()])
    .said(left_out)
    .columns(electrical, |(of, ()), number| of.runs.parameter(number.key))
    .column(R_SQUARED_CURRENT, |(of, ())| {
        of.runs.score(|fit| fit.r_squared_current)
    })
    .columns(mechanical, |(of, ()), number| of.runs.parameter(number.key))
    .column(R_SQUARED_CURVATURE, |(of, ())| {
        of.runs.score(|fit| fit.r_squared_curvature)
    });
    with_effects(sheet, input, |(of, ())| &of.runs)
        .column(SAMPLES.called("N", SAMPLES.name), |(of, ())| {
            of.runs.sample_count()
        })
        .column(RUNS.called("n", RUNS.name), |(of, ())| of.runs.at.len())
        .over(
            found
                .measured
                .iter()
                .map(|own| (OfCondition::new(input, &found, own), ())),
        )
}
