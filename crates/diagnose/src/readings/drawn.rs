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
    let readings = channel
        .values()
        .iter()
        .zip(fitted)
        .zip(channel.standard_deviation());
    let (time_s, sigma): (Vec<f64>, Vec<f64>) = channel
        .time_s()
        .iter()
        .zip(readings)
        .enumerate()
        .filter(|(k, _)| wanted(block.first + k))
        .map(|(_, (t, ((y, f), sd)))| (*t, (y - f) / sd))
        .unzip();
    let together = sigma.len().div_ceil(DRAWN).max(1);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    Some(ResidualCurve {
        run: group.runs[block.run].given.name.to_owned(),
        channel: channel_name(block.channel).to_owned(),
        time_s: time_s.chunks(together).map(mean).collect(),
        before_sigma: sigma.chunks(together).map(mean).collect(),
        after_sigma: Vec::new(),
    })
}

/// Two drawings of the same readings as one: what is left before and after.
pub(crate) fn paired(mut before: Vec<ResidualCurve>, after: &[ResidualCurve]) -> Vec<ResidualCurve> {
    for (curve, after) in before.iter_mut().zip(after) {
        curve.after_sigma.clone_from(&after.before_sigma);
    }
    before
}
