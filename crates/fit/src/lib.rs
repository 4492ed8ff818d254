//! Identification of a run with a model, in two steps as in the thesis: the electrical parameters from the
//! current; then, with those fixed, coupling and relaxation rate from the curvature.
//!
//! A fit is a pure function of its input and options, the seed of a random method among them: the same readings
//! give the same bytes.

mod bending;
mod bending_alone;
mod circuit;
mod coupled;
pub mod distributed;
mod electrical;
mod error;
mod estimates;
mod given;
mod group;
pub mod impedance;
mod joint;
mod joint_estimates;
mod noise_again;
mod outcome;
mod parabola;
mod sampled;
mod search;
mod strain;
mod uncertainty;
mod whitened;

use ieap_domain::{Channel, Drive, Fit, Level, Quantity};
use ieap_model::{FitModel, fit_model, fit_models};
use ieap_numerics::global::{Method, method, methods};

pub use error::FitError;
pub use given::{BaseKnowledge, Predict, fit_of_run};
pub use group::{
    Bootstrap, GroupFit, GroupOptions, Intervals, Resampled, Sharing, can_join_group, fit_group, shareable,
};

pub use noise_again::{FoundAgain, NoiseAgain, Pair, Scaled};
pub use whitened::WhitenedChannel;

use bending::Bending;
use electrical::Electrical;
use joint::readings::{Response, RunReadings};
use joint::single::Judged;
use sampled::Sampled;
use search::Search;

#[cfg(test)]
mod any_input;
#[cfg(test)]
mod tests;

/// What one run gives to a fit.
#[derive(Debug, Clone, Copy)]
pub struct FitInput<'a> {
    /// Channels of the run; current and curvature are fitted, the first of each, others are not looked at.
    pub channels: &'a [Channel],
    /// Voltage that drove the run.
    pub drive: &'a Drive,
    /// Active area of the sample, cm2.
    pub area_cm2: f64,
}

/// How to fit.
#[derive(Debug, Clone, Copy)]
pub struct FitOptions {
    /// The model.
    pub model: &'static FitModel,
    /// How minima are searched.
    pub method: &'static dyn Method,
    /// Seed of a method that is random.
    pub seed: u64,
    /// Whether to describe the noise beside its size (memory of higher order, growth with the signal, steps of the
    /// converter), which costs several times the fit itself and changes no estimate.
    pub describes_noise: bool,
    /// How current and curvature are brought together.
    pub steps: Steps,
}

/// How current and curvature are brought together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Steps {
    /// The electrical parameters from the current; then, with those fixed, the rest from the curvature.
    #[default]
    TwoStep,
    /// All parameters from both, each weighted by its noise.
    Simultaneous,
}

/// The model of a run where nothing else is asked for.
const DEFAULT_MODEL: &str = "lumped-2";

impl Default for FitOptions {
    /// Two branches, `lumped-2`, searched by variable projection.
    fn default() -> FitOptions {
        FitOptions {
            model: fit_model(DEFAULT_MODEL).unwrap_or(&fit_models()[0]),
            method: Search::default().method,
            seed: Search::default().seed,
            steps: Steps::TwoStep,
            describes_noise: false,
        }
    }
}

impl FitOptions {
    /// Options for the model of that id.
    ///
    /// # Errors
    /// [`FitError::UnknownModel`] where there is none.
    pub fn for_model(id: &str) -> Result<FitOptions, FitError> {
        let known = || {
            fit_models()
                .iter()
                .map(|model| model.id)
                .collect::<Vec<_>>()
                .join(", ")
        };
        fit_model(id)
            .map(|model| FitOptions {
                model,
                ..FitOptions::default()
            })
            .ok_or_else(|| FitError::UnknownModel {
                found: id.to_owned(),
                known: known(),
            })
    }
}

impl FitOptions {
    /// The same with the method of that id.
    ///
    /// # Errors
    /// [`FitError::UnknownMethod`] where there is none.
    pub fn with_method(self, id: &str) -> Result<FitOptions, FitError> {
        let known = || {
            methods()
                .iter()
                .map(|method| method.id())
                .collect::<Vec<_>>()
                .join(", ")
        };
        match method(id) {
            Some(method) => Ok(FitOptions { method, ..self }),
            None => Err(FitError::UnknownMethod {
                found: id.to_owned(),
                known: known(),
            }),
        }
    }

    fn search(&self) -> Search {
        Search {
            method: self.method,
            seed: self.seed,
        }
    }
}

/// Both steps as far as the channels allow; what is missing says why.
struct Identified {
    current: Result<(Sampled, Electrical), String>,
    curvature: Result<(Sampled, Bending), String>,
    /// The curvature's readings where they could not be fitted, to be drawn all the same.
    unfitted_curvature: Option<Sampled>,
}

/// Fits a run.
///
/// What the data leave open is reported in the fit: an estimate without a value, or with a bound, says why.
///
/// # Errors
/// [`FitError`] where there is nothing to fit: no response channel, too few readings after the step, an area
/// or a drive that is none.
pub fn fit_run(input: &FitInput, options: &FitOptions) -> Result<Fit, FitError> {
    let readings = Readings::new(input)?;
    readings.check(input, options)?;
    let mut identified = identify(input, options, readings);
    if options.steps == Steps::Simultaneous && identified.current.is_ok() {
        let group = fit_group(&[*input], &GroupOptions::sharing_all(options.model))?;
        if let Some(fit) = group.runs.into_iter().next() {
            return Ok(fit);
        }
    }
    if let (Err(why), Some(curvature)) = (&identified.current, &identified.unfitted_curvature)
        && curvature.after_step() >= needed(options.model)
        && let Some(fit) = bending_alone::fit(input, options, curvature.clone(), why)
    {
        return Ok(fit);
    }
    let judged = judge(input, options, &mut identified);
    Ok(outcome::fit(input, options, &identified, judged.as_ref()))
}

/// Fits both responses at once, with intervals by profile likelihood, where the covariance of the two steps would
/// mislead; estimates, curves and residuals are then those of that fit.
fn judge(input: &FitInput, options: &FitOptions, identified: &mut Identified) -> Option<Judged> {
    let (current, electrical) = identified.current.as_mut().ok()?;
    let bending = identified.curvature.as_ref().ok();
    let branches = options.model.branches;
    let settled = parabola::is_settled(electrical, bending.map(|(_, bending)| bending), branches);
    let parabolic = settled && parabola::is_narrow(electrical);
    let even = is_even(current) && bending.is_none_or(|(curvature, _)| is_even(curvature));
    let misfit = misfits(current, electrical.residuals.square)
        || bending.is_some_and(|(curvature, bending)| misfits(curvature, bending.residuals.square));
    if electrical.conductances_a_per_v.is_empty() || parabolic && even || misfit {
        return None;
    }
    if settled
        && even
        && let Some(ends) = parabola::ends(input.drive, current, electrical)
    {
        electrical.ends = ends;
        return None;
    }
    let readings = RunReadings {
        drive: input.drive,
        area_cm2: input.area_cm2,
        current: Some(Response::new(current.clone())),
        curvature: bending.map(|(curvature, _)| Response::new(curvature.clone())),
    };
    joint::single::judge(
        &readings,
        electrical,
        bending.map(|(_, bending)| bending),
        branches,
        parabolic,
    )
}

/// A root mean square of the residuals beyond this multiple of the noise is no chance: the noise is taken from the
/// scatter of neighbours, which finds slow noise (correlation 0.8) up to three times too small.
const MISFIT: f64 = 4.0;

/// Whether the model plainly does not describe the readings. A likelihood that knows noise only would then state
/// intervals far too narrow, about another place than the curve that is drawn; those of the two steps are
/// widened by what the model leaves.
fn misfits(sampled: &Sampled, square: f64) -> bool {
    let rms = (square / sampled.len().max(1) as f64).sqrt();
    sampled
        .scatter
        .as_ref()
        .is_some_and(|noise| rms > MISFIT * noise.standard_deviation)
}

/// Whether the readings follow each other evenly, so that noise by reading order is noise by time.
fn is_even(sampled: &Sampled) -> bool {
    sampled.blocks.iter().all(|(_, block)| block.step_s.is_some())
}

/// Readings after the step that the electrical step needs: two more than parameters, and never below five.
fn needed(model: &FitModel) -> usize {
    2 * model.branches + 3
}

/// Readings of the responses that a run has.
struct Readings {
    current: Option<Sampled>,
    curvature: Option<Sampled>,
}

impl Readings {
    /// Sorts the readings by segment, after a look at area and drive.
    fn new(input: &FitInput) -> Result<Readings, FitError> {
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
    fn check(&self, input: &FitInput, options: &FitOptions) -> Result<(), FitError> {
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
                start_s: input.drive.segments[0].start_s,
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
        let in_order = segment.start_s.is_finite() && segment.start_s > last_s;
        if !in_order || !finite(segment.level) {
            return Err(FitError::Drive {
                index,
                start_s: segment.start_s,
            });
        }
        last_s = segment.start_s;
    }
    if drive.segments.is_empty() || !drive.baseline_v.is_finite() {
        return Err(FitError::Drive {
            index: 0,
            start_s: f64::NAN,
        });
    }
    Ok(())
}

fn identify(input: &FitInput, options: &FitOptions, readings: Readings) -> Identified {
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
            let electrical = electrical::identify(
                input.drive,
                input.area_cm2,
                &sampled,
                options.model.branches,
                options.search(),
            );
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
