//! What may be claimed of runs that arrive one by one, when nobody knows how many will come: LORD++ (Ramdas, Yang,
//! Wainwright and Jordan 2017).
//!
//! Each run is tested at a level that depends on those before it only. A discovery earns levels for the runs after it; a
//! long row of clean runs uses them up. Clean runs are independent of each other, each p being made from a run's own
//! noise, which is what the rule asks for.

use super::false_discovery::CLAIMED_BELOW;

/// Levels fall with this power of the number of runs since one was earned. Slower would be fairer to late runs, but a p
/// is never below one part in a thousand draws, and a level below that finds nothing.
const POWER: f64 = 1.6;
/// Sum of `k^-1.6` over all whole numbers.
const SUM: f64 = 2.285_765_7;
/// Part of the allowed rate that stands at the beginning.
const AT_FIRST: f64 = 0.5;

/// One run in its turn.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct OnlineDecision {
    /// Place in the order of arrival, from 1.
    pub place: usize,
    /// Level at which it was tested.
    pub level: f64,
    /// Whether its p was as low, so that it was claimed when it came.
    pub is_claimed: bool,
}

/// Tests p-values in their order of arrival.
pub fn online_decisions(p: &[f64]) -> Vec<OnlineDecision> {
    let first = AT_FIRST * CLAIMED_BELOW;
    let mut claimed: Vec<usize> = Vec::new();
    let mut turns = Vec::with_capacity(p.len());
    for (k, &p) in p.iter().enumerate() {
        let place = k + 1;
        let earned = claimed.iter().enumerate().map(|(rank, &at)| {
            let of = if rank == 0 {
                CLAIMED_BELOW - first
            } else {
                CLAIMED_BELOW
            };
            of * share(place - at)
        });
        let level = first * share(place) + earned.sum::<f64>();
        let is_claimed = p <= level;
        if is_claimed {
            claimed.push(place);
        }
        turns.push(OnlineDecision {
            place,
            level,
            is_claimed,
        });
    }
    turns
}

/// Share of an earned level that the run so many places later is tested with; all shares sum to one.
fn share(places: usize) -> f64 {
    (places as f64).powf(-POWER) / SUM
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    #[test]
    fn shares_sum_to_one_and_levels_follow_the_rule() {
        let sum: f64 = (1..200_000).map(share).sum();
        // What is left behind n terms is about (n - 1/2)^-0.6 / 0.6.
        let left = 199_999.5_f64.powf(-0.6) / 0.6 / SUM;
        assert!((sum + left - 1.0).abs() < 1e-6, "{}", sum + left);
        let found = online_decisions(&[0.001, 0.5, 0.001, 0.001]);
        assert!((found[0].level - 0.025 / SUM).abs() < 1e-9 && found[0].is_claimed);
        assert!((found[1].level - (0.025 * share(2) + 0.025 * share(1))).abs() < 1e-12);
        assert!(!found[1].is_claimed && found[2].is_claimed && found[3].is_claimed);
        assert!((found[3].level - (0.025 * share(4) + 0.025 * share(3) + 0.05 * share(1))).abs() < 1e-12);
    }

    #[test]
    fn false_claims_stay_below_the_rate() {
        const CAMPAIGNS: usize = 2000;
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let (mut shares, mut found) = (0.0, 0);
        for _ in 0..CAMPAIGNS {
            // Every fifth run is wrong, with p by a thousand draws.
            let is_wrong: Vec<bool> = (0..60).map(|_| random.random_bool(0.2)).collect();
            let p: Vec<f64> = is_wrong
                .iter()
                .map(|wrong| match wrong {
                    true => 0.001,
                    false => random.random_range(0.001..1.0),
                })
                .collect();
            let claims = online_decisions(&p);
            let claimed = claims.iter().filter(|turn| turn.is_claimed).count();
            let false_ones = claims
                .iter()
                .zip(&is_wrong)
                .filter(|(turn, wrong)| turn.is_claimed && !**wrong)
                .count();
            shares += false_ones as f64 / claimed.max(1) as f64;
            found += claimed - false_ones;
        }
        let rate = shares / CAMPAIGNS as f64;
        assert!(rate < 0.05, "{rate}");
        // Of 12 wrong runs a campaign a third is found at once; q over all runs finds the others later.
        let mean = found as f64 / CAMPAIGNS as f64;
        println!("false share {rate:.3}, {mean:.1} of 12 found");
        assert!(mean > 4.0, "{mean}");
    }

    #[test]
    fn where_nothing_is_wrong_little_is_claimed() {
        let mut random = ChaCha8Rng::seed_from_u64(6);
        let mut wrong = 0;
        for _ in 0..2000 {
            let p: Vec<f64> = (0..100).map(|_| random.random_range(0.0..1.0)).collect();
            wrong += usize::from(online_decisions(&p).iter().any(|turn| turn.is_claimed));
        }
        // 5 % of 2000, and what chance adds in 1 of 1000 tries.
        assert!(wrong < 130, "{wrong} of 2000");
    }
}
