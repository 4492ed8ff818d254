//! What was found, what holds across runs and what is watched, as plain tables: `ieap export` writes them, and the database
//! shows the same rows in its views.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::analysis::conditions::material;
use crate::analysis::cycles::{CYCLE_FIGURES, Cycle, CycleRun};
use crate::analysis::laws::CampaignLaws;
use crate::analysis::laws::fitted::Interval;
use crate::analysis::model_free::{ENERGIES, FIGURES, ModelFree};
use crate::analysis::monitoring::{Monitoring, Watched, series::Reaches, words};
use crate::analysis::plain_columns::{PlainCells, PlainColumn, plain_columns};
use crate::analysis::{ExportError, run_tables::runs_table};
use crate::domain::tag::keys;
use crate::domain::{Campaign, Estimate, GroupDiagnosis, RunRecord};
use crate::pipeline::documents::campaign::{CampaignEntry, CampaignTest, entries, tests};
use crate::report;
use crate::store::PublishedRows;

/// A table that is made column by column of the things that its rows are about.
struct Table<'t, T> {
    rows: &'t [T],
    columns: Vec<PlainColumn>,
}

impl<'t, T> Table<'t, T> {
    fn of(rows: &'t [T]) -> Table<'t, T> {
        let columns = Vec::new();
        Table { rows, columns }
    }

    fn with(mut self, name: &str, cells: PlainCells) -> Self {
        let name = name.to_owned();
        self.columns.push(PlainColumn { name, cells });
        self
    }

    fn text<S: Into<String>>(self, name: &str, of: impl Fn(&'t T) -> Option<S>) -> Self {
        let cells = self.rows.iter().map(|row| of(row).map(Into::into)).collect();
        self.with(name, PlainCells::Texts(cells))
    }

    fn number(self, name: &str, of: impl Fn(&'t T) -> Option<f64>) -> Self {
        let finite = |row| of(row).filter(|number| number.is_finite());
        let cells = self.rows.iter().map(finite).collect();
        self.with(name, PlainCells::Numbers(cells))
    }

    fn count(self, name: &str, of: impl Fn(&'t T) -> Option<usize>) -> Self {
        let cells = self
            .rows
            .iter()
            .map(|row| of(row).map(|count| count as i64))
            .collect();
        self.with(name, PlainCells::Counts(cells))
    }

    fn flag(self, name: &str, of: impl Fn(&'t T) -> Option<bool>) -> Self {
        let cells = self.rows.iter().map(of).collect();
        self.with(name, PlainCells::Flags(cells))
    }

    /// Five columns a number: value, standard error, interval, and why there is no value.
    fn figures(mut self, figures: &[crate::show::Quantity], of: impl Fn(&'t T) -> &'t [Estimate]) -> Self {
        for (k, crate::show::Quantity { key, .. }) in figures.iter().enumerate() {
            self = self
                .number(key, |row| of(row)[k].value)
                .number(&format!("{key}_standard_error"), |row| of(row)[k].standard_error)
                .number(&format!("{key}_low_95"), |row| of(row)[k].low_95)
                .number(&format!("{key}_high_95"), |row| of(row)[k].high_95)
                .text(&format!("{key}_reason"), |row| of(row)[k].reason.as_deref());
        }
        self
    }

    /// A list of words in each cell, as JSON has it.
    fn list<S: AsRef<str>>(self, name: &str, of: impl Fn(&'t T) -> Vec<S>) -> Self {
        self.text(name, |row| {
            let words = of(row);
            let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
            serde_json::to_string(&words).ok()
        })
    }
}

/// One row a finding: of groups, then of single runs.
pub fn findings_table(
    (groups, alone): (&[GroupDiagnosis], &[GroupDiagnosis]),
    runs: &[RunRecord],
    campaign: &Campaign,
) -> Vec<PlainColumn> {
    let by_path: BTreeMap<&str, &RunRecord> = runs.iter().map(|run| (run.path.as_str(), run)).collect();
    // What all runs of a finding share.
    let shared = |found: &GroupDiagnosis, of: &dyn Fn(&RunRecord) -> Option<String>| {
        let mut values = found.runs.iter().map(|path| of(by_path.get(path.as_str())?));
        let first = values.next()??;
        values
            .all(|value| value.as_ref() == Some(&first))
            .then_some(first)
    };
    let tag = |found: &GroupDiagnosis, key: &str| shared(found, &|run| run.tag(key).map(str::to_owned));
    let rows: Vec<(&str, &GroupDiagnosis)> = (groups.iter().map(|found| ("group", found)))
        .chain(alone.iter().map(|found| ("run", found)))
        .collect();
    let table = Table::of(&rows)
        .text("kind", |(kind, _)| Some(*kind))
        .text("name", |(_, found)| Some(&found.group))
        .text("material", |(_, found)| {
            shared(found, &|run| material(run, campaign).map(str::to_owned))
        })
        .text("sample", |(_, found)| tag(found, keys::SAMPLE))
        .text("environment", |(_, found)| tag(found, keys::ENVIRONMENT))
        .text("verdict", |(_, found)| word(&found.verdict))
        .text("sentence", |(_, found)| Some(&found.sentence))
        .number("p_misfit", |(_, found)| found.p_misfit)
        .number("q_misfit", |(_, found)| found.q_misfit)
        .list("effects", |(_, found)| {
            found.effects.iter().map(|own| own.effect.clone()).collect()
        })
        .list("as_good", |(_, found)| found.set.clone())
        .list("most_probable", |(_, found)| {
            let first = found.posterior.first();
            first.map(|first| first.effects.clone()).unwrap_or_default()
        })
        .number("most_probable_mass", |(_, found)| {
            Some(found.posterior.first()?.mass)
        });
    gain_columns(table)
        .text("next_run", |(_, found)| {
            Some(found.next_run.as_ref()?.drive.clone())
        })
        .text("base_model", |(_, found)| Some(&found.base_model))
        .list("runs", |(_, found)| found.runs.clone())
        .columns
}

/// How much better held-out readings are predicted by the extended model.
fn gain_columns<'t>(table: Table<'t, (&str, &GroupDiagnosis)>) -> Table<'t, (&'t str, &'t GroupDiagnosis)> {
    let proof = |found: &'t GroupDiagnosis| found.gain.as_ref().map(|gain| &gain.proof);
    table
        .text("held_out", |(_, found)| {
            Some(found.gain.as_ref()?.held_out.clone())
        })
        .number("gain_deviance", move |(_, found)| Some(proof(found)?.deviance))
        .number("gain_standard_error", move |(_, found)| {
            Some(proof(found)?.standard_error)
        })
        .flag("gain_is_clear", move |(_, found)| Some(proof(found)?.is_clear()))
        .number("nrmse_current_before", move |(_, found)| {
            proof(found)?.nrmse_current_before
        })
        .number("nrmse_current_after", move |(_, found)| {
            proof(found)?.nrmse_current_after
        })
        .number("nrmse_curvature_before", move |(_, found)| {
            proof(found)?.nrmse_curvature_before
        })
        .number("nrmse_curvature_after", move |(_, found)| {
            proof(found)?.nrmse_curvature_after
        })
}

/// A verdict as JSON writes it.
fn word(of: &impl serde::Serialize) -> Option<String> {
    let value = serde_json::to_value(of).ok()?;
    value.as_str().map(str::to_owned)
}

/// One row a question asked across runs; with the law where it is claimed.
pub fn laws_table(laws: &CampaignLaws) -> Vec<PlainColumn> {
    let claimed = entries(laws);
    let of_question = |test: &CampaignTest| {
        claimed.iter().find(|entry| {
            (entry.effect, &entry.parameter, entry.covariate)
                == (test.effect, &test.parameter, test.covariate)
                && (entry.material == test.material || entry.material.is_none())
                && entry.sentence == test.sentence
        })
    };
    let asked = tests(laws);
    let rows: Vec<(&CampaignTest, Option<&CampaignEntry>)> =
        asked.iter().map(|test| (test, of_question(test))).collect();
    Table::of(&rows)
        .text("material", |(test, _)| test.material.clone())
        .text("sample", |(_, law)| (*law)?.sample.clone())
        .text("parameter", |(test, _)| Some(&test.parameter))
        .text("covariate", |(test, _)| Some(test.covariate))
        .text("effect", |(test, _)| Some(test.effect))
        .flag("claimed", |(_, law)| Some(law.is_some()))
        .text("law", |(_, law)| Some((*law)?.law))
        .number("coefficient", |(_, law)| (*law)?.coefficient.value)
        .number("coefficient_low_95", |(_, law)| (*law)?.coefficient.low_95)
        .number("coefficient_high_95", |(_, law)| (*law)?.coefficient.high_95)
        .text("coefficient_unit", |(_, law)| Some((*law)?.coefficient_unit))
        .number("ratio", |(_, law)| Some((*law)?.ratio.as_ref()?.ratio.value))
        .number("p", |(test, _)| Some(test.p))
        .number("q", |(test, _)| Some(test.q))
        .list("confounded_with", |(test, _)| test.confounded_with.clone())
        .count("runs", |(_, law)| Some((*law)?.runs))
        .count("samples", |(_, law)| Some((*law)?.samples))
        .text("sentence", |(test, _)| Some(&test.sentence))
        .columns
}

/// One row a parameter of a sample that is watched.
pub fn monitoring_table(monitoring: &Monitoring) -> Vec<PlainColumn> {
    let trend = |own: &Watched| (own.study.trends.first().copied()).filter(|_| own.study.is_shown());
    // The size of a law of logarithms is that of a ratio.
    let size = |own: &Watched, of: fn(&Interval) -> Option<f64>| {
        let size = of(&trend(own)?.size)?;
        Some(if own.series.is_log { size.exp() } else { size })
    };
    Table::of(&monitoring.watched)
        .text("material", |own| Some(&own.material))
        .text("sample", |own| Some(&own.sample))
        .text("parameter", |own| Some(&own.parameter))
        .text("axis", |own| Some(own.axis.key()))
        .count("runs", |own| Some(own.runs.len()))
        .flag("changes", |own| Some(own.study.is_shown()))
        .number("p_trend", |own| own.study.p_trend)
        .text("law", |own| Some(trend(own)?.law.key()))
        .number("change", |own| size(own, |of| Some(of.value)))
        .number("change_low_95", |own| size(own, |of| of.low_95))
        .number("change_high_95", |own| size(own, |of| of.high_95))
        .flag("is_ratio", |own| Some(own.series.is_log))
        .list("alarms", |own| alarms(own, monitoring))
        .number("limit_reached_at", |own| match &own.limit.as_ref()?.1 {
            Reaches::At(at) => Some(at.value),
            Reaches::Beyond => own.series.x.last().copied(),
            Reaches::Unknown(_) => None,
        })
        .text("sentence", |own| Some(words::life(own)))
        .columns
}

/// One row a run whose voltage is stepped and held: what the step says without a model, and its energies.
pub fn model_free_table(steps: &[ModelFree], runs: &[RunRecord], campaign: &Campaign) -> Vec<PlainColumn> {
    let by_id: BTreeMap<i64, &RunRecord> = runs.iter().map(|run| (run.id, run)).collect();
    let run = |own: &ModelFree| by_id.get(&own.run_id).copied();
    Table::of(steps)
        .text("run", |own| Some(&own.path))
        .text("sample", |own| run(own)?.tag(keys::SAMPLE))
        .text("material", |own| material(run(own)?, campaign))
        .text("environment", |own| run(own)?.tag(keys::ENVIRONMENT))
        .number(keys::RELATIVE_HUMIDITY_PERCENT, |own| {
            run(own)?.tag_number(keys::RELATIVE_HUMIDITY_PERCENT)
        })
        .number("voltage_v", |own| Some(own.voltage_v))
        .number("held_s", |own| Some(own.held_s))
        .figures(&FIGURES, |own| &own.values)
        .figures(&ENERGIES, |own| &own.energies)
        .columns
}

/// One row a cycle of a train.
pub fn cycles_table(trains: &[CycleRun], runs: &[RunRecord]) -> Vec<PlainColumn> {
    let by_id: BTreeMap<i64, &RunRecord> = runs.iter().map(|run| (run.id, run)).collect();
    let rows: Vec<(&CycleRun, &Cycle)> = trains
        .iter()
        .flat_map(|own| std::iter::repeat(own).zip(&own.cycles))
        .collect();
    Table::of(&rows)
        .text("run", |(own, _)| Some(&own.path))
        .count("cycle", |(_, cycle)| Some(cycle.number))
        .text("sample", |(own, _)| by_id.get(&own.run_id)?.tag(keys::SAMPLE))
        .number("start_s", |(_, cycle)| Some(cycle.start_s))
        .number("lowest_v", |(own, _)| Some(own.voltage_v.0))
        .number("highest_v", |(own, _)| Some(own.voltage_v.1))
        .figures(&CYCLE_FIGURES, |(_, cycle)| &cycle.values)
        .columns
}

/// Charts that raised an alarm on it.
fn alarms(own: &Watched, monitoring: &Monitoring) -> Vec<String> {
    let of_sample = monitoring
        .alarms
        .iter()
        .filter(|alarm| alarm.sample == own.sample);
    let charts = of_sample.flat_map(|alarm| {
        let signs = alarm.shown_by.iter().map(|sign| (&sign.parameter, &sign.chart));
        let first = (&alarm.parameter, &alarm.chart);
        signs.chain(alarm.shown_by.is_empty().then_some(first))
    });
    charts
        .filter(|(parameter, _)| **parameter == own.parameter)
        .map(|(_, chart)| chart.clone())
        .collect()
}

/// What a report shows, as rows for whoever asks in SQL.
pub fn shown(input: &report::Input) -> Result<Vec<PublishedRows>, ExportError> {
    let every: Vec<RunRecord> = input.runs.iter().chain(&input.set_aside).cloned().collect();
    let runs = plain_columns(&runs_table(&every, &input.campaign)?);
    let kept = ["run", "material", "standing", "standing_reason"];
    let runs: Vec<PlainColumn> = runs
        .into_iter()
        .filter(|column| kept.contains(&column.name.as_str()))
        .collect();
    let found = (input.findings.groups.as_slice(), input.findings.runs.as_slice());
    Ok(vec![
        ("run", json_rows(&runs)),
        (
            "finding",
            json_rows(&findings_table(found, &input.runs, &input.campaign)),
        ),
        ("law", json_rows(&laws_table(&input.laws))),
        ("monitoring", json_rows(&monitoring_table(&input.monitoring))),
    ])
}

/// Every row as a JSON object; yes and no are 1 and 0, as in a database.
fn json_rows(columns: &[PlainColumn]) -> Vec<String> {
    let cell = |cells: &PlainCells, row: usize| -> Value {
        match cells {
            PlainCells::Texts(cells) => cells[row].clone().into(),
            PlainCells::Numbers(cells) => cells[row].into(),
            PlainCells::Counts(cells) => cells[row].into(),
            PlainCells::Flags(cells) => cells[row].map(i32::from).into(),
        }
    };
    let height = columns.first().map_or(0, |column| match &column.cells {
        PlainCells::Texts(cells) => cells.len(),
        PlainCells::Numbers(cells) => cells.len(),
        PlainCells::Counts(cells) => cells.len(),
        PlainCells::Flags(cells) => cells.len(),
    });
    let object = |row: usize| {
        let pairs = columns
            .iter()
            .map(|column| (column.name.clone(), cell(&column.cells, row)));
        Value::Object(pairs.collect()).to_string()
    };
    (0..height).map(object).collect()
}
