//! What a file of a run holds, held against what was read of it.

use ieap_domain::Quantity;
use ieap_ingest::{Reading, RunTable};

use crate::base_run::Row;
use crate::reads::{only_channel, only_table};

/// The columns of a run with the time of each reading.
pub struct Expected {
    rows: usize,
    /// Time of the first and of the last row, s.
    ends_s: (f64, f64),
    columns: Vec<Column>,
}

struct Column {
    quantity: Quantity,
    /// Times and readings in canonical units.
    readings: Vec<(f64, f64)>,
    /// Half of the last digit that the file writes, canonical unit.
    rounding: f64,
}

/// Half of the last digit of a current in mA with five decimals, A.
const FIVE_DECIMALS_OF_MA: f64 = 0.5e-8;
/// What numbers may differ by that are written whole, as a share: what binary fractions and units make of them.
const WHOLE: f64 = 1e-9;

impl Expected {
    /// Voltage and current of rows, where the file's time at the step is `step_at_s`.
    pub fn run(rows: &[Row], step_at_s: f64) -> Expected {
        let time = |row: &Row| row.t + step_at_s;
        let expected = Expected {
            rows: rows.len(),
            ends_s: (time(&rows[0]), time(&rows[rows.len() - 1])),
            columns: Vec::new(),
        };
        expected
            .with(
                Quantity::Voltage,
                0.0,
                rows.iter().map(|row| (time(row), row.volts)),
            )
            .with(
                Quantity::Current,
                FIVE_DECIMALS_OF_MA,
                rows.iter().map(|row| (time(row), row.amperes())),
            )
    }

    /// One more column, written so that readings are off by at most `rounding`.
    pub fn with(
        mut self,
        quantity: Quantity,
        rounding: f64,
        readings: impl Iterator<Item = (f64, f64)>,
    ) -> Expected {
        self.columns.push(Column {
            quantity,
            readings: readings.collect(),
            rounding,
        });
        self
    }

    /// The tip of rows, mm, written with so many decimals.
    pub fn with_tip(self, rows: &[Row], step_at_s: f64, rounding: f64) -> Expected {
        self.with(
            Quantity::TipDisplacement,
            rounding,
            rows.iter().map(|row| (row.t + step_at_s, row.tip_mm)),
        )
    }

    /// The current is written more coarsely: half of its last digit, A.
    pub fn with_currents_to(mut self, rounding: f64) -> Expected {
        self.column(Quantity::Current).rounding = rounding;
        self
    }

    /// The readings of a column at these times are no measurements.
    pub fn without(mut self, quantity: Quantity, times_s: &[f64]) -> Expected {
        self.column(quantity)
            .readings
            .retain(|(time, _)| !times_s.contains(time));
        self
    }

    /// A column lasts longer than voltage and current.
    pub fn lasting_to(mut self, last_s: f64) -> Expected {
        self.ends_s.1 = last_s;
        self
    }

    /// A column has more rows than voltage and current.
    pub fn in_rows(mut self, rows: usize) -> Expected {
        self.rows = rows;
        self
    }

    /// The times of the file are in another unit, or from another zero.
    pub fn timed(mut self, time: impl Fn(f64) -> f64) -> Expected {
        self.ends_s = (time(self.ends_s.0), time(self.ends_s.1));
        for (time_s, _) in self.columns.iter_mut().flat_map(|column| &mut column.readings) {
            *time_s = time(*time_s);
        }
        self
    }

    fn column(&mut self, quantity: Quantity) -> &mut Column {
        self.columns
            .iter_mut()
            .find(|column| column.quantity == quantity)
            .unwrap()
    }

    /// Asserts that the reading is one table with these columns.
    pub fn is_all_of(&self, reading: &Reading) {
        self.is(only_table(reading));
    }

    /// Asserts that a table has these columns.
    pub fn is(&self, table: &RunTable) {
        assert_eq!(table.rows, self.rows, "rows");
        let (first, last) = table.time_first_last_s.expect("a column of times");
        assert_near("time of the first row", 0, first, self.ends_s.0, 0.0);
        assert_near("time of the last row", 0, last, self.ends_s.1, 0.0);
        for column in &self.columns {
            let channel = only_channel(table, column.quantity);
            let (time_s, values) = channel.included();
            let found: Vec<(f64, f64)> = time_s.iter().copied().zip(values.iter().copied()).collect();
            assert_readings(column.quantity.key(), &found, &column.readings, column.rounding);
        }
    }
}

/// Asserts that times and readings are those, up to what was rounded when they were written.
pub fn assert_readings(name: &str, found: &[(f64, f64)], expected: &[(f64, f64)], rounding: f64) {
    assert_eq!(found.len(), expected.len(), "readings of {name}");
    for (index, (one, other)) in found.iter().zip(expected).enumerate() {
        assert_near(&format!("time of {name}, s"), index, one.0, other.0, 0.0);
        assert_near(name, index, one.1, other.1, rounding);
    }
}

fn assert_near(name: &str, index: usize, found: f64, expected: f64, rounding: f64) {
    let allowed = rounding + WHOLE * expected.abs().max(rounding);
    assert!(
        (found - expected).abs() <= allowed,
        "{name}, reading {index}: found {found}, expected {expected}"
    );
}
