//! How to diagnose.

use ieap_model::FitModel;

/// Version of the procedure; a change makes earlier diagnoses out of date.
pub const VERSION: u32 = 41;

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
}

impl Default for DiagnoseOptions {
    fn default() -> DiagnoseOptions {
        DiagnoseOptions {
            model: ieap_fit::FitOptions::default().model,
            draws: 999,
            seed: 1,
            tolerance_percent: ieap_domain::diagnosis::TOLERANCE_PERCENT,
        }
    }
}
