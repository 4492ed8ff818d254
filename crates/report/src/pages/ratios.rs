//! Every condition over a reference condition, with intervals.

use super::parameter_section::ParameterSection;
use ieap_domain::words::counted;
use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::comparison::{caution, doubts, groups_of};
use super::wording::{surroundings_label, voltage_label};
use crate::error::ReportError;
use crate::figures::axis::Axis;
use crate::figures::comparison::{Group, ratio_comparison};
use crate::input::Input;
use crate::site::Site;
use ieap_analysis::comparison::ratios::{Ratio, Reference, ratios, reference};
use ieap_analysis::{PARAMETERS, ParameterInfo};
use ieap_domain::Estimate;
use ieap_domain::number::{fixed, interval, rounded};

/// Intervals may stretch an axis beyond the ratios by this factor.
const STRETCH: f64 = 3.0;

#[derive(Debug, Serialize)]
struct RatiosPage {
    lead: String,
    caution: Vec<String>,
    parameters: Vec<ParameterSection<Panel>>,
    columns: Vec<&'static str>,
    rows: Vec<Row>,
    /// What all rows are held against, and rest on, said once; empty where rows differ.
    over: String,
    rests_on: String,
}

#[derive(Debug, Serialize)]
struct Panel {
    material: String,
    figure: String,
}

#[derive(Debug, Serialize)]
struct Row {
    material: String,
    condition: String,
    reference: String,
    cells: Vec<Cell>,
    basis: String,
}

#[derive(Debug, Serialize)]
struct Cell {
    value: String,
    interval: String,
}

/// Whether there are two conditions to compare.
pub fn is_shown(input: &Input) -> bool {
    let conditions = ieap_analysis::conditions(&input.runs, &input.campaign);
    conditions.measured.len() > 1
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let input = site.input;
    let conditions = &site.conditions;
    let chosen = reference(conditions, &input.campaign.compare);
    let keys: Vec<&str> = PARAMETERS.iter().map(|info| info.key).collect();
    let found = chosen.as_ref().map_or_else(Vec::new, |chosen| {
        let facts = (site.facts.as_slice(), &input.laws.doubts);
        ratios(&input.runs, facts, conditions, chosen, &keys)
    });
    let mut figures = BTreeMap::new();
    let mut parameters = Vec::new();
    for info in &PARAMETERS {
        let own: Vec<&Ratio> = found.iter().filter(|ratio| ratio.parameter == info.key).collect();
        let panels = panels(site, info, &own, &mut figures)?;
        parameters.extend(ParameterSection::of(info, panels));
    }
    let shown: Vec<&ParameterInfo> = PARAMETERS
        .iter()
        .filter(|info| found.iter().any(|ratio| ratio.parameter == info.key))
        .collect();
    let rows = rows(site, &found, &shown);
    let page = RatiosPage {
        over: shared(&rows, |row| &row.reference),
        rests_on: shared(&rows, |row| &row.basis),
        lead: lead(chosen.as_ref()),
        caution: caution(site).into_iter().chain(doubts(site)).collect(),
        parameters,
        columns: shown.iter().map(|info| info.symbol).collect(),
        rows,
    };
    Content::new("ratios.html", &page, figures)
}

/// What all rows say; empty where they differ.
fn shared(rows: &[Row], of: impl Fn(&Row) -> &String) -> String {
    match rows {
        [first, others @ ..] if others.iter().all(|row| of(row) == of(first)) => of(first).clone(),
        _ => String::new(),
    }
}

fn lead(chosen: Option<&Reference>) -> String {
    let Some(chosen) = chosen else {
        return "No condition was measured yet.".to_owned();
    };
    let words = reference_words(chosen);
    let named = if chosen.is_named {
        format!(
            "The reference is {words}, as campaign.toml says; what it leaves open is the same on both sides."
        )
    } else {
        format!(
            "The reference is {words}: the condition with the most runs. Another one is stated in campaign.toml, [compare] reference."
        )
    };
    format!(
        "{named} Samples that were measured in both conditions are compared with themselves; where there is none, different samples are, and the table says so. Bars are 95 % intervals."
    )
}

/// `air at 34 % RH, 2.5 V`
pub fn reference_words(chosen: &Reference) -> String {
    let mut words: Vec<String> = chosen.environment.iter().cloned().collect();
    words.extend(
        chosen
            .relative_humidity_percent
            .map(|percent| format!("{} % RH", fixed(percent, 0))),
    );
    words.extend(chosen.voltage_v.map(voltage_label));
    words.join(", ")
}

/// One panel a material, in the manner of the comparison, with a line at 1.
fn panels(
    site: &Site,
    info: &'static ParameterInfo,
    own: &[&Ratio],
    figures: &mut BTreeMap<String, String>,
) -> Result<Vec<Panel>, ReportError> {
    let conditions = &site.conditions;
    let mut panels = Vec::new();
    for (material, name) in conditions.materials.iter().enumerate() {
        let of_material = |ratio: &&&Ratio| conditions.measured[ratio.condition].material == material;
        let own: Vec<&Ratio> = own.iter().filter(of_material).copied().collect();
        if own.is_empty() {
            continue;
        }
        let ends = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
        let (low, high) = own.iter().map(|ratio| ratio.value).fold((1.0, 1.0), ends);
        let bars = own.iter().flat_map(|ratio| [ratio.low_95, ratio.high_95]);
        let (low, high) = bars
            .map(|end| end.clamp(low / STRETCH, high * STRETCH))
            .fold((low, high), ends);
        let title = format!("{} over the reference", info.symbol);
        let y = Axis::log(low / 1.1, high * 1.1, &title, "");
        let id = format!("ratio-{}-{material}", info.key.replace('_', "-"));
        let desc = "Ratio to the reference condition in each environment and at each voltage, with 95 % intervals; the numbers stand in the table below.";
        let title = format!("{} of {name} over the reference condition", info.name);
        let drawn = ratio_comparison(&groups(site, &own), &y, &title, desc);
        let svg = drawn.map_err(|reason| ReportError::Figure {
            figure: id.clone(),
            reason,
        })?;
        figures.insert(id.clone(), svg);
        panels.push(Panel {
            material: name.clone(),
            figure: id,
        });
    }
    Ok(panels)
}

fn groups(site: &Site, own: &[&Ratio]) -> Vec<Group> {
    let conditions = &site.conditions;
    let estimate = |ratio: &&Ratio| {
        let error = ratio.value * ratio.log_standard_error;
        Estimate::determined(ratio.value, error, ratio.low_95, ratio.high_95)
    };
    let estimates = |surroundings, voltage| {
        let is_here = |ratio: &&&Ratio| {
            let condition = &conditions.measured[ratio.condition];
            (condition.surroundings, condition.voltage) == (surroundings, voltage)
        };
        (Vec::new(), own.iter().filter(is_here).map(estimate).collect())
    };
    // A run that no result is made from has no ratio.
    groups_of(conditions, estimates, |_, _| Vec::new())
}

fn rows(site: &Site, found: &[Ratio], shown: &[&ParameterInfo]) -> Vec<Row> {
    let conditions = &site.conditions;
    let words = |index: usize| {
        let condition = &conditions.measured[index];
        let surroundings = surroundings_label(&conditions.surroundings[condition.surroundings]);
        format!(
            "{surroundings}, {}",
            voltage_label(conditions.voltages_v[condition.voltage])
        )
    };
    let cell = |ratio: Option<&&Ratio>| match ratio {
        Some(ratio) => Cell {
            value: rounded(ratio.value, ratio.value * ratio.log_standard_error).value_text(),
            interval: interval(ratio.low_95, ratio.high_95),
        },
        None => Cell {
            value: "–".to_owned(),
            interval: String::new(),
        },
    };
    found
        .chunk_by(|a, b| a.condition == b.condition)
        .map(|own| {
            let first = &own[0];
            let own: Vec<&Ratio> = own.iter().collect();
            let of = |info: &&ParameterInfo| cell(own.iter().find(|ratio| ratio.parameter == info.key));
            Row {
                material: conditions.materials[conditions.measured[first.condition].material].clone(),
                condition: words(first.condition),
                reference: words(first.reference),
                cells: shown.iter().map(of).collect(),
                basis: basis(first),
            }
        })
        .collect()
}

/// What a ratio rests on.
fn basis(ratio: &Ratio) -> String {
    let runs = format!(
        "{} over {}",
        counted(ratio.runs.0, "run"),
        counted(ratio.runs.1, "run")
    );
    match (ratio.samples_in_both, ratio.is_by_fits_alone()) {
        (0, _) => format!("{runs}, of different samples"),
        (_, true) => format!("{runs} of the same sample; by the fits alone"),
        (samples, false) => format!("{runs}, {} in both", counted(samples, "sample")),
    }
}
