//! Runs of a campaign out of the rows that `ieap export --what traces --partitioned` writes: they are fitted as the campaign
//! fits them, and what comes out is what `ieap import-fits` takes.

use super::RunAtHand;
use super::fit::{FitAtHand, fit, options_as_asked};
use crate::domain::{AskedFit, Channel, Drive, Issue, KnownParameter};
use crate::fit::FitOptions;
use crate::pipeline::campaign::context::CODE_VERSION;
use crate::pipeline::fits::choice::FitChoice;
use crate::pipeline::fits::input_hash::{input_hash, input_hash_beside, is_weighed_by_kinds};
use crate::pipeline::fits::instruments::NoiseOfOthers;
use crate::pipeline::fits::result::FitResult;
use crate::store::FitTask;

/// What a row says of a run and of its fit.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignRow {
    /// Name of the run.
    pub run: String,
    /// Hash of its readings.
    pub data_hash: String,
    /// Hash of everything that its fit depends on.
    pub input_hash: String,
    /// Active area, cm2.
    pub area_cm2: f64,
    /// Free length, cm.
    pub length_cm: Option<f64>,
    /// Resistance of both electrodes along the strip, Ohm per square.
    pub electrode_resistance_ohm_per_sq: Option<f64>,
    /// Its standard error, where a probe measured it, Ohm per square.
    pub electrode_resistance_error_ohm_per_sq: Option<f64>,
    /// The drive.
    pub drive: Drive,
    /// Readings of the strip as a whole.
    pub channels: Vec<Channel>,
    /// How the campaign fits it.
    pub chosen: AskedFit,
    /// What other runs of its instrument tell of its noise.
    pub noise: NoiseOfOthers,
}

impl CampaignRow {
    /// The run, for whoever diagnoses it or fits it otherwise.
    pub fn at_hand(&self) -> RunAtHand {
        RunAtHand {
            channels: self.channels.clone(),
            task: FitTask {
                run_id: 0,
                revision: 0,
                path: self.run.clone(),
                drive: self.drive.clone(),
                area_cm2: self.area_cm2,
                length_cm: self.length_cm,
                electrode_resistance_ohm_per_sq: self.electrode_resistance_ohm_per_sq,
                electrode_resistance_error_ohm_per_sq: self.electrode_resistance_error_ohm_per_sq,
                data_hash: self.data_hash.clone(),
                climate_hash: None,
                sample: None,
                instrument: None,
                started_at: None,
                last_asked: AskedFit::default(),
            },
            tags: Default::default(),
            issues: Vec::new(),
        }
    }

    /// Fits it as the campaign does, or as `choice` asks for; gives the result as `ieap import-fits` takes it too.
    pub fn fit(&self, choice: &FitChoice) -> (Result<FitAtHand, Issue>, FitResult) {
        let asked = choice.asked();
        let run = self.at_hand();
        let options = self.options(&run, &asked);
        let made = options.and_then(|options| {
            let told = options.told_by(&self.noise.noise);
            let (fit, stated) = fit(&run, &told, &asked.known)?;
            let input_hash = self.hash_beside(&run, &options, &asked.known);
            Ok((fit, FitAtHand { input_hash, ..stated }))
        });
        let hash = made
            .as_ref()
            .map_or(&self.input_hash, |(_, stated)| &stated.input_hash);
        let outcome = made.as_ref().map(|(fit, _)| fit.clone()).map_err(Issue::clone);
        let result = FitResult::of(&self.run, &self.data_hash, hash, &asked, outcome);
        (made.map(|(_, stated)| stated), result)
    }

    /// Hash of everything that its fit depends on, in which others tell of its noise.
    fn hash_beside(&self, run: &RunAtHand, options: &FitOptions, known: &[KnownParameter]) -> String {
        let is_weighed = is_weighed_by_kinds(&run.task, options, known);
        let others = self.noise.made_from.iter().filter(|_| is_weighed);
        input_hash_beside(input_hash(&run.task, options, known), others.map(String::as_str))
    }

    fn options(&self, run: &RunAtHand, asked: &AskedFit) -> Result<FitOptions<'static>, Issue> {
        let options = options_as_asked(&asked.or(&self.chosen))?;
        if asked.is_open() && self.hash_beside(run, &options, &[]) != self.input_hash {
            let message = "what stands in the row is not what its input_hash is of";
            let issue = Issue::error("other-input", message).at("input_hash");
            return Err(issue.mend(format!(
                "export the runs with this version of ieap ({CODE_VERSION}), leave their columns as they are, and fit runs \
                 whose method has a seed of its own in the campaign"
            )));
        }
        Ok(options)
    }
}
