//! One measured quantity of a run with its own sampling.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::thinning::{DRAWN_BUCKETS, drawn_indices};
use super::{AlongStrip, ClimateCurve, Quantity, number_or_null};

/// Readings of one quantity: times and values of equal length, finite, in canonical units.
///
/// Empty cells of a table are left out, so a camera that is slower than the potentiostat has fewer
/// readings; channels sampled together share one `time_s`.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// What is measured.
    pub quantity: Quantity,
    /// The column's name as the file has it.
    pub raw_name: String,
    /// The unit as the file has it; empty where the file names none.
    pub raw_unit: String,
    /// Where along the strip it was measured, mm from the clamp; none for the strip as a whole.
    pub position_mm: Option<f64>,
    /// Time of each reading, s, strictly increasing.
    pub time_s: Arc<[f64]>,
    /// Readings in the canonical unit of `quantity`.
    pub values: Arc<[f64]>,
    /// Indices (increasing) of readings that are no measurement, such as an overload; a fit leaves them out.
    pub excluded: Arc<[u32]>,
    /// Whether an instrument with a clock of its own timed it, whose offset from that of the voltage nobody stated.
    pub own_clock: bool,
    /// What is not known of the zero of the sensor that it is made from; none where that bends no scale.
    pub open_zero: Option<OpenZero>,
}

/// What is not known of the zero of a sensor whose readings are no straight line of what is made of them, as of a displacement that
/// stands for a curvature.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenZero {
    /// How each reading goes with that zero, one standard deviation of it, canonical unit; what all readings have in common is left
    /// out.
    pub error: Arc<[f64]>,
    /// Whether nothing was read at rest: all readings may be off by one value.
    pub is_free: bool,
}

impl Channel {
    /// A channel under its canonical name with nothing excluded.
    pub fn new(quantity: Quantity, time_s: Arc<[f64]>, values: Arc<[f64]>) -> Channel {
        Channel {
            quantity,
            raw_name: quantity.column().to_owned(),
            raw_unit: quantity.unit().to_owned(),
            position_mm: None,
            time_s,
            values,
            excluded: Arc::from([]),
            own_clock: false,
            open_zero: None,
        }
    }

    /// Whether it is a response of the sample: current, bending, or a voltage measured along the strip.
    pub fn is_response(&self) -> bool {
        let along = self.quantity == Quantity::Voltage && self.position_mm.is_some();
        (along || self.quantity.is_response()) && !self.is_empty()
    }

    /// Whether it measures `quantity` of the strip as a whole, and has readings.
    pub fn is_whole(&self, quantity: Quantity) -> bool {
        self.quantity == quantity && self.position_mm.is_none() && !self.is_empty()
    }

    /// Number of readings, the excluded ones counted.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Whether there is no reading at all.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Times and values of the readings that are not excluded.
    pub fn included(&self) -> (Arc<[f64]>, Arc<[f64]>) {
        if self.excluded.is_empty() {
            return (self.time_s.clone(), self.values.clone());
        }
        let keep = |index: &usize| self.excluded.binary_search(&(*index as u32)).is_err();
        let indices: Vec<usize> = (0..self.len()).filter(keep).collect();
        (
            indices.iter().map(|&i| self.time_s[i]).collect(),
            indices.iter().map(|&i| self.values[i]).collect(),
        )
    }

    /// A current density as the current into an active area of `area_cm2`.
    pub fn as_current(&self, area_cm2: f64) -> Channel {
        Channel {
            quantity: Quantity::Current,
            values: self.values.iter().map(|density| density * area_cm2).collect(),
            ..self.clone()
        }
    }

    /// The readings as they are drawn where nothing was fitted: thinned, excluded ones left out.
    pub fn drawn(&self) -> RunCurve {
        let (time_s, values) = self.included();
        let kept = drawn_indices(&time_s, &[&values], 0.0, DRAWN_BUCKETS);
        RunCurve {
            quantity: self.quantity,
            time_s: kept.iter().map(|&i| time_s[i]).collect(),
            measured: kept.iter().map(|&i| values[i]).collect(),
            fitted: Vec::new(),
            residual_sigma: Vec::new(),
            readings: values.len(),
        }
    }

    /// What a table of channels says of this one.
    pub fn summary(&self) -> ChannelSummary {
        ChannelSummary {
            quantity: self.quantity,
            raw_name: self.raw_name.clone(),
            raw_unit: self.raw_unit.clone(),
            position_mm: self.position_mm,
            readings: self.len(),
            excluded: self.excluded.len(),
            first_time_s: self.time_s.first().copied(),
            last_time_s: self.time_s.last().copied(),
            first: self.values.first().copied(),
            last: self.values.last().copied(),
        }
    }
}

/// A channel without its readings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChannelSummary {
    /// What is measured.
    pub quantity: Quantity,
    /// The column's name as the file has it.
    pub raw_name: String,
    /// The unit as the file has it.
    pub raw_unit: String,
    /// Where along the strip it was measured, mm from the clamp; none for the strip as a whole.
    pub position_mm: Option<f64>,
    /// Number of readings, the excluded ones counted.
    pub readings: usize,
    /// How many of them are left out of fits.
    pub excluded: usize,
    /// Time of the first reading, s.
    pub first_time_s: Option<f64>,
    /// Time of the last reading, s.
    pub last_time_s: Option<f64>,
    /// First reading, canonical unit.
    pub first: Option<f64>,
    /// Last reading, canonical unit.
    pub last: Option<f64>,
}

/// A curve as it is drawn: thinned readings with the fitted value and the residual beside each.
///
/// Fits store these, so that figures draw what was computed and never compute.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunCurve {
    /// What is drawn.
    pub quantity: Quantity,
    /// Time of each drawn reading, s.
    pub time_s: Vec<f64>,
    /// Measured values, canonical unit.
    #[serde(deserialize_with = "number_or_null::many")]
    pub measured: Vec<f64>,
    /// Fitted values at the same times; empty where nothing was fitted.
    #[serde(deserialize_with = "number_or_null::many")]
    pub fitted: Vec<f64>,
    /// (measured - fitted) / noise standard deviation at the same times; empty where nothing was fitted.
    #[serde(deserialize_with = "number_or_null::many")]
    pub residual_sigma: Vec<f64>,
    /// Number of readings before thinning.
    pub readings: usize,
}

/// Gives the curves of a run when a page needs them, so that a report never holds all of them at once.
pub trait CurveSource {
    /// Curves of the run with that row id: of its current fit, or thinned readings where there is none.
    ///
    /// # Errors
    /// A message that names the run and what could not be read.
    fn curves(&self, run_id: i64) -> Result<Vec<RunCurve>, String>;

    /// Climate around that run, thinned; empty where no log covers it.
    ///
    /// # Errors
    /// As [`CurveSource::curves`].
    fn climate_curves(&self, _run_id: i64) -> Result<Vec<ClimateCurve>, String> {
        Ok(Vec::new())
    }

    /// What the curves and the climate of that run are read from, as a checksum: as long as it is the same, so are they. None
    /// where that is not known.
    ///
    /// # Errors
    /// As [`CurveSource::curves`].
    fn drawn_from(&self, _run_id: i64) -> Result<Option<String>, String> {
        Ok(None)
    }

    /// What is known along the strip of that run; none where it was not measured at several places.
    ///
    /// # Errors
    /// As [`CurveSource::curves`].
    fn along(&self, _run_id: i64) -> Result<Option<AlongStrip>, String> {
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excluded_readings_are_left_out() {
        let mut channel = Channel::new(
            Quantity::Current,
            Arc::from([0.0, 1.0, 2.0]),
            Arc::from([5.0, 6.0, 7.0]),
        );
        channel.excluded = Arc::from([1]);
        let (time_s, values) = channel.included();
        assert_eq!((&time_s[..], &values[..]), (&[0.0, 2.0][..], &[5.0, 7.0][..]));
        assert_eq!(channel.summary().excluded, 1);
    }
}
