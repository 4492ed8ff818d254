//! Where the search for one more effect beside a fitted model begins.

use ieap_numerics::sums::{dot, peak};
use ieap_numerics::symmetric::Symmetric;

use crate::fitting::fitted::Fitted;
use crate::misfit::signature::Signature;

/// Longest move of a parameter by which the others make room, in coordinates scaled to be of order one: beyond it a
/// straight line says nothing.
const FARTHEST: f64 = 1.0;
/// Parts of the forecast strength, each with the room that the others make for it.
const PARTS: [f64; 2] = [1.0, 0.4];

/// A fitted model beside which effects are tried, with the slopes that all of them need.
pub(crate) struct ExtendedStart<'a, 'g> {
    pub(crate) current: &'a Fitted<'g>,
    /// Columns of its Jacobian.
    columns: Vec<Vec<f64>>,
    normal: Symmetric,
}

impl<'a, 'g> ExtendedStart<'a, 'g> {
    pub(crate) fn of(current: &'a Fitted<'g>) -> ExtendedStart<'a, 'g> {
        let (slope, columns) = current.problem.slope(&current.at);
        ExtendedStart {
            current,
            columns,
            normal: slope.normal,
        }
    }

    /// The model with one more effect, searched from a strength of so many times its probe's.
    ///
    /// Where a refit takes up nearly all of an effect, its strength alone lies far up the wall of a valley: the search
    /// begins at the best of some places on the valley's floor, where the other parameters have made room; of the current model
    /// itself where all of them are worse, so that what it is extended by never costs anything.
    pub(crate) fn extended(&self, signature: &Signature, strength: f64) -> Option<Fitted<'g>> {
        let problem = self.current.problem.with(signature.free_effect());
        let alone = self.start(signature, strength, None);
        let room = self.room(signature, strength);
        let mut starts = vec![alone];
        starts.extend(self.itself(signature));
        starts.extend(PARTS.iter().map(|part| {
            let shift: Vec<f64> = room.iter().map(|shift| part * shift).collect();
            self.start(signature, part * strength, Some(&shift))
        }));
        let start = starts
            .into_iter()
            .map(|start| (problem.square(&start), start))
            .filter(|(square, _)| square.is_finite())
            .min_by(|a, b| a.0.total_cmp(&b.0))?
            .1;
        Fitted::search(problem, &[start], &self.columns)
    }

    /// The current model with the effect absent; none where the effect has no strength that could be.
    fn itself(&self, signature: &Signature) -> Option<Vec<f64>> {
        let strength = signature.limits[0];
        let mut absent = signature.probe.clone();
        absent[0] = signature.absent.clamp(strength.low, strength.high);
        let mut start = self.current.at.clone();
        start.extend(signature.free_effect().coordinates(&absent));
        (!strength.held).then_some(start)
    }

    fn start(&self, signature: &Signature, strength: f64, shift: Option<&[f64]>) -> Vec<f64> {
        let mut first = signature.probe.clone();
        first[0] = strength_within(signature, strength);
        let mut start = self.current.at.clone();
        for (at, shift) in start.iter_mut().zip(shift.unwrap_or(&[])) {
            *at += shift;
        }
        start.extend(signature.free_effect().coordinates(&first));
        start
    }

    /// How the other parameters move to take up what they can of the effect.
    fn room(&self, signature: &Signature, strength: f64) -> Vec<f64> {
        let times = strength_within(signature, strength) / (signature.part * signature.probe[0]);
        let right: Vec<f64> = self
            .columns
            .iter()
            .map(|column| times * dot(column, signature.change()))
            .collect();
        let shift = self.normal.solve(&right, 1e-10);
        let most = peak(&shift);
        let scale = FARTHEST / most.max(FARTHEST);
        shift.iter().map(|shift| scale * shift).collect()
    }
}

/// So many times the probe's strength, within the limits of a search; the probe's own where it is held, or where none
/// is not zero.
fn strength_within(signature: &Signature, times: f64) -> f64 {
    let (limits, own) = (signature.limits[0], signature.probe[0]);
    if limits.held || signature.absent != 0.0 {
        return own;
    }
    let low = 0.6 * limits.low.min(0.0) + 1.01 * limits.low.max(0.0);
    (times * own).clamp(low, 0.6 * limits.high)
}
