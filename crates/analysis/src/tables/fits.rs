//! Every run's current fit: one row a number, and one row a run with its parameters side by side.

use super::TableInput;
use super::extended::{effect_column, shared_notes};
use super::of_run::{OfRun, Own, of_runs_and_conditions};
use super::of_several::Runs;
use ieap_domain::ParameterInfo;
use ieap_domain::{Estimate, Fit, RunRecord};
use ieap_show::quantities::Quantity;
use ieap_show::{Made, Printed, Rough, Sheet, Value};

const MODEL: Quantity = Quantity::plain("model", "Model", "model of its fit");
const PARAMETER: Quantity = Quantity::plain(
    "parameter",
    "Parameter",
    "key of the number, which ends in its unit",
);
const ROLE: Quantity = Quantity::plain(
    "role",
    "Role",
    "parameter, or nuisance that is fitted beside them",
);
const VALUE: Quantity = Quantity::plain("value", "Value", "value");
const ERROR: Quantity = Quantity::plain("standard_error", "± SE", "standard error");
const LOW: Quantity = Quantity::plain("low_95", "from", "lower end of the 95 % interval");
const HIGH: Quantity = Quantity::plain("high_95", "to", "upper end of the 95 % interval");
const REASON: Quantity = Quantity::plain("reason", "Remark", "why it is not determined, or only bounded");
/// Digits of a value, and of its error.
const DIGITS: (i32, i32) = (5, 2);

/// Makes the table of one row a number: parameters, then what the fit estimated beside them.
pub fn make<M: Made>(input: &TableInput) -> M {
    /// A fit, the role of a number in it, its key and what is known of it.
    type OfNumber<'a> = (&'a Fit, &'a str, &'a str, &'a Estimate);
    fn numbers(fit: &Fit) -> impl Iterator<Item = OfNumber<'_>> {
        let parameters = fit.parameters.iter();
        let parameters = parameters.map(move |own| (fit, "parameter", own.key.as_str(), &own.estimate));
        let nuisances = fit.nuisances.iter();
        parameters.chain(nuisances.map(move |own| (fit, "nuisance", own.key.as_str(), &own.estimate)))
    }
    let of = |number: Option<f64>, digits| number.map(|number| Rough(number, digits));
    let fitted = input.runs.iter().filter_map(|run| Some((run, run.fit.as_ref()?)));
    identified::<OfNumber>("fits", "Every number of the current fits", input)
        .called(|(run, (_, _, key, _))| format!("{}, {key}", run.path()))
        .in_files(|sheet| sheet.plain("model", |(_, (fit, ..))| fit.model.as_str()))
        .column(PARAMETER, |(_, (_, _, key, _))| *key)
        .column(ROLE, |(_, (_, role, ..))| *role)
        .column(VALUE, move |(_, (.., own))| of(own.value, DIGITS.0))
        .column(ERROR, move |(_, (.., own))| of(own.standard_error, DIGITS.1))
        .column(LOW, move |(_, (.., own))| of(own.low_95, DIGITS.0))
        .column(HIGH, move |(_, (.., own))| of(own.high_95, DIGITS.0))
        .in_files(|sheet| {
            sheet
                .plain("converged", |(_, (fit, ..))| fit.converged)
                .plain("at_bound", |(_, (.., own))| own.at_bound)
        })
        .column(REASON, |(_, (.., own))| own.reason.clone())
        .made(fitted.flat_map(|(run, fit)| {
            let run = OfRun::of(input.campaign, run);
            numbers(fit).map(move |own| (run, own))
        }))
}

/// Makes the table of one row a run, fitted or not, with a column for each parameter that any of them has.
pub fn wide<M: Made>(input: &TableInput) -> M {
    type Fitted<'a> = Own<'a, Runs<'a>>;
    fn of<'a, V>((run, _): &Fitted<'a>, read: impl Fn(&'a Fit) -> Option<V>) -> Option<V> {
        run.fit().and_then(read)
    }
    let sheet = identified::<Runs>("fits-wide", "Current fits of all runs", input)
        .said(["Values are given with the standard error of the fit.".to_owned()])
        .column(MODEL, |row: &Fitted| {
            let fit = row.0.fit()?;
            let words = Value::from(format!("{} v{}", fit.model, fit.model_version));
            Some(Printed(fit.model.clone(), words.noted(shared_notes(&row.1))))
        })
        .in_files(|sheet| {
            sheet
                .plain("state", |(run, _)| Some(run.record?.state.key()))
                .plain("status", |(run, _)| Some(run.record?.status.key()))
                .plain("converged", |row| of(row, |fit| Some(fit.converged)))
                .plain("r_squared_current", |row| of(row, |fit| fit.r_squared_current))
                .plain("r_squared_curvature", |row| {
                    of(row, |fit| fit.r_squared_curvature)
                })
        });
    let sheet = parameter_keys(input.runs).into_iter().fold(sheet, |sheet, key| {
        let info = ParameterInfo::of(&key).map(Quantity::from);
        let effect = effect_column(&key);
        let is_printed = info.is_some() || key.contains('.');
        let number = move |row: &Fitted| {
            let own = of(row, |fit| fit.parameter(&key))?;
            Some(Printed(own.clone(), Value::from(row.1.parameter(&key))))
        };
        match info {
            Some(info) => sheet.column(info, number),
            None if is_printed => sheet.column_under(effect, number),
            None => sheet.in_files(|sheet| sheet.column_under(effect, number)),
        }
    });
    let runs = input.runs.iter().enumerate();
    sheet.made(runs.map(|(at, run)| (OfRun::of(input.campaign, run), Runs::new(input, [at]))))
}

/// A sheet of runs that prints which run a row is about, and has in files what it was measured under.
fn identified<'a, X: 'a>(
    name: &'static str,
    title: &'static str,
    input: &TableInput<'a>,
) -> Sheet<'a, Own<'a, X>> {
    of_runs_and_conditions(name, title, input.campaign.timezone.as_deref()).printing_first(1)
}

/// Keys that occur in any fit: those of the lumped model in its order, then the others by name.
pub(super) fn parameter_keys(runs: &[RunRecord]) -> Vec<String> {
    let fits = runs.iter().filter_map(|run| run.fit.as_ref());
    let mut keys: Vec<&str> = fits
        .flat_map(|fit| fit.parameters.iter().map(|parameter| parameter.key.as_str()))
        .collect();
    let rank = |key: &str| {
        let place = ParameterInfo::all().position(|known| known.key == key);
        place.unwrap_or(usize::MAX)
    };
    keys.sort_by_key(|key| (rank(key), *key));
    keys.dedup();
    keys.into_iter().map(str::to_owned).collect()
}
