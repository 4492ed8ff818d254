//! How often chance alone ties readings to columns as strongly: permutation within exchangeable blocks; normal
//! errors where few orders exist; and the F distribution where the tail is beyond the draws.

use super::policy::{DRAWS, ENOUGH, FEWEST_ORDERS, RESOLVED};

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use ieap_numerics::chance::f_chance;
use ieap_numerics::grouped::Grouped;
use ieap_numerics::interrupt;
use ieap_numerics::sums::dot;

/// What was answered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Probability of a tie at least as strong by chance: the share of draws that did as well, the readings themselves counted
    /// as one, or what the F distribution says where that is less than draws resolve.
    pub p: f64,
    /// Degrees of freedom left by the strongest alternative.
    pub freedom: usize,
}

/// Asks which of `alternatives`, each with what `null` takes out and more, explains `y` better, and how often chance
/// does as well. Both must have been made with the same variances; readings of one `block` are exchangeable.
///
/// None where no alternative leaves two degrees of freedom.
pub fn ask(
    y: &[f64],
    null: &Grouped,
    alternatives: &[Grouped],
    block: &[usize],
    seed: u64,
) -> Option<Answer> {
    let usable: Vec<usize> = (0..alternatives.len())
        .filter(|&k| alternatives[k].freedom() >= 2 && alternatives[k].rank() > null.rank())
        .collect();
    if usable.is_empty() {
        return None;
    }
    let residual = null.residual(y);
    let whole = dot(&residual, &residual);
    if whole <= 0.0 {
        return None;
    }
    let mut room = Vec::with_capacity(y.len());
    let mut score = |k: usize, whitened: &[f64], null_square: f64| -> f64 {
        let left = alternatives[k].square_left(whitened, &mut room);
        normal_score(null_square, left, null, &alternatives[k])
    };
    let own: Vec<f64> = usable.iter().map(|&k| score(k, &residual, whole)).collect();
    let observed = own.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let tail = usable
        .iter()
        .map(|&k| {
            let left = alternatives[k].square_left(&residual, &mut Vec::new());
            let (above, below) = (alternatives[k].rank() - null.rank(), alternatives[k].freedom());
            f_chance(
                ((whole - left) / above as f64) / (left / below as f64),
                above,
                below,
            )
        })
        .fold(1.0, f64::min);
    // Alternatives are alike, so that their number is more than is asked: the bound is safe.
    let tail = (tail * usable.len() as f64).min(1.0);
    let best = usable.iter().zip(&own).max_by(|a, b| a.1.total_cmp(b.1));
    let freedom = best.map_or(0, |(&k, _)| alternatives[k].freedom());
    let is_permuted = orders(block) >= FEWEST_ORDERS;
    let mut draw = residual.clone();
    let places = places_of(block);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut null_room = Vec::with_capacity(y.len());
    let mut as_strong = 0;
    let threshold = observed - 1e-9 * observed.abs().max(1.0);
    for done in 1..=DRAWS {
        if is_permuted {
            let all = places.iter();
            all.for_each(|place| shuffle(&residual, &mut draw, place, &mut random));
        } else {
            draw.iter_mut()
                .for_each(|x| *x = StandardNormal.sample(&mut random));
        }
        let null_square = null.square_left(&draw, &mut null_room);
        as_strong += usize::from(usable.iter().any(|&k| score(k, &draw, null_square) >= threshold));
        if as_strong == ENOUGH {
            let p = ENOUGH as f64 / done as f64;
            return Some(Answer { p, freedom });
        }
    }
    let drawn = (as_strong + 1) as f64 / (DRAWS + 1) as f64;
    let p = if as_strong < RESOLVED {
        tail.min(drawn)
    } else {
        drawn
    };
    Some(Answer { p, freedom })
}

/// The ratio of mean squares as a standard normal score (Wilson and Hilferty 1931), so that alternatives of
/// different size compare.
fn normal_score(whole: f64, left: f64, null: &Grouped, full: &Grouped) -> f64 {
    let (above, below) = ((full.rank() - null.rank()) as f64, full.freedom() as f64);
    let ratio = ((whole - left).max(0.0) / above) / (left / below).max(f64::MIN_POSITIVE);
    let root = ratio.cbrt();
    let (a, b) = (2.0 / (9.0 * above), 2.0 / (9.0 * below));
    ((1.0 - b) * root - (1.0 - a)) / (b * root * root + a).sqrt()
}

fn places_of(block: &[usize]) -> Vec<Vec<usize>> {
    let blocks = block.iter().max().map_or(0, |last| last + 1);
    let mut places = vec![Vec::new(); blocks];
    for (k, &b) in block.iter().enumerate() {
        places[b].push(k);
    }
    places
}

fn shuffle(from: &[f64], into: &mut [f64], places: &[usize], random: &mut ChaCha8Rng) {
    interrupt::check();
    let mut order: Vec<f64> = places.iter().map(|&k| from[k]).collect();
    order.shuffle(random);
    for (&k, value) in places.iter().zip(order) {
        into[k] = value;
    }
}

/// Number of orders within blocks, up to 10^15.
fn orders(block: &[usize]) -> f64 {
    let mut count = 1.0;
    for place in places_of(block) {
        for k in 2..=place.len() {
            count *= k as f64;
            if count > 1e15 {
                return count;
            }
        }
    }
    count
}

/// Largest distance of p-values from an even distribution.
#[cfg(test)]
pub fn distance_from_even(p: &[f64]) -> f64 {
    let mut sorted = p.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let above = |k: usize, p: f64| ((k + 1) as f64 / n - p).max(p - k as f64 / n);
    sorted
        .iter()
        .enumerate()
        .map(|(k, &p)| above(k, p))
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use rand_distr::StudentT;

    use super::*;

    fn long() -> bool {
        std::env::var_os("IEAP_LONG").is_some()
    }

    /// p-values where nothing is tied: `samples` of `each` readings with offsets, a column that rises within them.
    fn null_p(samples: usize, each: usize, heavy: bool, tries: u64) -> Vec<f64> {
        let group: Vec<usize> = (0..samples * each).map(|k| k / each).collect();
        let column: Vec<f64> = (0..samples * each).map(|k| (k % each) as f64).collect();
        let hinge: Vec<f64> = column
            .iter()
            .map(|x| (x - 0.6 * (each - 1) as f64).max(0.0))
            .collect();
        let variance: Vec<f64> = (0..group.len()).map(|k| 0.2 + 0.3 * (k % 4) as f64).collect();
        let null = Grouped::new(&variance, &group, &[]);
        let full: Vec<Grouped> = [column, hinge]
            .iter()
            .map(|shape| Grouped::new(&variance, &group, std::slice::from_ref(shape)))
            .collect();
        let fat = StudentT::new(3.0).unwrap();
        let one = |k: u64| {
            let mut random = ChaCha8Rng::seed_from_u64(1000 + k);
            let mut draw = || {
                if heavy {
                    fat.sample(&mut random)
                } else {
                    StandardNormal.sample(&mut random)
                }
            };
            let offsets: Vec<f64> = (0..samples).map(|_| 3.0 * draw()).collect();
            let y: Vec<f64> = group
                .iter()
                .zip(&variance)
                .map(|(&g, v)| offsets[g] + v.sqrt() * draw())
                .collect();
            ask(&y, &null, &full, &group, k).unwrap().p
        };
        (0..tries).map(one).collect()
    }

    #[test]
    #[ignore = "slow: cargo test -- --ignored"]
    fn p_values_are_even_where_nothing_is_tied() {
        let tries = if long() { 4000 } else { 400 };
        for (samples, each, heavy) in [(6, 4, false), (3, 5, true), (4, 3, false), (12, 4, true)] {
            let p = null_p(samples, each, heavy, tries);
            let distance = distance_from_even(&p);
            let below = |level: f64| p.iter().filter(|p| **p <= level).count() as f64 / tries as f64;
            println!(
                "{samples} samples x {each}, heavy tails {heavy}: KS {distance:.3} (5 %: {:.3}); {:.3} below 0.05, {:.4} below 0.01",
                1.358 / (tries as f64).sqrt(),
                below(0.05),
                below(0.01)
            );
            // What chance passes in 1 of 1000 tries.
            assert!(
                distance < 1.95 / (tries as f64).sqrt(),
                "{samples} {each}: {distance}"
            );
            assert!(below(0.01) < 0.01 + 3.3 * (0.01 / tries as f64).sqrt());
        }
    }

    #[test]
    fn a_tie_is_found() {
        let group: Vec<usize> = (0..24).map(|k| k / 4).collect();
        let x: Vec<f64> = (0..24).map(|k| f64::from(k % 4)).collect();
        let bent: Vec<f64> = x.iter().map(|x| f64::max(x - 2.0, 0.0)).collect();
        let y: Vec<f64> = bent
            .iter()
            .enumerate()
            .map(|(k, bent)| 5.0 * bent + (k as f64 * 1.7).sin() + group[k] as f64)
            .collect();
        let null = Grouped::new(&[1.0; 24], &group, &[]);
        let full: Vec<Grouped> = [x, bent]
            .iter()
            .map(|shape| Grouped::new(&[1.0; 24], &group, std::slice::from_ref(shape)))
            .collect();
        let answer = ask(&y, &null, &full, &group, 1).unwrap();
        assert!(answer.p < 1e-4, "{answer:?}");
    }
}
