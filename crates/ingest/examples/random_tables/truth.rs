//! What was measured: a run with a voltage step, or a climate log.

use ieap_domain::Quantity;

use crate::dice::Dice;
use crate::shapes::{drift, humidity, moment, response, voltage};

/// Microseconds of a second.
pub const SECOND: i64 = 1_000_000;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    /// Across the electrodes, V.
    Voltage,
    /// Into the sample, A.
    Current,
    /// Bending, 1/cm.
    Curvature,
    /// Bending, mm.
    TipDisplacement,
    /// Relative, %.
    Humidity,
    /// °C.
    Temperature,
    /// Of the air, Pa.
    Pressure,
    /// °C.
    DewPoint,
    /// A number that never changes and means nothing here.
    Constant,
    /// Words.
    Remark,
}

impl Meaning {
    /// The quantity a reader may call it; none where it must be kept uninterpreted.
    pub fn quantity(self) -> Option<Quantity> {
        Some(match self {
            Meaning::Voltage => Quantity::Voltage,
            Meaning::Current => Quantity::Current,
            Meaning::Curvature => Quantity::Curvature,
            Meaning::TipDisplacement => Quantity::TipDisplacement,
            Meaning::Humidity => Quantity::RelativeHumidity,
            Meaning::Temperature => Quantity::Temperature,
            Meaning::Pressure => Quantity::Pressure,
            Meaning::DewPoint | Meaning::Constant | Meaning::Remark => return None,
        })
    }
}

/// One column.
#[derive(Debug, Clone)]
pub struct Column {
    /// What it holds.
    pub meaning: Meaning,
    /// Which sensor measured it.
    pub sensor: usize,
    /// One number for each row, canonical unit; none for words.
    pub values: Vec<f64>,
}

/// A measurement.
#[derive(Debug, Clone)]
pub struct Truth {
    /// A climate log and no run.
    pub is_log: bool,
    /// First row, us since 1970 on the local clock.
    pub start_us: i64,
    /// Each row since then, us.
    pub time_us: Vec<i64>,
    /// Between rows, us.
    pub interval_us: i64,
    /// First rows of its parts: more than one where the instrument was started again.
    pub parts: Vec<usize>,
    /// Row of the step within a part.
    pub step_row: usize,
    /// Sensors of a log.
    pub sensors: Vec<&'static str>,
    /// The sensor of each row, where rows of sensors alternate.
    pub sensor_of_row: Option<Vec<usize>>,
    /// Columns.
    pub columns: Vec<Column>,
}

/// Draws a run or a log.
pub fn random(dice: &mut Dice) -> Truth {
    if dice.chance(0.6) { run(dice) } else { log(dice) }
}

fn run(dice: &mut Dice) -> Truth {
    let intervals_ms = [
        10, 20, 50, 100, 200, 250, 500, 1000, 2000, 5000, 10_000, 30_000, 60_000,
    ];
    let interval_us = dice.pick(&intervals_ms) * 1000;
    let each = dice.whole(30, 400) as usize;
    let restarts = dice.chance(0.06);
    let parts = if restarts { vec![0, each] } else { vec![0] };
    let step_row = dice.whole(1, each as i64 / 4) as usize;
    let pause_us = 60 * SECOND * dice.whole(1, 60);
    let jitter = if dice.chance(0.2) { interval_us / 10 } else { 0 };
    let rows = each * parts.len();
    let time_us = (0..rows as i64)
        .map(|row| {
            let late = if row == 0 {
                0
            } else {
                dice.whole(0, jitter) / 1000 * 1000
            };
            row * interval_us + late + if row as usize >= each { pause_us } else { 0 }
        })
        .collect();
    let mut columns = vec![
        column(Meaning::Voltage, voltage(dice, each, step_row, parts.len())),
        column(
            Meaning::Current,
            response(dice, rows, each, step_row, (1e-9, 0.5), true),
        ),
    ];
    if dice.chance(0.25) {
        let values = response(dice, rows, each, step_row, (0.01, 3.0), false);
        columns.push(column(Meaning::Curvature, values));
    } else if dice.chance(0.3) {
        let values = response(dice, rows, each, step_row, (0.02, 10.0), false);
        columns.push(column(Meaning::TipDisplacement, values));
    }
    if dice.chance(0.25) {
        columns.push(column(Meaning::Humidity, humidity(dice, rows)));
        columns.push(column(Meaning::Temperature, drift(dice, rows, (5.0, 60.0), 0.5)));
    }
    Truth {
        is_log: false,
        start_us: moment(dice),
        interval_us,
        time_us,
        parts,
        step_row,
        sensors: vec![""],
        sensor_of_row: None,
        columns: with_more(dice, columns, rows),
    }
}

fn log(dice: &mut Dice) -> Truth {
    let interval_us = dice.pick(&[1, 2, 5, 10, 30, 60, 120, 300, 600, 900, 1800, 3600]) * SECOND;
    let pairs = [
        ["1", "2"],
        ["A", "B"],
        ["Box 1", "Box 2"],
        ["inside", "outside"],
        ["SHT31", "BME280"],
    ];
    let sensors = if dice.chance(0.35) {
        dice.pick(&pairs).to_vec()
    } else {
        vec![""]
    };
    let alternates = sensors.len() == 2 && dice.chance(0.4);
    let rows = dice.whole(20, 300) as usize;
    let same_moment = dice.chance(0.5);
    let time_us: Vec<i64> = (0..rows as i64)
        .map(|row| {
            if alternates && same_moment {
                row / 2 * interval_us
            } else {
                row * interval_us
            }
        })
        .collect();
    let sensor_of_row = alternates.then(|| (0..rows).map(|row| row % 2).collect::<Vec<usize>>());
    let with_pressure = dice.chance(0.2);
    let with_dew_point = dice.chance(0.15);
    let mut columns = Vec::new();
    for sensor in 0..if alternates { 1 } else { sensors.len() } {
        let mut of = |meaning, values| {
            columns.push(Column {
                meaning,
                sensor,
                values,
            })
        };
        let mut temperature = drift(dice, rows, (-5.0, 60.0), 3.0);
        let mut damp = humidity(dice, rows);
        if alternates {
            let (shift, damper) = (dice.number(2.0, 9.0), humidity(dice, rows));
            for row in (1..rows).step_by(2) {
                temperature[row] += shift;
                damp[row] = damper[row];
            }
        }
        if with_dew_point {
            of(Meaning::DewPoint, temperature.iter().map(|t| t - 9.0).collect());
        }
        of(Meaning::Temperature, temperature);
        of(Meaning::Humidity, damp);
        if with_pressure {
            of(Meaning::Pressure, drift(dice, rows, (95_000.0, 103_000.0), 300.0));
        }
    }
    let parts = if !alternates && dice.chance(0.05) {
        vec![0, rows / 2]
    } else {
        vec![0]
    };
    Truth {
        is_log: true,
        start_us: moment(dice),
        interval_us,
        time_us,
        parts,
        step_row: 0,
        sensors,
        sensor_of_row,
        columns: with_more(dice, columns, rows),
    }
}

fn column(meaning: Meaning, values: Vec<f64>) -> Column {
    Column {
        meaning,
        sensor: 0,
        values,
    }
}

fn with_more(dice: &mut Dice, mut columns: Vec<Column>, rows: usize) -> Vec<Column> {
    if dice.chance(0.12) {
        columns.push(column(
            Meaning::Constant,
            vec![dice.pick(&[1.0, 3.0, 10.0, 50.0, 1000.0]); rows],
        ));
    }
    if dice.chance(0.1) {
        columns.push(column(Meaning::Remark, Vec::new()));
    }
    columns
}
