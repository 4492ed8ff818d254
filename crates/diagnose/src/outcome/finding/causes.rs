//! Candidates as they are reported: by forecast, by fit, and how alike they are.

use super::FindingBuilder;
use crate::cause::candidates::CandidateFit;
use crate::cause::lead::Lead;
use crate::cause::select::Selection;
use crate::misfit::signature::{Direction, Signature};
use crate::outcome::policy::{MOST_COMPARED, MOST_REPORTED};
use ieap_domain::{Candidate, Confusable};
use ieap_numerics::sums::dot;

impl FindingBuilder<'_, '_> {
    /// How alike the traces of the leading candidates are.
    pub(crate) fn confusable(&self, places: impl Iterator<Item = usize>) -> Confusable {
        let leading: Vec<&Direction> = places
            .take(MOST_COMPARED)
            .map(|place| &self.directions[place])
            .collect();
        let likeness = |a: &Direction, b: &Direction| dot(&a.unit, &b.unit).abs().min(1.0);
        Confusable {
            effects: leading
                .iter()
                .map(|direction| self.signatures[direction.signature].effect.about().id.to_owned())
                .collect(),
            likeness: leading
                .iter()
                .map(|a| leading.iter().map(|b| likeness(a, b)).collect())
                .collect(),
        }
    }

    /// The best direction of every effect with its forecast, the best first.
    pub(crate) fn by_forecast(&self) -> Vec<(usize, f64)> {
        let mut best: Vec<(usize, f64)> = Vec::new();
        for (place, direction) in self.directions.iter().enumerate() {
            let id = self.signatures[direction.signature].effect.about().id;
            let forecast = direction.gain(self.residuals);
            let same = |(other, _): &&mut (usize, f64)| {
                self.signatures[self.directions[*other].signature]
                    .effect
                    .about()
                    .id
                    == id
            };
            match best.iter_mut().find(same) {
                Some(known) if known.1 < forecast => *known = (place, forecast),
                Some(_) => {}
                None => best.push((place, forecast)),
            }
        }
        best.sort_by(|a, b| b.1.total_cmp(&a.1));
        best
    }

    /// Candidates by forecast alone.
    pub(crate) fn forecasts(&self) -> Vec<Candidate> {
        let best = self.by_forecast();
        let first = best.first().map(|(place, _)| *place);
        best.iter()
            .take(MOST_REPORTED)
            .map(|&(place, forecast)| self.candidate(place, first, forecast))
            .collect()
    }

    fn candidate(&self, place: usize, best: Option<usize>, forecast_gain: f64) -> Candidate {
        let direction = &self.directions[place];
        let signature = &self.signatures[direction.signature];
        let about = signature.effect.about();
        // Seen in 80 % of groups: 0.84 standard deviations beyond what chance passes in 5 %.
        let seen = self.null.gain_at_5_percent().sqrt() + 0.84;
        let likeness = best.map_or(0.0, |best| {
            dot(&direction.unit, &self.directions[best].unit).abs()
        });
        Candidate {
            effect: about.id.to_owned(),
            variant: about.variants.get(signature.variant).map(|v| (*v).to_owned()),
            forecast_gain,
            fitted_gain: None,
            extra_parameters: signature.free_effect().free(),
            held_out_gain: None,
            left_after_refit: direction.left,
            detectable_strength: detectable(signature, seen / direction.norm),
            likeness,
            accepted: false,
        }
    }

    /// The leading candidates; those of `lead` are accepted where it is told.
    pub(crate) fn candidates(
        &self,
        selection: &Selection,
        lead: Option<&Lead>,
        is_told: bool,
    ) -> Vec<Candidate> {
        let Some(step) = selection.steps.first() else {
            return self.forecasts();
        };
        let first = step.candidates.first().map(|candidate| candidate.direction);
        let taken = lead.map_or_else(Vec::new, Lead::ids);
        let held_out: Option<f64> = lead.map(|lead| lead.held_out.falls().iter().sum());
        let of = |candidate: &CandidateFit| {
            let accepted = is_told && taken.contains(&candidate.effect);
            Candidate {
                fitted_gain: candidate.fitted.as_ref().map(|_| candidate.gain),
                held_out_gain: held_out.filter(|_| taken == [candidate.effect]),
                accepted,
                ..self.candidate(candidate.direction, first, candidate.forecast)
            }
        };
        step.candidates.iter().take(MOST_REPORTED).map(of).collect()
    }
}

/// Strength of that many times what the signature was taken at.
fn detectable(signature: &Signature, times: f64) -> f64 {
    if signature.absent == 0.0 {
        times * signature.part * signature.probe[0]
    } else {
        signature.probe[0]
    }
}
