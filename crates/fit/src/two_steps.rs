//! The two steps: readings of a run, the circuit from its current, and with that the bending from its curvature.

use ieap_domain::{Drive, Level, Quantity};
use ieap_model::FitModel;

use crate::bending::{self, Bending};
use crate::electrical::{self, Electrical};
use crate::error::FitError;
use crate::options::{FitInput, FitOptions};
use crate::sampled::Sampled;

/// Both steps as far as the channels allow; what is missing says why.
pub(crate) struct Identified {
    pub(crate) current: Result<(Sampled, Electrical), String>,
    pub(crate) curvature: Result<(Sampled, Bending), String>,
    /// The curvature's readings where they could not be fitted, to be drawn all the same.
    pub(crate) unfitted_curvature: Option<Sampled>,
}

/// Readings after the step that the electrical step needs: two more than parameters, and never below five.
pub(crate) fn needed(model: &FitModel) -> usize {
    2 * model.branches + 3
}

/// Readings of the responses that a run has.
pub(crate) struct Readings {
    pub(crate) current: Option<Sampled>,
    pub(crate) curvature: Option<Sampled>,
}

impl Readings {
    /// Sorts the readings by segment, after a look at area and drive.
    pub(crate) fn new(input: &FitInput) -> Result<Readings, FitError> {
        if !(input.area_cm2.is_finite() && input.area_cm2 > 0.0) {
            return Err(FitError::Area {
                found_cm2: input.area_cm2,
            });
        }
        check_drive(input.drive)?;
        let of = |quantity: Quantity| {
            let channel = input
                .channels
                .iter()
                .find(|channel| channel.quantity == quantity)?;
            Some(Sampled::new(
                channel,
                input.drive,
                quantity == Quantity::Curvature,
            ))
        };
        Ok(Readings {
            current: of(Quantity::Current),
            curvature: of(Quantity::Curvature),
        })
    }

    /// Whether there is anything to fit.
    pub(crate) fn check(&self, input: &FitInput, options: &FitOptions) -> Result<(), FitError> {
        let counts = [
            (&self.current, Quantity::Current),
            (&self.curvature, Quantity::Curvature),
        ];
        let counts = counts
            .into_iter()
            .filter_map(|(sampled, quantity)| Some((sampled.as_ref()?.after_step(), quantity)));
        let Some((found, quantity)) = counts.max_by_key(|(count, _)| *count) else {
            let names: Vec<&str> = input
                .channels
                .iter()
                .map(|channel| channel.raw_name.as_str())
                .collect();
            let found = if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            };
            return Err(FitError::NoResponse { found });
        };
        let needed = needed(options.model);
        if found < needed {
            return Err(FitError::TooFewReadings {
                channel: quantity.column(),
                found,
                needed,
                start_s: input.drive.segments[0].start_s(),
                model: options.model.id,
            });
        }
        Ok(())
    }
}

fn check_drive(drive: &Drive) -> Result<(), FitError> {
    let finite = |level: Level| !matches!(level, Level::Voltage(v) if !v.is_finite());
    let mut last_s = f64::NEG_INFINITY;
    for (index, segment) in drive.segments.iter().enumerate() {
        let in_order = segment.start_s().is_finite() && segment.start_s() > last_s;
        if !in_order || !finite(segment.level) {
            return Err(FitError::Drive {
                index,
                start_s: segment.start_s(),
            });
        }
        last_s = segment.start_s();
    }
    if drive.segments.is_empty() || !drive.baseline_v.is_finite() {
        return Err(FitError::Drive {
            index: 0,
            start_s: f64::NAN,
        });
    }
    Ok(())
}

/// The circuit of a run whose drive is one step, found with that step at some place between two readings.
///
/// Shifting the step only rescales the amplitudes of the same exponentials, so the same circuit is known for every other place.
pub(crate) struct OfStep {
    start_s: f64,
    electrical: Electrical,
}

impl OfStep {
    /// From what was found with the step where `drive` has it; none where there are further edges, or where a limit of the
    /// search, which goes with the step, holds a branch.
    pub(crate) fn of(drive: &Drive, identified: &Identified) -> Option<OfStep> {
        let [step] = drive.segments.as_slice() else {
            return None;
        };
        let (_, electrical) = identified.current.as_ref().ok()?;
        let is_free = electrical.at_bound.iter().all(Option::is_none);
        let is_held = step.level != Level::OpenCircuit && !drive.moves();
        (is_held && is_free).then(|| OfStep {
            start_s: step.start_s(),
            electrical: electrical.clone(),
        })
    }

    /// The circuit with the step where `drive` has it.
    fn under(&self, drive: &Drive) -> Electrical {
        let later_s = drive.segments[0].start_s() - self.start_s;
        self.electrical.with_step_later(later_s)
    }
}

/// Both steps of a run under another drive; none where there is nothing to fit.
pub(crate) fn identified(input: &FitInput, options: &FitOptions, drive: &Drive) -> Option<Identified> {
    let input = &FitInput { drive, ..*input };
    let readings = Readings::new(input).ok()?;
    readings.check(input, options).ok()?;
    Some(identify(input, options, readings, None))
}

/// Both steps; where the circuit is known for another place of the `step`, it is not searched again.
pub(crate) fn identify(
    input: &FitInput,
    options: &FitOptions,
    readings: Readings,
    step: Option<&OfStep>,
) -> Identified {
    let needed = needed(options.model);
    let enough = |sampled: &Sampled, name: &str| {
        if sampled.after_step() >= needed {
            return Ok(());
        }
        let found = sampled.after_step();
        Err(format!(
            "the {name} has {found} usable readings after the step, {needed} are needed"
        ))
    };
    let current = readings
        .current
        .ok_or_else(|| "the run has no current channel".to_owned())
        .and_then(|sampled| {
            enough(&sampled, "current")?;
            let search = || {
                let branches = options.model.branches;
                electrical::identify(input.drive, input.area_cm2, &sampled, branches, options.search())
            };
            let electrical = step.map_or_else(search, |step| step.under(input.drive));
            Ok((sampled, electrical))
        });
    let mut unfitted_curvature = None;
    let curvature = readings
        .curvature
        .ok_or_else(|| "the run has no curvature channel".to_owned())
        .and_then(|sampled| {
            let fitted =
                enough(&sampled, "curvature").and_then(|()| bend(input, options, &current, &sampled));
            match fitted {
                Ok(bending) => Ok((sampled, bending)),
                Err(reason) => {
                    unfitted_curvature = Some(sampled);
                    Err(reason)
                }
            }
        });
    Identified {
        current,
        curvature,
        unfitted_curvature,
    }
}

fn bend(
    input: &FitInput,
    options: &FitOptions,
    current: &Result<(Sampled, Electrical), String>,
    sampled: &Sampled,
) -> Result<Bending, String> {
    let (_, electrical) = current
        .as_ref()
        .map_err(|reason| format!("the charge that bends the strip is not known: {reason}"))?;
    if electrical.conductances_a_per_v.is_empty() {
        return Err("the current shows no charge that could bend the strip".to_owned());
    }
    Ok(bending::identify(
        input.drive,
        electrical,
        sampled,
        options.search(),
    ))
}
