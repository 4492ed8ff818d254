//! Edges found with all that a run tells: its circuit and its bending, beside where the edges may be.

use ieap_domain::quantiles::{CHI_SQUARE_95_OF_ONE, NORMAL_95};
use ieap_domain::{Channel, ChannelNoise, Quantity, range_of};
use ieap_model::rival_law;
use ieap_numerics::line::Line;

use crate::edges::Settled;
use crate::error::FitError;
use crate::group;
use crate::options::{FitInput, FitOptions};
use crate::plain::in_two_steps;
use crate::policy::MOST_MEMORY;
use crate::two_steps::{Identified, OfStep, identified};

/// The edges of a run, of a lumped model with circuit and bending at once; of a rival's law, and of bending without a circuit,
/// where all of them together are best. Where nothing tells more they stay in the middle of where they may be. With them the
/// circuit of a single step, for whichever place of it.
///
/// # Errors
/// As [`crate::fit_run`].
pub(crate) fn settled(input: &FitInput, options: &FitOptions) -> Result<(Settled, Option<OfStep>), FitError> {
    let middle = Settled::in_the_middle(input.drive);
    if !middle.edges.is_open() {
        return Ok((middle, None));
    }
    let is_rival = rival_law(options.model.id).is_some();
    // A bending on a clock of its own has no part in where the edges are, nor has the law that a rival's is held against.
    let tells =
        |channel: &&Channel| !(channel.own_clock || is_rival && channel.quantity == Quantity::Curvature);
    let telling: Vec<Channel> = input.channels.iter().filter(tells).cloned().collect();
    let told = FitInput {
        channels: &telling,
        ..*input
    };
    let Some(identified) = identified(&told, options, middle.edges.drive()) else {
        return Ok((of_all_together(input, options, middle), None));
    };
    let step = OfStep::of(middle.edges.drive(), &identified);
    let hides = hides_charge(options, &identified);
    let settled = match group::settled(&told, options, &middle.edges, &identified) {
        Some(settled) if hides => settled.or_later(),
        Some(settled) if !is_rival => settled,
        None if hides => middle,
        settled => of_all_together(input, options, settled.unwrap_or(middle)),
    };
    Ok((settled, step))
}

/// Whether a branch of the model may have charged before the first reading behind an edge. It bends the strip as an earlier edge
/// does: the edge that is found without such a branch is the earliest that it may be.
fn hides_charge(options: &FitOptions, identified: &Identified) -> bool {
    identified.current.as_ref().is_ok_and(|(_, electrical)| {
        let seen = electrical.without_too_fast().conductances_a_per_v.len();
        seen > 0 && seen < options.model.branches
    })
}

/// Parts of the way to either side at which all edges are tried first.
const TRIED: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];

/// The edges where the plain fit leaves least, moved all alike.
fn of_all_together(input: &FitInput, options: &FitOptions, from: Settled) -> Settled {
    let shifts = from.edges.shifts().len();
    let widest_s = from
        .edges
        .shifts()
        .iter()
        .map(|shift| shift.limits_s().1 - shift.limits_s().0)
        .fold(0.0, f64::max);
    let alike = |by_s: f64| vec![by_s; shifts];
    let tried = TRIED.map(|part| part * widest_s * from.edges.part_of(&alike(part.signum() * widest_s)));
    // What is left of each response, and the variance of a long sum of it.
    let left = |by_s: f64| -> Option<Vec<(f64, f64)>> {
        let drive = from.edges.shifted(&alike(by_s));
        let fit = in_two_steps(
            &FitInput {
                drive: &drive,
                ..*input
            },
            options,
            None,
        )?;
        let of = |noise: &ChannelNoise| {
            let memory = noise.residual_autocorrelation.clamp(0.0, MOST_MEMORY);
            let variance = noise.residual_rms.powi(2);
            (
                variance * noise.readings as f64,
                variance * (1.0 + memory) / (1.0 - memory),
            )
        };
        Some(fit.noise.iter().map(of).collect())
    };
    let Some(found) = tried.iter().map(|by_s| left(*by_s)).collect::<Option<Vec<_>>>() else {
        return from;
    };
    // In variances of the noise where the model leaves least.
    let least = |k: usize| {
        found
            .iter()
            .filter_map(|own| Some(own.get(k)?.1))
            .fold(f64::INFINITY, f64::min)
    };
    let noise: Vec<f64> = (0..found[0].len()).map(least).collect();
    let square = |own: &[(f64, f64)]| {
        own.iter()
            .zip(&noise)
            .map(|(own, noise)| own.0 / noise)
            .sum::<f64>()
    };
    let (low, high) = range_of(found.iter().map(|own| square(own)));
    if high - low < CHI_SQUARE_95_OF_ONE {
        return from;
    }
    let at = |by_s: f64| left(by_s).map_or(f64::INFINITY, |own| square(&own));
    let Some(line) = Line::of(&tried, at, |_| CHI_SQUARE_95_OF_ONE) else {
        return from;
    };
    let open = if shifts == 1 {
        vec![alike((line.high - line.low) / (2.0 * NORMAL_95))]
    } else {
        from.open
    };
    Settled {
        edges: from.edges.moved(&alike(line.best)),
        open,
    }
}
