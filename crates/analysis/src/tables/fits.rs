//! Every run's current fit: one row a run, one column a parameter that any of them has.

use super::TableInput;
use super::extended::{shared_notes, with_effects};
use super::of_several::Runs;
use crate::parameters::{FURTHER, PARAMETERS, ParameterInfo};
use ieap_domain::{Fit, RunRecord};
use ieap_show::quantities::{Quantity, RUN};
use ieap_show::{Sheet, Table, Value};

const MODEL: Quantity = Quantity::plain("model", "Model", "model and its version");

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    type Fitted<'a> = (&'a RunRecord, &'a Fit, Runs<'a>);
    let fitted = || {
        let runs = input.runs.iter().enumerate();
        runs.filter_map(|(at, run)| Some((run, run.fit.as_ref()?, Runs::new(input, [at]))))
    };
    let occurs = |info: &&ParameterInfo| fitted().any(|(_, fit, _)| fit.parameter(info.key).is_some());
    let known = PARAMETERS.iter().chain(&FURTHER).filter(occurs);
    let shown: Vec<Quantity> = known.map(ParameterInfo::quantity).collect();
    let sheet = Sheet::<Fitted>::new("fits", "Current fits of all runs", 1)
        .said(["Values are given with the standard error of the fit.".to_owned()])
        .made_from(|(.., runs)| runs.sources())
        .column(RUN, |(run, ..)| run.path.as_str())
        .column(MODEL, |(_, fit, runs)| {
            Value::from(format!("{} v{}", fit.model, fit.model_version)).noted(shared_notes(runs))
        })
        .columns(&shown, |(_, fit, runs), of| {
            fit.parameter(of.key).map(|_| runs.shown(of))
        });
    with_effects(sheet, input, |(.., runs)| runs).over(fitted())
}
