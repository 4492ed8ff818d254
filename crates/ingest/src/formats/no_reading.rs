//! Numbers that stand where a sensor gave none: 998, -127, 0 in the midst of 21.3. They are found by what they do among the
//! readings beside them and by no list: they leap out of the neighbours' scatter and come back, always to the same number,
//! which no reading of the course comes to.

use std::collections::BTreeSet;

use super::policy::{
    BESIDE_A_CODE, CODE_LEAP, CODE_SHARE, FEWEST_FOR_CODES, LONGEST_CODE_IN_RESPONSE, SURE_CODE_LEAP,
    ZERO_ROWS,
};
use ieap_domain::Quantity;

/// The numbers of a column that stand for no reading, by their bits.
pub fn codes(quantity: Quantity, numbers: &[f64]) -> BTreeSet<u64> {
    let finite: Vec<f64> = numbers
        .iter()
        .copied()
        .filter(|number| number.is_finite())
        .collect();
    if quantity == Quantity::Temperature && finite.len() >= ZERO_ROWS && finite.iter().all(|x| *x == 0.0) {
        // No probe shows exactly zero in all rows.
        return finite.iter().map(|number| number.to_bits()).collect();
    }
    let (is_of_air, is_response) = (is_of_surroundings(quantity), quantity.is_response());
    if finite.len() < FEWEST_FOR_CODES || !(is_of_air || is_response) {
        return BTreeSet::new();
    }
    let runs = runs(&finite);
    let leaps: Vec<f64> = runs.iter().map(|run| leap(&runs, run)).collect();
    let scatter = scatter(&runs, &leaps);
    if scatter <= 0.0 {
        return BTreeSet::new();
    }
    let is_far = |bits: u64, factor: f64| {
        let own = || {
            runs.iter()
                .zip(&leaps)
                .filter(move |(run, _)| run.value.to_bits() == bits)
        };
        own().all(|(_, leap)| *leap > factor * scatter)
    };
    let suspects: BTreeSet<u64> = (runs.iter())
        .map(|run| run.value.to_bits())
        .filter(|bits| is_far(*bits, CODE_LEAP))
        .collect();
    let rest = || {
        finite
            .iter()
            .copied()
            .filter(|number| !suspects.contains(&number.to_bits()))
    };
    let (low, high) = rest().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), number| {
        (low.min(number), high.max(number))
    });
    let has_decimals = rest().any(|number| number.fract() != 0.0);
    let is_code = |bits: &u64| {
        let value = f64::from_bits(*bits);
        let own: Vec<&Run> = runs.iter().filter(|run| run.value.to_bits() == *bits).collect();
        let gap = (low - value).max(value - high);
        let is_round = value.fract() == 0.0 && has_decimals;
        let comes_again = own.len() > 1;
        let is_short = own.iter().all(|run| run.count <= LONGEST_CODE_IN_RESPONSE);
        // One number twice, farther away than all others lie from each other, is no course either.
        let stays = own.iter().any(|run| run.count > 1) && gap >= CODE_LEAP * (high - low);
        let leaps_far = is_far(*bits, SURE_CODE_LEAP) && (comes_again || is_round || stays);
        let is_apart = gap > 0.0 && leaps_far;
        if is_response {
            is_apart && is_short && comes_again && comes_back(&runs, &own, scatter)
        } else {
            is_apart && (comes_again || gap >= high - low)
        }
    };
    let found: BTreeSet<u64> = suspects.iter().copied().filter(is_code).collect();
    let taken = finite
        .iter()
        .filter(|number| found.contains(&number.to_bits()))
        .count();
    // What stands in most rows is the course.
    if taken as f64 <= CODE_SHARE * finite.len() as f64 {
        found
    } else {
        BTreeSet::new()
    }
}

/// Whether a quantity is of the surroundings, which follow no drive.
fn is_of_surroundings(quantity: Quantity) -> bool {
    use Quantity::{Oxygen, Pressure, RelativeHumidity, Temperature, Water};
    matches!(
        quantity,
        Temperature | RelativeHumidity | Pressure | Oxygen | Water
    )
}

/// Rows one after the other with one number.
struct Run {
    at: usize,
    value: f64,
    count: usize,
}

fn runs(numbers: &[f64]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for value in numbers {
        match runs.last_mut() {
            Some(last) if last.value == *value => last.count += 1,
            _ => runs.push(Run {
                at: runs.len(),
                value: *value,
                count: 1,
            }),
        }
    }
    runs
}

/// The nearest runs on one side with another number.
fn beside<'r>(runs: &'r [Run], run: &Run, forward: bool) -> impl Iterator<Item = &'r Run> + use<'r> {
    let (at, value) = (run.at, run.value);
    let mut step = 0;
    let others = std::iter::from_fn(move || {
        step += 1;
        let next = if forward {
            at.checked_add(step)
        } else {
            at.checked_sub(step)
        };
        runs.get(next?)
    });
    others
        .filter(move |other| other.value != value)
        .take(BESIDE_A_CODE)
}

/// How far a run lies from the middle of what stands beside it.
fn leap(runs: &[Run], run: &Run) -> f64 {
    let mut near: Vec<f64> = beside(runs, run, false)
        .chain(beside(runs, run, true))
        .map(|other| other.value)
        .collect();
    if near.is_empty() {
        return 0.0;
    }
    near.sort_unstable_by(f64::total_cmp);
    (run.value - near[near.len() / 2]).abs()
}

/// What readings usually lie from the middle of their neighbours, at least the least step between two of them.
fn scatter(runs: &[Run], leaps: &[f64]) -> f64 {
    let counted = runs.iter().zip(leaps);
    let mut sorted: Vec<f64> = counted
        .flat_map(|(run, leap)| std::iter::repeat_n(*leap, run.count))
        .collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let usual = sorted[(sorted.len() * 3 / 4).min(sorted.len() - 1)];
    let mut values: Vec<f64> = runs.iter().map(|run| run.value).collect();
    values.sort_unstable_by(f64::total_cmp);
    let steps = values.windows(2).map(|pair| pair[1] - pair[0]);
    let least = steps.filter(|step| *step > 1e-12).fold(f64::INFINITY, f64::min);
    usual.max(if least.is_finite() { least } else { 0.0 })
}

/// Whether the course goes on behind each of these runs where it was before.
fn comes_back(runs: &[Run], own: &[&Run], scatter: f64) -> bool {
    own.iter().all(|run| {
        let before = run.at.checked_sub(1).and_then(|at| runs.get(at));
        let after = runs.get(run.at + 1);
        before
            .zip(after)
            .is_some_and(|(before, after)| (after.value - before.value).abs() <= CODE_LEAP * scatter)
    })
}
