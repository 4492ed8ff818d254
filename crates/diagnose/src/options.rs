//! How to diagnose.

use ieap_model::FitModel;

/// Version of the procedure; a change makes earlier diagnoses out of date.
pub const VERSION: u32 = 30;

/// How to diagnose.
#[derive(Debug, Clone, Copy)]
pub struct DiagnoseOptions {
    /// The base model.
    pub model: &'static FitModel,
    /// Draws of what chance does; 999 tell a p-value of 0.001 from none.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Whether this is a run of a group of several, which is diagnosed too and can say more of the cause.
    pub of_several: bool,
}

impl Default for DiagnoseOptions {
    fn default() -> DiagnoseOptions {
        DiagnoseOptions {
            model: ieap_fit::FitOptions::default().model,
            draws: 999,
            seed: 1,
            of_several: false,
        }
    }
}
