//! What a selection of causes starts from.

use crate::fitting::fitted::Fitted;
use crate::misfit::calibration::{Asked, Calibration};
use crate::misfit::null::{Null, Statistics};
use crate::misfit::residual_bins::ResidualBin;
use crate::misfit::signature::{Direction, Signature, directions};
use crate::options::AbsentLaw;
use crate::readings::group::RunGroup;

/// A group, the base model fitted to it, and the questions that its residuals are asked.
pub(crate) struct SelectionInput<'a, 'g> {
    pub(crate) group: &'g RunGroup<'g>,
    pub(crate) base: &'a Fitted<'g>,
    pub(crate) signatures: &'a [Signature],
    pub(crate) bins: &'a [ResidualBin],
    pub(crate) draws: usize,
    pub(crate) seed: u64,
    /// A law that is not asked.
    pub(crate) absent: Option<AbsentLaw>,
}

impl<'g> SelectionInput<'_, 'g> {
    /// Null distribution and directions beside a fitted model.
    pub(crate) fn null(&self, fitted: &Fitted, step: u64) -> (Null, Vec<Direction>) {
        let (_, tangent) = fitted.tangent();
        let directions = directions(self.signatures, &tangent);
        let seed = self.seed.wrapping_add(step);
        let null = Null::new(self.group, &tangent, &directions, self.bins, self.draws, seed);
        (null, directions)
    }

    /// How the p of the base's misfit must be read; none where it is clear without.
    pub(crate) fn calibration(
        &self,
        null: &Null,
        observed: &Statistics,
        directions: &[Direction],
    ) -> Option<Calibration> {
        if Calibration::is_needless(null.unbounded_p(observed)) {
            return None;
        }
        let (_, tangent) = self.base.tangent();
        Some(Calibration::of(&Asked {
            group: self.group,
            null,
            tangent: &tangent,
            signatures: self.signatures,
            directions,
            bins: self.bins,
            seed: self.seed,
        }))
    }
}
