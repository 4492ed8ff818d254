//! The thesis's table 4: complex modulus before and after a humidity step, one row a material and step.

use super::TableInput;
use super::cells::{Contribution, Shown, combined, pooled_where};
use crate::dma::sheet::STEP;
use ieap_domain::modulus::step_keys;
use ieap_domain::tag::keys;
use ieap_domain::{Estimate, ModulusLog, ModulusStep};
use ieap_show::{Cell, Column, Content, Notes, Quantity, Row, Source, SourceOrigin, Table};
use std::borrow::Cow;

/// The first numbers of a step.
const SHOWN: &[Quantity] = STEP.split_at(6).0;
/// Humidities that agree when rounded to this step (percentage points) are one step of the programme.
const HUMIDITY_STEP_PERCENT: f64 = 5.0;

/// Steps of the same programme on the same material.
struct Alike<'a> {
    material: String,
    ordinal: usize,
    humidity: (i64, i64),
    steps: Vec<(&'a ModulusLog, &'a ModulusStep)>,
}

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let mut notes = Notes::default();
    let rows = alike(input)
        .into_iter()
        .map(|group| row(&group, &mut notes))
        .collect();
    let mut columns = vec![
        Column::plain("material", "Material", "material"),
        Column::plain("step", "Step", "number of the humidity step in the log"),
    ];
    columns.extend(SHOWN.iter().map(Quantity::of_column));
    columns.push(Column::plain("samples", "Samples", "number of samples"));
    columns.push(Column::plain("logs", "Logs", "number of modulus logs"));
    Table {
        title: "Complex modulus of elasticity before and after changes of the humidity".to_owned(),
        columns,
        stub: 2,
        rows,
        notes: notes.into_texts(),
        remarks: vec![pooled_where("a step was logged several times")],
        ..Table::default()
    }
}

/// Steps by material, place in the log and humidities, in the order of the logs.
fn alike<'a>(input: &TableInput<'a>) -> Vec<Alike<'a>> {
    let mut groups: Vec<Alike> = Vec::new();
    for log in input.modulus_logs {
        let sample = log.run.tag(keys::SAMPLE);
        let known = sample.and_then(|id| input.campaign.sample(id));
        let material = known.map_or_else(
            || sample.unwrap_or("–").to_owned(),
            |known| known.material.clone(),
        );
        for (ordinal, step) in log
            .analysis
            .iter()
            .flat_map(|found| found.steps.iter().enumerate())
        {
            let level = |key| {
                let percent = step.estimate(key).and_then(|estimate| estimate.value);
                percent.map_or(-1, |percent| (percent / HUMIDITY_STEP_PERCENT).round() as i64)
            };
            let humidity = (
                level(step_keys::HUMIDITY_BEFORE),
                level(step_keys::HUMIDITY_AFTER),
            );
            let same = |group: &&mut Alike| {
                (&group.material, group.ordinal, group.humidity) == (&material, ordinal, humidity)
            };
            match groups.iter_mut().find(same) {
                Some(group) => group.steps.push((log, step)),
                None => groups.push(Alike {
                    material: material.clone(),
                    ordinal,
                    humidity,
                    steps: vec![(log, step)],
                }),
            }
        }
    }
    // Steps of one material stand together, in the order in which materials first occur.
    let materials: Vec<String> = groups.iter().map(|group| group.material.clone()).collect();
    groups.sort_by_key(|group| {
        let first = materials.iter().position(|material| *material == group.material);
        (first, group.ordinal, group.humidity)
    });
    groups
}

fn row(group: &Alike, notes: &mut Notes) -> Row {
    let sources: Vec<Source> = group
        .steps
        .iter()
        .map(|(log, _)| Source {
            origin: SourceOrigin::ModulusLog(log.run.id),
            name: log.run.path.clone(),
            key: None,
            estimate: None,
            left_out: None,
        })
        .collect();
    let mut cells = vec![
        Cell::text(Some(group.material.clone()), sources.clone()),
        Cell::exact(Some(group.ordinal as f64 + 1.0), sources.clone()),
    ];
    for shown in SHOWN {
        let parts: Vec<Contribution> = group
            .steps
            .iter()
            .map(|(log, step)| part(log, step, shown.key))
            .collect();
        let cell = combined(&parts, &Shown::of(shown), notes);
        cells.push(match shown.unit {
            // A humidity between steps is a mean over many readings, whose last digits nobody wants.
            "%" if shown.key != step_keys::RELATIVE_CHANGE => rounded_to_percent(cell),
            _ => cell,
        });
    }
    let mut samples: Vec<Option<&str>> = group
        .steps
        .iter()
        .map(|(log, _)| log.run.tag(keys::SAMPLE))
        .collect();
    samples.sort_unstable();
    samples.dedup();
    cells.push(Cell::exact(Some(samples.len() as f64), sources.clone()));
    cells.push(Cell::exact(Some(group.steps.len() as f64), sources));
    Row {
        label: format!(
            "{}, step {}{}",
            group.material,
            group.ordinal + 1,
            humidities(group)
        ),
        cells,
    }
}

fn humidities(group: &Alike) -> String {
    match group.humidity {
        (-1, _) | (_, -1) => String::new(),
        (before, after) => {
            let percent = |level: i64| level as f64 * HUMIDITY_STEP_PERCENT;
            format!(", {} to {} % RH", percent(before), percent(after))
        }
    }
}

fn part<'a>(log: &'a ModulusLog, step: &'a ModulusStep, key: &str) -> Contribution<'a> {
    let estimate: Option<&Estimate> = step.estimate(key);
    Contribution {
        origin: SourceOrigin::ModulusLog(log.run.id),
        name: &log.run.path,
        sample: log.run.tag(keys::SAMPLE),
        shared: None,
        estimate: estimate
            .map(Cow::Borrowed)
            .ok_or_else(|| "the log has no such number".to_owned()),
    }
}

/// Sensors are good to a percent or two: a humidity is shown as a whole number.
fn rounded_to_percent(cell: Cell) -> Cell {
    let content = match cell.content {
        Content::Measured(measured) => Content::Exact(measured.value.round() + 0.0),
        other => other,
    };
    Cell { content, ..cell }
}
