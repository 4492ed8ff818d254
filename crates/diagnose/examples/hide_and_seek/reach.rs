//! The strength at which what is hidden leaves so many standard deviations after the refit.

use ieap_diagnose::sigmas_after_refit;
use ieap_model::extended::Responses;

use crate::case::Case;

/// Strengths tried at most.
const TRIES: usize = 16;
/// What is reached may be off by this share.
const WITHIN: f64 = 0.15;

/// Where a strength is sought.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    /// First one tried.
    pub start: f64,
    pub low: f64,
    pub high: f64,
    /// Whether a larger one leaves less, as a limit does.
    pub falls: bool,
}

/// The strength, and what `with` gives there; none where `d` cannot be reached.
pub fn reach(
    case: &Case,
    d: f64,
    range: Range,
    with: impl Fn(f64) -> Option<Vec<Responses>>,
) -> Option<(f64, Vec<Responses>)> {
    let mut power: f64 = if range.falls { -1.0 } else { 1.0 };
    let mut strength = range.start;
    let mut before: Option<(f64, f64)> = None;
    // Nearest strengths that leave too little and too much.
    let (mut weak, mut strong) = (None, None);
    for _ in 0..TRIES {
        let found = with(strength)?;
        let size = sigmas_after_refit(&case.base, &case.design, &found, case.noise).max(1e-6 * d);
        if (size / d - 1.0).abs() <= WITHIN {
            return Some((strength, found));
        }
        if let Some((other, its_size)) = before {
            let measured = (size / its_size).ln() / (strength / other).ln();
            // What is nearly flat or turns round is no guide.
            if (0.3..20.0).contains(&(measured * power.signum())) {
                power = measured;
            }
        }
        before = Some((strength, size));
        *(if size < d { &mut weak } else { &mut strong }) = Some(strength);
        let factor = (d / size).powf(power.recip()).clamp(0.1, 10.0);
        let mut next = (strength * factor).clamp(range.low, range.high);
        if let (Some(weak), Some(strong)) = (weak, strong) {
            let (low, high) = (f64::min(weak, strong), f64::max(weak, strong));
            if next <= low || next >= high {
                next = (low * high).sqrt().copysign(strength);
            }
        }
        if next == strength {
            return None;
        }
        strength = next;
    }
    None
}
