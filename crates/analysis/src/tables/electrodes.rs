//! Readings of the four-point probe: one row a sample and date, with what happened before it.

use super::TableInput;
use crate::probe::{Course, DAY_S, ProbeReading};
use ieap_domain::Estimate;
use ieap_domain::number::fixed;
use ieap_domain::quantiles::NORMAL_95;
use ieap_show::quantities::{HUMIDITY, Quantity, SAMPLE};
use ieap_show::{Sheet, Table, Value};

const DATE: Quantity = Quantity::plain("date", "Date", "date of the reading, UTC");
const RESISTANCE: Quantity = Quantity::new(
    "electrode_resistance_ohm_per_sq",
    "R_e",
    "resistance of both electrodes along the strip",
    "Ω/sq",
);
const FLEXINGS: Quantity = Quantity::plain("flexings", "Flexings", "flexings of the strip so far");
const EVENT: Quantity = Quantity::plain("event", "Before it", "what happened since the reading before");
const REMARK: &str = "R_e is the sum over both faces. Its error is as stated in the table of the probe, or by the scatter of several readings of a day. A crack is a step of the resistance that the scatter of the readings does not explain; it takes ten readings or more.";

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    type Read<'a> = (&'a Course, usize, &'a ProbeReading);
    let readings = input.electrodes.iter().flat_map(|course| {
        let readings = course.series.readings.iter().enumerate();
        readings.map(move |(at, reading)| (course, at, reading))
    });
    Sheet::<Read>::new(
        "electrodes",
        "Resistance of the electrodes along the strip, by the probe",
        1,
    )
    .remarks(REMARK, REMARK)
    .column(SAMPLE, |(course, ..)| course.series.sample.clone())
    .column(DATE, |(.., reading)| date(reading.at_s))
    .column(RESISTANCE, |(.., reading)| {
        let error = reading.error_ohm_per_sq;
        let end = |sign: f64| error.map(|error| reading.ohm_per_sq + sign * NORMAL_95 * error);
        Value::Estimate(Estimate {
            standard_error: error,
            low_95: end(-1.0),
            high_95: end(1.0),
            ..Estimate::determined(reading.ohm_per_sq, 0.0, reading.ohm_per_sq, reading.ohm_per_sq)
        })
    })
    .column(FLEXINGS, |(.., reading)| reading.flexings)
    .column(HUMIDITY, |(.., reading)| reading.humidity_percent)
    .column(EVENT, |(course, at, _)| {
        let crack = course.cracks.iter().find(|(crack, _)| crack == at);
        crack.map(|(_, size)| format!("crack: × {}", fixed(size.exp(), 2)))
    })
    .over(readings)
}

fn date(at_s: f64) -> String {
    let day = jiff::Timestamp::from_second((at_s / DAY_S).floor() as i64 * DAY_S as i64);
    day.map_or_else(|_| String::new(), |day| day.strftime("%Y-%m-%d").to_string())
}
