//! What tables are made from.

use super::of_run::ById;
use crate::cache::Cache;
use crate::cycles::CycleRun;
use crate::frequency::FrequencyRun;
use crate::impedance::OneLikelihood;
use crate::laws::doubt::Doubts;
use crate::model_free::ModelFree;
use crate::model_free::curves::StepCurves;
use crate::models_compared::view::Compared;
use crate::monitoring::Monitoring;
use crate::probe::Course;
use crate::reductions::RunReductions;
use crate::study::{Evidence, Study};
use ieap_domain::{
    BlockedRun, Campaign, GroupDiagnosis, ModulusLog, RunComparison, RunRecord, SourceFile, SpectrumRun,
};

/// What tables are made from.
#[derive(Debug, Clone, Copy)]
pub struct TableInput<'a> {
    /// The campaign.
    pub campaign: &'a Campaign,
    /// Current revision of every run that speaks.
    pub runs: &'a [RunRecord],
    /// The runs that do not: only the list of runs shows them.
    pub set_aside: &'a [RunRecord],
    /// Current modulus logs with what was found in them.
    pub modulus_logs: &'a [ModulusLog],
    /// Impedance spectra with what was found in them.
    pub spectra: &'a [SpectrumRun],
    /// What blocking forces of the runs say.
    pub blocked: &'a [BlockedRun],
    /// What runs under a sine or a chirp say against frequency.
    pub frequency: &'a [FrequencyRun],
    /// What the runs say without a model.
    pub model_free: &'a [ModelFree],
    /// Their current and bending after the step, in the order of the runs, for tables that ask for them.
    pub curves: &'a [StepCurves],
    /// Trains, cycle by cycle.
    pub cycles: &'a [CycleRun],
    /// Steps and spectra of the same strips in one likelihood.
    pub one_likelihood: &'a [OneLikelihood],
    /// Where simpler circuits would do.
    pub reductions: &'a [RunReductions],
    /// The electrodes' resistance over time, by the probe.
    pub electrodes: &'a [Course],
    /// Every file that the last scan saw.
    pub files: &'a [SourceFile],
    /// Diagnoses of groups.
    pub groups: &'a [GroupDiagnosis],
    /// Diagnoses of single runs.
    pub alone: &'a [GroupDiagnosis],
    /// Parameters over the life of the samples, for tables that ask for them.
    pub monitoring: Option<&'a Monitoring>,
    /// What they say against the fits of the runs.
    pub doubts: &'a Doubts,
    /// Comparisons of models on single runs.
    pub comparisons: &'a [RunComparison],
    /// Number of comparisons that are not among them, since what they were made from has changed.
    pub outdated_comparisons: usize,
    /// What the study asked of these runs and their curves, where that is known; else it is asked anew.
    pub told: Option<&'a Study>,
    /// What of it was answered before.
    pub kept: Option<&'a Cache>,
    /// Program and state of the database, for the table's foot.
    pub origin: &'a str,
}

impl<'a> TableInput<'a> {
    /// What the study asked, with its answers.
    pub fn study(&self) -> Study {
        if let Some(told) = self.told {
            return told.clone();
        }
        let evidence = Evidence {
            runs: self.runs,
            campaign: self.campaign,
            doubts: self.doubts,
            curves: self.curves,
        };
        Study::kept(evidence, self.kept.unwrap_or(&Cache::default())).beside(self.set_aside)
    }

    /// Of these runs alone.
    pub fn new(campaign: &'a Campaign, runs: &'a [RunRecord], doubts: &'a Doubts) -> TableInput<'a> {
        TableInput {
            campaign,
            runs,
            set_aside: &[],
            modulus_logs: &[],
            spectra: &[],
            blocked: &[],
            frequency: &[],
            model_free: &[],
            curves: &[],
            cycles: &[],
            one_likelihood: &[],
            reductions: &[],
            electrodes: &[],
            files: &[],
            groups: &[],
            alone: &[],
            monitoring: None,
            doubts,
            comparisons: &[],
            outdated_comparisons: 0,
            told: None,
            kept: None,
            origin: "",
        }
    }

    /// The runs that speak, by row id.
    pub fn by_id(&self) -> ById<'a> {
        ById::new(self.campaign, self.runs)
    }

    /// Comparisons of models.
    pub fn compared(&self) -> Compared<'a> {
        Compared {
            comparisons: self.comparisons,
            outdated: self.outdated_comparisons,
            runs: self.runs,
            campaign: self.campaign,
        }
    }
}
