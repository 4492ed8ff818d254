//! Inner products of many columns with many others: what [`dot`](super::sums::dot) gives of each pair, to the last digit,
//! several times as fast.

use super::sums::{LANES, total};

/// Rows that are gone through at a time: of so many, columns stay in the cache while they meet each other.
const ROWS: usize = 512;
/// Columns of either side that are multiplied at a time: their sums stay in registers.
const TILE: usize = 2;

/// Running sums of one pair of columns.
type Lanes = [f64; LANES];

/// `a_i . b_j` of every pair, as `[i][j]`. All columns have one length.
///
/// # Panics
/// Where columns differ in length.
pub fn products(a: &[&[f64]], b: &[&[f64]]) -> Vec<Vec<f64>> {
    of_pairs(a, b, |_| 0)
}

/// `a_i . a_j` of every pair, as `[i][j]`.
///
/// # Panics
/// Where columns differ in length.
pub fn gram(a: &[&[f64]]) -> Vec<Vec<f64>> {
    // From the tile on the diagonal; what lies before it is the same the other way round.
    let mut found = of_pairs(a, a, |i| i - i % TILE);
    for i in 0..a.len() {
        let (before, own) = found.split_at_mut(i);
        for (j, row) in before.iter().enumerate() {
            own[0][j] = row[i];
        }
    }
    found
}

fn of_pairs(a: &[&[f64]], b: &[&[f64]], first: impl Fn(usize) -> usize) -> Vec<Vec<f64>> {
    let length = a.first().or(b.first()).map_or(0, |column| column.len());
    assert!(
        a.iter().chain(b).all(|column| column.len() == length),
        "columns differ in length"
    );
    let whole = length - length % LANES;
    let mut sums: Vec<Lanes> = vec![[0.0; LANES]; a.len() * b.len()];
    for from in (0..whole).step_by(ROWS) {
        let rows = from..(from + ROWS).min(whole);
        for i in (0..a.len()).step_by(TILE) {
            // A last column without a second is its own: what is done twice is the same.
            let own = [i, (i + 1).min(a.len() - 1)];
            let left = own.map(|i| &a[i][rows.clone()]);
            for j in (first(i)..b.len()).step_by(TILE) {
                let other = [j, (j + 1).min(b.len() - 1)];
                let right = other.map(|j| &b[j][rows.clone()]);
                let places = own.map(|i| other.map(|j| i * b.len() + j));
                let added = add(places.map(|row| row.map(|place| sums[place])), left, right);
                for (place, sum) in places.iter().flatten().zip(added.iter().flatten()) {
                    sums[*place] = *sum;
                }
            }
        }
    }
    let rest = |i: usize, j: usize| -> f64 {
        let pairs = a[i][whole..].iter().zip(&b[j][whole..]);
        pairs.map(|(a, b)| a * b).sum()
    };
    let of_row = |i: usize| {
        let each = sums[i * b.len()..][..b.len()].iter().enumerate();
        each.map(|(j, lanes)| total(lanes, rest(i, j))).collect()
    };
    (0..a.len()).map(of_row).collect()
}

/// Sums to which the products of two columns with two others are added.
#[inline(always)]
fn add(from: [[Lanes; TILE]; TILE], left: [&[f64]; TILE], right: [&[f64]; TILE]) -> [[Lanes; TILE]; TILE] {
    let [[mut s00, mut s01], [mut s10, mut s11]] = from;
    let pairs = left[0].chunks_exact(LANES).zip(left[1].chunks_exact(LANES));
    let others = right[0].chunks_exact(LANES).zip(right[1].chunks_exact(LANES));
    for ((l0, l1), (r0, r1)) in pairs.zip(others) {
        for lane in 0..LANES {
            s00[lane] += l0[lane] * r0[lane];
            s01[lane] += l0[lane] * r1[lane];
            s10[lane] += l1[lane] * r0[lane];
            s11[lane] += l1[lane] * r1[lane];
        }
    }
    [[s00, s01], [s10, s11]]
}

#[cfg(test)]
mod tests {
    use super::super::sums::dot;
    use super::*;

    fn columns(count: usize, length: usize, seed: u32) -> Vec<Vec<f64>> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state) / f64::from(u32::MAX) - 0.5
        };
        (0..count)
            .map(|_| (0..length).map(|_| next()).collect())
            .collect()
    }

    #[test]
    fn each_is_the_product_of_its_pair_to_the_last_digit() {
        for (count, other, length) in [
            (1, 1, 3),
            (2, 3, 8),
            (5, 4, 17),
            (7, 7, 1203),
            (3, 1, 512),
            (0, 2, 4),
        ] {
            let (a, b) = (columns(count, length, 1), columns(other, length, 2));
            let a: Vec<&[f64]> = a.iter().map(Vec::as_slice).collect();
            let b: Vec<&[f64]> = b.iter().map(Vec::as_slice).collect();
            let of_pairs = |a: &[&[f64]], b: &[&[f64]]| -> Vec<Vec<f64>> {
                a.iter().map(|a| b.iter().map(|b| dot(a, b)).collect()).collect()
            };
            assert_eq!(products(&a, &b), of_pairs(&a, &b));
            assert_eq!(gram(&a), of_pairs(&a, &a));
        }
    }
}
