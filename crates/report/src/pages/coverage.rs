//! The coverage map: how often each condition was measured, what cannot be told apart, what to measure next: the plan
//! of the campaign, as the overview and "Across runs" have it, and apart from it the conditions that could be filled.

use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::across;
use super::comparison::caution;
use super::ratios::reference_words;
use super::wording::{counted, humidity_label, surroundings_label, voltage_label, voltage_labels};
use crate::error::ReportError;
use crate::input::Input;
use crate::site::Site;
use ieap_analysis::comparison::coverage::{Next, Place, Why, cell, next};
use ieap_analysis::comparison::ratios::reference;
use ieap_analysis::laws::words;
use ieap_analysis::plan::PlannedRun;

/// Suggestions shown; the rest is counted.
const SHOWN: usize = 12;
/// Runs of the plan that are told here; "Across runs" has all.
const PLANNED: usize = 3;
/// Shades of the map: at least so many runs.
const SHADES: [usize; 4] = [1, 2, 4, 8];

#[derive(Debug, Serialize)]
struct CoveragePage {
    summary: Vec<String>,
    alarms: Vec<String>,
    voltages: Vec<String>,
    rows: Vec<Row>,
    /// The first runs of the plan.
    planned: Vec<String>,
    next: Vec<String>,
    more: String,
}

#[derive(Debug, Serialize)]
struct Row {
    /// Set in the first row of a material: its name, and over how many rows it stands.
    material: Option<(String, usize)>,
    environment: String,
    humidity: String,
    cells: Vec<MapCell>,
}

#[derive(Debug, Serialize)]
struct MapCell {
    runs: String,
    samples: String,
    class: String,
    hover: String,
    /// Number of the suggestion to measure it.
    next: Option<usize>,
}

/// Whether there is a condition.
pub fn is_shown(input: &Input) -> bool {
    !ieap_analysis::conditions(&input.runs, &input.campaign)
        .measured
        .is_empty()
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let input = site.input;
    let conditions = &site.conditions;
    let chosen = reference(conditions, &input.campaign.compare);
    let mut all = next(&input.runs, conditions, chosen.as_ref());
    let more = all.len().saturating_sub(SHOWN);
    all.truncate(SHOWN);
    let mut alarms = caution(site);
    alarms.extend(input.laws.tied.iter().map(|set| words::tied(set, &input.laws)));
    let mut summary = summary(site);
    summary.extend(
        chosen
            .as_ref()
            .map(|chosen| format!("Compared with: {}.", reference_words(chosen))),
    );
    let page = CoveragePage {
        summary,
        alarms,
        voltages: voltage_labels(&conditions.voltages_v),
        rows: rows(site, &all),
        planned: input.next_runs.iter().take(PLANNED).map(planned_words).collect(),
        next: all.iter().map(|one| sentence(site, one)).collect(),
        more: match more {
            0 => String::new(),
            some => format!("{} more are not listed.", counted(some, "condition")),
        },
    };
    Content::new("coverage.html", &page, BTreeMap::new())
}

fn planned_words(planned: &PlannedRun) -> String {
    format!("{}: {}", across::place_words(planned), planned.run.drive)
}

fn summary(site: &Site) -> Vec<String> {
    let conditions = &site.conditions;
    let possible = conditions.materials.len() * conditions.surroundings.len() * conditions.voltages_v.len();
    let measured = &conditions.measured;
    let repeated = measured
        .iter()
        .filter(|condition| condition.runs.len() > 1)
        .count();
    vec![format!(
        "{} of {} are measured, {} of them more than once.",
        measured.len(),
        counted(possible, "combination of material, environment and voltage").replace(
            "combination of material, environment and voltages",
            "combinations of material, environment and voltage"
        ),
        match repeated {
            0 => "none".to_owned(),
            some => some.to_string(),
        },
    )]
}

fn rows(site: &Site, next: &[Next]) -> Vec<Row> {
    let conditions = &site.conditions;
    let mut rows = Vec::new();
    for (material, name) in conditions.materials.iter().enumerate() {
        for (surroundings, at) in conditions.surroundings.iter().enumerate() {
            let of = |voltage| {
                map_cell(
                    site,
                    Place {
                        material,
                        surroundings,
                        voltage,
                    },
                    next,
                )
            };
            rows.push(Row {
                material: (surroundings == 0).then(|| (name.clone(), conditions.surroundings.len())),
                environment: at.environment.clone(),
                humidity: humidity_label(at),
                cells: (0..conditions.voltages_v.len()).map(of).collect(),
            });
        }
    }
    rows
}

fn map_cell(site: &Site, place: Place, next: &[Next]) -> MapCell {
    let found = cell(&site.input.runs, &site.conditions, place);
    let shade = SHADES.iter().filter(|least| found.runs >= **least).count();
    MapCell {
        runs: if found.runs == 0 {
            "–".to_owned()
        } else {
            found.runs.to_string()
        },
        samples: if found.runs == 0 {
            String::new()
        } else {
            counted(found.samples, "sample")
        },
        class: if shade == 0 {
            "gap".to_owned()
        } else {
            format!("shade-{shade}")
        },
        hover: match found.runs {
            0 => String::new(),
            _ => format!("{}, {} fitted", counted(found.runs, "run"), found.fitted),
        },
        next: next.iter().position(|one| one.place == place).map(|at| at + 1),
    }
}

fn sentence(site: &Site, next: &Next) -> String {
    let conditions = &site.conditions;
    let place = format!(
        "{} in {} at {}",
        conditions.materials[next.place.material],
        surroundings_label(&conditions.surroundings[next.place.surroundings]),
        voltage_label(conditions.voltages_v[next.place.voltage])
    );
    match &next.why {
        Why::Reference(runs) => format!(
            "{place} again: others are compared with it, and its {} do not tell its spread.",
            counted(*runs, "run")
        )
        .replace("its 1 run do not tell", "its one run does not tell"),
        Why::Return(sample) => format!(
            "{place} again, on {sample}: its environments came one after the other, and a return to the first tells the environment from age."
        ),
        Why::Missing(beside) => format!(
            "{place}: not measured; {} beside it in the same environment or at the same voltage.",
            match beside {
                1 => "1 condition is".to_owned(),
                some => format!("{some} conditions are"),
            }
        ),
        Why::Repeat => {
            format!(
                "{place} again: no condition of this material was measured twice, and the spread between runs is not known."
            )
        }
    }
}
