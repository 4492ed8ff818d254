//! Current and bending of a step at a few times, the same in every run, so that runs can be held against each other.

use ieap_domain::{Channel, Quantity, RunRecord};
use serde::{Deserialize, Serialize};

use super::policy::{GRID, READ_FROM};
use super::{course, first_level};

/// A curve at a time of the grid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TimePoint {
    /// Place on the grid ([`time_s`]).
    pub place: i32,
    /// Value, counted from where it was before the step.
    pub value: f64,
    /// Its variance by the noise of the readings and by where the step lies.
    pub variance: f64,
}

/// What a run says after its step.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StepCurves {
    /// Current per area, A cm⁻²; empty where the area is not known.
    pub current: Vec<TimePoint>,
    /// Curvature, cm⁻¹.
    pub bending: Vec<TimePoint>,
}

/// Time of a place of the grid since the step, s: 1, 2, 5, 10, 20, ...
pub fn time_s(place: i32) -> f64 {
    [1.0, 2.0, 5.0][place.rem_euclid(3) as usize] * 10_f64.powi(place.div_euclid(3))
}

/// The curves of a run over its first level; empty where no voltage is stepped and held, or nothing tells when it was.
pub fn step_curves(run: &RunRecord, channels: &[Channel]) -> StepCurves {
    let of = |quantity| -> Option<Vec<TimePoint>> {
        let channel = channels.iter().find(|channel| channel.is_whole(quantity))?;
        curve(run, channel)
    };
    let per_area = |mut points: Vec<TimePoint>| {
        let area_cm2 = run.area_cm2?;
        for point in &mut points {
            point.value /= area_cm2;
            point.variance /= area_cm2 * area_cm2;
        }
        Some(points)
    };
    StepCurves {
        current: of(Quantity::Current).and_then(per_area).unwrap_or_default(),
        bending: of(Quantity::Curvature).unwrap_or_default(),
    }
}

fn curve(run: &RunRecord, channel: &Channel) -> Option<Vec<TimePoint>> {
    let held = first_level(run.drive.as_ref()?, *channel.time_s.last()?)?;
    let open_s = held.from.open_s();
    if !open_s.is_finite() {
        return None;
    }
    let (course, of_rest) = course(channel, &held)?;
    let step_s = held.from.middle_s();
    let (time_of, _) = channel.included();
    let mut after = time_of.iter().filter(|t| **t > step_s);
    let low = (after.nth(READ_FROM - 1)? - step_s).ln();
    let high = course.ends().1;
    let point = |place| {
        let time_s = time_s(place);
        let is_seen = time_s > open_s && (low..=high).contains(&time_s.ln());
        is_seen.then(|| {
            let local = course.at(time_s.ln());
            let of_step = local.slope * held.from.standard_deviation_s() / time_s;
            TimePoint {
                place,
                value: local.level,
                variance: local.error().powi(2) + of_rest + of_step * of_step,
            }
        })
    };
    Some(GRID.filter_map(point).collect())
}
