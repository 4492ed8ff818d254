//! What follows from humidity and temperature together.

use super::covering::Covering;
use crate::analysis::climate::humid_air::{absolute_humidity_g_per_m3, dew_point_c, vapour_pressure_pa};
use crate::analysis::climate::join::interpolated;
use crate::analysis::climate::{Window, statistics};
use crate::domain::{ClimateQuantity, RunClimate};

/// Dew point, vapour pressure and absolute humidity, reading by reading, from one sensor that has both.
pub(super) fn moisture(
    measured: &[(ClimateQuantity, Vec<Covering>)],
    window: Window,
    longest_gap_s: f64,
) -> Vec<RunClimate> {
    let of = |wanted| {
        let found = measured.iter().find(|(quantity, _)| *quantity == wanted);
        found.map_or(&[][..], |(_, covering)| covering)
    };
    let Some(humidity) = of(ClimateQuantity::RelativeHumidity).first() else {
        return Vec::new();
    };
    let temperatures = of(ClimateQuantity::Temperature);
    let same = |other: &&Covering| other.found.sensor == humidity.found.sensor;
    let Some(temperature) = temperatures.iter().find(same).or(temperatures.first()) else {
        return Vec::new();
    };
    let (rh, t) = (&humidity.series, &temperature.series);
    let reach = window.from_s - longest_gap_s..=window.to_s + longest_gap_s;
    let air: Vec<(f64, f64, f64)> = rh
        .times_s
        .iter()
        .zip(&rh.values)
        .filter(|(time, _)| reach.contains(time))
        .filter_map(|(&time, &percent)| {
            let temperature_c = interpolated(&t.times_s, &t.values, time, longest_gap_s)?;
            Some((time, temperature_c, vapour_pressure_pa(temperature_c, percent)))
        })
        .collect();
    let times_s: Vec<f64> = air.iter().map(|(time, _, _)| *time).collect();
    let sensor = if temperature.found.sensor == humidity.found.sensor {
        humidity.found.sensor.clone()
    } else {
        format!(
            "{} with the temperature of {}",
            humidity.found.sensor, temperature.found.sensor
        )
    };
    let mut found = Vec::new();
    for quantity in [
        ClimateQuantity::DewPoint,
        ClimateQuantity::VapourPressure,
        ClimateQuantity::AbsoluteHumidity,
    ] {
        let value = |(_, temperature_c, vapour_pa): &(f64, f64, f64)| match quantity {
            ClimateQuantity::DewPoint => dew_point_c(*vapour_pa),
            ClimateQuantity::VapourPressure => Some(*vapour_pa),
            _ => Some(absolute_humidity_g_per_m3(*temperature_c, *vapour_pa)),
        };
        // Air without water vapour, as a sensor at 0 % shows it, has no dew point.
        let Some(values) = air.iter().map(value).collect::<Option<Vec<f64>>>() else {
            continue;
        };
        if let Ok(statistics) = statistics((&times_s, &values), window, rh.interval_s, longest_gap_s) {
            found.push(statistics.of_run(&sensor, quantity, true, None));
        }
    }
    found
}
