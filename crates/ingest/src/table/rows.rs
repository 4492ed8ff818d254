//! The order of rows: the newest first, counters that wrap, clocks that start anew at each step of a programme.

use super::kind::Kind;
use super::read::Table;
use crate::formats::error::ReadError;
use crate::table::policy::{COUNTERS, REGULAR_WITHIN, RESTART_ROWS};
use ieap_domain::Issue;
use ieap_domain::unit::Conversion;
use ieap_numerics::robust::upper_median;

/// Which way the numbers of a clock go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Forward, but for single rows.
    Forward,
    /// Backward throughout.
    Backward,
    /// It starts anew in these rows.
    Restarts,
}

/// Which way numbers go.
pub fn order(numbers: &[f64]) -> Order {
    let finite: Vec<f64> = finite(numbers).map(|(_, number)| number).collect();
    if finite.len() > 2 && finite.windows(2).all(|pair| pair[1] < pair[0]) {
        Order::Backward
    } else if restarts(numbers).is_empty() {
        Order::Forward
    } else {
        Order::Restarts
    }
}

fn finite(numbers: &[f64]) -> impl Iterator<Item = (usize, f64)> + '_ {
    numbers
        .iter()
        .copied()
        .enumerate()
        .filter(|(_, number)| number.is_finite())
}

/// Rows in which a clock starts anew: it goes back and then counts on from there, through time that has passed already. A row by
/// itself is a glitch, or stands in another's place.
fn restarts(numbers: &[f64]) -> Vec<usize> {
    let finite: Vec<(usize, f64)> = finite(numbers).collect();
    let mut found = Vec::new();
    let mut latest = f64::NEG_INFINITY;
    for (at, (row, number)) in finite.iter().enumerate() {
        if *number >= latest {
            latest = *number;
            continue;
        }
        let run = &finite[at..(at + RESTART_ROWS).min(finite.len())];
        let counts_on = run.len() == RESTART_ROWS && run.windows(2).all(|pair| pair[1].1 > pair[0].1);
        let again = run.get(1).is_some_and(|(_, next)| *next <= latest);
        if counts_on && again && *number < finite[at - 1].1 {
            found.push(*row);
            latest = *number;
        }
    }
    found
}

/// Rows whose time is that of the row above.
fn repeats(numbers: &[f64]) -> Vec<usize> {
    (1..numbers.len())
        .filter(|row| numbers[*row] == numbers[row - 1])
        .collect()
}

/// Makes the numbers of a clock count on: reverses rows whose newest is first, adds what a counter lost when it wrapped, and
/// goes on where a clock starts anew at each step, if the dates beside it or a column that counts the steps show how.
///
/// `wall` are the rows with a date, and their seconds by it.
///
/// # Errors
/// The clock starts anew and nothing shows how its parts follow each other.
pub fn go_on(
    table: &mut Table<'_>,
    numbers: &mut [f64],
    wall: Option<(&[usize], &[f64])>,
    conversion: Conversion,
    issues: &mut Vec<Issue>,
) -> Result<(), ReadError> {
    let repeats = repeats(numbers);
    match order(numbers) {
        Order::Forward if steps_are_counted(table, &repeats) => {}
        Order::Forward => return Ok(()),
        Order::Backward => {
            table.reverse();
            numbers.reverse();
            issues.push(Issue::note(
                "newest-first",
                "the newest row comes first; rows are read from the last to the first",
            ));
            return Ok(());
        }
        Order::Restarts => {}
    }
    let mut starts = restarts(numbers);
    if starts.is_empty() {
        starts = repeats;
    }
    if let Some(modulus) = wraps(numbers, &starts) {
        for (count, start) in starts.iter().enumerate() {
            let end = starts.get(count + 1).copied().unwrap_or(numbers.len());
            numbers[*start..end]
                .iter_mut()
                .for_each(|number| *number += (count + 1) as f64 * modulus);
        }
        // A counter that runs free has no zero of its own.
        let first = numbers
            .iter()
            .copied()
            .find(|number| number.is_finite())
            .unwrap_or(0.0);
        numbers.iter_mut().for_each(|number| *number -= first);
        let message = format!(
            "the counter of the time wraps at {modulus} {} time(s); it is counted on",
            starts.len()
        );
        issues.push(Issue::note("counter-wrapped", message));
        return Ok(());
    }
    let place = |row: usize| table.cells.line_of_row.get(row).map_or(0, |line| *line as usize);
    let step = usual_step(numbers);
    // The last reading of a step and the first of the next are as far apart as others where all are.
    let counted = is_regular(numbers, step) && steps_are_counted(table, &starts);
    let mut offset = 0.0;
    for (count, start) in starts.iter().enumerate() {
        let (last, before) = finite(&numbers[..*start]).last().unwrap_or((0, 0.0));
        let by_wall = wall.and_then(|(rows, seconds)| {
            let of = |row: usize| rows.iter().position(|own| *own == row).map(|at| seconds[at]);
            Some((of(*start)? - of(last)?) / conversion.apply(1.0))
        });
        let passed = match by_wall {
            Some(passed) if passed > 0.0 => passed,
            _ if counted => step,
            _ => {
                return Err(ReadError::TimeOrder {
                    line: place(*start),
                    count: starts.len(),
                    rows: numbers.len(),
                    first: format!(
                        "{} after {}, from where it counts on: the clock starts anew",
                        numbers[*start],
                        before - offset
                    ),
                });
            }
        };
        let end = starts.get(count + 1).copied().unwrap_or(numbers.len());
        offset = before + passed - numbers[*start];
        numbers[*start..end]
            .iter_mut()
            .for_each(|number| *number += offset);
    }
    let message = format!(
        "the clock starts anew {} time(s), where a step begins; it is counted on",
        starts.len()
    );
    issues.push(Issue::warning("clock-starts-anew", message).at(format!("line {}", place(starts[0]))));
    Ok(())
}

/// The size of a counter that wraps at each of these rows; none where it does not.
fn wraps(numbers: &[f64], starts: &[usize]) -> Option<f64> {
    let step = usual_step(numbers);
    let whole = numbers
        .iter()
        .filter(|number| number.is_finite())
        .all(|number| number.fract() == 0.0);
    let goes_on = |modulus: &f64| {
        starts.iter().all(|start| {
            let before = finite(&numbers[..*start])
                .last()
                .map_or(f64::NAN, |(_, number)| number);
            let passed = numbers[*start] + modulus - before;
            passed > 0.0 && passed < 2.5 * step
        })
    };
    COUNTERS.into_iter().filter(|_| whole).find(goes_on)
}

fn usual_step(numbers: &[f64]) -> f64 {
    let steps = numbers.windows(2).map(|pair| pair[1] - pair[0]);
    let mut steps: Vec<f64> = steps.filter(|step| *step > 0.0).collect();
    upper_median(&mut steps).unwrap_or(0.0)
}

/// Whether all readings follow each other at the usual step.
fn is_regular(numbers: &[f64], step: f64) -> bool {
    let steps = numbers
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > 0.0);
    steps
        .into_iter()
        .all(|own| (own / step - 1.0).abs() < REGULAR_WITHIN)
}

/// Whether a column of whole numbers counts on at just these rows.
fn steps_are_counted(table: &Table<'_>, starts: &[usize]) -> bool {
    (0..table.headers.len())
        .filter(|column| table.kind(*column) == Kind::Number)
        .any(|column| {
            let numbers = &table.cells.columns[column].numbers;
            let changes = (1..numbers.len()).filter(|row| numbers[*row] != numbers[row - 1]);
            let rises = |row: &usize| numbers[*row] > numbers[row - 1] && numbers[*row].fract() == 0.0;
            !starts.is_empty() && changes.clone().eq(starts.iter().copied()) && starts.iter().all(rises)
        })
}
