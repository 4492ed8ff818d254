//! Curvature against the charge that has passed, one panel a material and voltage: a straight line where the bending follows
//! the charge, a hook back where it relaxes, a tail to the right where charge leaks.

use super::FigureInput;
use super::currents::lowest_and_highest;
use super::responses::{Line, chart, lines};
use crate::blocks::chart::prints;
use crate::figures::canvas::Drawing;
use crate::pages::wording::{surroundings_label, voltage_label};
use ieap_domain::Quantity;
use ieap_show::{Chart, Range};

/// Currents are drawn in mA.
const MILLI: f64 = 1e-3;
/// What the legend does not tell.
const CAPTION: &str = "Dots: measured. Lines: simulated. Charge is the integral of the current since the step, what leaks counted.";

/// Draws it.
pub fn draw(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let conditions = &input.site.conditions;
    let voltages = lowest_and_highest(&conditions.voltages_v);
    let names: Vec<String> = conditions.surroundings.iter().map(surroundings_label).collect();
    let mut charts: Vec<Chart> = Vec::new();
    for (material, name) in conditions.materials.iter().enumerate() {
        for &voltage in &voltages {
            let is_here = |of: usize, volts: usize| (of, volts) == (material, voltage);
            let mut drawn: Vec<Line> = Vec::new();
            for condition in conditions
                .measured
                .iter()
                .filter(|own| is_here(own.material, own.voltage))
            {
                for &run in &condition.runs {
                    drawn.extend(of_run(input, run, condition.surroundings)?);
                }
            }
            for own in &input.site.aside {
                if let Some((of, surroundings, volts)) = own.condition
                    && is_here(of, volts)
                {
                    drawn.extend(of_run(input, own.run, surroundings)?);
                }
            }
            let title = format!("{name}, {}", voltage_label(conditions.voltages_v[voltage]));
            let axes = (
                Range::linear("Charge", "C cm⁻²").with(0.0),
                Range::linear("Curvature", "cm⁻¹").with(0.0),
            );
            let chart = chart(input.site, title, axes, drawn, &names);
            charts.extend(chart.map(|chart| chart.told(CAPTION)));
        }
    }
    prints(&charts, voltages.len().max(1), width)
}

/// Curvature of a run against its charge; nothing where either was not read.
fn of_run(input: &FigureInput, run: usize, style: usize) -> Result<Vec<Line>, String> {
    let currents = lines(input, run, Quantity::Current, style)?;
    let curvatures = lines(input, run, Quantity::Curvature, style)?;
    let pair = currents.into_iter().next().zip(curvatures.into_iter().next());
    Ok(pair
        .map(|(current, curvature)| against_charge(&current, curvature))
        .into_iter()
        .collect())
}

/// Times of a curvature as the charge that had passed by then, C cm⁻²; readings after the last of the current have none.
fn against_charge(current: &Line, curvature: Line) -> Line {
    let with = |current: &[(f64, f64)], curvature: &[(f64, f64)]| -> Vec<(f64, f64)> {
        let passed = passed(current);
        let at = |&(time_s, value): &(f64, f64)| Some((MILLI * charge_at(&passed, time_s)?, value));
        curvature.iter().filter_map(at).collect()
    };
    Line {
        measured: with(&current.measured, &curvature.measured),
        fitted: with(&current.fitted, &curvature.fitted),
        ..curvature
    }
}

/// Time and the charge that has passed since the step: trapezia.
fn passed(current: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut charge = 0.0;
    let mut before: Option<(f64, f64)> = None;
    let mut passed = Vec::with_capacity(current.len());
    for &(time_s, value) in current.iter().filter(|point| point.0 >= 0.0) {
        if let Some((earlier_s, earlier)) = before {
            charge += 0.5 * (value + earlier) * (time_s - earlier_s);
        }
        passed.push((time_s, charge));
        before = Some((time_s, value));
    }
    passed
}

fn charge_at(passed: &[(f64, f64)], time_s: f64) -> Option<f64> {
    let after = passed.partition_point(|point| point.0 < time_s);
    let (late_s, late) = *passed.get(after)?;
    if late_s == time_s {
        return Some(late);
    }
    let (early_s, early) = *passed.get(after.checked_sub(1)?)?;
    Some(early + (late - early) * (time_s - early_s) / (late_s - early_s))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn charge_is_the_integral_of_the_current_since_the_step() {
        let current = [(-1.0, 9.0), (0.0, 2.0), (1.0, 2.0), (3.0, 0.0)];
        let passed = passed(&current);
        assert_eq!(passed, [(0.0, 0.0), (1.0, 2.0), (3.0, 4.0)]);
        assert_eq!(charge_at(&passed, 0.5), Some(1.0));
        assert_eq!(charge_at(&passed, 2.0), Some(3.0));
        assert_eq!((charge_at(&passed, -0.1), charge_at(&passed, 3.5)), (None, None));
    }
}
