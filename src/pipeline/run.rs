//! The main job, once: ingest, fit, analyse modulus logs, raise alarms, render; then diagnose, and render again.

use serde::Serialize;

use super::{
    AlarmSummary, AnalyseModulus, Context, DiagnoseChoice, DiagnoseRuns, DiagnoseSummary, FitChoice, FitRuns,
    FitSummary, Ingest, IngestSummary, ModulusSummary, Observer, PipelineError, RaiseAlarms, RenderReport,
    ReportSummary,
};

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
    /// The report.
    pub report: ReportSummary,
}

/// What is made of the runs before they are diagnosed.
#[derive(Debug, Clone, PartialEq)]
pub struct Made {
    /// Fits.
    pub fit: FitSummary,
    /// Modulus logs.
    pub modulus: ModulusSummary,
    /// Alarms of long-term monitoring.
    pub alarms: AlarmSummary,
}

impl Run {
    /// Does the main job once with every file that is there. A file that is still written when it is read is
    /// noticed (its size or time changes, or its last line is not whole) and taken as a new revision later.
    ///
    /// A diagnosis may take long: alarms are raised before it, and where there is something to diagnose a first report
    /// stands before it begins.
    ///
    /// # Errors
    /// See the single steps.
    pub fn run(&self, context: &mut Context, observer: &dyn Observer) -> Result<RunSummary, PipelineError> {
        let ingest = Ingest { ready: &mut |_| true }.run(context, observer)?;
        let Made { fit, modulus, alarms } = self.make(context, observer)?;
        let mut first = None;
        let diagnose = match self.skip_diagnosis {
            true => DiagnoseSummary::default(),
            false => self
                .diagnosis()
                .run_while(context, observer, &|| true, &mut |context| {
                    let rendered = RenderReport::default().run(context, observer)?;
                    observer.say(&format!("a first report stands: {}", rendered.index.display()));
                    first = Some(rendered);
                    Ok(())
                })?,
        };
        let last = RenderReport::default().run(context, observer)?;
        // What the diagnosis left as it was need not be rendered twice.
        let report = match first {
            Some(first) if !last.rendered && last.refused.is_none() => first,
            _ => last,
        };
        Ok(RunSummary {
            ingest,
            fit,
            modulus,
            diagnose,
            alarms,
            report,
        })
    }

    /// Fits, analyses modulus logs and raises alarms.
    ///
    /// # Errors
    /// See the single steps.
    pub fn make(&self, context: &mut Context, observer: &dyn Observer) -> Result<Made, PipelineError> {
        let choice = self.fit.clone();
        let fit = FitRuns { choice, again: false }.run(context, observer)?;
        Ok(Made {
            fit,
            modulus: AnalyseModulus::default().run(context, observer)?,
            alarms: RaiseAlarms.run(context, observer)?,
        })
    }

    /// The diagnosis that belongs to it.
    pub fn diagnosis(&self) -> DiagnoseRuns {
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
