//! Rows that are fitted again before they are taken. A checksum says that a row came as it was written; that what was written is
//! the fit of that run says only a fit: a share of all, and every row that looks odd. Where one differs all of its file are.

use std::collections::BTreeMap;

use super::{ImportSummary, Known, Row};
use crate::domain::number::exact;
use crate::domain::{Estimate, Fit};
use crate::pipeline::fits::outcome::Outcome;
use crate::pipeline::fits::result::FitResult;
use crate::pipeline::fits::runs::{Due, fit_and_take};
use crate::pipeline::{Context, Observer, PipelineError};

/// Share of the rows that is fitted again: what an import costs at most of what the fits cost.
const SHARE: f64 = 0.05;
/// Fewest rows of an import that are: of files in which a fifth of the rows is wrong, 99 of 100 are found by so many
/// (0.8^20 = 0.01), in less than a second.
const FEWEST: usize = 20;
/// How far a number may be from the one found here: computers differ in the last digits of their functions, and a search that
/// ends at a tolerance carries that on. In standard errors, and as a share of the number.
const NEAR_SIGMA: f64 = 0.02;
const NEAR_RELATIVE: f64 = 1e-6;
/// Larger numbers stand in no fit, in any unit that a parameter has.
const LARGEST: f64 = 1e15;

/// How many rows were fitted again so far.
#[derive(Debug, Default)]
pub struct Again {
    fitted: usize,
}

impl Again {
    /// The rows of a file that hold; the others are refused.
    pub fn held<'a>(
        &mut self,
        context: &Context,
        rows: Vec<Row<'a>>,
        known: &mut Known,
        summary: &mut ImportSummary,
        observer: &dyn Observer,
    ) -> Result<Vec<Row<'a>>, PipelineError> {
        let (chosen, others): (Vec<Row<'a>>, Vec<Row<'a>>) =
            rows.into_iter().partition(|row| self.chooses(&row.result));
        let count = chosen.len();
        let mut held = self.compared(context, chosen, known, summary, observer)?;
        // What wrote one wrong row may have written others.
        held.extend(if held.len() < count {
            self.compared(context, others, known, summary, observer)?
        } else {
            others
        });
        summary.fitted_again = self.fitted;
        held.sort_by_key(|row| row.row);
        Ok(held)
    }

    /// Whether a row is fitted again: the first of an import, a share by the names of the runs, and what looks odd.
    fn chooses(&mut self, result: &FitResult) -> bool {
        let hash = blake3::hash(result.run.as_bytes());
        let first: [u8; 4] = std::array::from_fn(|at| hash.as_bytes()[at]);
        let is_of_share = f64::from(u32::from_le_bytes(first)) < SHARE * f64::from(u32::MAX);
        let chosen = self.fitted < FEWEST || is_of_share || looks_odd(result);
        self.fitted += usize::from(chosen);
        chosen
    }

    fn compared<'a>(
        &mut self,
        context: &Context,
        rows: Vec<Row<'a>>,
        known: &mut Known,
        summary: &mut ImportSummary,
        observer: &dyn Observer,
    ) -> Result<Vec<Row<'a>>, PipelineError> {
        let mut due: Vec<Due> = Vec::new();
        for row in &rows {
            due.extend(known.due(context, &row.result.asked, &row.result.run)?.cloned());
        }
        let there = rows.iter().map(|row| (row.result.run.as_str(), &row.result));
        let there: BTreeMap<&str, &FitResult> = there.collect();
        let mut differences: BTreeMap<String, String> = BTreeMap::new();
        fit_and_take("fitting again", context, &due, observer, |made| {
            for ((_, run), here) in made {
                let name = &run.task.path;
                let found = there
                    .get(name.as_str())
                    .and_then(|there| difference(there, &here));
                differences.extend(found.map(|found| (name.clone(), found)));
            }
            Ok(())
        })?;
        let mut held = Vec::new();
        for row in rows {
            match differences.remove(&row.result.run) {
                None => held.push(row),
                Some(found) => {
                    let reason = format!(
                        "fitted again here {found}; it was computed or written wrongly there; `ieap run --only fit` fits the run"
                    );
                    // Another file may have it right.
                    known.taken.remove(&row.result.run);
                    summary.refuse(row.file, row.row, Some(row.result.run), reason);
                }
            }
        }
        Ok(held)
    }
}

/// Whether a row says what fits seldom say: that there is none, that the search did not converge, or numbers that contradict each
/// other.
fn looks_odd(result: &FitResult) -> bool {
    let Some(fit) = &result.fit else { return true };
    let r_squared = [fit.r_squared_current, fit.r_squared_curvature];
    let is_share = |number: &f64| number.is_finite() && *number <= 1.0;
    !fit.converged
        || !r_squared.iter().flatten().all(is_share)
        || fit.parameters.iter().any(|parameter| is_odd(&parameter.estimate))
}

fn is_odd(estimate: &Estimate) -> bool {
    let Estimate {
        value,
        standard_error,
        low_95,
        high_95,
        at_bound,
        ..
    } = estimate;
    let numbers = [value, standard_error, low_95, high_95];
    let is_number = |number: &&f64| number.is_finite() && number.abs() < LARGEST;
    let above = |one: &Option<f64>, other: &Option<f64>| matches!((one, other), (Some(one), Some(other)) if one > other);
    *at_bound
        || value.is_none()
        || !numbers.into_iter().flatten().all(|number| is_number(&number))
        || standard_error.is_some_and(|error| error < 0.0)
        || above(low_95, value)
        || above(value, high_95)
}

/// What the fit made here has otherwise than a row, in words; none where they agree.
fn difference(row: &FitResult, made: &Outcome) -> Option<String> {
    let (fit, own) = match (&row.fit, made) {
        (Some(fit), Ok(own)) => (fit, own),
        (None, Err(_)) => return None,
        (Some(_), Err(issue)) => return Some(format!("it gives no fit ({})", issue.message)),
        (None, Ok(_)) => return Some("it gives a fit, and the row says that there is none".to_owned()),
    };
    let keys = |fit: &Fit| {
        fit.parameters
            .iter()
            .map(|parameter| parameter.key.clone())
            .collect::<Vec<_>>()
    };
    if keys(fit) != keys(own) || fit.n_samples != own.n_samples {
        let (count, readings) = (own.parameters.len(), own.n_samples);
        return Some(format!(
            "it gives {count} parameters from {readings} readings, the row has others"
        ));
    }
    let pairs = fit.parameters.iter().zip(&own.parameters);
    let mut differing = pairs.filter_map(|(found, own)| {
        let (what, found, made) = differs(&found.estimate, &own.estimate)?;
        Some(format!(
            "it gives {} with {what} {made}, the row says \"{found}\"",
            own.key
        ))
    });
    let others = || {
        let share = |a: Option<f64>, b: Option<f64>| same(a, b, |a, b| (a - b).abs() <= NEAR_RELATIVE);
        let is_same = share(fit.r_squared_current, own.r_squared_current)
            && share(fit.r_squared_curvature, own.r_squared_curvature);
        (!is_same).then(|| "it describes the readings otherwise than the row says (r_squared)".to_owned())
    };
    differing.next().or_else(others)
}

/// The first number of an estimate that differs: what it is, as the row has it, as it was found here.
fn differs(found: &Estimate, own: &Estimate) -> Option<(&'static str, String, String)> {
    let sigma = own.standard_error.unwrap_or(0.0);
    let near = |a: f64, b: f64| (a - b).abs() <= NEAR_SIGMA * sigma + NEAR_RELATIVE * b.abs();
    let numbers = [
        ("the value", found.value, own.value),
        ("the standard error", found.standard_error, own.standard_error),
        ("the lower end", found.low_95, own.low_95),
        ("the upper end", found.high_95, own.high_95),
    ];
    let told = |number: Option<f64>| number.map_or("nothing".to_owned(), exact);
    let mut other = numbers
        .into_iter()
        .filter(|(_, found, own)| !same(*found, *own, near));
    other
        .next()
        .map(|(what, found, own)| (what, told(found), told(own)))
}

fn same(one: Option<f64>, other: Option<f64>, near: impl Fn(f64, f64) -> bool) -> bool {
    match (one, other) {
        (Some(one), Some(other)) => near(one, other),
        (one, other) => one.is_none() && other.is_none(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::testing::{fit, known};
    use crate::domain::{AskedFit, Issue};

    fn row(made: &Fit) -> FitResult {
        FitResult::of("runs/a.csv", "d", "i", &AskedFit::default(), Ok(made.clone()))
    }

    #[test]
    fn last_digits_are_those_of_a_computer_and_a_tenth_is_another_fit() {
        let made = fit(&[
            ("r1_ohm_cm2", known(10.0, 0.1)),
            ("c1_f_per_cm2", known(1e-3, 1e-5)),
        ]);
        assert_eq!(difference(&row(&made), &Ok(made.clone())), None);
        for (factor, is_other) in [
            (1.0 + 1e-9, false),
            (1.1, true),
            (-1.0, true),
            (1e308, true),
            (f64::NAN, true),
        ] {
            for place in 0..4 {
                let mut changed = made.clone();
                let estimate = &mut changed.parameters[1].estimate;
                let numbers = [
                    &mut estimate.value,
                    &mut estimate.standard_error,
                    &mut estimate.low_95,
                    &mut estimate.high_95,
                ];
                for (at, number) in numbers.into_iter().enumerate() {
                    *number = if at == place {
                        number.map(|number| number * factor)
                    } else {
                        *number
                    };
                }
                let found = difference(&row(&changed), &Ok(made.clone()));
                assert_eq!(found.is_some(), is_other, "{factor}, {place}: {found:?}");
                if let Some(found) = found {
                    assert!(found.contains("c1_f_per_cm2"), "{found}");
                }
            }
        }
        let none = Issue::warning("not-fitted", "too few readings");
        assert!(difference(&row(&made), &Err(none.clone())).is_some());
        let denied = FitResult::of("runs/a.csv", "d", "i", &AskedFit::default(), Err(none.clone()));
        assert!(difference(&denied, &Ok(made)).is_some() && difference(&denied, &Err(none)).is_none());
    }

    #[test]
    fn the_first_rows_and_a_twentieth_of_the_others_are_fitted_again() {
        let made = fit(&[("r1_ohm_cm2", known(10.0, 0.1))]);
        let mut again = Again::default();
        let mut chosen = |number: usize| {
            let run = format!("runs/{number}.csv");
            again.chooses(&FitResult::of(
                &run,
                "d",
                "i",
                &AskedFit::default(),
                Ok(made.clone()),
            ))
        };
        assert!((0..FEWEST).all(&mut chosen));
        let others = (FEWEST..4000).filter(|&number| chosen(number)).count();
        assert!((150..250).contains(&others), "{others}");
    }

    #[test]
    fn numbers_that_contradict_each_other_look_odd() {
        let made = fit(&[("r1_ohm_cm2", known(10.0, 0.1))]);
        let is_odd = |change: &dyn Fn(&mut Fit)| {
            let mut changed = made.clone();
            change(&mut changed);
            looks_odd(&row(&changed))
        };
        assert!(!is_odd(&|_| {}), "{made:?}");
        let changes: [&dyn Fn(&mut Fit); 7] = [
            &|fit| fit.converged = false,
            &|fit| fit.r_squared_current = Some(1.5),
            &|fit| fit.parameters[0].estimate.value = Some(1000.0),
            &|fit| fit.parameters[0].estimate.value = Some(1e308),
            &|fit| fit.parameters[0].estimate.high_95 = Some(f64::INFINITY),
            &|fit| fit.parameters[0].estimate.standard_error = Some(-0.1),
            &|fit| fit.parameters[0].estimate.value = None,
        ];
        for (at, change) in changes.into_iter().enumerate() {
            assert!(is_odd(change), "{at}");
        }
    }
}
