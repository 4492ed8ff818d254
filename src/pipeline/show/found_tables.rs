//! What was found, what holds across runs and what is watched, as plain tables: `ieap export` writes them, and the database
//! shows the same rows in its views.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::analysis::conditions::material;
use crate::analysis::json_rows::rows;
use crate::analysis::monitoring::fitted::Interval;
use crate::analysis::monitoring::{Monitoring, Watched, series::Reaches, words};
use crate::analysis::run_tables::runs_table;
use crate::analysis::study::{self, Answer, InScope, Study, Verdict, sentence};
use crate::analysis::tables::{NamedTable, Need, TABLES, TableInput};
use crate::domain::tag::keys;
use crate::domain::{Campaign, GroupDiagnosis, HeldOutGain, RunRecord};
use crate::pipeline::campaign::standing;
use crate::pipeline::show::columns::columns_table;
use crate::report;
use crate::show::{Frame, Sheet, frame_of};
use crate::store::{PublishedRows, has_view};

/// A list of words in a cell, as JSON has it.
fn list<S: AsRef<str>>(words: &[S]) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    json!(words).to_string()
}

/// One row a finding: of groups, then of single runs.
pub fn findings_table(
    (groups, alone): (&[GroupDiagnosis], &[GroupDiagnosis]),
    runs: &[RunRecord],
    campaign: &Campaign,
) -> Frame {
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
    let groups = groups.iter().map(|found| ("group", found));
    let rows = groups.chain(alone.iter().map(|found| ("run", found)));
    let proof = |found: &GroupDiagnosis, of: fn(&HeldOutGain) -> Option<f64>| of(&found.gain.as_ref()?.proof);
    Sheet::<(&str, &GroupDiagnosis)>::new("findings", "", 2)
        .plain("kind", |(kind, _)| *kind)
        .plain("name", |(_, found)| found.group.as_str())
        .plain("material", |(_, found)| {
            shared(found, &|run| material(run, campaign).map(str::to_owned))
        })
        .plain("sample", |(_, found)| tag(found, keys::SAMPLE))
        .plain("environment", |(_, found)| tag(found, keys::ENVIRONMENT))
        .plain("verdict", |(_, found)| word(&found.verdict))
        .plain("sentence", |(_, found)| found.sentence.as_str())
        .plain("p_misfit", |(_, found)| found.p_misfit)
        .plain("q_misfit", |(_, found)| found.q_misfit)
        .plain("effects", |(_, found)| {
            let effects: Vec<&str> = found.effects.iter().map(|own| own.effect.as_str()).collect();
            list(&effects)
        })
        .plain("as_good", |(_, found)| list(&found.set))
        .plain("most_probable", |(_, found)| {
            let first = found.posterior.first().and_then(|first| first.effect.clone());
            list(&first.into_iter().collect::<Vec<String>>())
        })
        .plain("most_probable_mass", |(_, found)| {
            Some(found.posterior.first()?.mass)
        })
        .plain("held_out", |(_, found)| {
            Some(found.gain.as_ref()?.held_out.clone())
        })
        .plain("gain_deviance", move |(_, found)| {
            proof(found, |of| Some(of.deviance))
        })
        .plain("gain_standard_error", move |(_, found)| {
            proof(found, |of| Some(of.standard_error))
        })
        .plain("gain_is_clear", |(_, found)| {
            Some(found.gain.as_ref()?.proof.is_clear())
        })
        .plain("nrmse_current_before", move |(_, found)| {
            proof(found, |of| of.nrmse_current_before)
        })
        .plain("nrmse_current_after", move |(_, found)| {
            proof(found, |of| of.nrmse_current_after)
        })
        .plain("nrmse_curvature_before", move |(_, found)| {
            proof(found, |of| of.nrmse_curvature_before)
        })
        .plain("nrmse_curvature_after", move |(_, found)| {
            proof(found, |of| of.nrmse_curvature_after)
        })
        .plain("next_run", |(_, found)| {
            Some(found.next_run.as_ref()?.drive.clone())
        })
        .plain("base_model", |(_, found)| found.base_model.as_str())
        .plain("runs", |(_, found)| list(&found.runs))
        .frame(rows)
}

/// A verdict as JSON writes it.
fn word(of: &impl serde::Serialize) -> Option<String> {
    let value = serde_json::to_value(of).ok()?;
    value.as_str().map(str::to_owned)
}

/// One row a law that was asked for.
pub fn laws_table(study: &Study) -> Frame {
    let over = |own: &Answer, number: Option<f64>| number.map(|number| own.over_all(number));
    let of = |own: &Answer, number: fn(&InScope) -> f64| own.of_material.as_ref().map(number);
    Sheet::<&Answer>::new("laws", "", 1)
        .plain("question", |own| own.kind.key())
        .plain("material", |own| own.material.as_str())
        .plain("against_material", |own| own.against_material.clone())
        .plain("parameter", |own| own.parameter)
        .plain("covariate", |own| own.covariate.unwrap_or("voltage_v"))
        .plain("follows", |own| own.upper.as_str())
        .plain("over", |own| (!own.lower.is_empty()).then(|| own.lower.clone()))
        .plain("claimed", |own| own.verdict == Verdict::Differs)
        .plain("certainty", |own| own.certainty.key())
        .plain("scope", |own| own.scope.key())
        .plain("scale", |own| own.scale.key())
        .plain("per_unit", |own| own.value)
        .plain("per_unit_low_95", |own| own.low_95)
        .plain("per_unit_high_95", |own| own.high_95)
        .plain("low_end", |own| own.from_to.map(|ends| ends.0))
        .plain("high_end", |own| own.from_to.map(|ends| ends.1))
        .plain("change", move |own| over(own, own.value))
        .plain("change_low_95", move |own| over(own, own.low_95))
        .plain("change_high_95", move |own| over(own, own.high_95))
        .plain("p", |own| own.p)
        .plain("q", |own| own.q)
        .plain("of_material", move |own| of(own, |law| law.value))
        .plain("of_material_low_95", move |own| of(own, |law| law.low_95))
        .plain("of_material_high_95", move |own| of(own, |law| law.high_95))
        .plain("of_material_q", |own| own.of_material.as_ref()?.q)
        .plain("strips_differ_p", |own| own.strips_differ_p)
        .plain("also_changed", |own| list(&own.also_changed))
        .plain("runs", |own| own.of_runs.len())
        .plain("samples", |own| own.samples)
        .plain("sentence", |own| sentence(own))
        .frame(study.laws())
}

/// One row a parameter of a sample that is watched.
pub fn monitoring_table(monitoring: &Monitoring) -> Frame {
    let trend = |own: &Watched| (own.study.trends.first().copied()).filter(|_| own.study.is_shown());
    // The size of a law of logarithms is that of a ratio.
    let size = |own: &Watched, of: fn(&Interval) -> Option<f64>| {
        let size = of(&trend(own)?.size)?;
        Some(if own.series.is_log { size.exp() } else { size })
    };
    Sheet::<&Watched>::new("monitoring", "", 3)
        .plain("material", |own| own.material.as_str())
        .plain("sample", |own| own.sample.as_str())
        .plain("parameter", |own| own.parameter.as_str())
        .plain("axis", |own| own.axis.key())
        .plain("runs", |own| own.runs.len())
        .plain("changes", |own| own.study.is_shown())
        .plain("p_trend", |own| own.study.p_trend)
        .plain("law", |own| Some(trend(own)?.law.key()))
        .plain("change", |own| size(own, |of| Some(of.value)))
        .plain("change_low_95", |own| size(own, |of| of.low_95))
        .plain("change_high_95", |own| size(own, |of| of.high_95))
        .plain("is_ratio", |own| own.series.is_log)
        .plain("alarms", |own| list(&alarms(own, monitoring)))
        .plain("limit_reached_at", |own| match &own.limit.as_ref()?.1 {
            Reaches::At(at) => Some(at.value),
            Reaches::Beyond => own.series.x.last().copied(),
            Reaches::Unknown(_) => None,
        })
        .plain("sentence", |own| words::life(own))
        .frame(&monitoring.watched)
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

/// What a report shows, as rows for whoever asks in SQL: yes and no are 1 and 0 there.
pub fn shown(input: &report::Input) -> Vec<PublishedRows> {
    let every: Vec<RunRecord> = input.runs.iter().chain(&input.set_aside).cloned().collect();
    let mut runs = runs_table(&every, &input.campaign);
    let kept = ["run", "standing", "standing_reason"];
    runs.retain(|column| kept.contains(&column.name.as_str()));
    let found = (input.findings.groups.as_slice(), input.findings.runs.as_slice());
    let [table_rows, table_columns] = shown_tables(input);
    vec![
        ("run", texts(&runs)),
        standing::shown_samples(&input.campaign),
        (
            "finding",
            texts(&findings_table(found, &input.runs, &input.campaign)),
        ),
        ("law", texts(&laws_table(&input.study))),
        ("monitoring", texts(&monitoring_table(&input.monitoring))),
        table_rows,
        table_columns,
    ]
}

/// Rows of a frame as a database has them: yes and no are 1 and 0.
fn in_json(frame: &Frame) -> impl Iterator<Item = Value> {
    rows(frame, |flag| i32::from(flag).into())
}

fn texts(frame: &Frame) -> Vec<String> {
    in_json(frame).map(|row| row.to_string()).collect()
}

/// The tables of `ieap table` that no view shows otherwise and that a report makes what they need for: their rows, and their
/// columns with units.
fn shown_tables(input: &report::Input) -> [PublishedRows; 2] {
    let from = TableInput {
        told: Some(&input.study),
        ..input.of_tables()
    };
    let made = |named: &NamedTable| match named.needs {
        Need::None | Need::Readings => Some(named.table(&from)),
        Need::Curves => Some(study::view::table(&input.study.answers)),
        Need::Reductions | Need::OneLikelihood => None,
    };
    let tables: Vec<(&'static str, Frame)> = (TABLES.iter())
        .filter(|named| !has_view(&format!("{}_view", named.name)))
        .filter_map(|named| Some((named.name, frame_of(&made(named)?))))
        .collect();
    let rows_of = |(name, frame): &(&'static str, Frame)| {
        let name = *name;
        let row = move |(at, cells)| json!({ "table": name, "row": at + 1, "cells": cells }).to_string();
        in_json(frame).enumerate().map(row).collect::<Vec<String>>()
    };
    let of_rows = tables.iter().flat_map(rows_of).collect();
    [
        ("table_row", of_rows),
        ("table_column", texts(&columns_table(tables))),
    ]
}
