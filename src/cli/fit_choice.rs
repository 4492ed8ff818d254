//! How runs are fitted: options that `run`, `watch` and `fit` share.

use clap::Args;

use super::global::Global;
use crate::domain::KnownParameter;
use crate::pipeline::FitChoice;

/// How runs are fitted.
#[derive(Debug, Args)]
pub struct FitChoiceArgs {
    /// Model to fit with [default: the campaign's; `ieap list models` lists them]
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// Method that searches minima [default: variable-projection; `ieap list models` lists them]
    #[arg(long, value_name = "METHOD")]
    method: Option<String>,
    /// Fit current and curvature together, each weighted by its noise, instead of one after the other
    #[arg(long)]
    simultaneous: bool,
    /// What is known of a parameter before the fit: r1_ohm_cm2=120 (exact), r1_ohm_cm2=120±6, or lambda_per_s=0.001..0.01; repeat it for others
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = known)]
    known: Vec<KnownParameter>,
}

fn known(text: &str) -> Result<KnownParameter, String> {
    KnownParameter::parse(text).map_err(|error| error.to_string())
}

impl FitChoiceArgs {
    /// The choice, with the seed of the global options.
    pub fn choice(&self, global: &Global) -> FitChoice {
        FitChoice {
            model: self.model.clone(),
            method: self.method.clone(),
            simultaneous: self.simultaneous,
            seed: global.seed,
            known: self.known.clone(),
        }
    }
}
