//! The thesis's figure 23: bending over time, one panel a material and surroundings, one line a voltage. Panels of
//! one material share their vertical axis: how much less bends back in dry gas is the point of the figure. The thesis
//! shows the displacement; the curvature is what the strip does whatever its length.

use super::FigureInput;
use super::responses::{Line, aside_lines, chart, lines};
use crate::blocks::chart::prints;
use crate::figures::canvas::Drawing;
use crate::pages::wording::{surroundings_label, voltage_label};
use ieap_domain::{Quantity, range_of};
use ieap_show::{Chart, Range};

/// What precedes the step is shown so long, part of what follows.
const BEFORE: f64 = 0.02;
/// Panels side by side at most.
const MOST_COLUMNS: usize = 3;

/// Draws the curvature.
pub fn curvature(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    draw(input, width, Quantity::Curvature)
}

/// Draws the displacement at the free length, from the curvature where that was measured.
pub fn displacement(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    draw(input, width, Quantity::TipDisplacement)
}

fn draw(input: &FigureInput, width: u32, quantity: Quantity) -> Result<Drawing, String> {
    let conditions = &input.site.conditions;
    let names: Vec<String> = conditions
        .voltages_v
        .iter()
        .map(|&volts| voltage_label(volts))
        .collect();
    let mut charts: Vec<Chart> = Vec::new();
    for (material, name) in conditions.materials.iter().enumerate() {
        let mut of_material: Vec<(usize, Vec<Line>)> = Vec::new();
        for surroundings in 0..conditions.surroundings.len() {
            let mut drawn = Vec::new();
            for voltage in 0..conditions.voltages_v.len() {
                let condition = conditions.at(material, surroundings, voltage);
                for &run in condition.map_or(&[][..], |condition| &condition.runs) {
                    drawn.extend(lines(input, run, quantity, voltage)?);
                }
            }
            drawn.extend(aside_lines(input, quantity, |(of, around, voltage)| {
                ((of, around) == (material, surroundings)).then_some(voltage)
            })?);
            of_material.push((surroundings, drawn));
        }
        let axes = axes(&mut of_material, quantity);
        for (surroundings, drawn) in of_material {
            let around = surroundings_label(&conditions.surroundings[surroundings]);
            let title = format!("{name}, {around}");
            charts.extend(chart(input.site, title, axes.clone(), drawn, &names));
        }
    }
    if charts.is_empty() && quantity == Quantity::TipDisplacement {
        return Err("no run with a curvature is of a sample whose length is known: give samples length_mm in campaign.toml".to_owned());
    }
    let columns = conditions.surroundings.len().clamp(1, MOST_COLUMNS);
    prints(&charts, columns, width)
}

/// Axes that all lines of a material share, from which what long precedes the step is taken.
fn axes(of_material: &mut [(usize, Vec<Line>)], quantity: Quantity) -> (Range, Range) {
    let all = |of_material: &[(usize, Vec<Line>)]| -> Vec<(f64, f64)> {
        let lines = of_material.iter().flat_map(|(_, lines)| lines);
        let shown = lines.filter(|line| line.is_shown());
        shown
            .flat_map(|line| line.measured.iter().chain(&line.fitted).copied())
            .collect()
    };
    let (_, last_s) = range_of(all(of_material).into_iter().map(|at| at.0));
    for line in of_material.iter_mut().flat_map(|(_, lines)| lines) {
        line.measured.retain(|at| at.0 >= -BEFORE * last_s);
        line.fitted.retain(|at| at.0 >= -BEFORE * last_s);
    }
    let points = all(of_material);
    let ends = |pick: fn(&(f64, f64)) -> f64| {
        let (low, high) = range_of(points.iter().map(pick));
        vec![low, high]
    };
    let title = match quantity {
        Quantity::TipDisplacement => "Displacement",
        _ => quantity.label(),
    };
    let shared = |range: Range, always: Vec<f64>| Range { always, ..range };
    (
        shared(Range::linear("Time after the step", "s"), ends(|at| at.0)),
        shared(Range::linear(title, quantity.unit()), ends(|at| at.1)),
    )
}
