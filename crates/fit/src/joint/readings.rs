//! One run as a joint fit sees it: both responses, weighted by their noise.

use crate::instrument_noise::ChannelNoises;
use crate::joint::policy::LEAST_NOISE_PART;
use crate::kind_of_noise::{KindEvidence, ToldOfNoise};
use crate::sampled::Sampled;
#[cfg(test)]
use ieap_domain::{Channel, Quantity};
use ieap_domain::{Drive, Estimate};
use ieap_model::LumpedModel;
use ieap_model::lumped::SegmentResponse;
use ieap_numerics::noise::local_scatter;
use ieap_numerics::sums::peak;

use super::compressed::{Compressed, CompressedSpan, Mode};
use super::kinds::{Bins, KindsOfNoise};
use super::noise::{Noise, crowding};
use super::whitening::Whitener;

/// Relative distance of lambda from a charging rate within which the response is taken as a straight line in lambda.
const NEAR: f64 = 1e-2;

/// One channel with its noise.
#[derive(Debug, Clone)]
pub(crate) struct Response {
    pub(crate) sampled: Sampled,
    pub(crate) noise: Noise,
    whitener: Whitener,
    compressed: Compressed,
    /// What the readings tell of every kind of noise, where a fit was asked to tell.
    pub(crate) evidence: Vec<KindEvidence>,
}

impl Response {
    pub(crate) fn new(sampled: Sampled) -> Response {
        let noise = Noise::of(&sampled, LEAST_NOISE_PART * peak(&sampled.values));
        Response::with_noise(sampled, noise)
    }

    /// With the noise beside a fit that has `left` so much of the readings.
    pub(crate) fn beside_fit(sampled: Sampled, left: &[f64]) -> Response {
        let noise = Noise::beside_fit(&sampled, left, LEAST_NOISE_PART * peak(&sampled.values));
        Response::with_noise(sampled, noise)
    }

    /// With a noise found before.
    pub(crate) fn with_noise(sampled: Sampled, noise: Noise) -> Response {
        let whitener = noise.whitener(&sampled);
        let compressed = Compressed::new(&sampled, &whitener);
        Response {
            sampled,
            noise,
            whitener,
            compressed,
            evidence: Vec::new(),
        }
    }

    /// With the kinds of noise that a fit tells which has `left` so much of the readings and searched `columns`, given at times in s;
    /// none where too few readings are left to tell any.
    pub(crate) fn by_kinds(
        sampled: Sampled,
        left: &[f64],
        columns: impl FnOnce(&[f64]) -> Vec<Vec<f64>>,
        known: &ChannelNoises,
    ) -> Option<Response> {
        let least = LEAST_NOISE_PART * peak(&sampled.values);
        let noise = Noise::beside_fit(&sampled, left, least);
        let floor = noise.floor.max(f64::MIN_POSITIVE);
        let scale: Vec<f64> = noise.sd.iter().map(|sd| sd / floor).collect();
        let bins = Bins::of(&sampled);
        let per_scale: Vec<f64> = scale.iter().map(|scale| scale.recip()).collect();
        let per_scale = bins.means(&per_scale);
        let mut columns = columns(&bins.time_s);
        for column in &mut columns {
            column
                .iter_mut()
                .zip(&per_scale)
                .for_each(|(value, per)| *value *= per);
        }
        let left: Vec<f64> = left
            .iter()
            .zip(&scale)
            .map(|(left, scale)| left / scale)
            .collect();
        let kinds = KindsOfNoise::of(&sampled, bins, &left, &columns, least, known)?;
        Some(Response {
            whitener: noise.whitener(&sampled),
            compressed: Compressed::by_means(&sampled, &kinds, &scale),
            evidence: kinds.evidence,
            noise: Noise {
                freedom: kinds.freedom,
                ..noise
            },
            sampled,
        })
    }

    /// The same readings and noise with other values.
    pub(crate) fn with_values(&self, values: Vec<f64>) -> Response {
        let mut sampled = self.sampled.clone();
        sampled.values = values.into();
        sampled.scatter = local_scatter(&sampled.smooth_stretches());
        let compressed = Compressed::new(&sampled, &self.whitener);
        Response {
            sampled,
            compressed,
            ..self.clone()
        }
    }

    /// Independent readings that carry as much as these.
    pub(crate) fn effective_readings(&self) -> f64 {
        self.sampled.len() as f64 / crowding(&self.sampled, &self.noise.autocorrelation)
    }

    /// Measured minus `fitted`, white and in standard deviations.
    pub(crate) fn whitened(&self, fitted: impl Iterator<Item = f64>, out: &mut Vec<f64>) {
        let first = out.len();
        out.extend(self.sampled.values.iter().zip(fitted).map(|(y, f)| y - f));
        self.whiten(&mut out[first..]);
    }

    /// Makes a series over the readings white, in standard deviations.
    pub(crate) fn whiten(&self, series: &mut [f64]) {
        for span in &self.sampled.spans {
            self.whitener.whiten(span, &mut series[span.first..span.end]);
        }
    }
}

/// Responses of one run.
#[derive(Debug, Clone)]
pub(crate) struct RunReadings<'a> {
    pub(crate) drive: &'a Drive,
    pub(crate) area_cm2: f64,
    pub(crate) current: Option<Response>,
    pub(crate) curvature: Option<Response>,
}

/// Offsets of the instruments' zeros.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Offsets {
    pub(crate) current_a: f64,
    pub(crate) curvature_per_cm: f64,
}

impl<'a> RunReadings<'a> {
    /// Readings of the first channel of each quantity that has at least `needed` of them after the step.
    #[cfg(test)]
    pub(crate) fn new(
        channels: &[Channel],
        drive: &'a Drive,
        area_cm2: f64,
        needed: usize,
    ) -> RunReadings<'a> {
        let response = |quantity: Quantity| {
            let channel = channels.iter().find(|channel| channel.quantity == quantity)?;
            let sampled = Sampled::new(channel, drive, quantity == Quantity::Curvature);
            (sampled.after_step() >= needed).then(|| Response::new(sampled))
        };
        RunReadings {
            drive,
            area_cm2,
            current: response(Quantity::Current),
            curvature: response(Quantity::Curvature),
        }
    }

    /// Number of readings.
    pub(crate) fn len(&self) -> usize {
        [&self.current, &self.curvature]
            .into_iter()
            .flatten()
            .map(|response| response.sampled.len())
            .sum()
    }

    /// What the readings of current and curvature tell of every kind of noise.
    pub(crate) fn told_of_noise(self) -> ToldOfNoise {
        let of = |own: Option<Response>| own.map_or(Vec::new(), |response| response.evidence);
        ToldOfNoise {
            current: of(self.current),
            curvature: of(self.curvature),
        }
    }

    /// Memories of the noise of current and curvature that weigh a fit; none of a channel that is not there.
    pub(crate) fn memories(&self) -> [Option<Estimate>; 2] {
        [&self.current, &self.curvature].map(|own| own.as_ref().map(|response| response.noise.memory()))
    }

    /// Weighted residuals over the condensed readings, appended to `out`.
    pub(crate) fn condensed(&self, model: &LumpedModel, offsets: Offsets, out: &mut Vec<f64>) {
        self.condensed_under(self.drive, model, offsets, out);
    }

    /// The same under a drive whose edges lie elsewhere between the same readings.
    pub(crate) fn condensed_under(
        &self,
        drive: &Drive,
        model: &LumpedModel,
        offsets: Offsets,
        out: &mut Vec<f64>,
    ) {
        let responses = model.segment_responses(drive);
        let lag_s = |span: &CompressedSpan, index: usize| span.first_s - drive.segments[index].start_s();
        let mut modes: Vec<Mode> = Vec::with_capacity(8);
        if let Some(current) = &self.current {
            for span in &current.compressed.spans {
                modes.clear();
                let constant = match span.segment {
                    None => drive.baseline_v / model.steady_state_resistance_ohm_cm2,
                    Some(index) => {
                        let response = &responses[index];
                        let pairs = response
                            .rates_per_s
                            .iter()
                            .zip(&response.current_amplitudes_a_per_cm2);
                        modes.extend(pairs.map(|(&rate_per_s, amplitude)| Mode {
                            rate_per_s,
                            amplitude: self.area_cm2 * amplitude,
                        }));
                        modes.iter_mut().for_each(|mode| mode.die(lag_s(span, index)));
                        response.current_constant_a_per_cm2
                    }
                };
                span.residuals(self.area_cm2 * constant + offsets.current_a, &modes, out);
            }
        }
        if let Some(curvature) = &self.curvature {
            let scale = model.charge_to_curvature_per_c_cm * self.area_cm2;
            for span in &curvature.compressed.spans {
                modes.clear();
                if let Some(index) = span.segment {
                    strain_modes(&responses[index], model.relaxation_rate_per_s, scale, &mut modes);
                    modes.iter_mut().for_each(|mode| mode.die(lag_s(span, index)));
                }
                span.residuals(offsets.curvature_per_cm, &modes, out);
            }
        }
    }

    /// Current and curvature of the model at all readings, offsets included.
    pub(crate) fn fitted(&self, model: &LumpedModel, offsets: Offsets) -> [Option<Vec<f64>>; 2] {
        let shifted = |mut values: Vec<f64>, by: f64| {
            values.iter_mut().for_each(|value| *value += by);
            values
        };
        let (drive, area) = (self.drive, self.area_cm2);
        let current = self.current.as_ref().map(|current| {
            shifted(
                model.current_a(drive, area, &current.sampled.time_s),
                offsets.current_a,
            )
        });
        let curvature = self.curvature.as_ref().map(|curvature| {
            shifted(
                model.curvature_per_cm(drive, area, &curvature.sampled.time_s),
                offsets.curvature_per_cm,
            )
        });
        [current, curvature]
    }

    /// Weighted residuals over all readings, appended to `out`.
    pub(crate) fn whole(&self, model: &LumpedModel, offsets: Offsets, out: &mut Vec<f64>) {
        let fitted = self.fitted(model, offsets);
        for (response, fitted) in [&self.current, &self.curvature].into_iter().zip(fitted) {
            if let (Some(response), Some(fitted)) = (response, fitted) {
                response.whitened(fitted.into_iter(), out);
            }
        }
    }
}

/// The strain of a segment as modes: every charging rate, and the rate of relaxation.
fn strain_modes(response: &SegmentResponse, rate_per_s: f64, scale: f64, modes: &mut Vec<Mode>) {
    let mut relaxing = |rate_per_s: f64, amplitude: f64| {
        modes.push(Mode {
            rate_per_s,
            amplitude,
        })
    };
    relaxing(rate_per_s, scale * response.strain_start_c_per_cm2);
    let pairs = response
        .rates_per_s
        .iter()
        .zip(&response.charge_amplitudes_c_per_cm2);
    for (&rate, amplitude) in pairs {
        if rate == 0.0 {
            continue;
        }
        let mut driven = |at: f64, weight: f64| {
            let part = weight * scale * amplitude * rate / (at - rate);
            relaxing(rate, -part);
            relaxing(at, part);
        };
        let apart = (rate_per_s / rate - 1.0) / NEAR;
        if apart.abs() >= 1.0 {
            driven(rate_per_s, 1.0);
        } else {
            driven(rate * (1.0 - NEAR), (1.0 - apart) / 2.0);
            driven(rate * (1.0 + NEAR), (1.0 + apart) / 2.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::branch;
    use ieap_domain::{Level, Segment};
    use std::sync::Arc;

    #[test]
    fn condensed_residuals_are_the_whole_ones_under_any_drive() {
        let mut model = LumpedModel {
            branches: vec![branch(521.4, 0.098), branch(2629.9, 0.13)],
            steady_state_resistance_ohm_cm2: 5660.0,
            charge_to_curvature_per_c_cm: 13.88,
            relaxation_rate_per_s: 3.8e-4,
        };
        let segment = |start_s, level| Segment::at(start_s, level);
        let drive = Drive {
            baseline_v: 0.4,
            segments: vec![
                segment(0.0, Level::Voltage(2.0)),
                segment(400.0, Level::OpenCircuit),
                segment(900.0, Level::Voltage(-1.0)),
            ],
        };
        let time_s: Arc<[f64]> = (0..1300).map(|k| f64::from(k) - 50.0).collect();
        let channels = [
            Channel::new(
                Quantity::Current,
                time_s.clone(),
                model.current_a(&drive, 0.1, &time_s).into(),
            ),
            Channel::new(
                Quantity::Curvature,
                time_s.clone(),
                model.curvature_per_cm(&drive, 0.1, &time_s).into(),
            ),
        ];
        let mut run = RunReadings::new(&channels, &drive, 0.1, 5);
        for (response, sd) in [(&mut run.current, 1e-5), (&mut run.curvature, 1e-3)] {
            let old = response.take().unwrap();
            let noise = Noise {
                sd: vec![sd; old.sampled.len()],
                ..old.noise
            };
            *response = Some(Response::with_noise(old.sampled, noise));
        }
        for (stretch, rate) in [
            (1.0, 3.8e-4),
            (1.2, 0.0),
            (0.9, 0.02),
            (1.1, 1.0 / (521.4 * 0.098)),
        ] {
            model.branches[0].resistance_ohm_cm2 = 521.4 * stretch;
            model.relaxation_rate_per_s = rate;
            let (mut condensed, mut whole) = (Vec::new(), Vec::new());
            let square = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
            run.condensed(&model, Offsets::default(), &mut condensed);
            run.whole(&model, Offsets::default(), &mut whole);
            let (a, b) = (square(&condensed), square(&whole));
            assert!((a - b).abs() < 1e-7 * b + 1e-4, "{stretch} {rate}: {a} {b}");
            // Wherever the edges are between the same readings.
            let mut later = drive.clone();
            for (segment, by_s) in later.segments.iter_mut().zip([-0.4, -0.9, -0.1]) {
                segment.edge.no_later_s += by_s;
            }
            let moved = RunReadings {
                drive: &later,
                ..run.clone()
            };
            condensed.clear();
            whole.clear();
            moved.condensed(&model, Offsets::default(), &mut condensed);
            moved.whole(&model, Offsets::default(), &mut whole);
            let (a, b) = (square(&condensed), square(&whole));
            assert!((a - b).abs() < 1e-7 * b + 1e-4, "{stretch} {rate}: {a} {b}");
        }
    }
}
