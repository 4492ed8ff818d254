//! How to diagnose.

use ieap_model::FitModel;
use ieap_model::effects::Site;
use ieap_model::effects::smooth_laws::Place;

/// Version of the procedure; a change makes earlier diagnoses out of date.
pub const VERSION: u32 = 43;

/// How to diagnose.
#[derive(Debug, Clone, Copy)]
pub struct DiagnoseOptions {
    /// The base model.
    pub model: &'static FitModel,
    /// Draws of what chance does; 999 tell a p-value of 0.001 from none.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Misfit up to which the simulation is right whatever chance says, percent of ranges.
    pub tolerance_percent: f64,
    /// A law that is taken off the list, to count what is said where the truth is not on it; none in use.
    pub absent: Option<AbsentLaw>,
}

/// A law by a variable, however it is split over branches and whichever curve it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AbsentLaw {
    /// Where it acts.
    pub site: Site,
    /// The law.
    pub law: &'static str,
    /// Key of its variable.
    pub variable: &'static str,
}

impl AbsentLaw {
    pub(crate) fn is(&self, place: &Place) -> bool {
        // Of a capacitor the charge is a function of its voltage: a law by one is a law by the other.
        let own = |variable: &'static str| match (self.law, variable) {
            ("capacitance", "charge_c_per_cm2") => "voltage_v",
            (_, other) => other,
        };
        (place.site, place.law, own(place.variable)) == (self.site, self.law, own(self.variable))
    }
}

impl Default for DiagnoseOptions {
    fn default() -> DiagnoseOptions {
        DiagnoseOptions {
            model: ieap_fit::FitOptions::default().model,
            draws: 999,
            seed: 1,
            tolerance_percent: ieap_domain::diagnosis::TOLERANCE_PERCENT,
            absent: None,
        }
    }
}
