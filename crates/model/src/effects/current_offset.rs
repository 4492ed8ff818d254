//! A constant in the measured current.

use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct CurrentOffset;

static ABOUT: About = About {
    id: "current-offset",
    code: "E15",
    summary: "constant added to the measured current",
    equation: "I -> I + I_off",
    variants: &[],
    parameters: &[EffectParameter {
        key: "offset_a",
        symbol: "I_off",
        unit: "A",
        meaning: "constant in the current reading",
    }],
    vanishes: "I_off = 0",
    signature: "the current before the drive is not zero; in one step the same as R_ss",
    twins: &["faradaic-leak"],
    separated_by: "readings before the drive, or a run at 0 V",
    sources: "offset of the current range of potentiostats",
};

impl Equation for CurrentOffset {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, _variant: usize, scale: &Scale) -> Search {
        Search::over(
            0.01 * scale.current_a,
            vec![Limits::linear(-0.2 * scale.current_a, 0.2 * scale.current_a)],
            &[],
        )
    }

    fn apply(&self, _variant: usize, parameters: &[f64], _run: &RunContext, system: &mut System) {
        system.current_offset_a += parameters[0];
    }
}
