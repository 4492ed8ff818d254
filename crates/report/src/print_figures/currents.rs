//! The thesis's figure 22: currents in the environments, one panel a material and voltage. Both axes are logarithmic,
//! so that the charging of the first seconds and the steady current of the last hour are seen at once.

use std::collections::BTreeMap;

use super::FigureInput;
use super::grid::{Panel, grid};
use super::responses::{Line, aside_lines, aside_words, draw_lines, lines, note_aside, speaking};
use crate::figures::axis::Axis;
use crate::figures::canvas::{Drawing, Ink};
use crate::pages::wording::surroundings_label;
use ieap_domain::Quantity;

/// Height of a panel, px.
const HEIGHT: u32 = 190;
/// Decades of current shown at most: noise about zero has no end on a logarithmic axis.
const MOST_DECADES: f64 = 5.0;

/// Draws it.
pub fn draw(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let conditions = &input.site.conditions;
    let lowest_and_highest = lowest_and_highest(&conditions.voltages_v);
    let (mut panels, mut aside) = (Vec::new(), BTreeMap::new());
    for (material, name) in conditions.materials.iter().enumerate() {
        for &voltage in &lowest_and_highest {
            let mut drawn: Vec<Line> = Vec::new();
            for surroundings in 0..conditions.surroundings.len() {
                let Some(condition) = conditions.at(material, surroundings, voltage) else {
                    continue;
                };
                for &run in &condition.runs {
                    drawn.extend(lines(input, run, Quantity::Current, surroundings)?);
                }
            }
            drawn.extend(aside_lines(input, Quantity::Current, |condition| {
                let (of, surroundings, volts) = condition;
                ((of, volts) == (material, voltage)).then_some(surroundings)
            })?);
            let drawn: Vec<Line> = drawn.into_iter().filter_map(magnitudes).collect();
            let Some((x, y)) = axes(&drawn) else { continue };
            note_aside(&mut aside, (&x, &y), &drawn);
            let volts = crate::pages::wording::voltage_label(conditions.voltages_v[voltage]);
            panels.push(Panel {
                title: format!("{name}, {volts}"),
                draw: Box::new(move |area| draw_lines(area, &x, &y, &drawn)),
            });
        }
    }
    let legend: Vec<(String, Ink)> = conditions
        .surroundings
        .iter()
        .map(surroundings_label)
        .zip(Ink::SERIES.into_iter().cycle())
        .collect();
    let columns = lowest_and_highest.len().max(1);
    grid(
        width,
        columns,
        HEIGHT,
        &legend,
        &panels,
        &aside_words(input.site, &aside),
    )
}

/// Indices of the voltages of smallest and largest magnitude; one where there is one only.
pub(super) fn lowest_and_highest(voltages_v: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..voltages_v.len()).collect();
    order.sort_by(|&a, &b| voltages_v[a].abs().total_cmp(&voltages_v[b].abs()));
    match order.as_slice() {
        [] => vec![],
        [only] => vec![*only],
        [low, .., high] => vec![*low, *high],
    }
}

/// The line without the times before the step, its values as magnitudes; none where nothing is left.
fn magnitudes(line: Line) -> Option<Line> {
    let keep = |points: Vec<(f64, f64)>| -> Vec<(f64, f64)> {
        let after = points
            .into_iter()
            .filter(|(time_s, value)| *time_s > 0.0 && *value != 0.0);
        after.map(|(time_s, value)| (time_s, value.abs())).collect()
    };
    let line = Line {
        measured: keep(line.measured),
        fitted: keep(line.fitted),
        ..line
    };
    (!line.measured.is_empty()).then_some(line)
}

fn axes(lines: &[Line]) -> Option<(Axis, Axis)> {
    let points = || speaking(lines).flat_map(|line| line.measured.iter().chain(&line.fitted));
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, 0.0f64), |(low, high), value| {
            (low.min(value), high.max(value))
        })
    };
    let (from, to) = range(&mut points().map(|point| point.0));
    // What is simulated bounds the axis from below: readings may come as near to zero as chance has it.
    let simulated = || speaking(lines).flat_map(|line| line.fitted.iter().map(|point| point.1));
    let (_, high) = range(&mut points().map(|point| point.1));
    let (low, _) = match simulated().next() {
        Some(_) => range(&mut simulated()),
        None => range(&mut points().map(|point| point.1)),
    };
    let low = (0.5 * low).max(high / 10f64.powf(MOST_DECADES));
    (to > from && high > low).then(|| {
        (
            Axis::log(0.9 * from, 1.1 * to, "Time after the step", "s"),
            Axis::log(low, 1.5 * high, "Current", "mA cm⁻²"),
        )
    })
}
