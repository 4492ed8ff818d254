//! The clock of the samples where the printed time has too few digits: row number times sample interval.
//!
//! The printed column is kept under its own name, as the file has it.

use super::assemble::Raw;
use super::cells::CellColumn;
use super::error::quoted;
use crate::formats::policy::SAME_TIME_SHARE;
use crate::text::header::{Header, Meaning};
use ieap_domain::number::fixed;
use ieap_domain::{Issue, Quantity};

/// What the file says of its sampling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampleClock {
    /// Time between two rows, s.
    pub interval_s: f64,
    /// Name of the interval in the file.
    pub name: &'static str,
    /// Significant digits of the printed time.
    pub digits: i32,
    /// Share of the time by which the printed column may run wrong beside its rounding.
    pub drift: f64,
}

/// Times the table by row number, where the printed time in column `index` repeats or cannot resolve the interval
/// and both clocks agree. Returns whether it did.
pub fn rebuild(raw: &mut Raw, index: usize, clock: SampleClock, issues: &mut Vec<Issue>) -> bool {
    let printed = &raw.cells.columns[index].numbers;
    let Some(&first) = printed.first() else {
        return false;
    };
    let is_usable = clock.interval_s.is_finite() && clock.interval_s > 0.0 && first.is_finite();
    let true_s = |row: usize| first + row as f64 * clock.interval_s;
    let apart = |(row, time): (usize, &f64)| (time - true_s(row)).abs();
    let coarse = printed
        .iter()
        .enumerate()
        .any(|at| apart(at) > SAME_TIME_SHARE * clock.interval_s);
    if !coarse || !is_usable {
        return false;
    }
    let agrees = |(row, time): (usize, &f64)| {
        let allowed = rounding(*time, clock.digits) + clock.drift * time.abs() + 1e-9 * time.abs();
        apart((row, time)) <= allowed
    };
    if !printed.iter().enumerate().all(agrees) {
        issues.push(Issue::warning(
            "sample-clock",
            format!(
                "{} is {} s, but the printed times do not follow it; they are used as printed",
                clock.name, clock.interval_s
            ),
        ));
        return false;
    }
    let largest = printed.iter().enumerate().map(apart).fold(0.0, f64::max);
    let name = quoted(&raw.headers[index].raw_name);
    issues.push(Issue::note(
        "time-rebuilt",
        format!(
            "column {name} has too few digits to time the rows; they are timed by row number times {} ({} s), up to \
             {} s beside the printed time, which is kept",
            clock.name,
            clock.interval_s,
            fixed(largest, 3)
        ),
    ));
    replace(raw, index, clock, first);
    true
}

/// Half a unit of the last of `digits` significant digits.
fn rounding(value: f64, digits: i32) -> f64 {
    if value == 0.0 {
        0.0
    } else {
        0.5 * 10f64.powi(value.abs().log10().floor() as i32 + 1 - digits)
    }
}

fn replace(raw: &mut Raw, index: usize, clock: SampleClock, first: f64) {
    let rows = raw.cells.rows();
    let numbers = (0..rows)
        .map(|row| first + row as f64 * clock.interval_s)
        .collect();
    raw.headers[index].meaning = Meaning::Other;
    raw.printed_time = Some(raw.headers[index].raw_name.clone());
    let name = format!("row number x {}", clock.name);
    let time = Header {
        raw_name: name,
        ..Header::with_unit("time", "s")
    };
    debug_assert_eq!(time.meaning.quantity(), Some(Quantity::Time));
    raw.headers.push(time);
    raw.cells.columns.push(CellColumn {
        numbers,
        filled: rows,
        ..CellColumn::default()
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::cells::CellTable;
    use crate::text::Cell;

    fn raw(printed: &[f64]) -> Raw {
        let mut cells = CellTable::new(1, &[false], 0);
        for (row, &time) in printed.iter().enumerate() {
            cells.columns[0].push(row + 2, Cell::Number(time), String::new);
            cells.end_row(row + 2, 1);
        }
        Raw::of_instrument(String::new(), vec![Header::parse("Time/sec")], cells)
    }

    fn clock(drift: f64) -> SampleClock {
        SampleClock {
            interval_s: 0.1,
            name: "Sample Interval (s)",
            digits: 4,
            drift,
        }
    }

    /// Times of 0.1 s steps printed with four digits.
    fn printed(rows: usize) -> Vec<f64> {
        let text = |row: usize| format!("{:.3e}", (row + 1) as f64 * 0.1);
        (0..rows).map(|row| text(row).parse().unwrap()).collect()
    }

    #[test]
    fn a_printed_clock_without_enough_digits_is_rebuilt() {
        let mut raw = raw(&printed(20_000));
        let mut issues = Vec::new();
        assert!(rebuild(&mut raw, 0, clock(0.0), &mut issues));
        let time = &raw.cells.columns[1].numbers;
        assert!((time[19_999] - 2000.0).abs() < 1e-9 && time.windows(2).all(|pair| pair[1] > pair[0]));
        assert_eq!(
            (issues[0].code.as_str(), raw.headers[0].meaning.quantity()),
            ("time-rebuilt", None)
        );
    }

    #[test]
    fn a_good_clock_and_another_interval_stay_as_they_are() {
        assert!(!rebuild(&mut raw(&printed(50)), 0, clock(0.0), &mut Vec::new()));
        let doubled: Vec<f64> = printed(20_000).iter().map(|time| 2.0 * time).collect();
        let mut issues = Vec::new();
        assert!(!rebuild(&mut raw(&doubled), 0, clock(0.01), &mut issues));
        assert_eq!(issues[0].code, "sample-clock");
    }
}
