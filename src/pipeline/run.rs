//! The main job, once: ingest, fit, analyse modulus logs, raise alarms, render; then diagnose, and render again.

use schemars::JsonSchema;
use serde::Serialize;

use super::{
    AlarmSummary, AnalyseModulus, Context, DiagnoseChoice, DiagnoseRuns, DiagnoseSummary, FitChoice, FitRuns,
    FitSummary, Ingest, IngestSummary, ModulusSummary, Observer, PipelineError, RaiseAlarms, RenderReport,
    ReportSummary,
};
use crate::domain::Fault;
use crate::pipeline::campaign::standing::{self, SetAside};
use crate::pipeline::infra::allowed::AllowedCommands;
use crate::pipeline::infra::fault::{or_nothing, step};
use crate::pipeline::show::report::said_before;
use crate::report::moved::Numbers;

/// The verb `run`.
#[derive(Debug, Clone, Default)]
pub struct Run {
    /// How runs are fitted.
    pub fit: FitChoice,
    /// Whether the diagnosis is left for later; stored findings stay.
    pub skip_diagnosis: bool,
    /// Which commands of campaigns may be run for alarms; none where nothing is said.
    pub commands: AllowedCommands,
}

/// What `run` did.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
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

    /// Whether results are left because what they depend on changed whenever they were made.
    pub fn left_results(&self) -> bool {
        let changing = [
            &self.fit.changing,
            &self.diagnose.changing,
            &self.modulus.changing,
        ];
        changing.iter().any(|names| !names.is_empty())
    }
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
    /// Steps that a fault of the program stopped; the others were done.
    pub faults: Vec<Fault>,
}

/// Renders the report, numbers held against `before` or against the report that stands; a fault of the program costs the
/// report and is noted.
///
/// # Errors
/// As of [`RenderReport::run`].
pub(super) fn render(
    context: &Context,
    observer: &dyn Observer,
    before: Option<&Numbers>,
    faults: &mut Vec<Fault>,
) -> Result<ReportSummary, PipelineError> {
    let verb = RenderReport {
        before: before.cloned(),
        ..RenderReport::default()
    };
    or_nothing(step("report", || verb.run(context, observer)), faults)
}

impl Run {
    /// Does the main job once with every file that is there. A file that is still written when it is read is
    /// noticed (its size or time changes, or its last line is not whole) and taken as a new revision later.
    ///
    /// A diagnosis may take long: alarms are raised before it, of runs that it will not condemn, and where there is something to diagnose a first report
    /// stands before it begins.
    ///
    /// # Errors
    /// See the single steps.
    pub fn run(&self, context: &mut Context, observer: &dyn Observer) -> Result<RunSummary, PipelineError> {
        let ingest = Ingest { ready: &mut |_| true }.run(context, observer)?;
        let Made {
            mut fit,
            modulus,
            mut alarms,
            mut faults,
        } = self.make(context, observer)?;
        let condemned = context.store.condemned_by_diagnosis()?;
        // The first report of this command is none that anybody has read.
        let before = said_before(context, observer);
        let mut first = None;
        let diagnose = if self.skip_diagnosis {
            DiagnoseSummary::default()
        } else {
            self.diagnosis()
                .run_while(context, observer, &|| true, &mut |context| {
                    // What a fault stops here is tried again at the end, and told then.
                    let rendered = render(context, observer, Some(&before), &mut Vec::new())?;
                    if rendered.rendered {
                        observer.say(&format!("a first report stands: {}", rendered.index.display()));
                    }
                    first = Some(rendered);
                    Ok(())
                })?
        };
        if context.store.condemned_by_diagnosis()? != condemned {
            // A run that shared its parameters with others does so no more, and what was watched with it is watched without.
            let later = self.fits().run(context, observer)?;
            fit.and_then(later);
        }
        if !self.skip_diagnosis {
            // What findings say against fits is part of what is watched.
            let later = or_nothing(self.alarms().run(context, observer), &mut faults)?;
            alarms.standing = later.standing;
            alarms.new.extend(later.new);
            alarms.failed_commands.extend(later.failed_commands);
            faults.dedup();
        }
        let set_aside = standing::runs(context)?.set_aside;
        let last = render(context, observer, Some(&before), &mut faults)?;
        // What the diagnosis left as it was need not be rendered twice.
        let is_made = !last.index.as_os_str().is_empty();
        let report = match first {
            Some(first) if is_made && !last.rendered && last.refused.is_none() => first,
            _ => last,
        };
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

    /// Fits, analyses modulus logs and raises alarms.
    ///
    /// # Errors
    /// See the single steps.
    pub fn make(&self, context: &mut Context, observer: &dyn Observer) -> Result<Made, PipelineError> {
        let fit = self.fits().run(context, observer)?;
        let modulus = AnalyseModulus::default().run(context, observer)?;
        let mut faults = Vec::new();
        let alarms = or_nothing(self.alarms().run(context, observer), &mut faults)?;
        Ok(Made {
            fit,
            modulus,
            alarms,
            faults,
        })
    }

    /// The fits that belong to it.
    fn fits(&self) -> FitRuns {
        let choice = self.fit.clone();
        FitRuns { choice, again: false }
    }

    /// The alarms that belong to it.
    fn alarms(&self) -> RaiseAlarms {
        let diagnosis = (!self.skip_diagnosis).then(|| self.diagnosis().choice);
        let commands = self.commands.clone();
        RaiseAlarms { diagnosis, commands }
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
