//! All runs of a page on one axis: what their voltages do to each response.

use ieap_domain::words::counted;
use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::run::DrawnRun;
use super::wording::voltage_label;
use crate::blocks::chart::Key;
use crate::error::ReportError;
use crate::figures::Ink as Colour;
use crate::figures::overlaid::{Line, overlaid};
use ieap_analysis::conditions::nominal_voltage_v;
use ieap_domain::{Drive, Quantity, RunRecord};
use ieap_show::Ink;

/// Responses that are laid over each other.
const DRAWN: [Quantity; 4] = [
    Quantity::Current,
    Quantity::CurrentDensity,
    Quantity::Curvature,
    Quantity::TipDisplacement,
];

/// Lines that are told apart on one axis; of more, each voltage has its first run alone.
const MOST_LINES: usize = 8;

/// The figures with their keys.
#[derive(Debug, Serialize)]
pub struct Overlay {
    keys: Vec<Key>,
    /// Whether repeats are left out.
    is_first_only: bool,
    figures: Vec<OverlayFigure>,
}

#[derive(Debug, Serialize)]
struct OverlayFigure {
    heading: String,
    figure: String,
}

/// A run that has one step of a known voltage.
struct Stepped<'a> {
    drawn: &'a DrawnRun,
    volts: f64,
    step_s: f64,
    name: String,
    /// Number of its voltage among those of the page.
    rank: usize,
}

/// The overlay of a page of several runs; its figures go to `figures`. None where there is one voltage or fewer.
///
/// # Errors
/// [`ReportError::Figure`] where a figure cannot be drawn.
pub fn overlay(
    drawn: &[(&RunRecord, &DrawnRun)],
    figures: &mut BTreeMap<String, String>,
) -> Result<Option<Overlay>, ReportError> {
    let mut runs = stepped(drawn);
    let is_first_only = runs.len() > MOST_LINES;
    if is_first_only {
        let mut seen = BTreeSet::new();
        runs.retain(|run| seen.insert(run.rank));
    }
    let ranks = runs.iter().map(|run| run.rank + 1).max().unwrap_or(0);
    if ranks < 2 {
        return Ok(None);
    }
    let mut made = Vec::new();
    for quantity in DRAWN {
        let of = |run: &&Stepped| run.drawn.curves.iter().any(|curve| curve.quantity == quantity);
        let own: Vec<&Stepped> = runs.iter().filter(of).collect();
        let lines: Vec<Line> = own
            .iter()
            .filter_map(|run| {
                Some(Line {
                    name: &run.name,
                    ink: Ink::Ordered(run.rank, ranks),
                    curve: run.drawn.curves.iter().find(|curve| curve.quantity == quantity)?,
                    step_s: run.step_s,
                })
            })
            .collect();
        let id = format!("overlay-{}", quantity.key().replace('_', "-"));
        let title = format!("{} of all runs", quantity.label());
        let desc = format!(
            "{} over the time since the step, coloured by voltage.",
            counted(lines.len(), "run")
        );
        let svg = overlaid(&lines, &title, &desc).map_err(ReportError::of_figure(&id))?;
        if let Some(svg) = svg {
            figures.insert(id.clone(), svg);
            made.push(OverlayFigure {
                heading: quantity.label().to_owned(),
                figure: id,
            });
        }
    }
    let mut keys: Vec<Key> = Vec::new();
    for run in &runs {
        let key = Key::line(&run.name, Colour::ordered(run.rank, ranks));
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    Ok((!made.is_empty()).then_some(Overlay {
        keys,
        is_first_only,
        figures: made,
    }))
}

fn stepped<'a>(drawn: &[(&RunRecord, &'a DrawnRun)]) -> Vec<Stepped<'a>> {
    let mut runs: Vec<Stepped> = drawn
        .iter()
        .filter_map(|&(record, drawn)| {
            let volts = nominal_voltage_v(record).filter(|volts| *volts != 0.0)?;
            let step_s = only_step(record.drive.as_ref())?;
            record.standing.speaks().then(|| Stepped {
                drawn,
                volts,
                step_s,
                name: voltage_label(volts),
                rank: 0,
            })
        })
        .collect();
    let mut levels: Vec<f64> = runs.iter().map(|run| run.volts).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|a, b| voltage_label(*a) == voltage_label(*b));
    for run in &mut runs {
        let own = levels.iter().position(|level| voltage_label(*level) == run.name);
        run.rank = own.unwrap_or(0);
    }
    runs
}

/// When the only step is, s; none of a drive that changes more than once.
fn only_step(drive: Option<&Drive>) -> Option<f64> {
    match drive?.segments.as_slice() {
        [only] => Some(only.start_s()),
        _ => None,
    }
}
