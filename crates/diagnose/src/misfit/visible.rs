//! What a diagnosis could have seen: the least error of the simulation that would have been called wrong in 95 of 100 groups.
//!
//! Where nothing is found to be wrong, that is as much worth as the readings are: a few of them in loud or slow noise find
//! nothing wrong with anything.

use ieap_domain::MisfitPercent;

use crate::fitting::fitted::Fitted;
use crate::misfit::misfit_size::range;
use crate::misfit::policy::SEEN_SIGMAS;
use crate::misfit::residual_bins::{Kind, ResidualBin};
use crate::readings::group::RunGroup;

/// An error of that size at every reading, with a random sign in each bin of the clock, would have been seen: of the current
/// alone, and of the curvature alone.
pub(crate) fn visible_percent(group: &RunGroup, base: &Fitted, bins: &[ResidualBin]) -> MisfitPercent {
    let (_, tangent) = base.tangent();
    let mut squares = [0.0; 2];
    for bin in bins.iter().filter(|bin| matches!(bin.kind, Kind::Clock(..))) {
        let block = &group.blocks[bin.block];
        let Some(channel) = group.channel(block) else {
            continue;
        };
        let mut own = vec![0.0; block.end - block.first];
        bin.rows.iter().for_each(|&row| own[row - block.first] = 1.0);
        channel.whiten(&mut own);
        let mut series = vec![0.0; group.rows()];
        series[block.first..block.end].copy_from_slice(&own);
        group.take_out(&mut series);
        tangent.remove(&mut series);
        squares[block.channel] += series.iter().map(|v| v * v).sum::<f64>();
    }
    let largest = |channel: usize| {
        let of_channel = group.blocks.iter().filter(|block| block.channel == channel);
        let ranges = of_channel.filter_map(|block| Some(range(group.channel(block)?.values())));
        ranges.fold(0.0, f64::max)
    };
    let percent = |channel: usize| {
        let range = largest(channel);
        (squares[channel] > 0.0 && range > 0.0).then(|| 100.0 * SEEN_SIGMAS / squares[channel].sqrt() / range)
    };
    MisfitPercent {
        current: percent(0),
        curvature: percent(1),
        charge: None,
    }
}
