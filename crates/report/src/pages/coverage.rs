//! The coverage map: how often each condition was measured, what cannot be told apart, what to measure next: first the
//! plan of the campaign, as the overview and "Across runs" have it, then the conditions that could be filled beside it.

use ieap_domain::words::counted;
use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::across;
use super::comparison::caution;
use super::ratios::reference_words;
use super::wording::{humidity_label, surroundings_label, voltage_label, voltage_labels};
use crate::error::ReportError;
use crate::input::Input;
use crate::pages::policy::MOST_TO_FILL;
use crate::site::Site;
use ieap_analysis::comparison::coverage::{Next, Place, Why, cell, next};
use ieap_analysis::comparison::ratios::reference;
use ieap_analysis::conditions::{HUMIDITY_GAP_PERCENT, HumidityLevel, Surroundings, VOLTAGE_STEP_V};
use ieap_analysis::plan::PlannedRun;

/// Shades of the map: at least so many runs.
const SHADES: [usize; 4] = [1, 2, 4, 8];

#[derive(Debug, Serialize)]
struct CoveragePage {
    summary: Vec<String>,
    alarms: Vec<String>,
    voltages: Vec<String>,
    rows: Vec<Row>,
    /// What to measure next: the runs of the plan, then the conditions to fill.
    next: Vec<String>,
    /// How many of them are runs of the plan.
    planned: usize,
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
    let plan = input.next_runs.iter();
    let mut all: Vec<Item> = plan.map(|planned| Item::planned(site, planned)).collect();
    let planned = all.len();
    let mut to_fill = next(&input.runs, conditions, chosen.as_ref());
    to_fill.retain(|one| all.iter().all(|known| known.place != Some(one.place)));
    let more = to_fill.len().saturating_sub(MOST_TO_FILL);
    to_fill.truncate(MOST_TO_FILL);
    all.extend(to_fill.iter().map(|one| Item {
        place: Some(one.place),
        sentence: sentence(site, one),
    }));
    let mut alarms = caution(site);
    alarms.extend(across::tied(site));
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
        next: all.into_iter().map(|one| one.sentence).collect(),
        planned,
        more: match more {
            0 => String::new(),
            some => format!("{} more are not listed.", counted(some, "condition")),
        },
    };
    Content::new("coverage.html", &page, BTreeMap::new())
}

/// Something to measure next.
struct Item {
    /// Its cell of the map; none where it lies in no condition that was measured.
    place: Option<Place>,
    sentence: String,
}

impl Item {
    fn planned(site: &Site, planned: &PlannedRun) -> Item {
        Item {
            place: place_of(site, planned),
            sentence: format!("{}: {}.", across::place_words(planned), planned.run.drive),
        }
    }
}

/// The cell in which a planned run would stand.
fn place_of(site: &Site, planned: &PlannedRun) -> Option<Place> {
    let (conditions, run) = (&site.conditions, &planned.run);
    let is_here = |surroundings: &Surroundings| {
        let is_at = |level: &HumidityLevel| {
            run.relative_humidity_percent.is_none_or(|rh| {
                (level.low_percent - HUMIDITY_GAP_PERCENT..=level.high_percent + HUMIDITY_GAP_PERCENT)
                    .contains(&rh)
            })
        };
        run.environment.as_deref() == Some(surroundings.environment.as_str())
            && surroundings.humidity.as_ref().is_none_or(is_at)
    };
    Some(Place {
        material: conditions
            .materials
            .iter()
            .position(|name| *name == run.material)?,
        surroundings: conditions.surroundings.iter().position(is_here)?,
        voltage: conditions.voltages_v.iter().position(|volts| {
            run.voltage_v
                .is_some_and(|wanted| (wanted - volts).abs() < VOLTAGE_STEP_V)
        })?,
    })
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
        "{} of {} of material, environment and voltage are measured, {} of them more than once.",
        measured.len(),
        counted(possible, "combination"),
        match repeated {
            0 => "none".to_owned(),
            some => some.to_string(),
        },
    )]
}

fn rows(site: &Site, next: &[Item]) -> Vec<Row> {
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

fn map_cell(site: &Site, place: Place, next: &[Item]) -> MapCell {
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
        next: next
            .iter()
            .position(|one| one.place == Some(place))
            .map(|at| at + 1),
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
            "{place} again: others are compared with it, and {} its spread.",
            match runs {
                1 => "its one run does not tell".to_owned(),
                some => format!("its {some} runs do not tell"),
            }
        ),
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
