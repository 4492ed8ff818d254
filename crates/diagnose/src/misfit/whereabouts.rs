//! Where the simulation is wrong, in words.

use ieap_domain::number::seconds::span;
use ieap_domain::number::{fixed, plain};
use ieap_domain::words::in_a_row;
use ieap_domain::{MisfitStretch, Whereabouts};
use ieap_numerics::sums::peak;

use crate::misfit::null::Null;
use crate::misfit::policy::WRONG_BIN_SIGMAS;
use crate::misfit::residual_bins::{Kind, ResidualBin};
use crate::readings::group::{RunGroup, channel_name};

/// Bins in which `residuals` are off, with a sentence on the worst of them.
pub(crate) fn whereabouts(
    group: &RunGroup,
    null: &Null,
    bins: &[ResidualBin],
    residuals: &[f64],
) -> Whereabouts {
    let scores = null.bin_scores(residuals);
    let mut segments: Vec<MisfitStretch> = Vec::new();
    for (bin, &sigma) in bins.iter().zip(&scores) {
        let (Kind::Clock(from_s, to_s), true) = (bin.kind, sigma.abs() >= WRONG_BIN_SIGMAS) else {
            continue;
        };
        let block = &group.blocks[bin.block];
        segments.push(MisfitStretch {
            run: group.runs[block.run].given.name.to_owned(),
            channel: channel_name(block.channel).to_owned(),
            from_s,
            to_s,
            sigma,
        });
    }
    segments.sort_by(|a, b| b.sigma.abs().total_cmp(&a.sigma.abs()));
    let off = (!segments.is_empty()).then(|| sentence(group, &segments));
    let said: Vec<String> = off
        .into_iter()
        .chain(unequal_edge_responses(group, bins, &scores))
        .collect();
    let text = if said.is_empty() {
        "no single stretch of time stands out".to_owned()
    } else {
        said.join("; ")
    };
    Whereabouts { text, segments }
}

/// Says which channel answers the edges of a drive of many most unequally; none where none does beyond chance.
fn unequal_edge_responses(group: &RunGroup, bins: &[ResidualBin], scores: &[f64]) -> Option<String> {
    let of_block = |place: usize| {
        let is_its = |(bin, _): &(&ResidualBin, &f64)| bin.kind == Kind::EdgeResponse && bin.block == place;
        let own: Vec<f64> = bins.iter().zip(scores).filter(is_its).map(|(_, z)| *z).collect();
        let count = own.len() as f64;
        let excess = (own.iter().map(|z| z * z).sum::<f64>() - count) / (2.0 * count).sqrt();
        (!own.is_empty()).then_some((excess, place, own))
    };
    let most = (0..group.blocks.len()).filter_map(of_block);
    let (_, place, own) = most
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(excess, ..)| *excess > WRONG_BIN_SIGMAS)?;
    let largest = peak(&own);
    let block = &group.blocks[place];
    let run = &group.runs[block.run].given;
    let what = if run.input.drive.moves() {
        format!("the moving voltage of {}", run.name)
    } else {
        format!(
            "the {} edges of the drive of {}",
            run.input.drive.segments.len(),
            run.name
        )
    };
    Some(format!(
        "the {} answers {what} unequally, by up to {} standard errors more or less than simulated",
        channel_name(block.channel),
        fixed(largest, 0)
    ))
}

/// Of bins that are off, of which there is one at least, the worst first. A moving voltage has no level to name, and no sign in
/// which too large and too small are meant.
fn sentence(group: &RunGroup, segments: &[MisfitStretch]) -> String {
    let worst = &segments[0];
    let alike: Vec<&MisfitStretch> = segments
        .iter()
        .filter(|other| other.channel == worst.channel && overlap(other, worst))
        .collect();
    let from_s = alike.iter().map(|s| s.from_s).fold(f64::INFINITY, f64::min);
    let to_s = alike.iter().map(|s| s.to_s).fold(0.0, f64::max);
    let of_run = |run: &str| {
        group
            .runs
            .iter()
            .find(|r| r.given.name == run && !r.drive().moves())
            .map(|r| r.drive().nominal_step_v())
    };
    let mut volts: Vec<f64> = alike.iter().filter_map(|s| of_run(&s.run)).collect();
    volts.sort_by(f64::total_cmp);
    volts.dedup();
    // Too large and too small are meant in size: a current of -2 mA where -1 mA was simulated is too large.
    let signs = alike
        .iter()
        .map(|s| of_run(&s.run).map_or(0.0, |volts| s.sigma * volts));
    let (mut simulated_small, mut simulated_large) = (false, false);
    signs.for_each(|sign| {
        simulated_small |= sign >= 0.0;
        simulated_large |= sign <= 0.0;
    });
    let wrong = match (simulated_small, simulated_large) {
        (true, false) => "too small",
        (false, true) => "too large",
        _ => "wrong",
    };
    let list: Vec<String> = volts.iter().map(|v| plain((100.0 * v).round() / 100.0)).collect();
    let at = if list.is_empty() {
        String::new()
    } else {
        format!(" at {} V", in_a_row(&list))
    };
    format!(
        "simulated {} {wrong} from {}{at}, by up to {} standard errors of its mean",
        worst.channel,
        span(from_s, to_s),
        fixed(worst.sigma.abs(), 0)
    )
}

fn overlap(a: &MisfitStretch, b: &MisfitStretch) -> bool {
    a.from_s <= b.to_s && b.from_s <= a.to_s
}
