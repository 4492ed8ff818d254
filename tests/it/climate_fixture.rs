//! Made-up sensors for the golden of the climate page.

use ieap::domain::{
    ClimateAssessment, ClimateQuantity, Exposure, Issue, RunClimate, SensorPair, SensorSummary,
};
use ieap::report::Input;

use crate::report_fixture::input;

/// A campaign of nine runs with two sensors on a bench, one of them 2 h ahead, and a third that is not used.
pub fn climate_input() -> Input {
    let mut input = input(&["CNaf"], 1);
    input.climate = ClimateAssessment {
        sensors: vec![
            sensor("10173910", ClimateQuantity::RelativeHumidity, 45.0, None),
            sensor("lab/2", ClimateQuantity::RelativeHumidity, 48.2, None),
            sensor("10173910", ClimateQuantity::Temperature, 21.0, None),
            sensor(
                "copy",
                ClimateQuantity::RelativeHumidity,
                0.0,
                Some("column RH is a copy of T"),
            ),
        ],
        pairs: vec![SensorPair {
            first: "10173910".into(),
            second: "lab/2".into(),
            quantity: ClimateQuantity::RelativeHumidity,
            hours: 54.33,
            bias: -2.0,
            standard_deviation: 8.5,
            allowed: 3.0,
            accuracies_are_stated: false,
            clock_ahead_h: Some(2.0),
            put_right: Some((-3.2, 0.46)),
        }],
        exposures: vec![Exposure {
            sample: "CNaf-01".into(),
            above_percent: 60.0,
            from: "2026-11-01T00:00:00Z".into(),
            to: "2026-11-01T10:00:00Z".into(),
            sensors: vec!["10173910".into()],
            above_h: 1.25,
            covered_h: 7.0,
            uncovered_h: 2.0,
            elsewhere_h: 1.0,
            reason: None,
        }],
        issues: vec![Issue::warning("clock-offset", "the clock of lab is 2 h ahead").at("lab, 10173910")],
    };
    input.run_spans_s = vec![(1_793_491_200.0, 1_793_494_800.0)];
    let run = &mut input.runs[6];
    run.climate = vec![RunClimate {
        sensor: "10173910".into(),
        quantity: ClimateQuantity::RelativeHumidity,
        chosen: true,
        readings: 61,
        mean: 45.123,
        standard_deviation: Some(0.5),
        drift_per_h: Some(-0.25),
        largest_deviation: 4.0,
        largest_gap_s: 60.0,
        accuracy: Some(2.5),
    }];
    let left = "the relative humidity left the tolerance of ±3 % while the run went on";
    run.issues
        .push(Issue::warning("climate-left-tolerance", left).at("relative_humidity_percent"));
    input
}

fn sensor(name: &str, quantity: ClimateQuantity, mean: f64, not_used: Option<&str>) -> SensorSummary {
    let times: Vec<f64> = (0..50).map(|k| 1_793_480_000.0 + 600.0 * f64::from(k)).collect();
    SensorSummary {
        sensor: name.into(),
        place: "bench".into(),
        quantity,
        files: 2,
        readings: 5760,
        from: "2026-10-31T22:01:00Z".into(),
        to: "2026-11-04T22:00:00Z".into(),
        interval_s: 60.0,
        least: mean - 5.0,
        mean,
        most: mean + 5.0,
        clock: "UTC+02:00 (stated in the file)".into(),
        accuracy: Some(2.5),
        correction: Some(-1.2),
        calibration: Some("2026-02, saturated salts".into()),
        not_used: not_used.map(str::to_owned),
        curve: (
            times.clone(),
            times.iter().map(|t| mean + (t / 5000.0).sin()).collect(),
        ),
    }
}
