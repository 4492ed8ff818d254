//! The scores of models on the runs of a group: what fits leave, what they predict of later times and of other voltages.

use std::time::Instant;

use crate::domain::thinning::drawn_indices;
use crate::domain::{Channel, ComparedCurve, Drive, ModelScore, Quantity, ResponseScore, RunComparison};
use crate::fit::{Described, FitInput, FitOptions, Left, Noise, describe, placed_drive};
use crate::model::{FitModel, rival_law};
use crate::store::FitTask;

/// Part of the time after the step that a model is fitted to when it predicts the rest.
const EARLIER: f64 = 0.7;
/// Stretches of time in which the drawn readings are chosen.
const DRAWN_STRETCHES: usize = 60;
/// Digits that drawn values keep.
const DRAWN_DIGITS: i32 = 6;
/// The responses that models describe.
const RESPONSES: [Quantity; 2] = [Quantity::Current, Quantity::Curvature];

/// One model on one run.
struct Tried {
    /// The drive with its edges where this model has them.
    drive: Drive,
    whole: Result<Described, String>,
    earlier: Option<Described>,
    seconds: f64,
}

/// The comparison of every run, in the order of `tasks`.
pub(super) fn scored(
    tasks: &[FitTask],
    channels: &[Vec<Channel>],
    models: &[&'static FitModel],
) -> Vec<RunComparison> {
    let inputs: Vec<FitInput> = tasks
        .iter()
        .zip(channels)
        .map(|(task, channels)| FitInput {
            channels,
            drive: &task.drive,
            area_cm2: task.area_cm2,
        })
        .collect();
    let tried: Vec<Vec<Tried>> = inputs
        .iter()
        .map(|input| models.iter().map(|model| try_model(input, model)).collect())
        .collect();
    (0..tasks.len())
        .map(|run| compared(run, tasks, &inputs, &tried, models))
        .collect()
}

fn try_model(input: &FitInput, model: &'static FitModel) -> Tried {
    let begun = Instant::now();
    let options = FitOptions {
        model,
        ..FitOptions::default()
    };
    let drive = placed_drive(input, &options).unwrap_or_else(|_| input.drive.clone());
    let input = &FitInput {
        drive: &drive,
        ..*input
    };
    let whole = if rival_law(model.id).is_some() && !is_bent(input) {
        Err(NOT_BENT.to_owned())
    } else {
        describe(input, model).map_err(|error| error.to_string())
    };
    let seconds = begun.elapsed().as_secs_f64();
    let earlier = before(input, cut_s(input)).and_then(|channels| {
        let input = FitInput {
            channels: &channels,
            ..*input
        };
        describe(&input, model).ok()
    });
    Tried {
        drive: drive.clone(),
        whole,
        earlier,
        seconds,
    }
}

/// Why a rival is not asked about a run.
const NOT_BENT: &str = "the run has no curvature: without bending a rival is the circuit of lumped-2";

fn is_bent(input: &FitInput) -> bool {
    input
        .channels
        .iter()
        .any(|channel| channel.quantity == Quantity::Curvature)
}

/// Where the earlier part of a run ends, s.
fn cut_s(input: &FitInput) -> f64 {
    let step_s = input
        .drive
        .segments
        .first()
        .map_or(0.0, |segment| segment.start_s());
    let of_responses = input
        .channels
        .iter()
        .filter(|channel| RESPONSES.contains(&channel.quantity));
    let last_s = of_responses
        .filter_map(|channel| channel.time_s.last().copied())
        .fold(step_s, f64::max);
    step_s + EARLIER * (last_s - step_s)
}

/// The responses up to that time; none where nothing is left to predict.
fn before(input: &FitInput, cut_s: f64) -> Option<Vec<Channel>> {
    let of = |quantity: Quantity| input.channels.iter().find(|channel| channel.quantity == quantity);
    let part = |channel: &Channel| {
        let (time_s, values) = channel.included();
        let kept = time_s.partition_point(|&t| t <= cut_s);
        (kept < time_s.len())
            .then(|| Channel::new(channel.quantity, time_s[..kept].into(), values[..kept].into()))
    };
    let parts: Vec<Channel> = RESPONSES.into_iter().filter_map(of).filter_map(part).collect();
    (!parts.is_empty()).then_some(parts)
}

/// The comparison of one run.
fn compared(
    run: usize,
    tasks: &[FitTask],
    inputs: &[FitInput],
    tried: &[Vec<Tried>],
    models: &[&'static FitModel],
) -> RunComparison {
    let responses: Vec<Response> = RESPONSES
        .into_iter()
        .filter_map(|quantity| Response::of(quantity, &inputs[run], &tried[run]))
        .collect();
    let beside = neighbours(run, inputs);
    let scores = models.iter().enumerate().map(|(place, model)| {
        let own = &tried[run][place];
        let score = |response: &Response| response.score(run, place, inputs, tried, &beside);
        let responses_scored: Vec<ResponseScore> = responses.iter().filter_map(score).collect();
        let missing = match &own.whole {
            Err(why) => Some(why.clone()),
            // Where no bending was measured none is missing.
            Ok(described) => described.no_bending.clone().filter(|_| is_bent(&inputs[run])),
        };
        ModelScore {
            model: model.id.to_owned(),
            version: model.version,
            parameters: own.whole.as_ref().map_or(0, Described::searched),
            bic: own
                .whole
                .as_ref()
                .ok()
                .and_then(|described| bic(described, &responses)),
            responses: responses_scored,
            missing,
            seconds: own.seconds,
        }
    });
    RunComparison {
        run: tasks[run].path.clone(),
        models: scores.collect(),
        curves: responses
            .iter()
            .map(|response| response.curve(&inputs[run], &tried[run]))
            .collect(),
    }
}

/// Runs at the nearest lower and the nearest higher voltage with their weights: what lies between is interpolated, what
/// lies beyond is taken from the nearest.
fn neighbours(run: usize, inputs: &[FitInput]) -> Vec<(usize, f64)> {
    let volts = |at: usize| inputs[at].drive.nominal_step_v();
    let own = volts(run);
    // Levels of a source are set to 10 mV.
    let is_other = |at: &usize| (volts(*at) - own).abs() > 0.01;
    let below = (0..inputs.len()).filter(is_other).filter(|&at| volts(at) < own);
    let above = (0..inputs.len()).filter(is_other).filter(|&at| volts(at) > own);
    let below = below.max_by(|&a, &b| volts(a).total_cmp(&volts(b)));
    let above = above.min_by(|&a, &b| volts(a).total_cmp(&volts(b)));
    match (below, above) {
        (Some(low), Some(high)) => {
            let share = (own - volts(low)) / (volts(high) - volts(low));
            vec![(low, 1.0 - share), (high, share)]
        }
        (Some(only), None) | (None, Some(only)) => vec![(only, 1.0)],
        (None, None) => Vec::new(),
    }
}

/// One measured response of a run, with the noise that all models are judged by.
struct Response {
    quantity: Quantity,
    time_s: Vec<f64>,
    values: Vec<f64>,
    noise: Noise,
    cut_s: f64,
}

impl Response {
    /// None where it was not measured, or no model describes it.
    fn of(quantity: Quantity, input: &FitInput, tried: &[Tried]) -> Option<Response> {
        let channel = input
            .channels
            .iter()
            .find(|channel| channel.quantity == quantity)?;
        let described = tried.iter().filter_map(|tried| tried.whole.as_ref().ok());
        let noises = described
            .filter_map(|described| left(described, quantity))
            .map(Left::noise);
        // The least: what one model shows not to be noise is none for the others.
        let noise = noises.min_by(|a, b| a.standard_deviation.total_cmp(&b.standard_deviation))?;
        let (time_s, values) = channel.included();
        let readings = time_s
            .iter()
            .zip(values.iter())
            .filter(|(t, y)| t.is_finite() && y.is_finite());
        let (time_s, values) = readings.map(|(t, y)| (*t, *y)).unzip();
        (noise.standard_deviation > 0.0).then_some(Response {
            quantity,
            time_s,
            values,
            noise,
            cut_s: cut_s(input),
        })
    }

    fn score(
        &self,
        run: usize,
        place: usize,
        inputs: &[FitInput],
        tried: &[Vec<Tried>],
        beside: &[(usize, f64)],
    ) -> Option<ResponseScore> {
        let own = &tried[run][place];
        let found = left(own.whole.as_ref().ok()?, self.quantity)?;
        let input = &inputs[run];
        let unit = self.noise.standard_deviation;
        let predict = |described: &Described| {
            described.predict(self.quantity, &own.drive, input.area_cm2, &self.time_s)
        };
        let later = own
            .earlier
            .as_ref()
            .and_then(predict)
            .and_then(|predicted| self.rms_after(self.cut_s, &predicted));
        let others = || {
            let parts: Option<Vec<(Vec<f64>, f64)>> = beside
                .iter()
                .map(|&(at, weight)| Some((predict(tried[at][place].whole.as_ref().ok()?)?, weight)))
                .collect();
            let parts = parts.filter(|parts| !parts.is_empty())?;
            let mixed = |k: usize| parts.iter().map(|(part, weight)| weight * part[k]).sum();
            let predicted: Vec<f64> = (0..self.time_s.len()).map(mixed).collect();
            self.rms_after(first_s(input.drive), &predicted)
        };
        Some(ResponseScore {
            quantity: self.quantity,
            readings: found.readings,
            leaves: (found.square / found.readings.max(1) as f64).sqrt() / unit,
            later: later.map(|rms| rms / unit),
            other_voltages: others().map(|rms| rms / unit),
        })
    }

    /// Root mean square of measured minus predicted after `from_s`; none where there is no reading.
    fn rms_after(&self, from_s: f64, predicted: &[f64]) -> Option<f64> {
        let first = self.time_s.partition_point(|&t| t <= from_s);
        let apart = self.values[first..]
            .iter()
            .zip(&predicted[first..])
            .map(|(y, f)| (y - f).powi(2));
        let count = self.values.len() - first;
        (count > 0)
            .then(|| (apart.sum::<f64>() / count as f64).sqrt())
            .filter(|rms| rms.is_finite())
    }

    fn curve(&self, input: &FitInput, tried: &[Tried]) -> ComparedCurve {
        let all: Vec<Vec<f64>> = tried
            .iter()
            .map(|tried| {
                let described = tried.whole.as_ref().ok();
                let fitted = described.and_then(|described| {
                    described.predict(self.quantity, &tried.drive, input.area_cm2, &self.time_s)
                });
                fitted.unwrap_or_default()
            })
            .collect();
        let mut series: Vec<&[f64]> = vec![&self.values];
        series.extend(all.iter().find(|fitted| !fitted.is_empty()).map(Vec::as_slice));
        let drawn = drawn_indices(&self.time_s, &series, first_s(input.drive), DRAWN_STRETCHES);
        let at = |column: &[f64]| -> Vec<f64> {
            drawn
                .iter()
                .filter_map(|&k| column.get(k).copied())
                .map(shortened)
                .collect()
        };
        ComparedCurve {
            quantity: self.quantity,
            noise: self.noise.standard_deviation,
            time_s: at(&self.time_s),
            measured: at(&self.values),
            fitted: all.iter().map(|fitted| at(fitted)).collect(),
        }
    }
}

fn first_s(drive: &Drive) -> f64 {
    drive.segments.first().map_or(0.0, |segment| segment.start_s())
}

fn left(described: &Described, quantity: Quantity) -> Option<&Left> {
    described.left.iter().find(|left| left.quantity == quantity)
}

/// `-2 ln L + k ln n` for noise of known size and memory, n in independent readings; none where a measured response is
/// not described.
fn bic(described: &Described, responses: &[Response]) -> Option<f64> {
    let (mut misfit, mut independent) = (0.0, 0.0);
    for response in responses {
        let found = left(described, response.quantity)?;
        let memory = response.noise.memory.max(1.0);
        misfit += found.square / (response.noise.standard_deviation.powi(2) * memory);
        independent += found.readings as f64 / memory;
    }
    let bic = misfit + described.searched() as f64 * independent.max(2.0).ln();
    (!responses.is_empty() && bic.is_finite()).then_some(bic)
}

/// A number with the digits that a drawing needs.
fn shortened(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let scale = 10f64.powi(DRAWN_DIGITS - 1 - value.abs().log10().floor() as i32);
    let short = (value * scale).round() / scale;
    if short.is_finite() { short } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawn_values_keep_six_digits() {
        assert_eq!(shortened(1.234_567_89), 1.234_57);
        assert_eq!(shortened(-1.234_567_89e-7), -1.234_57e-7);
        assert_eq!(shortened(0.0), 0.0);
    }

    #[test]
    fn a_voltage_is_predicted_from_those_about_it() {
        let drives = [1.0, 2.0, 2.5, 2.5].map(Drive::step);
        let inputs: Vec<FitInput> = drives
            .iter()
            .map(|drive| FitInput {
                channels: &[],
                drive,
                area_cm2: 0.1,
            })
            .collect();
        let between = neighbours(1, &inputs);
        assert_eq!((between[0].0, between[1].0), (0, 2));
        assert!((between[0].1 - 1.0 / 3.0).abs() < 1e-12 && (between[1].1 - 2.0 / 3.0).abs() < 1e-12);
        assert_eq!(neighbours(0, &inputs), [(1, 1.0)]);
        assert_eq!(neighbours(3, &inputs), [(1, 1.0)], "a repeat is no other voltage");
        assert!(neighbours(0, &inputs[..1]).is_empty());
    }
}
