//! What was measured along the strip, sorted by what the model says of it in one go.

use std::sync::Arc;

use ieap_domain::{Channel, Quantity};
use ieap_model::distributed::driven::steps;
use ieap_numerics::noise::scatter_between;

use super::input::DistributedInput;

/// Readings of a thinned series at most: enough for a coarse search.
const THINNED: usize = 40;

/// What a series measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Voltage between the electrodes at a place.
    Voltage,
    /// Current into the strip at the clamp.
    Current,
    /// Curvature at a place.
    Curvature,
}

impl Kind {
    /// As channels call it.
    pub fn quantity(self) -> Quantity {
        match self {
            Kind::Voltage => Quantity::Voltage,
            Kind::Current => Quantity::Current,
            Kind::Curvature => Quantity::Curvature,
        }
    }
}

/// Series of one kind that were sampled together.
#[derive(Debug, Clone)]
pub(super) struct SeriesGroup {
    /// What they measure.
    pub kind: Kind,
    /// Places, cm from the clamp; one entry, not used, for a current.
    pub positions_cm: Vec<f64>,
    /// Times, s.
    pub time_s: Arc<[f64]>,
    /// Values of each place.
    pub values: Vec<Arc<[f64]>>,
    /// Noise of each place, same unit.
    pub noise: Vec<f64>,
}

/// Everything that a run gives.
#[derive(Debug, Clone)]
pub(super) struct Readings {
    /// The groups.
    pub groups: Vec<SeriesGroup>,
    /// Start of the first segment, s.
    pub step_s: f64,
    /// Starts of all segments, s.
    pub edges_s: Vec<f64>,
    /// First change of the voltage, V.
    step_v: f64,
}

impl Readings {
    pub fn new(input: &DistributedInput) -> Readings {
        let step_s = input
            .drive
            .segments
            .first()
            .map_or(0.0, |segment| segment.start_s());
        let step_v = steps(input.drive).first().map_or(1.0, |step| step.1);
        let mut readings = Readings {
            groups: Vec::new(),
            step_s,
            edges_s: input.drive.edges_s(),
            step_v,
        };
        for channel in input.channels {
            let Some((kind, position_cm)) = kind_of(channel, input.strip.length_cm) else {
                continue;
            };
            let (time_s, values) = channel.included();
            readings.add(kind, position_cm, time_s, values);
        }
        readings
    }

    fn add(&mut self, kind: Kind, position_cm: f64, time_s: Arc<[f64]>, values: Arc<[f64]>) {
        let noise = noise_of(&time_s, &values, &self.edges_s);
        let together = self
            .groups
            .iter_mut()
            .find(|g| g.kind == kind && kind != Kind::Current && g.time_s == time_s);
        match together {
            Some(group) => {
                group.positions_cm.push(position_cm);
                group.values.push(values);
                group.noise.push(noise);
            }
            None => self.groups.push(SeriesGroup {
                kind,
                positions_cm: vec![position_cm],
                time_s,
                values: vec![values],
                noise: vec![noise],
            }),
        }
    }

    /// Number of readings of a kind.
    pub fn count(&self, kind: Kind) -> usize {
        self.of(kind)
            .map(|group| group.time_s.len() * group.values.len())
            .sum()
    }

    /// Numbers of readings of voltages, current and curvatures.
    pub fn counts(&self) -> [usize; 3] {
        [Kind::Voltage, Kind::Current, Kind::Curvature].map(|kind| self.count(kind))
    }

    /// Groups of a kind.
    pub fn of(&self, kind: Kind) -> impl Iterator<Item = &SeriesGroup> {
        self.groups.iter().filter(move |group| group.kind == kind)
    }

    /// Time from the first step to the last reading, s.
    pub fn duration_s(&self) -> f64 {
        let last = self.groups.iter().filter_map(|group| group.time_s.last());
        last.fold(1e-9, |longest: f64, &t| longest.max(t - self.step_s))
    }

    /// Conductance of the strip at the first instant, 1/Ohm, where the current was measured.
    pub fn first_conductance(&self) -> Option<f64> {
        let group = self.of(Kind::Current).next()?;
        let first = group.time_s.iter().position(|&t| t >= self.step_s)?;
        Some((group.values[0][first] / self.step_v).abs()).filter(|g| *g > 0.0 && g.is_finite())
    }

    /// The same with the noise's variance of each group multiplied by a factor.
    pub fn less_sure(&self, factors: &[f64]) -> Readings {
        let mut readings = self.clone();
        for (group, factor) in readings.groups.iter_mut().zip(factors) {
            group.noise.iter_mut().for_each(|noise| *noise *= factor.sqrt());
        }
        readings
    }

    /// The same with few readings a series, closer together after the step.
    pub fn thinned(&self) -> Readings {
        let mut thinned = self.clone();
        for group in &mut thinned.groups {
            let kept = spread(&group.time_s, self.step_s);
            group.time_s = kept.iter().map(|&i| group.time_s[i]).collect();
            for values in &mut group.values {
                *values = kept.iter().map(|&i| values[i]).collect();
            }
        }
        thinned
    }
}

/// Indices of about [`THINNED`] readings, half of them even in time, half in the logarithm of the time since the step.
fn spread(time_s: &[f64], step_s: f64) -> Vec<usize> {
    let n = time_s.len();
    let first = time_s.partition_point(|&t| t <= step_s).min(n.saturating_sub(1));
    let half = THINNED / 2;
    let even = (0..half).map(|k| k * (n - 1) / half.max(1));
    let after = (n - first).max(1) as f64;
    let logarithmic = (0..half).map(|k| first + (after.powf(k as f64 / (half - 1) as f64) - 1.0) as usize);
    let mut kept: Vec<usize> = even
        .chain(logarithmic)
        .chain([n - 1])
        .filter(|&i| i < n)
        .collect();
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// What the model can say of a channel, and its place in cm; none for channels it says nothing of.
pub(super) fn kind_of(channel: &Channel, length_cm: f64) -> Option<(Kind, f64)> {
    let position_cm = channel.position_mm.map(|mm| mm / 10.0);
    let inside = position_cm.is_none_or(|s| s <= length_cm * (1.0 + 1e-9));
    if channel.is_empty() || !inside {
        return None;
    }
    match (channel.quantity, position_cm) {
        (Quantity::Voltage, Some(position_cm)) => Some((Kind::Voltage, position_cm)),
        (Quantity::Curvature, Some(position_cm)) => Some((Kind::Curvature, position_cm)),
        (Quantity::Current, None) => Some((Kind::Current, 0.0)),
        _ => None,
    }
}

/// Noise of a series without the model; at least a millionth of its range, which no instrument beats.
fn noise_of(time_s: &[f64], values: &[f64], edges_s: &[f64]) -> f64 {
    let scatter = scatter_between(time_s, values, edges_s).map_or(0.0, |s| s.standard_deviation);
    let (low, high) = values
        .iter()
        .fold((0.0f64, 0.0f64), |(low, high), &v| (low.min(v), high.max(v)));
    scatter.max(1e-6 * (high - low)).max(f64::MIN_POSITIVE)
}
