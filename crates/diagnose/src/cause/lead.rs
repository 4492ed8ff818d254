//! Which explanation leads, and whether it is adequate.
//!
//! An explanation that leaves a misfit is refuted, and with it all that explain no more. The next leads, until one leaves no
//! more than chance does or none is left; then the first stands for what is explained in part.

use ieap_domain::Hypothesis;

use crate::cause::candidates::CandidateFit;
use crate::cause::evidence::{Standing, Weighed};
use crate::cause::policy::{BETTER_PARTS, FOUND_AGAIN_PART, MOST_ASKED, NAMELESS_BEATS_BY};
use crate::cause::proof::discrepancy;
use crate::cause::proof::held_out::{self, Part};
use crate::cause::select::Selection;
use crate::cause::selection_input::SelectionInput;
use crate::fitting::fitted::Fitted;
use crate::levels::WRONG_BELOW;

/// The explanation that leads.
pub(crate) struct Lead<'g> {
    pub(crate) model: Fitted<'g>,
    /// Chance of what it leaves.
    pub(crate) p_leftover: f64,
    pub(crate) held_out: HeldOut,
}

impl Lead<'_> {
    pub(crate) fn is_adequate(&self) -> bool {
        self.p_leftover >= WRONG_BELOW
    }

    /// Ids of its effects.
    pub(crate) fn ids(&self) -> Vec<&'static str> {
        let effects = self.model.problem.effects.iter();
        effects.map(|free_effect| free_effect.effect.about().id).collect()
    }
}

/// Held-out parts by the base and by the extended model.
pub(crate) struct HeldOut {
    pub(crate) before: Vec<Part>,
    pub(crate) after: Vec<Part>,
    /// Fall of the deviance on each by a smooth answer to the voltage that has no name.
    pub(crate) nameless: Vec<f64>,
}

impl HeldOut {
    /// Fall of the deviance on every part.
    pub(crate) fn falls(&self) -> Vec<f64> {
        self.before
            .iter()
            .zip(&self.after)
            .map(|(before, after)| before.deviance - after.deviance)
            .collect()
    }

    /// Whether the extension predicts better what it has not seen, and no worse than what has no name.
    pub(crate) fn passed(&self, gain: f64) -> bool {
        let falls = self.falls();
        let total: f64 = falls.iter().sum();
        let nameless: f64 = self.nameless.iter().sum();
        let better = falls.iter().filter(|fall| **fall > 0.0).count() as f64;
        let is_most = total > 0.0 && better >= BETTER_PARTS * falls.len() as f64;
        nameless <= total + NAMELESS_BEATS_BY && (total > FOUND_AGAIN_PART * gain || is_most)
    }
}

/// What stands after the leading explanations were asked what they leave.
pub(crate) struct Settled<'g> {
    /// None where no effect was fitted.
    pub(crate) lead: Option<Lead<'g>>,
    pub(crate) posterior: Vec<Hypothesis>,
}

impl<'g> SelectionInput<'_, 'g> {
    /// Asks the leading explanations what they leave. `may_vary` says whether each run is described by its own parameters.
    pub(crate) fn settled(&self, weighed: &Weighed<'_, 'g>, may_vary: bool) -> Settled<'g> {
        let mut standing = Standing {
            may_vary,
            ..Standing::ALL
        };
        let mut first: Option<(&Fitted<'g>, f64)> = None;
        let mut found = None;
        for _ in 0..MOST_ASKED {
            let Some(lead) = weighed.lead(standing) else { break };
            let p = self.p_of(lead);
            first.get_or_insert((lead, p));
            if p >= WRONG_BELOW {
                found = Some((lead, p));
                break;
            }
            standing.refuted_below = 0.5 * (self.base.square - lead.square);
        }
        if found.is_none() {
            standing.refuted_below = f64::INFINITY;
        }
        let lead = found.or(first).map(|(model, p_leftover)| Lead {
            model: model.clone(),
            p_leftover,
            held_out: self.held_out(model),
        });
        Settled {
            lead,
            posterior: weighed.posterior(standing),
        }
    }

    /// Chance of what a model leaves.
    fn p_of(&self, model: &Fitted<'g>) -> f64 {
        let (null, directions) = self.null(model, 1);
        let left = null.observe(self.group, &model.residuals(), &directions);
        self.p_left(model, &null, &left, 1)
    }

    /// Every held-out part by the base, by `model`, and by what has no name.
    fn held_out(&self, model: &Fitted<'g>) -> HeldOut {
        let before = held_out::parts(self.base, self.group);
        HeldOut {
            after: held_out::parts(model, self.group),
            nameless: discrepancy::falls(self.base, self.group, &before),
            before,
        }
    }
}

impl Selection<'_> {
    /// Chance of as large a gain as the best beside which the effect was fitted first; 1 of one that was not fitted.
    pub(crate) fn p_of(&self, id: &str) -> f64 {
        let is_it = |other: &CandidateFit| other.effect == id && other.fitted.is_some();
        let own = self.steps.iter().find(|step| step.candidates.iter().any(is_it));
        own.map_or(1.0, |step| step.p)
    }
}
