//! Two instruments' clocks differ by a number that nobody knows, but it is one number a folder: the one at which the most files
//! with a current and files with a bending begin, or end, together.

use super::half::Half;

/// By how much a hand that starts two instruments scatters, s. Chosen.
const SCATTER_S: f64 = 12.0;
/// By how much the clocks of two instruments may differ, s. Chosen: a clock that nobody set is minutes off.
const MOST_APART_S: f64 = 1800.0;
/// Fewest pairs that show how far two clocks are apart. Chosen.
const FEWEST: usize = 3;
/// By how many pairs one difference must be better than any other, beyond what chance pairs. Chosen: e^3 to one.
const BETTER_BY: f64 = 3.0;

/// What the clocks of a folder say.
pub(super) struct Clocks {
    /// Pairs of halves.
    pairs: Vec<(usize, usize)>,
}

impl Clocks {
    /// Whether a pair joins a file with another than the clocks do.
    pub fn contradicts(&self, &(e, b): &(usize, usize)) -> bool {
        let is_other = |&(own_e, own_b): &(usize, usize)| (own_e == e) != (own_b == b);
        self.pairs.iter().any(is_other)
    }

    /// The pairs of which both halves are open.
    pub fn pairs_among(&self, electrical: &[usize], bending: &[usize]) -> Vec<(usize, usize)> {
        let is_open = |(e, b): &&(usize, usize)| electrical.contains(e) && bending.contains(b);
        self.pairs.iter().filter(is_open).copied().collect()
    }
}

/// The pairs at the difference between the clocks that joins the most; none where no difference does so clearly.
pub(super) fn together(halves: &[Half], electrical: &[usize], bending: &[usize]) -> Option<Clocks> {
    let begins = |among: &[usize]| -> Vec<(usize, f64)> {
        let mut found: Vec<(usize, f64)> = (among.iter())
            .filter_map(|at| Some((*at, halves[*at].window_s?.0)))
            .collect();
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        found
    };
    let (e, b) = (begins(electrical), begins(bending));
    let mut apart: Vec<f64> = Vec::new();
    for (_, start) in &e {
        let from = b.partition_point(|(_, other)| *other < start - MOST_APART_S);
        let near = b[from..]
            .iter()
            .take_while(|(_, other)| *other <= start + MOST_APART_S);
        apart.extend(near.map(|(_, other)| other - start));
    }
    apart.sort_by(f64::total_cmp);
    let mut judged: Vec<Judged> = Vec::new();
    let chance = apart.len() as f64 * SCATTER_S / (2.0 * MOST_APART_S);
    for (at, first) in apart.iter().enumerate() {
        let inside = apart[at..].partition_point(|other| *other <= first + SCATTER_S);
        // What cannot be better than the best is not counted out.
        let most = judged.iter().map(|(worth, ..)| *worth).fold(0.0, f64::max);
        if inside < FEWEST || (inside as f64) - chance + BETTER_BY < most {
            continue;
        }
        let offset = first + SCATTER_S / 2.0;
        let pairs = one_to_one(&e, &b, offset);
        // A clock is rather seconds off than quarters of an hour.
        let worth = pairs.len() as f64 - chance - (offset.abs() / 60.0).ln_1p();
        judged.push((worth, offset, pairs));
    }
    judged.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (worth, offset, pairs) = judged.first()?.clone();
    let next = judged
        .iter()
        .filter(|(_, other, _)| (other - offset).abs() > SCATTER_S);
    let next = next.map(|(worth, ..)| *worth).fold(0.0, f64::max);
    // Middle of the pairs that were found, and once more about it.
    let start =
        |of: &[(usize, f64)], at: usize| of.iter().find(|(own, _)| *own == at).map_or(0.0, |(_, s)| *s);
    let sum: f64 = pairs
        .iter()
        .map(|(own_e, own_b)| start(&b, *own_b) - start(&e, *own_e))
        .sum();
    let middle = sum / pairs.len().max(1) as f64;
    (pairs.len() >= FEWEST && worth > next + BETTER_BY).then(|| Clocks {
        pairs: one_to_one(&e, &b, middle),
    })
}

/// What an offset of the clocks is worth, the offset, s, and the pairs that it makes.
type Judged = (f64, f64, Vec<(usize, usize)>);

/// Pairs within the scatter of a difference, each half the nearest of the other.
fn one_to_one(e: &[(usize, f64)], b: &[(usize, f64)], offset: f64) -> Vec<(usize, usize)> {
    let nearest = |of: f64, among: &[(usize, f64)]| {
        let at = among.partition_point(|(_, other)| *other < of);
        let near = among[at.saturating_sub(1)..(at + 1).min(among.len())].iter();
        let best = near.min_by(|x, y| (x.1 - of).abs().total_cmp(&(y.1 - of).abs()))?;
        ((best.1 - of).abs() <= SCATTER_S / 2.0).then_some(*best)
    };
    let pair = |(at, start): &(usize, f64)| {
        let (partner, other) = nearest(start + offset, b)?;
        let (back, _) = nearest(other - offset, e)?;
        (back == *at).then_some((*at, partner))
    };
    e.iter().filter_map(pair).collect()
}
