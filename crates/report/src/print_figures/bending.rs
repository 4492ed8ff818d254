//! The thesis's figure 23: bending over time, one panel a material and surroundings, one line a voltage. Panels of
//! one material share their vertical axis: how much less bends back in dry gas is the point of the figure. The thesis
//! shows the displacement; the curvature is what the strip does whatever its length.

use ieap_domain::range_of;
use std::collections::BTreeMap;

use super::FigureInput;
use super::grid::{Panel, grid};
use super::responses::{Line, aside_lines, aside_words, draw_lines, lines, note_aside, speaking};
use crate::figures::axis::Axis;
use crate::figures::canvas::{Drawing, Ink};
use crate::pages::wording::{surroundings_label, voltage_label};
use ieap_domain::Quantity;

/// Height of a panel, px.
const HEIGHT: u32 = 180;
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
    let (mut panels, mut aside) = (Vec::new(), BTreeMap::new());
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
            if drawn.iter().any(|line| !line.measured.is_empty()) {
                drawn.extend(aside_lines(input, quantity, |(of, around, voltage)| {
                    ((of, around) == (material, surroundings)).then_some(voltage)
                })?);
                of_material.push((surroundings, drawn));
            }
        }
        let all = of_material.iter().flat_map(|(_, lines)| speaking(lines));
        let points: Vec<(f64, f64)> = all
            .flat_map(|line| line.measured.iter().chain(&line.fitted).copied())
            .collect();
        for (surroundings, drawn) in of_material {
            let (x, y) = axes(&points, quantity);
            note_aside(&mut aside, (&x, &y), &drawn);
            panels.push(Panel {
                title: format!(
                    "{name}, {}",
                    surroundings_label(&conditions.surroundings[surroundings])
                ),
                draw: Box::new(move |area| draw_lines(area, &x, &y, &drawn)),
            });
        }
    }
    if panels.is_empty() && quantity == Quantity::TipDisplacement {
        return Err("no run with a curvature is of a sample whose length is known: give samples length_mm in campaign.toml".to_owned());
    }
    let legend: Vec<(String, Ink)> = conditions
        .voltages_v
        .iter()
        .map(|&v| voltage_label(v))
        .zip(Ink::SERIES.into_iter().cycle())
        .collect();
    let columns = conditions.surroundings.len().clamp(1, MOST_COLUMNS);
    grid(
        width,
        columns,
        HEIGHT,
        &legend,
        &panels,
        &aside_words(input.site, &aside),
    )
}

fn axes(points: &[(f64, f64)], quantity: Quantity) -> (Axis, Axis) {
    let range = |pick: fn(&(f64, f64)) -> f64| range_of(points.iter().map(pick));
    let ((from, to), (low, high)) = (range(|point| point.0), range(|point| point.1));
    let margin = 0.04 * (high - low);
    // Hours are read, thousands of seconds are not; short runs keep their seconds.
    let x = Axis::linear(from.max(-0.02 * to), 1.01 * to, "Time after the step", "s", 4);
    let title = match quantity {
        Quantity::TipDisplacement => "Displacement",
        _ => quantity.label(),
    };
    (
        x,
        Axis::linear(low - margin, high + margin, title, quantity.unit(), 4),
    )
}
