//! Phases 1 and 2: R_e, R_c, C and R_ss from the current and the voltages along the strip.

use super::described::{self, electrical_parameters};
use super::input::DistributedInput;
use super::readings::{Kind, Readings};
use super::squares::{Fitted, StripProblem};

/// Voltages along the strip and the current against the electrical parameters.
pub(super) fn problem<'a>(input: &'a DistributedInput<'a>, readings: &'a Readings) -> StripProblem<'a> {
    let parameters = electrical_parameters(&input.strip);
    let kinds = [Kind::Voltage, Kind::Current];
    StripProblem::new(input, readings, &kinds, parameters, |at| {
        described::electrical(&input.strip, at)
    })
}

/// The box, the starts, the best of the searches.
pub(super) fn fit(input: &DistributedInput, readings: &Readings) -> Fitted {
    let problem = problem(input, readings);
    let coarse_readings = readings.thinned();
    let coarse = self::problem(input, &coarse_readings);
    let mut starts: Vec<(f64, Vec<f64>)> = starts(input, readings)
        .into_iter()
        .map(|start| (coarse.square(&start), start))
        .filter(|(square, _)| square.is_finite())
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let searched = starts.iter().take(3).map(|(_, start)| coarse.search(start));
    let best = searched.min_by(|a, b| a.square.total_cmp(&b.square));
    let from = best.map_or_else(|| vec![0.0; problem.parameters()], |fitted| fitted.at);
    problem.search(&from)
}

/// Starts on a grid of what shapes the response: how far the electrodes' resistance reaches, the share of the
/// steady current, the time constant. The current, where there is one, sets the scale.
pub(super) fn starts(input: &DistributedInput, readings: &Readings) -> Vec<Vec<f64>> {
    let (length_cm, duration_s) = (input.strip.length_cm, readings.duration_s());
    let given = input
        .strip
        .electrode_resistance_ohm_per_sq
        .map(|r| r / input.strip.width_cm);
    let mut starts = Vec::new();
    for reach in [0.2f64, 0.7, 2.0, 5.0] {
        for steady in [3.0f64, 30.0] {
            for part in [0.003f64, 0.02, 0.1, 0.5] {
                // reach^2 = R_e L^2 / R_c.
                let branch = match (given, readings.first_conductance()) {
                    (Some(along), _) => along * length_cm * length_cm / (reach * reach),
                    (None, Some(conductance)) => length_cm / conductance * (1.0 + reach).recip(),
                    (None, None) => 100.0,
                };
                let along = given.unwrap_or(branch * reach * reach / (length_cm * length_cm));
                let capacitance = part * duration_s / branch;
                let mut start = vec![branch.ln(), capacitance.ln(), (steady * branch).ln()];
                if electrical_parameters(&input.strip) > 3 {
                    start.push(along.ln());
                }
                starts.push(start);
            }
        }
    }
    starts
}
