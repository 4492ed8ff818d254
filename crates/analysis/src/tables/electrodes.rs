//! Readings of the four-point probe: one row a sample and date, with what happened before it.

use super::TableInput;
use crate::probe::{Course, DAY_S};
use ieap_domain::quantiles::NORMAL_95;
use ieap_show::{Cell, Column, Content, Measured, Row, Table};

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    Table {
        title: "Resistance of the electrodes along the strip, by the probe".to_owned(),
        columns: vec![
            Column::plain("sample", "Sample", "sample"),
            Column::plain("date", "Date", "date of the reading, UTC"),
            Column::of(
                "electrode_resistance_ohm_per_sq",
                "R_e",
                "resistance of both electrodes along the strip",
                "Ω/sq",
            ),
            Column::plain("flexings", "Flexings", "flexings of the strip so far"),
            Column::of("relative_humidity_percent", "RH", "relative humidity", "%"),
            Column::plain("event", "Before it", "what happened since the reading before"),
        ],
        stub: 1,
        rows: input.electrodes.iter().flat_map(rows).collect(),
        remarks: vec![
            "R_e is the sum over both faces. Its error is as stated in the table of the probe, or by the scatter of several readings of a day. A crack is a step of the resistance that the scatter of the readings does not explain; it takes ten readings or more.".to_owned(),
        ],
        ..Table::default()
    }
}

fn rows(course: &Course) -> Vec<Row> {
    let sample = &course.series.sample;
    let row = |(at, reading): (usize, &crate::probe::ProbeReading)| {
        let error = reading.error_ohm_per_sq;
        let end = |sign: f64| error.map(|error| reading.ohm_per_sq + sign * NORMAL_95 * error);
        let resistance = Content::Measured(Measured {
            value: reading.ohm_per_sq,
            standard_error: error,
            low_95: end(-1.0),
            high_95: end(1.0),
            pooled: None,
        });
        let crack = course.cracks.iter().find(|(crack, _)| *crack == at);
        let event = crack.map(|(_, size)| format!("crack: × {:.2}", size.exp()));
        let date = date(reading.at_s);
        Row {
            label: format!("{sample}, {date}"),
            cells: vec![
                Cell::text(Some(sample.clone()), Vec::new()),
                Cell::text(Some(date), Vec::new()),
                Cell::new(resistance, Vec::new()),
                Cell::exact(reading.flexings, Vec::new()),
                Cell::exact(reading.humidity_percent, Vec::new()),
                Cell::text(event, Vec::new()),
            ],
        }
    };
    course.series.readings.iter().enumerate().map(row).collect()
}

fn date(at_s: f64) -> String {
    let day = jiff::Timestamp::from_second((at_s / DAY_S).floor() as i64 * DAY_S as i64);
    day.map_or_else(|_| String::new(), |day| day.strftime("%Y-%m-%d").to_string())
}
