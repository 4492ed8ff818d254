//! One series as it was read, held against the written one.

use ieap_domain::{Issue, Quantity};

use crate::expected::{Expected, Series};
use crate::judge::tells_of_loss;
use crate::table::Expect;

/// Numbers that differ by less than this part of themselves are the same.
const SAME: f64 = 1e-9;
/// Times of a clock of microseconds that was held as a double, s.
const SAME_TIME_S: f64 = 1e-6;

/// A series as it was read.
pub struct Found {
    /// Part of the file.
    pub part: usize,
    /// Name of the sensor.
    pub sensor: String,
    /// Quantity.
    pub quantity: Quantity,
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Values, canonical unit.
    pub values: Vec<f64>,
    /// Whether the reader says that it rebuilt the printed times.
    pub is_rebuilt: bool,
}

/// What differs, in a kind and a detail; none where the series is right.
pub fn fault(
    series: &Series,
    found: &Found,
    expected: &Expected,
    issues: &[Issue],
) -> Option<(String, String)> {
    let within_s = if found.is_rebuilt { expected.digit_s } else { 0.0 } + SAME_TIME_S;
    let zeros: Vec<f64> = match (expected.free_offset, found.time_s.first()) {
        (true, Some(first)) => series.time_s.iter().take(6).map(|time| first - time).collect(),
        _ => vec![0.0],
    };
    let faults: Vec<Option<Fault>> = zeros
        .iter()
        .map(|zero| at_zero(series, found, *zero, within_s, issues))
        .collect();
    if faults.iter().any(Option::is_none) {
        return None;
    }
    let best = faults.into_iter().flatten().min_by_key(|fault| fault.rank)?;
    let name = found.quantity.key();
    Some((
        best.kind.replace('#', name),
        format!("{} ({name}): {}", series.name, best.detail),
    ))
}

struct Fault {
    rank: usize,
    kind: String,
    detail: String,
}

fn at_zero(series: &Series, found: &Found, zero_s: f64, within_s: f64, issues: &[Issue]) -> Option<Fault> {
    let largest = series
        .cells
        .iter()
        .filter_map(value)
        .map(f64::abs)
        .fold(1e-300, f64::max);
    let same = |a: f64, b: f64| (a - b).abs() <= SAME * (a.abs() + largest * 1e-2);
    let same_time = |row: usize, at: usize| {
        (series.time_s[row] + zero_s - found.time_s[at]).abs() <= within_s + SAME * found.time_s[at].abs()
    };
    if let Some(fault) = spans_differ(series, found) {
        return Some(fault);
    }
    let (mut at, mut missing) = (0, 0);
    for row in 0..series.cells.len() {
        let is_here = at < found.values.len() && same_time(row, at);
        match series.cells[row] {
            Expect::Reading(value) if is_here && same(value, found.values[at]) => at += 1,
            Expect::Reading(value) if is_here => {
                return Some(values_differ(series, found, row, value, found.values[at]));
            }
            Expect::Reading(_) => missing += 1,
            Expect::Optional(value) if is_here && same(value, found.values[at]) => at += 1,
            Expect::Optional(_) if is_here => {
                return Some(of(0, "a cut cell enters", format!("{}", found.values[at])));
            }
            Expect::Gap if is_here && !belongs_to_next(&series.cells[row + 1..], found.values[at], &same) => {
                let detail = format!("{} at {} s", found.values[at], found.time_s[at]);
                return Some(of(0, "a sentinel or a gap enters as # ", detail));
            }
            Expect::Optional(_) | Expect::Gap => {}
        }
    }
    if at < found.values.len() {
        return Some(times_differ(series, found, at));
    }
    let is_told = tells_of_loss(issues, &series.name);
    (missing > 0 && !is_told).then(|| {
        of(
            1,
            "readings of # are missing without a word",
            format!("{missing} of {}", series.cells.len()),
        )
    })
}

fn of(rank: usize, kind: &str, detail: String) -> Fault {
    Fault {
        rank,
        kind: kind.trim().to_owned(),
        detail,
    }
}

fn value(cell: &Expect) -> Option<f64> {
    match cell {
        Expect::Reading(value) | Expect::Optional(value) => Some(*value),
        Expect::Gap => None,
    }
}

/// Where a clock is coarse the next reading may bear the time of a gap.
fn belongs_to_next(next: &[Expect], read: f64, same: &dyn Fn(f64, f64) -> bool) -> bool {
    next.iter().find_map(value).is_some_and(|value| same(value, read))
}

/// The factor between values, where it is one for all rows.
fn values_differ(series: &Series, found: &Found, row: usize, is: f64, read: f64) -> Fault {
    let detail = format!("{read} in place of {is} at {} s", series.time_s[row]);
    let truth: Vec<f64> = series.cells.iter().filter_map(value).collect();
    let ratios: Vec<f64> = truth
        .iter()
        .zip(&found.values)
        .filter(|(t, _)| **t != 0.0)
        .map(|(t, v)| v / t)
        .collect();
    let factor = ratios.first().copied().unwrap_or(f64::NAN);
    let is_one = ratios.iter().all(|ratio| (ratio / factor - 1.0).abs() < 1e-6);
    match (truth.len() == found.values.len(), is_one) {
        (true, true) => of(
            2,
            &format!("# is wrong by the factor {}", rounded(factor)),
            detail,
        ),
        _ => of(2, "values of # are wrong", detail),
    }
}

/// Times that are far off show as wrong values at the times that happen to be met: they are told first.
fn spans_differ(series: &Series, found: &Found) -> Option<Fault> {
    let (read_s, is_s) = spans(series, found);
    let readings = series.cells.iter().filter_map(value).count();
    let are_all_there = found.values.len() + 5 >= readings;
    let differ = !(0.67..1.5).contains(&(read_s / is_s));
    (are_all_there && differ).then(|| times_differ(series, found, 0))
}

/// From the first to the last time, as it was read and as it is, s.
fn spans(series: &Series, found: &Found) -> (f64, f64) {
    let span = |times: &[f64]| times.last().unwrap_or(&0.0) - times.first().unwrap_or(&0.0);
    (span(&found.time_s), span(&series.time_s))
}

fn times_differ(series: &Series, found: &Found, at: usize) -> Fault {
    let (read_s, is_s) = spans(series, found);
    let factor = read_s / is_s;
    let detail = format!(
        "reading {at} at {} s; {read_s} s in place of {is_s} s in all",
        found.time_s[at]
    );
    let is_near = |by: &f64| (factor / by - 1.0).abs() < 0.05;
    let kind = match factor {
        _ if is_near(&1.0) => "times are shifted, or rows are out of order".to_owned(),
        _ if [1e-3, 1e3, 1e6, 1e-6, 60.0, 3600.0, 1.0 / 60.0]
            .iter()
            .any(is_near) =>
        {
            format!("times are wrong by the factor {}", rounded(factor))
        }
        _ => "times are wrong".to_owned(),
    };
    of(3, &kind, detail)
}

/// Two digits, so that kinds can be counted.
fn rounded(factor: f64) -> String {
    format!("{factor:.1e}")
}
