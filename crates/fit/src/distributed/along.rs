//! What pages draw along the strip: readings of every place with what the fit says of it, thinned in time.

use std::sync::Arc;

use ieap_domain::{AlongCurve, PlaceSeries, Quantity};

use super::described::Described;
use super::input::DistributedInput;
use super::readings::{Kind, Readings, SeriesGroup};
use super::response;

/// Even places of the simulated voltage: a line through them is smooth on a page.
const PROFILE_PLACES: usize = 25;

/// Voltages and curvatures of all places with the fitted values of their groups, and the voltage between them.
pub(super) fn along(
    input: &DistributedInput,
    readings: &Readings,
    described: &Described,
    fitted: &[(&SeriesGroup, Vec<f64>)],
) -> Vec<AlongCurve> {
    let of = |kind: Kind, quantity: Quantity| {
        let places: Vec<PlaceSeries> = readings
            .groups
            .iter()
            .filter(|group| group.kind == kind)
            .flat_map(|group| places(group, fitted))
            .collect();
        AlongCurve::of(quantity, &places, &readings.edges_s)
    };
    let voltage = of(Kind::Voltage, Quantity::Voltage);
    let profile = voltage
        .as_ref()
        .map(|voltage| profile(input, described, &voltage.time_s));
    [of(Kind::Curvature, Quantity::Curvature), voltage, profile]
        .into_iter()
        .flatten()
        .collect()
}

fn places<'a>(group: &'a SeriesGroup, fitted: &'a [(&SeriesGroup, Vec<f64>)]) -> Vec<PlaceSeries<'a>> {
    let times = group.time_s.len();
    let values = fitted.iter().find(|(of, _)| std::ptr::eq(*of, group));
    (0..group.values.len())
        .map(|place| PlaceSeries {
            position_mm: 10.0 * group.positions_cm[place],
            time_s: &group.time_s,
            measured: &group.values[place],
            fitted: values.map_or(&[], |(_, all)| &all[place * times..(place + 1) * times]),
            noise: group.noise[place],
        })
        .collect()
}

/// Voltage from the clamp to the tip at these times, as the model has it.
fn profile(input: &DistributedInput, described: &Described, time_s: &[f64]) -> AlongCurve {
    let share = |k: usize| k as f64 / (PROFILE_PLACES - 1) as f64;
    let group = SeriesGroup {
        kind: Kind::Voltage,
        positions_cm: (0..PROFILE_PLACES)
            .map(|k| described.model.length_cm * share(k))
            .collect(),
        time_s: Arc::from(time_s),
        values: vec![Arc::from([]); PROFILE_PLACES],
        noise: vec![f64::NAN; PROFILE_PLACES],
    };
    AlongCurve {
        quantity: Quantity::Voltage,
        position_mm: group.positions_cm.iter().map(|cm| 10.0 * cm).collect(),
        fitted: response::predicted(described, input.drive, &group),
        noise: group.noise,
        time_s: time_s.to_vec(),
        measured: Vec::new(),
        frames: time_s.len(),
    }
}
