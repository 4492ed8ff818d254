//! The thesis's figure 22: currents in the environments, one panel a material and voltage. Both axes are logarithmic,
//! so that the charging of the first seconds and the steady current of the last hour are seen at once.

use super::FigureInput;
use super::responses::{Line, aside_lines, chart, lines};
use crate::blocks::chart::prints;
use crate::figures::canvas::Drawing;
use crate::pages::wording::{surroundings_label, voltage_label};
use ieap_domain::Quantity;
use ieap_show::{Chart, Range};

/// Decades of current shown at most: noise about zero has no end on a logarithmic axis.
const MOST_DECADES: f64 = 5.0;

/// Draws it.
pub fn draw(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let conditions = &input.site.conditions;
    let lowest_and_highest = lowest_and_highest(&conditions.voltages_v);
    let names: Vec<String> = conditions.surroundings.iter().map(surroundings_label).collect();
    let mut charts: Vec<Chart> = Vec::new();
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
            let title = format!("{name}, {}", voltage_label(conditions.voltages_v[voltage]));
            let axes = (
                Range::log("Time after the step", "s"),
                Range::log("Current", "mA cm⁻²"),
            );
            charts.extend(chart(input.site, title, axes, magnitudes(drawn), &names));
        }
    }
    prints(&charts, lowest_and_highest.len().max(1), width)
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

/// Lines without the times before the step, their values as magnitudes. What is simulated bounds them from below: readings
/// may come as near to zero as chance has it.
fn magnitudes(lines: Vec<Line>) -> Vec<Line> {
    let least = |points: &mut dyn Iterator<Item = f64>| points.fold(f64::INFINITY, f64::min);
    let after = |points: Vec<(f64, f64)>| -> Vec<(f64, f64)> {
        let after = points.into_iter().filter(|at| at.0 > 0.0 && at.1 != 0.0);
        after.map(|(time_s, value)| (time_s, value.abs())).collect()
    };
    let mut lines: Vec<Line> = (lines.into_iter())
        .map(|line| Line {
            measured: after(line.measured),
            fitted: after(line.fitted),
            ..line
        })
        .collect();
    let of = |points: fn(&Line) -> &Vec<(f64, f64)>| {
        let shown = lines.iter().filter(|line| line.is_shown());
        shown.flat_map(points).map(|at| at.1)
    };
    let simulated = least(&mut of(|line| &line.fitted));
    let lowest = if simulated.is_finite() {
        0.5 * simulated
    } else {
        0.0
    };
    let high = of(|line| &line.measured).fold(0.0, f64::max);
    let lowest = lowest.max(high / 10f64.powf(MOST_DECADES));
    for line in &mut lines {
        line.measured.retain(|at| at.1 >= lowest);
        line.fitted.retain(|at| at.1 >= lowest);
    }
    lines
}
