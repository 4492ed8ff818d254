//! Rows in the order of time: strictly increasing, with what was left out counted and gaps named.

use super::cells::CellTable;
use super::error::ReadError;
use crate::formats::policy::{BAD_SHARE, GAP_FACTOR};
use ieap_domain::Issue;

/// Times that increase strictly, and the rows they stand in.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeAxis {
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Row of each time in the table.
    pub rows: Vec<u32>,
}

impl TimeAxis {
    /// Numbers of rows in the place of times.
    pub fn of_rows(rows: usize) -> TimeAxis {
        TimeAxis {
            time_s: (0..rows).map(|row| row as f64).collect(),
            rows: (0..rows as u32).collect(),
        }
    }
}

/// Keeps the rows whose time, s, lies after every time before it. `time_s` has one value per row, NaN where
/// there is none.
///
/// # Errors
/// More than a twentieth of the rows repeat a time or go back.
pub fn increasing(
    time_s: &[f64],
    cells: &CellTable,
    column: &str,
    issues: &mut Vec<Issue>,
) -> Result<TimeAxis, ReadError> {
    let is_in_order =
        time_s.iter().all(|time| time.is_finite()) && time_s.windows(2).all(|pair| pair[1] > pair[0]);
    if is_in_order {
        let axis = TimeAxis {
            time_s: time_s.to_vec(),
            rows: (0..time_s.len() as u32).collect(),
        };
        issues.extend(gaps(&axis, cells));
        return Ok(axis);
    }
    let mut axis = TimeAxis {
        time_s: Vec::with_capacity(time_s.len()),
        rows: Vec::with_capacity(time_s.len()),
    };
    let (mut without, mut disordered) = ((0usize, 0usize), (0usize, 0usize, String::new()));
    let mut latest = f64::NEG_INFINITY;
    for (row, &time) in time_s.iter().enumerate() {
        let line = cells.line_of_row[row] as usize;
        if !time.is_finite() {
            without = (without.0 + 1, if without.0 == 0 { line } else { without.1 });
        } else if time > latest {
            latest = time;
            axis.time_s.push(time);
            axis.rows.push(row as u32);
        } else {
            if disordered.0 == 0 {
                disordered = (0, line, format!("{time} s after {latest} s"));
            }
            disordered.0 += 1;
        }
    }
    let rows = time_s.len();
    let (count, line, first) = disordered;
    if count as f64 > BAD_SHARE * rows as f64 {
        return Err(ReadError::TimeOrder {
            line,
            count,
            rows,
            first,
        });
    }
    if count > 0 {
        issues.push(
            Issue::warning(
                "time-not-increasing",
                format!(
                    "{count} of {rows} rows repeat a time or go back in {column}, first {first}; left out"
                ),
            )
            .at(format!("line {line}"))
            .mend("export the time with more digits"),
        );
    }
    if without.0 > 0 {
        issues.push(
            Issue::warning(
                "time-missing",
                format!("{} of {rows} rows have no time; left out", without.0),
            )
            .at(format!("line {}", without.1)),
        );
    }
    issues.extend(gaps(&axis, cells));
    Ok(axis)
}

/// Names the steps that are much longer than their neighbours. Sampling that grows steadily, as a logarithmic
/// one does, shows none.
fn gaps(axis: &TimeAxis, cells: &CellTable) -> Option<Issue> {
    let step = |k: usize| axis.time_s[k + 1] - axis.time_s[k];
    let steps = axis.time_s.len().checked_sub(1)?;
    let is_gap = |&k: &usize| step(k) > GAP_FACTOR * step(k - 1).max(step(k + 1));
    let found: Vec<usize> = (1..steps.saturating_sub(1)).filter(is_gap).collect();
    let &first = found.first()?;
    let line = cells.line_of_row[axis.rows[first + 1] as usize];
    let message = format!(
        "{} gap(s) in time, the first from {} s to {} s",
        found.len(),
        axis.time_s[first],
        axis.time_s[first + 1]
    );
    Some(Issue::note("time-gap", message).at(format!("line {line}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(time_s: &[f64]) -> (Result<TimeAxis, ReadError>, Vec<Issue>) {
        let mut cells = CellTable::new(1, &[false], 0);
        (0..time_s.len()).for_each(|row| cells.end_row(row + 2, 1));
        let mut issues = Vec::new();
        (increasing(time_s, &cells, "time_s", &mut issues), issues)
    }

    #[test]
    fn a_few_repeated_times_are_left_out_and_counted() {
        let mut time_s: Vec<f64> = (0..100).map(f64::from).collect();
        time_s[50] = 49.0;
        time_s[70] = f64::NAN;
        let (axis, issues) = axis(&time_s);
        assert_eq!(axis.unwrap().rows.len(), 98);
        assert_eq!(issues[0].place, "line 52");
        assert!(issues[0].message.contains("1 of 100 rows") && issues[0].message.contains("49 s after 49 s"));
        assert_eq!(
            (issues[1].code.as_str(), issues[1].place.as_str()),
            ("time-missing", "line 72")
        );
    }

    #[test]
    fn a_clock_that_stands_still_is_refused() {
        let time_s: Vec<f64> = (0..100).map(|k| f64::from(k / 10)).collect();
        let error = axis(&time_s).0.unwrap_err();
        assert!(
            matches!(
                error,
                ReadError::TimeOrder {
                    line: 3,
                    count: 90,
                    rows: 100,
                    ..
                }
            ),
            "{error:?}"
        );
    }

    #[test]
    fn gaps_are_named_and_logarithmic_sampling_has_none() {
        let mut time_s: Vec<f64> = (0..30).map(f64::from).collect();
        time_s[20..].iter_mut().for_each(|t| *t += 100.0);
        let (_, issues) = axis(&time_s);
        assert_eq!(
            (issues.len(), issues[0].code.as_str(), issues[0].place.as_str()),
            (1, "time-gap", "line 22")
        );
        let logarithmic: Vec<f64> = (0..60).map(|k| 1e-3 * 1.3f64.powi(k)).collect();
        assert!(axis(&logarithmic).1.is_empty());
    }
}
