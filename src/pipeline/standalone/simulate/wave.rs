//! A sine or a chirp as the drive of a simulated run.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::wrong::{Wrong, above_zero};
use crate::domain::Drive;

/// Steps in a period of the staircase under which effects are simulated: a reading lies within a step that is 0.3 % of the
/// amplitude off at most. Without effects the differential equations are solved under the wave itself.
const STEPS_IN_PERIOD: f64 = 1000.0;

/// A sine of one frequency, or one whose frequency grows or falls evenly on a logarithmic scale to `to_hz` at its end. It
/// starts at time zero, rising from the offset, and ends with the offset held.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Wave {
    /// Height above the offset, V.
    pub amplitude_v: f64,
    /// Frequency, at the start of a chirp, Hz.
    pub frequency_hz: f64,
    /// Frequency at the end of a chirp, Hz; none: a sine.
    pub to_hz: Option<f64>,
    /// Voltage about which it swings, V.
    #[serde(default)]
    pub offset_v: f64,
    /// How long it lasts, s.
    pub lasting_s: f64,
}

impl Wave {
    pub(super) fn check(&self, place: &str) -> Result<(), Wrong> {
        let sizes = [
            self.amplitude_v,
            self.frequency_hz,
            self.lasting_s,
            self.to_hz.unwrap_or(1.0),
        ];
        let fits = sizes.into_iter().all(above_zero) && self.offset_v.is_finite() && self.periods() <= 1e4;
        let needed = "amplitude_v, frequency_hz, lasting_s and to_hz above 0, and at most 10 000 periods";
        if fits {
            Ok(())
        } else {
            Err(Wrong::new(place, format!("{self:?}"), needed))
        }
    }

    /// Time in which the frequency of a chirp changes by a factor e, s; without bound for a sine.
    fn slow_s(&self) -> f64 {
        self.lasting_s / (self.to_hz.unwrap_or(self.frequency_hz) / self.frequency_hz).ln()
    }

    /// Periods until a time.
    fn periods_until(&self, t: f64) -> f64 {
        let slow_s = self.slow_s();
        if slow_s.is_finite() {
            self.frequency_hz * slow_s * (t / slow_s).exp_m1()
        } else {
            self.frequency_hz * t
        }
    }

    fn periods(&self) -> f64 {
        self.periods_until(self.lasting_s)
    }

    /// Voltage at a time, V.
    pub fn volts(&self, t: f64) -> f64 {
        if (0.0..self.lasting_s).contains(&t) {
            self.offset_v + self.amplitude_v * (TAU * self.periods_until(t)).sin()
        } else {
            self.offset_v
        }
    }

    /// The staircase that stands for it: each step holds what the wave has in its middle.
    pub(super) fn drive(&self, baseline_v: f64) -> Drive {
        let slow_s = self.slow_s();
        let count = (self.periods() * STEPS_IN_PERIOD).ceil();
        // The time at which so many periods are over.
        let at = |step: f64| {
            let periods = self.periods() * step / count;
            if slow_s.is_finite() {
                slow_s * (periods / (self.frequency_hz * slow_s)).ln_1p()
            } else {
                periods / self.frequency_hz
            }
        };
        let step = |step: u32| (at(f64::from(step)), Some(self.volts(at(f64::from(step) + 0.5))));
        let steps = (0..count as u32).map(step);
        Drive::of_levels(baseline_v, steps.chain([(self.lasting_s, Some(self.offset_v))]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chirp_ends_at_its_frequency_and_its_staircase_follows_it() {
        let wave = Wave {
            amplitude_v: 2.0,
            frequency_hz: 0.01,
            to_hz: Some(0.1),
            offset_v: 0.5,
            lasting_s: 300.0,
        };
        let late = (wave.periods_until(300.0) - wave.periods_until(299.9)) / 0.1;
        assert!((late - 0.1).abs() < 1e-4, "{late}");
        let drive = wave.drive(0.0);
        assert!(drive.moves());
        for (start_s, volts) in drive.levels().step_by(97) {
            assert!((volts.unwrap() - wave.volts(start_s)).abs() < 0.01, "{start_s}");
        }
        assert_eq!(drive.levels().last(), Some((300.0, Some(0.5))));
    }
}
