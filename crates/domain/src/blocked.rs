//! What a blocking force says of a run: the moment that bends the strip, per charge and per volt.

use super::{Estimate, Issue};

/// Tag of a run whose force sensor touches the strip nearer to the clamp than at its tip: the distance, mm.
pub const FORCE_AT_MM: &str = "blocking_force_at_mm";

/// Curvature of the free strip times the distance to the sensor, rad, up to which M = 2 F a / 3 is right within 2 %: the
/// exact form of a held strip says so (a test of `ieap_model::geometry::blocking`).
pub const LARGEST_BENDING_RAD: f64 = 2.0;

/// A run in which the tip was held and its force measured.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockedRun {
    /// Row id of the run.
    pub run: i64,
    /// Its path relative to the campaign.
    pub path: String,
    /// Reading of the force that is largest in size, mN.
    pub largest_force_mn: Option<f64>,
    /// Distance from the clamp to the sensor, mm.
    pub force_at_mm: Option<f64>,
    /// Size of the moment per charge on the electrodes, mu, mN mm / C.
    pub per_charge_mn_mm_per_c: Estimate,
    /// Size of the moment per volt once charged, relaxation left aside, mN mm / V.
    pub per_volt_mn_mm_per_v: Estimate,
    /// Rate at which the moment relaxes, 1/s.
    pub relaxation_per_s: Estimate,
    /// What the fit of the moment and the reading of the force say.
    pub issues: Vec<Issue>,
}

impl BlockedRun {
    /// A run of which nothing is known, for `issue`.
    pub fn without_moment(run: i64, path: &str, issue: Issue) -> BlockedRun {
        let open = || Estimate::not_determined(issue.message.clone());
        BlockedRun {
            run,
            path: path.to_owned(),
            largest_force_mn: None,
            force_at_mm: None,
            per_charge_mn_mm_per_c: open(),
            per_volt_mn_mm_per_v: open(),
            relaxation_per_s: open(),
            issues: vec![issue],
        }
    }
}
