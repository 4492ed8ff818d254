//! Renders the report, where it is out of date, and puts it in place as a whole.

use std::path::{Path, PathBuf};

use super::across_runs::campaign_laws;
use super::along::PageCurves;
use super::context::CODE_VERSION;
use super::diagnosis_document::current_findings;
use super::fault::{or_nothing, step};
use super::standing::Runs;
use super::swap::replace_folder;
use super::{Context, Observer, PipelineError, next_runs, standing};
use crate::analysis::laws::contrast;
use crate::analysis::laws::facts::facts;
use crate::analysis::laws::matrix::confounding_maps;
use crate::analysis::shared_effects::{sentence, shared_effects};
use crate::analysis::{monitoring, same_tags, sequence};
use crate::domain::{Fault, RunRecord};
use crate::model::effects::{self, Effect};
use crate::pipeline::ingest::run_window;
use crate::report;

/// Folder of the report inside a campaign.
pub const REPORT_FOLDER: &str = "report";
/// Says what a report was made from, so that an unchanged one is not made again. A report with faults has none.
pub(super) const STAMP: &str = ".made-from";
/// What a fault of the program left out of the report; there where something is.
pub(super) const FAULTS: &str = ".faults.json";

/// The verb `report`.
#[derive(Debug, Clone, Copy, Default)]
pub struct RenderReport {
    /// Render even where nothing changed.
    pub again: bool,
}

/// What `report` did.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct ReportSummary {
    /// The page to open.
    pub index: PathBuf,
    /// Whether it was made anew.
    pub rendered: bool,
    /// Number of pages written.
    pub pages: usize,
    /// What a fault of the program left out of it.
    pub faults: Vec<Fault>,
}

/// What a fault of the program left out of the report that stands.
pub fn report_faults(folder: &Path) -> Vec<Fault> {
    let text = std::fs::read_to_string(folder.join(REPORT_FOLDER).join(FAULTS));
    text.ok()
        .and_then(|text| serde_json::from_str(&text).ok())
        .unwrap_or_default()
}

impl RenderReport {
    /// Renders into a folder beside the report and exchanges the two; the last good report stays until then.
    ///
    /// # Errors
    /// The database cannot be read, or the report cannot be written.
    pub fn run(&self, context: &Context, observer: &dyn Observer) -> Result<ReportSummary, PipelineError> {
        let target = context.folder.join(REPORT_FOLDER);
        let index = target.join("index.html");
        let (changes, changed_at) = context.store.changes()?;
        let stamp = format!(
            "{CODE_VERSION} {changes} {changed_at} {}\n",
            context.campaign_digest
        );
        let current = std::fs::read_to_string(target.join(STAMP)).is_ok_and(|found| found == stamp);
        if current && !self.again && index.exists() {
            return Ok(ReportSummary {
                index,
                rendered: false,
                pages: 0,
                faults: Vec::new(),
            });
        }
        let input = input(context, changes, &changed_at)?;
        let fresh = context
            .folder
            .join(format!(".{REPORT_FOLDER}-{}", std::process::id()));
        remove_leftovers(&context.folder);
        let rendered = write_fresh(context, &input, &fresh, &stamp, observer).inspect_err(|_| {
            let _ = std::fs::remove_dir_all(&fresh);
        })?;
        replace_folder(&fresh, &target).map_err(failed(&target, "putting the report in place"))?;
        Ok(ReportSummary {
            index,
            rendered: true,
            pages: rendered.pages,
            faults: rendered.faults,
        })
    }
}

fn write_fresh(
    context: &Context,
    input: &report::Input,
    fresh: &Path,
    stamp: &str,
    observer: &dyn Observer,
) -> Result<report::Rendered, PipelineError> {
    std::fs::create_dir_all(fresh).map_err(failed(fresh, "making the report's folder"))?;
    observer.begin("rendering", input.runs.len() as u64);
    let curves = PageCurves::new(&context.store, &input.runs, &context.campaign);
    // Several runs share a page; progress is told in runs.
    let reach = |done: usize, pages: usize| observer.reach((done * input.runs.len() / pages.max(1)) as u64);
    let rendered = report::render(input, &curves, fresh, &reach)?;
    observer.end();
    let (name, text) = match rendered.faults.is_empty() {
        true => (STAMP, stamp.to_owned()),
        false => (FAULTS, serde_json::json!(rendered.faults).to_string()),
    };
    std::fs::write(fresh.join(name), text).map_err(failed(fresh, "stamping the report"))?;
    sync(fresh);
    Ok(rendered)
}

/// Brings the report to the disk before it takes the old one's place. What fails here costs durability only:
/// a report can always be made again.
fn sync(folder: &Path) {
    #[cfg(target_os = "linux")]
    if let Ok(folder) = std::fs::File::open(folder) {
        let _ = rustix::fs::syncfs(folder);
    }
    #[cfg(not(target_os = "linux"))]
    let _ = folder;
}

/// Removes what renderings that were cut short left behind.
fn remove_leftovers(folder: &Path) {
    let prefix = format!(".{REPORT_FOLDER}-");
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().starts_with(&prefix) {
            let _ = std::fs::remove_dir_all(entry.path());
        }
    }
}

pub(super) fn input(
    context: &Context,
    changes: u64,
    changed_at: &str,
) -> Result<report::Input, PipelineError> {
    let Runs {
        speaking: mut runs,
        set_aside,
    } = standing::runs(context)?;
    same_tags::annotate(&mut runs);
    sequence::annotate(&mut runs);
    let mut news: Vec<report::News> = (runs.iter().chain(&set_aside))
        .map(|run| report::News {
            run_path: run.path.clone(),
            at: run.ingested_at.clone(),
        })
        .collect();
    news.sort_by(|a, b| b.at.cmp(&a.at).then_with(|| a.run_path.cmp(&b.run_path)));
    // Each of these may fail by itself: the report then lacks it, and says so.
    let mut faults = Vec::new();
    let mut laws = or_nothing(campaign_laws(context, &runs, None), &mut faults)?;
    if laws.facts.len() != runs.len() {
        laws.facts = facts(&runs, &context.campaign, &vec![None; runs.len()]);
    }
    let contrasts = || Ok(contrast::contrasts(&runs, &context.campaign, &laws.facts));
    let contrasts = or_nothing(step("environments and voltages compared", contrasts), &mut faults)?;
    let findings = or_nothing(step("findings", || findings(context, &runs)), &mut faults)?;
    let plan = || next_runs::plan_from(context, &runs, &laws, &findings.groups);
    let plan = or_nothing(step("which runs to make next", plan), &mut faults)?;
    let monitoring = || Ok(monitoring::monitor(&runs, &context.campaign, &laws));
    let monitoring = or_nothing(step("monitoring", monitoring), &mut faults)?;
    let confounding = step("confounding", || Ok(confounding_maps(&laws, &runs)));
    Ok(report::Input {
        confounding: or_nothing(confounding, &mut faults)?,
        faults,
        untying: plan.untying,
        next_runs: plan.runs,
        laws,
        contrasts,
        monitoring,
        campaign: context.campaign.clone(),
        modulus_logs: standing::modulus_logs(context)?.0,
        set_aside,
        superseded: context.store.superseded_runs()?,
        files: context
            .store
            .files()?
            .iter()
            .map(|file| file.source_file())
            .collect(),
        origin: report::Origin {
            program: format!("ieap {CODE_VERSION}"),
            database: format!("change {changes} of {changed_at}"),
        },
        news,
        climate: context
            .store
            .climate_assessment()?
            .map(|(_, climate)| climate)
            .unwrap_or_default(),
        run_spans_s: runs
            .iter()
            .filter_map(run_window)
            .map(|window| (window.from_s, window.to_s))
            .collect(),
        findings,
        runs,
    })
}

fn findings(context: &Context, runs: &[RunRecord]) -> Result<report::Findings, PipelineError> {
    let found = current_findings(context)?;
    let of_effect = |effect: &&dyn Effect| {
        let about = effect.about();
        report::EffectText {
            id: about.id.to_owned(),
            summary: about.summary.to_owned(),
            equation: about.equation.to_owned(),
            signature: about.signature.to_owned(),
            separated_by: about.separated_by.to_owned(),
            parameters: about
                .parameters
                .iter()
                .map(|parameter| report::EffectParameterText {
                    key: parameter.key.to_owned(),
                    symbol: parameter.symbol.to_owned(),
                    unit: parameter.unit.to_owned(),
                    meaning: parameter.meaning.to_owned(),
                })
                .collect(),
        }
    };
    let shared = shared_effects(&found.groups, runs, &context.campaign)
        .into_iter()
        .map(|effect| {
            let said = sentence(&effect, &found.groups);
            (effect, said)
        })
        .collect();
    Ok(report::Findings {
        shared,
        groups: found.groups,
        runs: found.runs,
        turns: found.turns,
        effects: effects::ALL.iter().map(of_effect).collect(),
    })
}

fn failed(path: &Path, doing: &'static str) -> impl FnOnce(std::io::Error) -> PipelineError {
    let path = path.to_owned();
    move |source| PipelineError::File { path, doing, source }
}
