//! Lumped or distributed: what a run says, in numbers and in a sentence.

use ieap_domain::number::probabilities::equation;
use ieap_domain::number::{fixed, percent, significant, upper_bound};
use ieap_domain::{Estimate, Issue, LUMPED_OR_DISTRIBUTED};
pub(super) use ieap_model::distributed::criterion::LUMPED_TOLERANCE;
use ieap_model::distributed::{DistributedModel, LumpedError};
use ieap_numerics::student::quantile_95;

use super::described::electrical_parameters;
use super::estimates::electrode_resistance;
use super::identified::Identified;
use super::policy::UNEVEN_BELOW;
use super::unevenness::{Unevenness, unevenness};

/// What a run says of lumped and distributed.
#[derive(Debug, Clone, PartialEq)]
pub struct Decision {
    /// The differences between places; none where nothing was measured at two.
    pub unevenness: Option<Unevenness>,
    /// What a lumped model with these parameters gets wrong; none where the parameters do not say.
    pub lumped_error: Option<Bounded>,
    /// Resistance of both electrodes along the strip, Ohm per square: given, fitted, bounded, or why none of these.
    pub electrode_resistance_ohm_per_sq: Estimate,
}

/// The criterion with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounded {
    /// At the parameters found; none where they only bound it.
    pub value: Option<LumpedError>,
    /// Share of the first displacement, least.
    pub low_first: f64,
    /// Share of the first displacement, most.
    pub high_first: f64,
}

/// What is decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LumpedOrDistributed {
    /// Places differ, and some follow later, as resistance along the electrodes makes them.
    Distributed,
    /// Places differ, but in a pattern that a coupling of their own explains as well.
    UnevenPattern,
    /// Places do not differ beyond noise.
    Even,
    /// There is one place at most; the criterion decides.
    ByCriterion,
    /// There is one place at most, and nothing known of the electrodes.
    Untold,
}

impl Decision {
    /// Of a run without readings along the strip, from parameters of its laminate that were found otherwise.
    pub fn by_criterion(model: &DistributedModel, electrode_resistance_ohm_per_sq: Estimate) -> Decision {
        let error = model.lumped_error();
        Decision {
            unevenness: None,
            lumped_error: Some(Bounded {
                value: Some(error),
                low_first: error.first_displacement,
                high_first: error.first_displacement,
            }),
            electrode_resistance_ohm_per_sq,
        }
    }

    pub(super) fn of(found: &Identified) -> Decision {
        Decision {
            unevenness: unevenness(found),
            lumped_error: lumped_error(found),
            electrode_resistance_ohm_per_sq: electrode_resistance(found),
        }
    }

    /// What the numbers say.
    pub fn verdict(&self) -> LumpedOrDistributed {
        match (&self.unevenness, &self.lumped_error) {
            (Some(found), _) if found.p >= UNEVEN_BELOW => LumpedOrDistributed::Even,
            (Some(found), _) if found.p_later >= UNEVEN_BELOW => LumpedOrDistributed::UnevenPattern,
            (Some(_), _) => LumpedOrDistributed::Distributed,
            (None, Some(_)) => LumpedOrDistributed::ByCriterion,
            (None, None) => LumpedOrDistributed::Untold,
        }
    }

    /// The decision in a sentence, as a note of a fit.
    pub fn issue(&self) -> Issue {
        let criterion = self.criterion();
        let share = |found: &Unevenness| 100.0 * found.gain / found.uneven.max(f64::MIN_POSITIVE);
        let message = match (self.verdict(), &self.unevenness) {
            (LumpedOrDistributed::Distributed, Some(found)) => format!(
                "distributed: {} places along the strip differ as the electrodes' resistance makes them ({}), and some follow later than others ({}); it explains {} % of the differences, {} -> {} variances of the noise; {criterion}",
                found.places,
                chance(found.p),
                chance(found.p_later),
                fixed(share(found), 0),
                rounded(found.uneven),
                rounded(found.uneven - found.gain)
            ),
            (LumpedOrDistributed::UnevenPattern, Some(found)) => format!(
                "open: {} places along the strip differ ({}), but none follows later than another ({}): a coupling that differs from place to place would look the same; {criterion}",
                found.places,
                chance(found.p),
                chance(found.p_later),
            ),
            (LumpedOrDistributed::Even, Some(found)) => format!(
                "lumped: {} places along the strip do not differ as the electrodes' resistance would make them ({}); {criterion}",
                found.places,
                chance(found.p),
            ),
            (LumpedOrDistributed::ByCriterion, _) => {
                format!("{}: nothing was measured at several places; {criterion}", self.word())
            }
            _ => "cannot be told from this run: nothing was measured at several places, and the resistance of the electrodes along the strip is neither given nor determined".to_owned(),
        };
        let issue = Issue::note(LUMPED_OR_DISTRIBUTED, message);
        match self.verdict() {
            LumpedOrDistributed::Untold => issue.mend(
                "measure the electrodes with a four-point probe (electrode_resistance_ohm_per_sq of the sample), or voltages or curvatures at several places",
            ),
            LumpedOrDistributed::UnevenPattern => issue.mend(
                "voltages at several places, or frames closer together just after the step, would tell",
            ),
            _ => issue,
        }
    }

    /// The first words of the note that [`Decision::issue`] gives; none of any other issue.
    pub fn word_of(issue: &Issue) -> Option<&'static str> {
        let words = ["distributed", "open", "lumped", "cannot be told"];
        let is_it = issue.code == LUMPED_OR_DISTRIBUTED;
        words
            .into_iter()
            .find(|word| is_it && issue.message.starts_with(word))
    }

    /// What the criterion alone says.
    fn word(&self) -> &'static str {
        match &self.lumped_error {
            Some(error) if error.high_first <= LUMPED_TOLERANCE => "lumped",
            Some(error) if error.low_first > LUMPED_TOLERANCE => "distributed",
            _ => "open",
        }
    }

    fn criterion(&self) -> String {
        match &self.lumped_error {
            Some(Bounded {
                value: Some(error),
                low_first,
                high_first,
            }) => {
                let interval = if low_first < high_first {
                    // As many decimals as tell its ends apart.
                    let digits = (1.0 - (100.0 * (high_first - low_first)).log10()).clamp(1.0, 4.0) as usize;
                    format!(
                        " (95 % interval {} to {})",
                        fixed(100.0 * low_first, digits),
                        percent(*high_first, digits)
                    )
                } else {
                    String::new()
                };
                format!(
                    "a lumped model with these parameters is wrong at the tip by {} of its first motion{interval} and by {} in the end",
                    percent(error.first_displacement, 1),
                    percent(error.final_displacement, 1)
                )
            }
            Some(Bounded { high_first, .. }) => format!(
                "a lumped model is wrong at the tip by at most {} of its first motion",
                percent(*high_first, 1)
            ),
            None => "by how much a lumped model is wrong is not determined".to_owned(),
        }
    }
}

/// A chance as it is told.
fn chance(p: f64) -> String {
    match p {
        p if p < 1e-6 => format!("p {}", upper_bound(1e-6)),
        p if p < 1e-3 => format!("p = {}", significant(p, 1)),
        p => equation("p", p),
    }
}

fn rounded(square: f64) -> String {
    match square {
        s if s < 1e5 => fixed(s, 0),
        s => significant(s, 3),
    }
}

/// The criterion at the parameters, its interval from that of `x^2 = R_e L^2 (1/R_c + 1/R_ss)`.
fn lumped_error(found: &Identified) -> Option<Bounded> {
    let model = found.described().even();
    let fits_along = electrical_parameters(&found.input.strip) > 3;
    let electrical = &found.electrical;
    let (charging, steady) = (
        model.branch_resistance_ohm_cm.recip(),
        model.steady_state_resistance_ohm_cm.recip(),
    );
    let mut weights = vec![0.0; electrical.at.len()];
    weights[0] = -charging / (charging + steady);
    weights[2] = -steady / (charging + steady);
    if fits_along {
        weights[3] = 1.0;
    }
    let error = electrical.covariance.error_along(&weights);
    let half = quantile_95(electrical.freedom) * error;
    let at = |log_factor: f64| {
        let mut moved = model;
        moved.electrode_resistance_ohm_per_cm *= log_factor.exp();
        moved.lumped_error()
    };
    // Where R_e is hardly more than nothing its logarithm says little, and its size is bounded evenly.
    if half > 1.0 {
        let high = at((1.0 + half).ln()).first_displacement;
        return (fits_along || found.is_relative)
            .then_some(high)
            .filter(|high| *high < 0.5)
            .map(|high_first| Bounded {
                value: None,
                low_first: 0.0,
                high_first,
            });
    }
    Some(Bounded {
        value: Some(at(0.0)),
        low_first: at(-half).first_displacement,
        high_first: at(half).first_displacement,
    })
}
