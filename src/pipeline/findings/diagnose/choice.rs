//! How to diagnose: the base model, seed and draws, of the command line or of campaign.toml.

use crate::diagnose::DiagnoseOptions;
use crate::domain::Campaign;
use crate::fit::FitError;
use crate::model::{ModelChoice, fit_models};
use crate::pipeline::PipelineError;

/// How to diagnose.
#[derive(Debug, Clone, Default)]
pub struct DiagnoseChoice {
    /// Base model; none takes the campaign's.
    pub model: Option<String>,
    /// Draws of what chance does; none takes the default. Doors take [`Draws`](crate::diagnose::Draws).
    pub draws: Option<usize>,
    /// Seed of the draws; none takes the default.
    pub seed: Option<u64>,
}

impl DiagnoseChoice {
    /// As options of a diagnosis. Only lumped models have an extended form: another one that is asked for is refused; where
    /// the campaign is fitted with one, the default model stands in ([`stands_in`] says so).
    pub(crate) fn options(&self, campaign: &Campaign) -> Result<DiagnoseOptions, FitError> {
        let options = self.options_for(&campaign.model)?;
        let stated = campaign.tolerance_percent;
        Ok(DiagnoseOptions {
            tolerance_percent: stated.unwrap_or(options.tolerance_percent),
            ..options
        })
    }

    /// The same where `model` is what the campaign states.
    pub(crate) fn options_for(&self, model: &str) -> Result<DiagnoseOptions, FitError> {
        let default = DiagnoseOptions::default();
        // What extends the campaign's model was found against its base, and is asked about against it again.
        let stated = ModelChoice::parse(self.model.as_deref().unwrap_or(model))?.base;
        if self.model.is_some() && !is_extended(stated.id) {
            return Err(FitError::NotExtended {
                found: stated.id,
                known: extended_ids(),
            });
        }
        Ok(DiagnoseOptions {
            model: if is_extended(stated.id) {
                stated
            } else {
                default.model
            },
            draws: self.draws.unwrap_or(default.draws),
            seed: self.seed.unwrap_or(default.seed),
            ..default
        })
    }
}

/// Whether effects extend the model of that id.
fn is_extended(model: &str) -> bool {
    model.starts_with("lumped")
}

fn extended_ids() -> String {
    let ids = fit_models().iter().map(|model| model.id);
    ids.filter(|id| is_extended(id)).collect::<Vec<_>>().join(", ")
}

/// That another model is diagnosed than the one that the campaign is fitted with, and why; none where it is the same.
///
/// # Errors
/// The campaign's model is not known.
pub fn stands_in(choice: &DiagnoseChoice, campaign: &Campaign) -> Result<Option<String>, PipelineError> {
    let stated = ModelChoice::parse(&campaign.model)
        .map_err(FitError::from)?
        .base
        .id;
    let taken = choice.options(campaign)?.model.id;
    Ok((choice.model.is_none() && taken != stated).then(|| {
        format!(
            "{stated} has no form that effects extend, so {taken} is diagnosed in its place; a diagnosis extends {}",
            extended_ids()
        )
    }))
}
