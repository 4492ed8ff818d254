//! All candidates together: how much likelier the residuals are if one of the effects is there than if none is.
//!
//! The largest gain alone makes a simple effect pay for the many forms of the others. Of tests of a given false-alarm rate
//! the one on the ratio of likelihoods sees most on average over what may be there (Neyman and Pearson's lemma, for the
//! mean of the alternatives): here every effect is as likely as every other, and so is each of its forms.

use crate::misfit::policy::SHRUNK;
use crate::misfit::signature::Direction;

/// Share of every direction in the whole.
pub(crate) struct Mixture {
    shares: Vec<f64>,
}

impl Mixture {
    pub(crate) fn of(directions: &[Direction]) -> Mixture {
        let forms = |id: &str| directions.iter().filter(|other| other.effect == id).count();
        let mut effects: Vec<&str> = directions.iter().map(|direction| direction.effect).collect();
        effects.sort_unstable();
        effects.dedup();
        let share = |direction: &Direction| 1.0 / (forms(direction.effect) * effects.len()) as f64;
        Mixture {
            shares: directions.iter().map(share).collect(),
        }
    }

    /// Logarithm of the ratio of likelihoods, from the gain of every direction; 0 of none.
    pub(crate) fn log_ratio(&self, gains: &[f64]) -> f64 {
        let most = gains.iter().copied().fold(0.0, f64::max);
        let part = |(share, gain): (&f64, &f64)| share * (0.5 * SHRUNK * (gain - most)).exp();
        let sum: f64 = self.shares.iter().zip(gains).map(part).sum();
        if sum > 0.0 {
            0.5 * SHRUNK * most + sum.ln()
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn direction(effect: &'static str) -> Direction {
        Direction {
            signature: 0,
            effect,
            unit: vec![1.0],
            norm: 1.0,
            one_sided: false,
        }
    }

    #[test]
    fn an_effect_of_many_forms_weighs_no_more_than_one_of_one() {
        let mixture = Mixture::of(&["a", "b", "b", "b", "b"].map(direction));
        let only = |k: usize, gain: f64| {
            let mut gains = [0.0; 5];
            gains[k] = gain;
            mixture.log_ratio(&gains)
        };
        assert!(only(0, 20.0) > only(1, 20.0) + 1.0);
        assert!((mixture.log_ratio(&[0.0, 9.0, 9.0, 9.0, 9.0]) - only(0, 9.0)).abs() < 1e-12);
        assert_eq!(mixture.log_ratio(&[0.0; 5]), 0.0);
        // It does not overflow.
        assert!((only(0, 1e6) - (0.5e6 * SHRUNK - 2.0_f64.ln())).abs() < 1e-3);
        assert_eq!(Mixture::of(&[]).log_ratio(&[]), 0.0);
    }
}
