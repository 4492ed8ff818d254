//! Residuals as they are drawn: single readings over the noise, neighbours averaged.

use ieap_domain::ResidualCurve;

use crate::readings::group::{Block, RunGroup, channel_name};

/// Points of a drawn residual.
const DRAWN: usize = 160;

/// Residuals of one channel of one run where the model says `fitted` at its readings; of the readings that `wanted`
/// tells by their row in the group.
pub(crate) fn drawn(
    group: &RunGroup,
    block: &Block,
    fitted: &[f64],
    wanted: &dyn Fn(usize) -> bool,
) -> Option<ResidualCurve> {
    let channel = group.channel(block)?;
    let readings = channel.values().iter().zip(fitted);
    let rows = channel
        .time_s()
        .iter()
        .zip(readings)
        .zip(channel.standard_deviation());
    let kept: Vec<[f64; 4]> = rows
        .enumerate()
        .filter(|(k, _)| wanted(block.first + k))
        .map(|(_, ((t, (y, f)), sd))| [*t, (y - f) / sd, *y, *f])
        .collect();
    let together = kept.len().div_ceil(DRAWN).max(1);
    let means = |column: usize| -> Vec<f64> {
        let mean = |rows: &[[f64; 4]]| rows.iter().map(|row| row[column]).sum::<f64>() / rows.len() as f64;
        kept.chunks(together).map(mean).collect()
    };
    Some(ResidualCurve {
        run: group.runs[block.run].given.name.to_owned(),
        channel: channel_name(block.channel).to_owned(),
        time_s: means(0),
        before_sigma: means(1),
        after_sigma: Vec::new(),
        measured: means(2),
        base: means(3),
        extended: Vec::new(),
    })
}

/// Two drawings of the same readings as one: what is left before and after.
pub(crate) fn paired(mut before: Vec<ResidualCurve>, after: &[ResidualCurve]) -> Vec<ResidualCurve> {
    for (curve, after) in before.iter_mut().zip(after) {
        curve.after_sigma.clone_from(&after.before_sigma);
        curve.extended.clone_from(&after.base);
    }
    before
}
