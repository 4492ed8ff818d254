//! Models compared: what was measured with every model's curve, and below it what each leaves in units of the noise.

use super::FigureInput;
use super::family::{Family, FamilyLine, FamilyPanel};
use crate::figures::canvas::Drawing;
use crate::site::Site;
use ieap_analysis::models_compared::{ComparedCondition, models_compared};
use ieap_domain::number::fixed;
use ieap_domain::{ComparedCurve, RunComparison};

/// Heights of panels, px: a response and its residuals are of one height, as the rows of a grid are.
const HEIGHT: u32 = 190;
/// Runs side by side at most.
const MOST_COLUMNS: usize = 3;
/// Residuals are shown within this multiple of the noise at least, and at most.
const RESIDUALS: (f64, f64) = (4.0, 40.0);

/// Draws one run of every material and environment, that of the highest voltage; or the run that is asked for.
pub fn draw(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let site = input.site;
    let comparisons = &site.input.comparisons;
    if comparisons.is_empty() {
        return Err("no models were compared yet: `ieap compare` does it".to_owned());
    }
    let conditions = models_compared(comparisons, &site.input.runs, &site.input.campaign);
    let asked = input.run.map(|run| &site.input.record(run).path);
    let mut shown: Vec<(String, &RunComparison)> = Vec::new();
    for condition in &conditions {
        let of_condition = || condition.comparisons.iter().map(|&place| &comparisons[place]);
        let chosen = match asked {
            Some(path) => of_condition().find(|one| one.run == *path),
            None => of_condition().next_back(),
        };
        shown.extend(chosen.map(|one| (title(condition), one)));
    }
    if shown.is_empty() {
        return Err("models were not compared on that run: `ieap compare` does it".to_owned());
    }
    family(&shown, MOST_COLUMNS).draw(width)
}

fn title(condition: &ComparedCondition) -> String {
    format!("{}, {}", condition.material, condition.surroundings)
}

/// One run as a page shows it.
pub fn of_run(site: &Site, one: &RunComparison, width: u32) -> Result<Drawing, String> {
    let run = site.input.runs.iter().position(|run| run.path == one.run);
    let name = run.map_or(one.run.as_str(), |run| site.run_name(run));
    family(&[(name.to_owned(), one)], 1).draw(width)
}

/// Responses in one row, their residuals in the row below.
fn family(shown: &[(String, &RunComparison)], most: usize) -> Family {
    let names: Vec<String> = shown
        .iter()
        .flat_map(|(_, one)| one.models.iter().map(|score| score.model.clone()))
        .fold(Vec::new(), |mut names, name| {
            if !names.contains(&name) {
                names.push(name);
            }
            names
        });
    let mut panels = Vec::new();
    for row in shown.chunks(most) {
        let curves: Vec<(&str, &RunComparison, &ComparedCurve)> = row
            .iter()
            .filter_map(|(title, one)| {
                let deciding = one.deciding()?;
                let curve = one.curves.iter().find(|curve| curve.quantity == deciding)?;
                Some((title.as_str(), *one, curve))
            })
            .collect();
        panels.extend(
            curves
                .iter()
                .map(|(title, one, curve)| response(title, one, curve, &names)),
        );
        panels.extend(curves.iter().map(|(_, one, curve)| residuals(one, curve, &names)));
    }
    Family {
        panels,
        columns: shown.len().min(most),
        panel_height: HEIGHT,
        legend: names.into_iter().zip(0..).collect(),
        notes: vec![],
    }
}

fn lines(
    one: &RunComparison,
    curve: &ComparedCurve,
    names: &[String],
    value: impl Fn(usize, f64) -> f64,
) -> Vec<FamilyLine> {
    one.models
        .iter()
        .zip(&curve.fitted)
        .filter(|(_, fitted)| !fitted.is_empty())
        .map(|(score, fitted)| FamilyLine {
            name: String::new(),
            style: names.iter().position(|name| *name == score.model).unwrap_or(0),
            points: curve
                .time_s
                .iter()
                .zip(fitted)
                .enumerate()
                .map(|(k, (t, f))| (*t, value(k, *f)))
                .collect(),
        })
        .collect()
}

fn response(title: &str, one: &RunComparison, curve: &ComparedCurve, names: &[String]) -> FamilyPanel {
    FamilyPanel {
        title: title.to_owned(),
        x: ("Time".to_owned(), "s".to_owned()),
        y: (
            curve.quantity.label().to_owned(),
            curve.quantity.unit().to_owned(),
        ),
        about_zero: None,
        dots: curve
            .time_s
            .iter()
            .copied()
            .zip(curve.measured.iter().copied())
            .collect(),
        lines: lines(one, curve, names, |_, fitted| fitted),
    }
}

fn residuals(one: &RunComparison, curve: &ComparedCurve, names: &[String]) -> FamilyPanel {
    let mut left = lines(one, curve, names, |k, fitted| {
        (curve.measured[k] - fitted) / curve.noise
    });
    let largest = left
        .iter()
        .flat_map(|line| &line.points)
        .fold(0.0_f64, |most, point| most.max(point.1.abs()));
    let half = largest.clamp(RESIDUALS.0, RESIDUALS.1);
    let points = left.iter_mut().flat_map(|line| &mut line.points);
    points.for_each(|point| point.1 = point.1.clamp(-half, half));
    FamilyPanel {
        title: if largest > half {
            format!("what each leaves (edge: over {})", fixed(half, 0))
        } else {
            "what each leaves".to_owned()
        },
        x: ("Time".to_owned(), "s".to_owned()),
        y: ("Residual / noise".to_owned(), String::new()),
        about_zero: Some(half),
        dots: vec![],
        lines: left,
    }
}
