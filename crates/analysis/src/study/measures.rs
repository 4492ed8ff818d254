//! What is asked about.

use crate::parameters::COMPARED;

/// Keys of what is asked about: the parameters of figure 26 of the thesis, bending per volt, for a fit of a short record trades
/// alpha for C, and the bending lost in an hour, which has a scale where lambda has a bound only.
pub const MEASURES: [&str; 7] = [
    COMPARED[0],
    COMPARED[1],
    COMPARED[2],
    COMPARED[3],
    COMPARED[4],
    BENDING_PER_VOLT,
    BENDING_LOST,
];
/// alpha (C1 + C2): curvature per volt once charged, before it relaxes.
pub const BENDING_PER_VOLT: &str = "bending_per_volt_per_cm_v";
/// 100 (1 - exp(-3600 s lambda)).
pub const BENDING_LOST: &str = "bending_lost_in_an_hour_percent";
/// Keys of whole curves: current per area, and curvature, at every time since the step.
pub const CURVES: [&str; 2] = [CURRENT_CURVE, BENDING_CURVE];
/// Current per area.
pub const CURRENT_CURVE: &str = "current_curve";
/// Curvature.
pub const BENDING_CURVE: &str = "bending_curve";
