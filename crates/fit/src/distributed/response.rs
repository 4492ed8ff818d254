//! What the model says of a group of series, for any drive of held voltages: steps add up.

use ieap_domain::Drive;
use ieap_model::distributed::{BrokenStrip, DistributedModel};

use super::described::Described;
use super::readings::{Kind, SeriesGroup, steps};

/// A time after which everything has come to rest, s.
const AT_REST_S: f64 = 1e15;

/// Values of every series of the group, one after the other, each over all times.
pub(super) fn predicted(described: &Described, drive: &Drive, group: &SeriesGroup) -> Vec<f64> {
    let model = &Along::of(described);
    let (places, times) = (group.values.len(), group.time_s.len());
    let mut values = vec![0.0; places * times];
    // At rest at the baseline: the shape there is subtracted, so only voltage and current begin with something.
    if drive.baseline_v != 0.0 && group.kind != Kind::Curvature {
        let rest = unit(model, group, &[AT_REST_S]);
        for (place, row) in values.chunks_exact_mut(times).enumerate() {
            row.fill(drive.baseline_v * rest[place]);
        }
    }
    let factor = match group.kind {
        Kind::Curvature => described.mu_per_c,
        Kind::Voltage | Kind::Current => 1.0,
    };
    for (start_s, change_v) in steps(drive) {
        let change_v = change_v * factor;
        let first = group.time_s.partition_point(|&t| t < start_s);
        let since: Vec<f64> = group.time_s[first..].iter().map(|t| t - start_s).collect();
        if since.is_empty() || change_v == 0.0 {
            continue;
        }
        let response = unit(model, group, &since);
        for (time, at_time) in response.chunks_exact(places).enumerate() {
            for (place, value) in at_time.iter().enumerate() {
                values[place * times + first + time] += change_v * value;
            }
        }
    }
    values
}

/// The strip with even electrodes, or with a break in them.
enum Along {
    Even(DistributedModel),
    Broken(Box<BrokenStrip>),
}

impl Along {
    fn of(described: &Described) -> Along {
        let model = described.model;
        match described.contact_break {
            None => Along::Even(model),
            Some(at) => Along::Broken(Box::new(BrokenStrip::new(&model, at.place_cm, at.factor))),
        }
    }
}

/// Response to a step of 1 V at times since it: for each time, all places.
fn unit(along: &Along, group: &SeriesGroup, since_s: &[f64]) -> Vec<f64> {
    let places = &group.positions_cm;
    match (along, group.kind) {
        (Along::Even(strip), Kind::Voltage) => strip.voltage_v(1.0, places, since_s).values,
        (Along::Even(strip), Kind::Curvature) => strip.curvature_per_cm(1.0, places, since_s).values,
        (Along::Even(strip), Kind::Current) => strip.clamp_current_a(1.0, since_s),
        (Along::Broken(strip), Kind::Voltage) => strip.voltage_v(1.0, places, since_s).values,
        (Along::Broken(strip), Kind::Curvature) => strip.curvature_per_cm(1.0, places, since_s).values,
        (Along::Broken(strip), Kind::Current) => strip.clamp_current_a(1.0, since_s),
    }
}
