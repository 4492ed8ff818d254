//! Numbers that stand where a sensor gave none: 998, -127, 0 in the midst of 21.3. They are found by what they do among the
//! readings beside them and by no list: they leap out of the neighbours' scatter and come back, always to the same number,
//! which no reading of the course comes to.

use std::collections::{BTreeMap, BTreeSet};

use super::policy::{
    BESIDE_A_CODE, CODE_LEAP, CODE_SHARE, FEWEST_FOR_CODES, LONGEST_CODE_IN_RESPONSE, MOST_CODES,
    SURE_CODE_LEAP, ZERO_ROWS,
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
    // The farthest first: what stood between readings is no neighbour that others are held against.
    let (mut left, mut found) = (finite.clone(), BTreeSet::new());
    while let Some(code) = farthest(&left, is_response) {
        found.insert(code);
        left.retain(|number| number.to_bits() != code);
        let taken = finite.len() - left.len();
        // What stands in most rows is the course, and so is what comes in many numbers.
        if taken as f64 > CODE_SHARE * finite.len() as f64 || found.len() > MOST_CODES {
            return BTreeSet::new();
        }
    }
    found
}

/// That number which stands for no reading and lies farthest from the others, by its bits; none where none does.
fn farthest(finite: &[f64], is_response: bool) -> Option<u64> {
    let runs = runs(finite);
    let course = Course::of(&runs);
    let suspects: BTreeSet<u64> = (course.own.keys().copied())
        .filter(|bits| course.is_far(*bits, CODE_LEAP))
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
    let gap = |bits: &u64| (low - f64::from_bits(*bits)).max(f64::from_bits(*bits) - high);
    let is_code = |bits: &u64| {
        let own: Vec<&Run> = course.own[bits].iter().map(|at| &runs[*at]).collect();
        let gap = gap(bits);
        let is_round = f64::from_bits(*bits).fract() == 0.0 && has_decimals;
        let comes_again = own.len() > 1;
        let is_short = own.iter().all(|run| run.count <= LONGEST_CODE_IN_RESPONSE);
        // One number twice, farther away than all others lie from each other, is no course either.
        let stays = own.iter().any(|run| run.count > 1) && gap >= CODE_LEAP * (high - low);
        let leaps_far = course.is_far(*bits, SURE_CODE_LEAP) && (comes_again || is_round || stays);
        let is_apart = gap > 0.0 && leaps_far;
        if is_response {
            is_apart && is_short && comes_again && comes_back(&runs, &own, course.scatter_without(*bits))
        } else {
            is_apart && (comes_again || gap >= high - low)
        }
    };
    let found = suspects.iter().filter(|bits| is_code(bits));
    found.max_by(|a, b| gap(a).total_cmp(&gap(b))).copied()
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

/// How far a run lies from the middle of what stands beside it: of two middles from the nearer, and from the farther.
fn leap(runs: &[Run], run: &Run) -> (f64, f64) {
    let mut near: Vec<f64> = beside(runs, run, false)
        .chain(beside(runs, run, true))
        .map(|other| other.value)
        .collect();
    if near.is_empty() {
        return (0.0, 0.0);
    }
    near.sort_unstable_by(f64::total_cmp);
    let from = |at: usize| (run.value - near[at]).abs();
    let (one, other) = (from(near.len() / 2), from((near.len() - 1) / 2));
    (one.min(other), one.max(other))
}

/// How the numbers of a column follow each other.
struct Course {
    /// How far each run lies from what stands beside it, at least and at most.
    leaps: Vec<(f64, f64)>,
    /// How far each row does at most, from the least on.
    sorted: Vec<f64>,
    /// The rows of each run.
    counts: Vec<usize>,
    /// The least step between two numbers.
    least: f64,
    /// The places of the runs of each number, by its bits.
    own: BTreeMap<u64, Vec<usize>>,
}

impl Course {
    fn of(runs: &[Run]) -> Course {
        let leaps: Vec<(f64, f64)> = runs.iter().map(|run| leap(runs, run)).collect();
        let counted = runs.iter().zip(&leaps);
        let rows = counted.flat_map(|(run, (_, most))| std::iter::repeat_n(*most, run.count));
        let mut sorted: Vec<f64> = rows.collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let mut values: Vec<f64> = runs.iter().map(|run| run.value).collect();
        values.sort_unstable_by(f64::total_cmp);
        let steps = values.windows(2).map(|pair| pair[1] - pair[0]);
        let mut own: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
        for run in runs {
            own.entry(run.value.to_bits()).or_default().push(run.at);
        }
        Course {
            least: steps.filter(|step| *step > 1e-12).fold(f64::INFINITY, f64::min),
            counts: runs.iter().map(|run| run.count).collect(),
            leaps,
            sorted,
            own,
        }
    }

    /// What all readings but those of one number usually lie from their neighbours, at least the least step between two: a
    /// number is held against the others, so that one which stands often is no measure of itself.
    fn scatter_without(&self, bits: u64) -> f64 {
        let runs = self.own[&bits].iter();
        let mut own: Vec<(f64, usize)> = runs.map(|at| (self.leaps[*at].1, self.counts[*at])).collect();
        own.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let others = self.sorted.len() - own.iter().map(|(_, count)| count).sum::<usize>();
        let mut at = others * 3 / 4;
        for (leap, count) in own {
            // What lies below in the order of all takes a place there.
            if self.sorted.get(at).is_some_and(|usual| leap <= *usual) {
                at += count;
            }
        }
        self.sorted
            .get(at)
            .map_or(f64::INFINITY, |usual| usual.max(self.least))
    }

    /// Whether a number lies far from its neighbours wherever it stands.
    fn is_far(&self, bits: u64, factor: f64) -> bool {
        let scatter = self.scatter_without(bits);
        self.own[&bits]
            .iter()
            .all(|at| self.leaps[*at].0 > factor * scatter)
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn found(numbers: &[f64]) -> Vec<f64> {
        let codes = codes(Quantity::Temperature, numbers);
        codes.into_iter().map(f64::from_bits).collect()
    }

    #[test]
    fn readings_among_codes_are_none_themselves() {
        // The least readings stand between codes alone.
        let mut course: Vec<f64> = [18.0, 150.0].repeat(4);
        course.extend((0..60).map(|k| 18.1 + f64::from(k / 6 + k % 3) / 10.0));
        assert_eq!(found(&course), [150.0]);
    }

    #[test]
    fn a_code_in_a_third_of_the_rows_is_no_measure_of_itself() {
        let course = |k: i32| 20.0 + f64::from(k % 7) / 10.0;
        let numbers: Vec<f64> = (0..90)
            .map(|k| if k % 3 == 1 { -127.0 } else { course(k) })
            .collect();
        assert_eq!(found(&numbers), [-127.0]);
        // In every second row it may be the course.
        let numbers: Vec<f64> = (0..90)
            .map(|k| if k % 2 == 1 { -127.0 } else { course(k) })
            .collect();
        assert!(found(&numbers).is_empty());
    }
}
