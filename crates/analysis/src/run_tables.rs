//! Runs, tags, fits and conditions as tables for other programs. Columns carry their unit in their name.

use std::collections::BTreeSet;

use super::conditions::{Condition, conditions, material, nominal_voltage_v};
use super::one_fit::SharedEstimate;
use super::parameters::{PARAMETERS, usable};
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, Estimate, Fit, RunFile, RunRecord, Severity, Tag};
use ieap_numerics::sums;
use ieap_show::{Frame, Sheet};

/// A run, and what else a row is made from.
type Of<'a, X> = (&'a RunRecord, X);

/// A sheet that begins with which run a row is about.
fn of_runs<'a, X: 'a>(name: &'static str, campaign: &'a Campaign) -> Sheet<'a, Of<'a, X>> {
    Sheet::<Of<X>>::new(name, "", 1)
        .plain("run", |(run, _)| run.path.as_str())
        .plain("revision", |(run, _)| run.revision)
        .plain("sample", |(run, _)| run.tag(keys::SAMPLE))
        .plain("material", |(run, _)| material(run, campaign))
        .plain("environment", |(run, _)| run.tag(keys::ENVIRONMENT))
        .plain(keys::RELATIVE_HUMIDITY_PERCENT, |(run, _)| {
            run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT)
        })
        .plain(keys::TEMPERATURE_C, |(run, _)| {
            run.tag_number(keys::TEMPERATURE_C)
        })
        .plain(keys::VOLTAGE_V, |(run, _)| nominal_voltage_v(run))
        .plain(keys::STARTED_AT, |(run, _)| run.tag(keys::STARTED_AT))
        .plain("model", |(run, _)| run.fit.as_ref().map(|fit| fit.model.clone()))
}

/// One row per run: identity, tags, state, files with their hashes, quality of the fit, number of warnings.
pub fn runs_table(runs: &[RunRecord], campaign: &Campaign) -> Frame {
    let joined = |run: &RunRecord, of: fn(&RunFile) -> &str| {
        let files: Vec<&str> = run.files.iter().map(of).collect();
        files.join(" ")
    };
    of_runs::<Option<&Fit>>("runs", campaign)
        .plain("state", |(run, _)| run.state.key())
        .plain("standing", |(run, _)| run.standing.key())
        .plain("standing_reason", |(run, _)| {
            Some(run.standing.reason()).filter(|why| !why.is_empty())
        })
        .plain("status", |(run, _)| run.status.key())
        .plain("technique", |(run, _)| run.technique.clone())
        .plain("format", |(run, _)| run.format.as_str())
        .plain("files", move |(run, _)| joined(run, |file| &file.path))
        .plain("file_hashes_blake3", move |(run, _)| {
            joined(run, |file| &file.hash)
        })
        .plain("data_hash", |(run, _)| run.data_hash.as_str())
        .plain("ingested_at", |(run, _)| run.ingested_at.as_str())
        .plain("area_cm2", |(run, _)| run.area_cm2)
        .plain("model_version", |(_, fit)| fit.map(|fit| fit.model_version))
        .plain("converged", |(_, fit)| fit.map(|fit| fit.converged))
        .plain("readings_fitted", |(_, fit)| fit.map(|fit| fit.n_samples))
        .plain("r_squared_current", |(_, fit)| {
            fit.and_then(|fit| fit.r_squared_current)
        })
        .plain("r_squared_curvature", |(_, fit)| {
            fit.and_then(|fit| fit.r_squared_curvature)
        })
        .plain("warnings", |(run, _)| warnings(run))
        .frame(with_fits(runs))
}

fn with_fits(runs: &[RunRecord]) -> impl Iterator<Item = Of<'_, Option<&Fit>>> {
    runs.iter().map(|run| (run, run.fit.as_ref()))
}

/// Issues of a run and its fit that are more than notes.
fn warnings(run: &RunRecord) -> usize {
    let of_fit = run.fit.iter().flat_map(|fit| &fit.issues);
    let issues = run.issues.iter().chain(of_fit);
    issues.filter(|issue| issue.severity >= Severity::Warning).count()
}

/// One row per run and tag, from every source; `chosen` tells which value of a key holds: the first.
pub fn tags_table(runs: &[RunRecord]) -> Frame {
    type OfTag<'a> = (&'a RunRecord, usize, &'a Tag);
    Sheet::<OfTag>::new("tags", "", 1)
        .plain("run", |(run, ..)| run.path.as_str())
        .plain("key", |(.., tag)| tag.key.as_str())
        .plain("value", |(.., tag)| tag.value.as_str())
        .plain("source", |(.., tag)| tag.source.key())
        .plain("detail", |(.., tag)| tag.detail.as_str())
        .plain("chosen", |(run, at, tag)| {
            !run.tags[..*at].iter().any(|earlier| earlier.key == tag.key)
        })
        .frame(
            runs.iter()
                .flat_map(|run| run.tags.iter().enumerate().map(move |(at, tag)| (run, at, tag))),
        )
}

/// One row per run and parameter: value, standard error, 95 % interval and the reason for what is missing; then of what the fit
/// estimated beside them, whose `role` is nuisance.
pub fn fits_long(runs: &[RunRecord], campaign: &Campaign) -> Frame {
    /// A fit, the role of a number in it, its key and what is known of it.
    type OfNumber<'a> = (&'a Fit, &'a str, &'a str, &'a Estimate);
    fn numbers(fit: &Fit) -> impl Iterator<Item = OfNumber<'_>> {
        let parameters = fit
            .parameters
            .iter()
            .map(move |own| (fit, "parameter", own.key.as_str(), &own.estimate));
        let nuisances = fit
            .nuisances
            .iter()
            .map(move |own| (fit, "nuisance", own.key.as_str(), &own.estimate));
        parameters.chain(nuisances)
    }
    let fitted = runs.iter().filter_map(|run| Some((run, run.fit.as_ref()?)));
    of_runs::<OfNumber>("fits", campaign)
        .plain("parameter", |(_, (_, _, key, _))| *key)
        .plain("role", |(_, (_, role, ..))| *role)
        .plain("value", |(_, (.., own))| own.value)
        .plain("standard_error", |(_, (.., own))| own.standard_error)
        .plain("low_95", |(_, (.., own))| own.low_95)
        .plain("high_95", |(_, (.., own))| own.high_95)
        .plain("converged", |(_, (fit, ..))| fit.converged)
        .plain("at_bound", |(_, (.., own))| own.at_bound)
        .plain("reason", |(_, (.., own))| own.reason.clone())
        .frame(fitted.flat_map(|(run, fit)| numbers(fit).map(move |own| (run, own))))
}

/// One row per run, fitted or not: identity, tags, fit quality, and each parameter with its uncertainty.
pub fn fits_wide(runs: &[RunRecord], campaign: &Campaign) -> Frame {
    let sheet = of_runs::<Option<&Fit>>("fits-wide", campaign)
        .plain("state", |(run, _)| run.state.key())
        .plain("status", |(run, _)| run.status.key())
        .plain("converged", |(_, fit)| fit.map(|fit| fit.converged))
        .plain("r_squared_current", |(_, fit)| {
            fit.and_then(|fit| fit.r_squared_current)
        })
        .plain("r_squared_curvature", |(_, fit)| {
            fit.and_then(|fit| fit.r_squared_curvature)
        });
    parameter_keys(runs)
        .iter()
        .fold(sheet, |sheet, key| {
            sheet.plain(key, move |(_, fit)| fit.and_then(|fit| fit.parameter(key)))
        })
        .frame(with_fits(runs))
}

/// One row per measured condition: numbers of runs, and per parameter how many runs determine it, their mean
/// and their standard deviation between runs (empty for fewer than two). Fits that did not converge are left
/// out of the parameters; runs with the one parameter set of a group count as one.
pub fn conditions_table(runs: &[RunRecord], campaign: &Campaign) -> Frame {
    let found = conditions(runs, campaign);
    let around = |own: &Condition| &found.surroundings[own.surroundings];
    let sheet = Sheet::<&Condition>::new("conditions", "", 1)
        .plain("material", |own| found.materials[own.material].as_str())
        .plain("environment", |own| around(own).environment.as_str())
        .plain("relative_humidity_low_percent", |own| {
            around(own).humidity.map(|level| level.low_percent)
        })
        .plain("relative_humidity_high_percent", |own| {
            around(own).humidity.map(|level| level.high_percent)
        })
        .plain("voltage_v", |own| found.voltages_v[own.voltage])
        .plain("runs", |own| own.runs.len())
        .plain("runs_fitted", |own| {
            own.runs.iter().filter(|&&run| runs[run].fit.is_some()).count()
        });
    parameter_keys(runs)
        .iter()
        .fold(sheet, |sheet, key| {
            let of = move |own: &&Condition| determined(runs, &own.runs, key);
            sheet
                .plain(&format!("{key}_runs"), move |own| of(own).len())
                .plain(&format!("{key}_mean"), move |own| mean(&of(own)))
                .plain(&format!("{key}_standard_deviation"), move |own| {
                    standard_deviation(&of(own))
                })
        })
        .frame(&found.measured)
}

/// Keys that occur in any fit: those of the lumped model in its order, then the others by name.
fn parameter_keys(runs: &[RunRecord]) -> Vec<String> {
    let fits = runs.iter().filter_map(|run| run.fit.as_ref());
    let mut keys: Vec<&str> = fits
        .flat_map(|fit| fit.parameters.iter().map(|parameter| parameter.key.as_str()))
        .collect();
    let rank = |key: &str| {
        PARAMETERS
            .iter()
            .position(|known| known.key == key)
            .unwrap_or(PARAMETERS.len())
    };
    keys.sort_by_key(|key| (rank(key), *key));
    keys.dedup();
    keys.into_iter().map(str::to_owned).collect()
}

/// Determined values of a condition's runs; one that the fit of a group gave to several of them counts once.
fn determined(runs: &[RunRecord], indices: &[usize], key: &str) -> Vec<f64> {
    let mut counted = BTreeSet::new();
    let value = |&index: &usize| {
        let estimate = usable(&runs[index], key)?;
        let is_new = SharedEstimate::of(&runs[index], estimate).is_none_or(|shared| counted.insert(shared));
        estimate.value.filter(|_| is_new)
    };
    indices.iter().filter_map(value).collect()
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
    use ieap_domain::Estimate;
    use ieap_domain::testing::{campaign, fit, known, run};
    use ieap_show::{FrameCells, FrameColumn};

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
        let table = conditions_table(&runs, &campaign());
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
        let table = conditions_table(&runs, &campaign());
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
