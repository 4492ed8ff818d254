//! What every candidate effect would add to the readings, before and after the base parameters are refitted.

use rayon::prelude::*;

use ieap_model::effects::{ALL, Applied, Effect, Limits, Scale};
use ieap_model::extended::ExtendedModel;
use ieap_numerics::sums::dot;

use crate::fitting::problem::{ExtendedProblem, FreeEffect};
use crate::fitting::tangent::Tangent;
use crate::misfit::policy::ABSORBED;
use crate::readings::group::RunGroup;

/// Part of a probe's strength at which the signature is taken: what is left of its bend is below what a refit leaves.
const SMALL: f64 = 0.1;

/// Change of the whitened residuals by an effect at one probe.
#[derive(Clone)]
pub(crate) struct Signature {
    pub(crate) effect: &'static dyn Effect,
    pub(crate) variant: usize,
    pub(crate) limits: Vec<Limits>,
    pub(crate) probe: Vec<f64>,
    /// Strength at which the effect is absent.
    pub(crate) absent: f64,
    /// Part of the probe's strength at which the change was taken.
    pub(crate) part: f64,
    /// Whitened readings of the model with the probe less those without.
    change: Vec<f64>,
}

/// A signature after the refit, of unit length.
#[derive(Clone)]
pub(crate) struct Direction {
    /// Place of the signature in the list.
    pub(crate) signature: usize,
    /// Id of its effect.
    pub(crate) effect: &'static str,
    pub(crate) unit: Vec<f64>,
    /// Length before it was made unit: sigmas that the probe leaves after the refit.
    pub(crate) norm: f64,
    /// Whether only strengths of the probe's sign are allowed.
    pub(crate) one_sided: bool,
}

impl Direction {
    /// Forecast gain of a candidate: the fall of the sum of squares to first order; 0 for a strength of the wrong sign.
    pub(crate) fn gain(&self, residuals: &[f64]) -> f64 {
        let z = dot(&self.unit, residuals);
        if z > 0.0 || !self.one_sided { z * z } else { 0.0 }
    }
}

impl Signature {
    /// Whitened readings of the model with the probe's part less those without.
    pub(crate) fn change(&self) -> &[f64] {
        &self.change
    }

    /// The same change whitened with the noise of `to`, where it was with that of `from`: the same readings in both.
    pub(crate) fn in_noise_of(&self, from: &RunGroup, to: &RunGroup) -> Signature {
        let mut change = self.change.clone();
        from.put_back(&mut change);
        for (block, other) in from.blocks.iter().zip(&to.blocks) {
            if let Some((before, after)) = from.channel(block).zip(to.channel(other)) {
                let rows = &mut change[block.first..block.end];
                before.colour(rows);
                after.whiten(rows);
            }
        }
        to.take_out(&mut change);
        Signature {
            change,
            ..self.clone()
        }
    }

    /// The effect at this probe as something to search.
    pub(crate) fn free_effect(&self) -> FreeEffect {
        FreeEffect::new(self.effect, self.variant, self.limits.clone(), &self.probe)
    }
}

/// Effect, variant, limits, probe, and the strength at which it is absent.
type Wanted = (&'static dyn Effect, usize, Vec<Limits>, Vec<f64>, f64);

/// Signatures of every effect of the library at every probe, at the base model `at`.
pub(crate) fn signatures(problem: &ExtendedProblem, at: &[f64], scale: &Scale) -> Vec<Signature> {
    signatures_of(&ALL, problem, at, scale)
}

/// Signatures of these effects.
pub(crate) fn signatures_of(
    effects: &[&'static dyn Effect],
    problem: &ExtendedProblem,
    at: &[f64],
    scale: &Scale,
) -> Vec<Signature> {
    let model = problem.model(at);
    let mut without = Vec::new();
    problem.residuals(at, &mut without);
    let mut wanted = Vec::new();
    for &effect in effects {
        for variant in 0..effect.about().variants.len().max(1) {
            let search = effect.search(variant, scale);
            wanted.extend(
                search
                    .probes
                    .into_iter()
                    .map(|probe| (effect, variant, search.limits.clone(), probe, search.absent)),
            );
        }
    }
    let of = |(effect, variant, limits, probe, absent): Wanted| {
        let part = if absent == 0.0 { SMALL } else { 1.0 };
        let mut small = probe.clone();
        small[0] *= part;
        let change = change(problem, &model, &without, effect, variant, &small)?;
        Some(Signature {
            effect,
            variant,
            limits,
            probe,
            absent,
            part,
            change,
        })
    };
    wanted.into_par_iter().filter_map(of).collect()
}

fn change(
    problem: &ExtendedProblem,
    model: &ExtendedModel,
    without: &[f64],
    effect: &'static dyn Effect,
    variant: usize,
    probe: &[f64],
) -> Option<Vec<f64>> {
    let mut effects = model.effects.clone();
    effects.push(Applied {
        effect,
        variant,
        parameters: probe.to_vec(),
    });
    let extended = ExtendedModel {
        base: model.base.clone(),
        effects,
    };
    let mut with = Vec::with_capacity(without.len());
    for &run in &problem.runs {
        if effect.acts_in(probe, run) {
            problem.run_residuals(&extended, run, &mut with);
        } else {
            let same = with.len()..with.len() + problem.rows_of(run);
            with.extend_from_slice(&without[same]);
        }
    }
    with.iter_mut()
        .zip(without)
        .for_each(|(with, without)| *with = without - *with);
    let size = dot(&with, &with);
    (size.is_finite() && size > 0.0).then_some(with)
}

/// The signatures with what the tangent absorbs taken out; those that it absorbs whole are left out.
pub(crate) fn directions(signatures: &[Signature], tangent: &Tangent) -> Vec<Direction> {
    let of = |(place, signature): (usize, &Signature)| {
        let mut unit = signature.change.clone();
        let whole = dot(&unit, &unit).sqrt();
        tangent.remove(&mut unit);
        let norm = dot(&unit, &unit).sqrt();
        if norm < ABSORBED * whole || norm < 1e-9 {
            return None;
        }
        unit.iter_mut().for_each(|v| *v /= norm);
        let strength = signature.limits[0];
        let reach = signature.probe[0] - signature.absent;
        let one_sided = if strength.held {
            true
        } else if reach > 0.0 {
            strength.low >= signature.absent
        } else {
            strength.high <= signature.absent
        };
        Some(Direction {
            signature: place,
            effect: signature.effect.about().id,
            unit,
            norm,
            one_sided,
        })
    };
    signatures.par_iter().enumerate().filter_map(of).collect()
}
