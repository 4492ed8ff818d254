//! The charge that a circuit stores over a run, in the forms in which laws of bending ask for it.

use ieap_domain::Drive;

use crate::lumped::{LumpedModel, SegmentResponse};

/// Charge of a sample beyond that at rest, at given times, in closed form segment by segment.
#[derive(Debug, Clone)]
pub struct ChargeCourse {
    segments: Vec<SegmentResponse>,
    resting_c_per_cm2: f64,
    area_cm2: f64,
    /// Segment and time since its start, s; none before the first.
    places: Vec<Option<(usize, f64)>>,
    /// Start of the first segment, s.
    first_s: f64,
}

impl ChargeCourse {
    /// The charge of `circuit` (whose coupling and relaxation are not looked at) under `drive`, for a sample of
    /// `area_cm2`, at `time_s` in any order.
    pub fn new(circuit: &LumpedModel, drive: &Drive, area_cm2: f64, time_s: &[f64]) -> ChargeCourse {
        let segments = circuit.segment_responses(drive);
        let place = |&t: &f64| {
            let after = segments.partition_point(|segment| segment.start_s <= t);
            after
                .checked_sub(1)
                .map(|index| (index, t - segments[index].start_s))
        };
        ChargeCourse {
            resting_c_per_cm2: drive.baseline_v * circuit.total_capacitance_f_per_cm2(),
            area_cm2,
            places: time_s.iter().map(place).collect(),
            first_s: segments.first().map_or(0.0, |segment| segment.start_s),
            segments,
        }
    }

    /// Number of times.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there is no time.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Charge q beyond that at rest, C.
    pub fn charge_c(&self) -> Vec<f64> {
        self.each(|index, elapsed_s| {
            self.segments[index].charge_c_per_cm2(elapsed_s) - self.resting_c_per_cm2
        })
    }

    /// What of the charge a spring still feels that relaxes at `rate_per_s` (14), C: `q_S' = q' - rate q_S`.
    pub fn sprung_c(&self, rate_per_s: f64) -> Vec<f64> {
        let mut segments = self.segments.clone();
        let mut strain = 0.0;
        for index in 0..segments.len() {
            segments[index].strain_start_c_per_cm2 = strain;
            if let Some(next_s) = segments.get(index + 1).map(|next| next.start_s) {
                let lasting_s = next_s - segments[index].start_s;
                strain = segments[index].strain_c_per_cm2(lasting_s, rate_per_s);
            }
        }
        self.each(|index, elapsed_s| segments[index].strain_c_per_cm2(elapsed_s, rate_per_s))
    }

    /// Integral of the charge over time since the first segment began, C s.
    pub fn integral_c_s(&self) -> Vec<f64> {
        let mut starts = Vec::with_capacity(self.segments.len());
        let mut sum = 0.0;
        for (index, segment) in self.segments.iter().enumerate() {
            starts.push(sum);
            if let Some(next) = self.segments.get(index + 1) {
                sum += self.gathered(segment, next.start_s - segment.start_s);
            }
        }
        self.each(|index, elapsed_s| starts[index] + self.gathered(&self.segments[index], elapsed_s))
    }

    /// Time since the first segment began, s; none before.
    pub fn elapsed_s(&self) -> Vec<Option<f64>> {
        let since =
            |(index, elapsed_s): (usize, f64)| self.segments[index].start_s - self.first_s + elapsed_s;
        self.places.iter().map(|place| place.map(since)).collect()
    }

    /// Integral over a segment from its start, C s/cm2: of the charge at its start and of what every mode brings.
    fn gathered(&self, segment: &SegmentResponse, elapsed_s: f64) -> f64 {
        let modes = segment
            .rates_per_s
            .iter()
            .zip(&segment.charge_amplitudes_c_per_cm2);
        let brought = |(&rate, amplitude): (&f64, &f64)| match rate {
            0.0 => 0.0,
            _ => amplitude * (-(-rate * elapsed_s).exp_m1() / rate - elapsed_s),
        };
        (segment.charge_start_c_per_cm2 - self.resting_c_per_cm2) * elapsed_s
            + modes.map(brought).sum::<f64>()
    }

    fn each(&self, areal: impl Fn(usize, f64) -> f64) -> Vec<f64> {
        let at = |place: &Option<(usize, f64)>| {
            place.map_or(0.0, |(index, elapsed_s)| self.area_cm2 * areal(index, elapsed_s))
        };
        self.places.iter().map(at).collect()
    }
}
