//! Everything a report is made of, except the curves.

use crate::moved::Before;
use ieap_analysis::study::Study;
use ieap_analysis::tables::TableInput;
use std::collections::BTreeMap;

use ieap_analysis::cycles::CycleRun;
use ieap_analysis::frequency::FrequencyRun;
use ieap_analysis::impedance::Spectra;
use ieap_analysis::laws::doubt::{Doubted, Doubts};
use ieap_analysis::model_free::ModelFree;
use ieap_analysis::models_compared::view::Compared;
use ieap_analysis::monitoring::Monitoring;
use ieap_analysis::online::OnlineDecision;
use ieap_analysis::plan::PlannedRun;
use ieap_analysis::probe::Course;
use ieap_analysis::shared_effects::SharedEffect;
use ieap_domain::file_story::FileStory;
use ieap_domain::{
    BlockedRun, Campaign, ClimateAssessment, Fault, GroupDiagnosis, ModulusLog, RunComparison, RunRecord,
    SourceFile,
};

/// What a report shows. No clock is read anywhere: the same input gives the same bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    /// The campaign.
    pub campaign: Campaign,
    /// Current revision of every run that results are made from, in the order in which lists show them.
    pub runs: Vec<RunRecord>,
    /// The runs that none are made from, each with its reason: they have a page and stand in the list of runs.
    pub set_aside: Vec<RunRecord>,
    /// Earlier revisions of the same paths, for the history on the run pages.
    pub superseded: Vec<RunRecord>,
    /// Current modulus logs with what was found in them.
    pub modulus_logs: Vec<ModulusLog>,
    /// Impedance spectra with what was found in them, alone and beside the steps.
    pub spectra: Spectra,
    /// What blocking forces of the runs say.
    pub blocked: Vec<BlockedRun>,
    /// What runs under a sine or a chirp say against frequency.
    pub frequency: Vec<FrequencyRun>,
    /// What the runs say without a model.
    pub model_free: Vec<ModelFree>,
    /// Trains, cycle by cycle.
    pub cycles: Vec<CycleRun>,
    /// The electrodes' resistance over time, by the probe.
    pub electrodes: Vec<Course>,
    /// Every file that the last scan saw.
    pub files: Vec<SourceFile>,
    /// What became of each file, and why.
    pub file_stories: Vec<FileStory>,
    /// What the report was generated from.
    pub origin: Origin,
    /// What the simulation gets wrong.
    pub findings: Findings,
    /// What findings say against fits.
    pub doubts: Doubts,
    /// Groups whose fits are in doubt, and what is done with them.
    pub doubted: Vec<Doubted>,
    /// Runs to make next, the first first.
    pub next_runs: Vec<PlannedRun>,
    /// What the study asked, with its answers.
    pub study: Study,
    /// Parameters over the life of the samples.
    pub monitoring: Monitoring,
    /// Climate logs: sensors, comparisons, exposure.
    pub climate: ClimateAssessment,
    /// Steps before the report that a fault of the program stopped: what they would have given is missing.
    pub faults: Vec<Fault>,
    /// Start and end of the runs whose start is known, s since 1970 UTC.
    pub run_spans_s: Vec<(f64, f64)>,
    /// Models held against each other, by the runs' names; empty where none were.
    pub comparisons: Vec<RunComparison>,
    /// Comparisons that what they were made from does not bear out any more.
    pub outdated_comparisons: usize,
    /// What the report before says, for numbers that moved since.
    pub before: Before,
    /// Templates of the campaign's own by their names, each in place of ours.
    pub templates: BTreeMap<String, String>,
}

impl Input {
    /// Comparisons of models.
    pub fn compared(&self) -> Compared<'_> {
        self.of_tables().compared()
    }

    /// What tables are made from.
    pub fn of_tables(&self) -> TableInput<'_> {
        TableInput {
            set_aside: &self.set_aside,
            modulus_logs: &self.modulus_logs,
            spectra: &self.spectra.runs,
            blocked: &self.blocked,
            frequency: &self.frequency,
            model_free: &self.model_free,
            cycles: &self.cycles,
            electrodes: &self.electrodes,
            files: &self.files,
            groups: &self.findings.groups,
            alone: &self.findings.runs,
            monitoring: Some(&self.monitoring),
            comparisons: &self.comparisons,
            outdated_comparisons: self.outdated_comparisons,
            origin: &self.origin.database,
            ..TableInput::new(&self.campaign, &self.runs, &self.doubts)
        }
    }

    /// Run number `run` of all that have a page: those of `runs`, then those of `set_aside`.
    pub fn record(&self, run: usize) -> &RunRecord {
        match run.checked_sub(self.runs.len()) {
            None => &self.runs[run],
            Some(place) => &self.set_aside[place],
        }
    }

    /// All runs that have a page, in the order of their numbers.
    pub fn records(&self) -> impl Iterator<Item = &RunRecord> {
        self.runs.iter().chain(&self.set_aside)
    }
}

/// What diagnoses found, and what is known of the effects that they name.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Findings {
    /// Of groups, by name.
    pub groups: Vec<GroupDiagnosis>,
    /// Of single runs, by name.
    pub runs: Vec<GroupDiagnosis>,
    /// What could be claimed of every single run when it came, by name.
    pub turns: BTreeMap<String, OnlineDecision>,
    /// Causes that several samples of a material share, with the finding in words.
    pub shared: Vec<(SharedEffect, String)>,
    /// Every effect that was looked for.
    pub effects: Vec<EffectText>,
    /// What is known of every law that is asked as a free curve.
    pub laws: Vec<EffectText>,
}

impl Findings {
    /// What is known of an effect.
    pub fn effect(&self, id: &str) -> Option<&EffectText> {
        let mut known = self.effects.iter().chain(&self.laws);
        known.find(|effect| effect.id == id)
    }
}

/// What is known of an effect, as pages print it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EffectText {
    /// Id, `faradaic-leak`.
    pub id: String,
    /// What it is, in one line.
    pub summary: String,
    /// Governing equation.
    pub equation: String,
    /// What it leaves in the residual.
    pub signature: String,
    /// Run or instrument that tells it from its twins.
    pub separated_by: String,
    /// Parameters, the strength first.
    pub parameters: Vec<EffectParameterText>,
}

/// A parameter of an effect, as pages print it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EffectParameterText {
    /// Stored key.
    pub key: String,
    /// Symbol in the equation.
    pub symbol: String,
    /// Unit; empty for a pure number.
    pub unit: String,
    /// What it is, in one line.
    pub meaning: String,
}

/// What a report was generated from, printed at the foot of every page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// Program with its version, `ieap 0.1.0`.
    pub program: String,
    /// State of the database in words, `change 412 of 20 Nov 2026, 08:00 +02:00`.
    pub database: String,
}
