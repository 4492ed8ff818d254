//! The main job, once: ingest, fit, diagnose, analyse modulus logs, render.

use serde::Serialize;

use super::fault::{or_nothing, step};
use super::standing::{self, SetAside};
use super::{
    AlarmSummary, AnalyseModulus, Context, DiagnoseChoice, DiagnoseRuns, DiagnoseSummary, FitChoice, FitRuns,
    FitSummary, Ingest, IngestSummary, ModulusSummary, Observer, PipelineError, RaiseAlarms, RenderReport,
    ReportSummary,
};
use crate::domain::Fault;
use crate::ingest::scan::SeenFile;

/// The verb `run`.
#[derive(Debug, Clone, Default)]
pub struct Run {
    /// How runs are fitted.
    pub fit: FitChoice,
    /// Whether the diagnosis is left for later; stored findings stay.
    pub skip_diagnosis: bool,
}

/// What `run` did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunSummary {
    /// Files and runs.
    pub ingest: IngestSummary,
    /// Fits.
    pub fit: FitSummary,
    /// Diagnoses.
    pub diagnose: DiagnoseSummary,
    /// Modulus logs.
    pub modulus: ModulusSummary,
    /// Alarms of long-term monitoring.
    pub alarms: AlarmSummary,
    /// Runs that no result is made from.
    pub set_aside: Vec<SetAside>,
    /// The report.
    pub report: ReportSummary,
    /// Steps that a fault of the program stopped; the others were done.
    pub faults: Vec<Fault>,
}

impl RunSummary {
    /// Whether a fault of the program left something undone: a step, a fit, a diagnosis, a part of the report.
    pub fn has_fault(&self) -> bool {
        !self.faults.is_empty()
            || !self.report.faults.is_empty()
            || self.fit.has_fault()
            || self.diagnose.has_fault()
            || self.modulus.has_fault()
    }
}

impl Run {
    /// Does the main job once with every file that is there. A file that is still written when it is read is
    /// noticed (its size or time changes, or its last line is not whole) and taken as a new revision later.
    ///
    /// # Errors
    /// See the single steps.
    pub fn run(&self, context: &mut Context, observer: &dyn Observer) -> Result<RunSummary, PipelineError> {
        self.run_ready(context, observer, &mut |_| true, &|| true)
    }

    /// The same with those files only that `ready` lets pass. The diagnosis ends early where `may_go_on` says no; what is
    /// left of it is counted.
    ///
    /// # Errors
    /// See the single steps.
    pub fn run_ready(
        &self,
        context: &mut Context,
        observer: &dyn Observer,
        ready: &mut dyn FnMut(&SeenFile) -> bool,
        may_go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<RunSummary, PipelineError> {
        let ingest = Ingest { ready }.run(context, observer)?;
        let fits = FitRuns {
            choice: self.fit.clone(),
            again: false,
        };
        let mut fit = fits.run(context, observer)?;
        let condemned = context.store.condemned_by_diagnosis()?;
        let diagnose = match self.skip_diagnosis {
            true => DiagnoseSummary::default(),
            false => self.diagnosis().run_while(context, observer, may_go_on)?,
        };
        if context.store.condemned_by_diagnosis()? != condemned {
            // A run that shared its parameters with others does so no more.
            let later = fits.run(context, observer)?;
            fit.fitted += later.fitted;
            fit.not_converged.extend(later.not_converged);
        }
        let modulus = AnalyseModulus::default().run(context, observer)?;
        let mut faults = Vec::new();
        let alarms = or_nothing(RaiseAlarms.run(context, observer), &mut faults)?;
        let set_aside = standing::runs(context)?.set_aside;
        let report = step("report", || RenderReport::default().run(context, observer));
        let report = or_nothing(report, &mut faults)?;
        Ok(RunSummary {
            ingest,
            fit,
            modulus,
            diagnose,
            alarms,
            set_aside: set_aside.iter().map(SetAside::of).collect(),
            report,
            faults,
        })
    }

    fn diagnosis(&self) -> DiagnoseRuns {
        DiagnoseRuns {
            choice: DiagnoseChoice {
                model: self.fit.model.clone(),
                seed: self.fit.seed,
                draws: None,
            },
            ..DiagnoseRuns::default()
        }
    }
}
