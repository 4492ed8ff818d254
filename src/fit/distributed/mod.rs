//! Identification of the distributed model from voltages and curvatures measured along the strip, in the thesis's
//! three phases: R_e is given (or fitted); C, R_c and R_ss follow from the voltages along the strip and the
//! current; mu and lambda from the curvatures, with those fixed.

mod along;
mod outcome;
mod readings;
mod response;
mod squares;
#[cfg(test)]
mod tests;

use crate::domain::{Channel, Drive, Fit, Level};
use crate::model::coupling::CurvaturePerLineCharge;
use crate::model::distributed::DistributedModel;

use super::FitError;
use readings::{Kind, Readings};
use squares::{Fitted, Problem};

/// Id of the model in the registry.
pub const MODEL_ID: &str = "distributed";

/// Readings after the step that each phase needs at least.
const LEAST_READINGS: usize = 12;

/// The strip that was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strip {
    /// Free length, cm.
    pub length_cm: f64,
    /// Width, cm.
    pub width_cm: f64,
    /// Resistance of both electrodes along the strip, Ohm per square, as measured by a probe; none: fitted.
    pub electrode_resistance_ohm_per_sq: Option<f64>,
}

/// What one run gives to a distributed fit.
#[derive(Debug, Clone, Copy)]
pub struct DistributedInput<'a> {
    /// Channels of the run: voltages and curvatures with a position, and the current at the clamp.
    pub channels: &'a [Channel],
    /// Voltage at the clamp; open circuits are not described.
    pub drive: &'a Drive,
    /// The strip.
    pub strip: Strip,
}

/// Logarithms of R_c (Ohm cm), C (F/cm), R_ss (Ohm cm) and, where it is fitted, R_e (Ohm/cm).
type Electrical = Vec<f64>;

/// Fits a run with the distributed model.
///
/// # Errors
/// [`FitError`] where there is nothing along the strip to fit, the strip has no size, or the drive is not one of
/// held voltages.
pub fn fit_distributed(input: &DistributedInput) -> Result<Fit, FitError> {
    check(input)?;
    let readings = Readings::new(input);
    let electrical_readings = readings.count(Kind::Voltage) + readings.count(Kind::Current);
    if electrical_readings < LEAST_READINGS {
        return Err(FitError::NothingAlong {
            found: electrical_readings,
            needed: LEAST_READINGS,
        });
    }
    let electrical = identify_electrical(input, &readings);
    let mechanical = (readings.count(Kind::Curvature) >= LEAST_READINGS)
        .then(|| squares::fit_mechanical(input, &readings, &electrical));
    Ok(outcome::fit(input, &readings, &electrical, mechanical.as_ref()))
}

fn check(input: &DistributedInput) -> Result<(), FitError> {
    let Strip {
        length_cm,
        width_cm,
        electrode_resistance_ohm_per_sq,
    } = input.strip;
    let positive = |x: f64| x.is_finite() && x > 0.0;
    if !positive(length_cm) || !positive(width_cm) {
        return Err(FitError::Area {
            found_cm2: length_cm * width_cm,
        });
    }
    if let Some(found) = electrode_resistance_ohm_per_sq.filter(|&r| !positive(r)) {
        return Err(FitError::ElectrodeResistance {
            found_ohm_per_sq: found,
        });
    }
    if input.drive.segments.iter().any(|s| s.level == Level::OpenCircuit) {
        return Err(FitError::OpenCircuitAlong);
    }
    Ok(())
}

/// The model with these electrical parameters and a coupling of one.
fn model_of(strip: &Strip, electrical: &[f64], relaxation_rate_per_s: f64) -> DistributedModel {
    let given = strip.electrode_resistance_ohm_per_sq.map(|r| r / strip.width_cm);
    DistributedModel {
        branch_resistance_ohm_cm: electrical[0].exp(),
        capacitance_f_per_cm: electrical[1].exp(),
        steady_state_resistance_ohm_cm: electrical[2].exp(),
        electrode_resistance_ohm_per_cm: given.unwrap_or_else(|| electrical[3].exp()),
        length_cm: strip.length_cm,
        coupling: CurvaturePerLineCharge(1.0),
        relaxation_rate_per_s,
    }
}

/// Phases 1 and 2: the box, the starts, the best of the searches.
fn identify_electrical(input: &DistributedInput, readings: &Readings) -> Fitted {
    let problem = Problem::electrical(input, readings);
    let coarse_readings = readings.thinned();
    let coarse = Problem::electrical(input, &coarse_readings);
    let mut starts: Vec<(f64, Electrical)> = starts(input, readings)
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
fn starts(input: &DistributedInput, readings: &Readings) -> Vec<Electrical> {
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
                if given.is_none() {
                    start.push(along.ln());
                }
                starts.push(start);
            }
        }
    }
    starts
}
