//! What all runs of an instrument tell of its noise: a run alone cannot tell a slow drift from what its sample does, twelve can.

use std::collections::{BTreeMap, BTreeSet};

use ieap_domain::Quantity;
use serde::{Deserialize, Serialize};

use crate::joint::policy::{NOISE_OF_ITS_OWN, PRIOR_OF_SLOW_KIND};
use crate::kind_of_noise::{KindEvidence, NoiseForm, NoiseKind, ToldOfNoise};

/// How likely each kind of noise is of an instrument, by channel, after the runs that it learnt from.
///
/// An instrument has one kind; a run has it too, or, one in ten, another that is drawn from all. So runs multiply, in any order,
/// and what one run tells can be taken out again.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct InstrumentNoise {
    runs: u32,
    current: ChannelNoises,
    curvature: ChannelNoises,
}

/// The same of one channel.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "Vec<KindEvidence>", into = "Vec<KindEvidence>")]
pub(crate) struct ChannelNoises {
    /// By kind: logarithm of how much likelier it makes the runs than a noise that is another in each of them.
    likelier: BTreeMap<NoiseKind, f64>,
}

impl InstrumentNoise {
    /// Learns from a run; one that tells nothing changes nothing.
    pub fn learn(&mut self, told: &ToldOfNoise) {
        self.runs += u32::from(!told.is_empty());
        self.current.learn(&told.current);
        self.curvature.learn(&told.curvature);
    }

    /// Runs that it learnt from.
    pub fn runs(&self) -> u32 {
        self.runs
    }

    /// Of the kinds of a channel how likely each is, sum 1: what is known before a further run is seen.
    pub fn probabilities(&self, quantity: Quantity, kinds: &[NoiseKind]) -> Vec<f64> {
        let own = if quantity == Quantity::Current {
            &self.current
        } else {
            &self.curvature
        };
        own.log_priors(kinds).iter().map(|log| log.exp()).collect()
    }

    pub(crate) fn channel(&self, bends: bool) -> &ChannelNoises {
        if bends { &self.curvature } else { &self.current }
    }
}

impl From<Vec<KindEvidence>> for ChannelNoises {
    fn from(likelier: Vec<KindEvidence>) -> ChannelNoises {
        let each = likelier.into_iter().map(|own| (own.kind, own.log_likelihood));
        ChannelNoises {
            likelier: each.collect(),
        }
    }
}

impl From<ChannelNoises> for Vec<KindEvidence> {
    fn from(noises: ChannelNoises) -> Vec<KindEvidence> {
        let each = noises.likelier.into_iter();
        each.map(|(kind, log_likelihood)| KindEvidence { kind, log_likelihood })
            .collect()
    }
}

impl ChannelNoises {
    fn learn(&mut self, evidence: &[KindEvidence]) {
        let kinds: Vec<NoiseKind> = evidence.iter().map(|own| own.kind).collect();
        let any = log_sum(
            evidence
                .iter()
                .zip(log_shares(&kinds))
                .map(|(own, share)| own.log_likelihood + share),
        );
        for own in evidence {
            let same = (1.0 - NOISE_OF_ITS_OWN) * (own.log_likelihood - any).exp();
            *self.likelier.entry(own.kind).or_default() += (same + NOISE_OF_ITS_OWN).ln();
        }
    }

    /// Logarithm of the probability of each of the kinds that the next run can have.
    pub(crate) fn log_priors(&self, kinds: &[NoiseKind]) -> Vec<f64> {
        let log = |kind: &NoiseKind| share(*kind).ln() + self.likelier.get(kind).copied().unwrap_or(0.0);
        let known: BTreeSet<&NoiseKind> = self.likelier.keys().chain(kinds).collect();
        let all = log_sum(known.iter().map(|kind| log(kind)));
        let same = |kind: &NoiseKind| (1.0 - NOISE_OF_ITS_OWN) * (log(kind) - all).exp();
        // What the instrument may have and a record of this length and clock cannot show is any of those that it can.
        let any = 1.0 - kinds.iter().map(same).sum::<f64>();
        let shares = log_shares(kinds);
        kinds
            .iter()
            .zip(shares)
            .map(|(kind, share)| (same(kind) + any * share.exp()).ln())
            .collect()
    }
}

/// How likely a kind is before any run, in that of white noise.
fn share(kind: NoiseKind) -> f64 {
    if kind.form == NoiseForm::White {
        1.0
    } else {
        PRIOR_OF_SLOW_KIND
    }
}

/// The same among these kinds, as logarithms of parts.
fn log_shares(kinds: &[NoiseKind]) -> Vec<f64> {
    let all: f64 = kinds.iter().map(|kind| share(*kind)).sum();
    kinds.iter().map(|kind| (share(*kind) / all).ln()).collect()
}

/// ln(sum of e^value).
fn log_sum(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let most = values.clone().fold(f64::NEG_INFINITY, f64::max);
    most + values.map(|value| (value - most).exp()).sum::<f64>().ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds() -> Vec<NoiseKind> {
        let slow = (0..4).map(|size| NoiseKind {
            form: NoiseForm::Process(3),
            size,
        });
        [NoiseKind {
            form: NoiseForm::White,
            size: 0,
        }]
        .into_iter()
        .chain(slow)
        .collect()
    }

    /// Evidence of a run that makes one kind likelier than all others by that much.
    fn evidence(place: usize, by: f64) -> Vec<KindEvidence> {
        let own = |(k, kind): (usize, &NoiseKind)| KindEvidence {
            kind: *kind,
            log_likelihood: -700.0 + if k == place { by } else { 0.0 },
        };
        kinds().iter().enumerate().map(own).collect()
    }

    #[test]
    fn probabilities_sum_to_one_and_runs_make_them_sure() {
        let mut noises = ChannelNoises::default();
        let of = |noises: &ChannelNoises| -> Vec<f64> {
            noises.log_priors(&kinds()).iter().map(|log| log.exp()).collect()
        };
        let mut before = of(&noises)[2];
        for _ in 0..12 {
            noises.learn(&evidence(2, 1.0));
            let now = of(&noises);
            assert!((now.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(now[2] > before, "{now:?}");
            before = now[2];
        }
        assert!(before > 0.85, "{before}");
        // Of a record that cannot show it, the others share what it has.
        let others: Vec<NoiseKind> = kinds()
            .into_iter()
            .filter(|kind| kind.size != 1 || kind.form == NoiseForm::White)
            .collect();
        let left: f64 = noises.log_priors(&others).iter().map(|log| log.exp()).sum();
        assert!((left - 1.0).abs() < 1e-12, "{left}");
    }

    /// One run with another noise, however plain, leaves the instrument what it is, and is itself believed.
    #[test]
    fn a_run_of_its_own_moves_the_instrument_by_a_bounded_amount() {
        let mut noises = ChannelNoises::default();
        (0..12).for_each(|_| noises.learn(&evidence(0, 2.0)));
        let before = noises.log_priors(&kinds());
        noises.learn(&evidence(4, 300.0));
        let after = noises.log_priors(&kinds());
        assert!(after[0] > (0.5_f64).ln(), "{before:?} {after:?}");
        assert!(after[4] + 300.0 > after[0], "{after:?}");
    }

    #[test]
    fn what_is_learnt_does_not_depend_on_the_order() {
        let all = [evidence(0, 1.0), evidence(3, 2.0), evidence(1, 0.3)];
        let learnt = |order: [usize; 3]| {
            let mut noises = ChannelNoises::default();
            order.iter().for_each(|&k| noises.learn(&all[k]));
            noises.log_priors(&kinds())
        };
        for (a, b) in learnt([0, 1, 2]).iter().zip(learnt([2, 0, 1])) {
            assert!((a - b).abs() < 1e-12);
        }
    }
}
