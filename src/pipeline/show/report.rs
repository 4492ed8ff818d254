//! Renders the report, where it is out of date, and puts it in place as a whole.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;
use std::path::{Path, PathBuf};

use super::along::PageCurves;
use super::own_templates::OwnTemplates;
use super::shown_rows;
use crate::analysis::cache::Cache;
use crate::analysis::laws::doubt::{Doubts, Findings};
use crate::analysis::laws::facts::facts;
use crate::analysis::monitoring::{self, monitor};
use crate::analysis::shared_effects::{sentence, shared_effects};
use crate::analysis::study::{Evidence, Study};
use crate::analysis::{same_tags, sequence};
use crate::domain::diagnosis::follows_a_tag;
use crate::domain::{Fault, GroupDiagnosis, RunRecord, SourceFile};
use crate::model::effects::smooth_laws::SMOOTH_LAWS;
use crate::model::effects::{self, Effect};
use crate::numerics::interrupt;
use crate::pipeline::campaign::context::{CODE_VERSION, now};
use crate::pipeline::campaign::places::{FAULTS, KEPT_VALUES, REPORT_FOLDER, STAMP};
use crate::pipeline::campaign::standing::{self, Runs};
use crate::pipeline::findings::blocked::blocked_runs;
use crate::pipeline::findings::compare::current_comparisons;
use crate::pipeline::findings::current::{CurrentFindings, findings_among};
use crate::pipeline::findings::frequency::frequency_runs;
use crate::pipeline::findings::impedance;
use crate::pipeline::findings::kept as kept_values;
use crate::pipeline::findings::model_free::{curves_after_steps, without_model};
use crate::pipeline::findings::next_runs::{self, PlannedIds};
use crate::pipeline::infra::fault::{or_nothing, step};
use crate::pipeline::infra::own_folder::{self, Altered, Fresh};
use crate::pipeline::intake::climate::{assess, electrode_courses};
use crate::pipeline::intake::files::stories;
use crate::pipeline::intake::ingest::run_window;
use crate::pipeline::{Context, Observer, PipelineError, failed};
use crate::report;
use crate::report::kept::{self, Earlier, Made};
use crate::report::moved::{Before, Numbers};
use crate::store::journal::End;
use crate::system::fs;

/// The verb `report`.
#[derive(Debug, Clone, Default)]
pub struct RenderReport {
    /// Render even where nothing changed.
    pub again: bool,
    /// What numbers are held against to say that they moved; what the report that stands says where this is none.
    pub before: Option<Numbers>,
}

/// What `report` did.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct ReportSummary {
    /// The page to open.
    pub index: PathBuf,
    /// Whether it was made anew.
    pub rendered: bool,
    /// Number of pages written.
    pub pages: usize,
    /// Number of pages that stood already and were taken over: nothing that they are made from changed.
    pub pages_kept: usize,
    /// Why it was not made: the folder holds what the program did not write.
    pub refused: Option<String>,
    /// What a fault of the program left out of it.
    pub faults: Vec<Fault>,
    /// Files that were not as they had been written, and were made anew with the others.
    pub altered: Vec<String>,
    /// Templates of the campaign's own that do not take the place of the program's, each with the reason.
    pub templates_left_out: Vec<String>,
}

/// What stands in [`FAULTS`].
#[derive(Debug, Default, serde::Serialize, serde::Deserialize)]
struct Faulty {
    /// The stamp that the report would have without them: the same input would only bring the same faults again.
    made_from: String,
    faults: Vec<Fault>,
}

fn faulty(folder: &Path) -> Option<Faulty> {
    let text = fs::read_own_text(folder.join(REPORT_FOLDER).join(FAULTS)).ok()?;
    serde_json::from_str(&text).ok()
}

/// What a fault of the program left out of the report that stands.
pub fn report_faults(folder: &Path) -> Vec<Fault> {
    faulty(folder).map_or_else(Vec::new, |faulty| faulty.faults)
}

impl RenderReport {
    /// Renders into a folder beside the report and exchanges the two; the last good report stays until then. Where the
    /// folder holds a file that the program did not write nothing is touched, and the summary says so.
    ///
    /// # Errors
    /// The database cannot be read, or the report cannot be written.
    pub fn run(&self, context: &Context, observer: &dyn Observer) -> Result<ReportSummary, PipelineError> {
        let target = context.folder.join(REPORT_FOLDER);
        let index = target.join("index.html");
        // Also where nothing is to be rendered: what was cut short would stay until something changes.
        let leftovers = own_folder::remove_leftovers(&context.folder, FRESH);
        for kept in leftovers {
            observer.warn(&format!(
                "{}: looks like what a rendering left that was cut short, but carries no mark of ours or cannot be removed; it stays. Remove it if it is not yours.",
                kept.display()
            ));
        }
        // What others write meanwhile is shown the next time, whole.
        let snapshot = context.store.snapshot()?;
        let (changes, changed_at) = context.store.changes()?;
        let own = OwnTemplates::of(context);
        let stamp = stamp(context, changes, &changed_at, &own)?;
        let altered = own_folder::altered(&target)
            .map_err(failed(&target, "looking whether it is as it was written"))?;
        let current = stands(context, &stamp) && altered.is_empty();
        let unchanged = |refused| ReportSummary {
            index: index.clone(),
            rendered: false,
            pages: 0,
            pages_kept: 0,
            refused,
            faults: Vec::new(),
            altered: Vec::new(),
            templates_left_out: own.left_out.clone(),
        };
        // A database of an earlier version has a report and no rows yet.
        let is_shown = context.store.shown_of()? == Some(changes);
        if current && is_shown && !self.again {
            return Ok(ReportSummary {
                faults: report_faults(&context.folder),
                ..unchanged(None)
            });
        }
        if let Some(refused) = not_ours(&context.folder)? {
            return Ok(unchanged(Some(refused)));
        }
        let fresh = Fresh::begin(&context.folder, FRESH)
            .map_err(failed(&context.folder, "making the report's folder"))?;
        let hashes = if self.again {
            BTreeMap::new()
        } else {
            own_folder::hashes(&target).map_err(failed(&target, "looking what was written into it"))?
        };
        let standing = Standing::of(&target, &hashes, &altered);
        let kept = (!self.again).then(|| kept_values::of_report(context)).flatten();
        let made = kept.as_ref().map_or_else(Made::new, |_| standing.pages());
        let values = kept.unwrap_or_else(|| Cache::by(&kept_values::program()));
        let input = report::Input {
            templates: own.texts.clone(),
            before: Before {
                numbers: self
                    .before
                    .clone()
                    .unwrap_or_else(|| said_before(context, observer)),
                now: now(),
            },
            ..input(context, changes, &changed_at, &values)?
        };
        let take = |files: &[String]| {
            let known: Option<Vec<(&str, &str)>> = files
                .iter()
                .map(|name| Some((name.as_str(), hashes.get(name)?.as_str())))
                .collect();
            known.map_or(Ok(false), |known| fresh.keep(&target, &known))
        };
        let earlier = Earlier {
            made,
            take: &take,
            values: Some(&values),
        };
        let rendered = write_fresh(context, (&input, &values), (&fresh, &earlier), &stamp, observer)?;
        let shown = shown_rows::shown(&input);
        drop(snapshot);
        context.store.put_shown(&shown, changes, &now())?;
        match fresh.put(&target, &is_of_earlier_version) {
            Ok(()) => {}
            // Somebody's file came in while it was rendered.
            Err(error @ PipelineError::NotOurs { .. }) => return Ok(unchanged(Some(error.to_string()))),
            Err(error) => return Err(error),
        }
        Ok(ReportSummary {
            index,
            rendered: true,
            pages: rendered.pages - rendered.kept,
            pages_kept: rendered.kept,
            refused: None,
            faults: rendered.faults,
            altered: altered.into_iter().map(|(name, _)| name).collect(),
            templates_left_out: own.left_out,
        })
    }
}

/// What is said of the report that stands, where it shows the campaign as it is.
///
/// # Errors
/// The database or the folder cannot be read.
pub fn standing_report(context: &Context) -> Result<Option<ReportSummary>, PipelineError> {
    let target = context.folder.join(REPORT_FOLDER);
    let altered =
        own_folder::altered(&target).map_err(failed(&target, "looking whether it is as it was written"))?;
    if !altered.is_empty() || !is_current(context)? {
        return Ok(None);
    }
    Ok(Some(ReportSummary {
        index: target.join("index.html"),
        rendered: false,
        pages: 0,
        pages_kept: 0,
        refused: None,
        faults: report_faults(&context.folder),
        altered: Vec::new(),
        templates_left_out: OwnTemplates::of(context).left_out,
    }))
}

/// What the report that stands says of each run; nothing where there is none. What cannot be read is said: no number is then
/// marked as moved.
pub fn said_before(context: &Context, observer: &dyn Observer) -> Numbers {
    let path = context.folder.join(REPORT_FOLDER).join(report::moved::FILE);
    let said = match fs::read_own_text(&path) {
        Ok(text) => Numbers::read(&text).map_err(|error| error.to_string()),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Numbers::default()),
        Err(error) => Err(error.to_string()),
    };
    said.unwrap_or_else(|why| {
        let path = path.display();
        observer.warn(&format!(
            "{path}: cannot be read, so that no number is marked as moved: {why}"
        ));
        Numbers::default()
    })
}

/// What a report of the campaign as it is would say that it was made from. Its last words are the id of the database, and
/// number and checksum of the last line of the journal.
fn stamp(
    context: &Context,
    changes: u64,
    changed_at: &str,
    own: &OwnTemplates,
) -> Result<String, PipelineError> {
    let (digest, own) = (&context.campaign_digest, own.mark());
    let (id, End { n, sum }) = (context.store.identity()?, context.store.last_said()?);
    let sum = sum.unwrap_or_else(|| "-".to_owned());
    Ok(format!(
        "{CODE_VERSION} {changes} {changed_at} {digest}{own} {id} {n} {sum}\n"
    ))
}

/// What the report that is there says that it was made from.
fn made_from(campaign: &Path) -> Option<String> {
    let stamp = fs::read_own_text(campaign.join(REPORT_FOLDER).join(STAMP)).ok();
    stamp.or_else(|| Some(faulty(campaign)?.made_from))
}

/// Number and checksum of the last line of the journal when the report was made from this database: a third witness beside
/// journal and database, which may both have been cut.
///
/// # Errors
/// The database cannot be read.
pub fn line_of_report(context: &Context) -> Result<Option<(u64, String)>, PipelineError> {
    let id = context.store.identity()?;
    let Some(stamp) = made_from(&context.folder) else {
        return Ok(None);
    };
    let mut words = stamp.split_whitespace().rev();
    let (sum, n, of) = (words.next(), words.next(), words.next());
    let line = of
        .filter(|of| *of == id)
        .and(n.and_then(|n| n.parse().ok()))
        .zip(sum.map(str::to_owned));
    Ok(line.filter(|(n, _)| *n > 0))
}

/// Whether a report with that stamp is there.
fn stands(context: &Context, stamp: &str) -> bool {
    let folder = context.folder.join(REPORT_FOLDER);
    let made_from = made_from(&context.folder);
    let is_whole = folder.join("index.html").exists() && own_folder::is_hashed(&folder);
    is_whole && made_from.is_some_and(|found| found == stamp)
}

/// Whether the report shows the campaign as it is.
///
/// # Errors
/// The database cannot be read.
pub fn is_current(context: &Context) -> Result<bool, PipelineError> {
    let (changes, changed_at) = context.store.changes()?;
    let own = OwnTemplates::of(context);
    Ok(stands(context, &stamp(context, changes, &changed_at, &own)?))
}

/// How the name of a report in the making begins.
const FRESH: &str = ".report-";

/// Why the report of a campaign cannot be exchanged: its folder holds what the program did not write.
///
/// # Errors
/// The folder cannot be looked through.
pub fn not_ours(campaign: &Path) -> Result<Option<String>, PipelineError> {
    match own_folder::check(&campaign.join(REPORT_FOLDER), &is_of_earlier_version) {
        Ok(()) => Ok(None),
        Err(error @ PipelineError::NotOurs { .. }) => Ok(Some(error.to_string())),
        Err(error) => Err(error),
    }
}

/// Whether a report without a list of its files is one that an earlier version wrote: it carries the stamp, has the
/// names that reports ever had and nothing else, and every page begins as the layout does.
fn is_of_earlier_version(folder: &Path) -> bool {
    const BESIDE_PAGES: [&str; 11] = [
        STAMP,
        kept::FILE,
        report::moved::FILE,
        KEPT_VALUES,
        "style.css",
        "site.js",
        "runs.js",
        "table5.csv",
        "fits-wide.csv",
        "conditions.csv",
        "dma.csv",
    ];
    const FOLDERS: [&str; 4] = ["runs", "findings", "along", "readings"];
    let ends = |path: &Path, with: &str| path.extension().is_some_and(|end| end == with);
    let is_page = |path: &Path| {
        (ends(path, "html") && begins_as_page(path)) || (ends(path, "js") && begins_as_readings(path))
    };
    let names = |folder: &Path| -> Option<Vec<(String, PathBuf)>> {
        let entries = fs::read_dir(folder).ok()?;
        let named = entries.map(|entry| {
            let entry = entry.ok()?;
            Some((entry.file_name().into_string().ok()?, entry.path()))
        });
        named.collect()
    };
    let pages_only =
        |folder: &Path| names(folder).is_some_and(|all| all.iter().all(|(_, path)| is_page(path)));
    folder.join(STAMP).is_file()
        && names(folder).is_some_and(|all| {
            all.iter().all(|(name, path)| {
                if path.is_dir() {
                    FOLDERS.contains(&name.as_str()) && pages_only(path)
                } else {
                    BESIDE_PAGES.contains(&name.as_str()) || is_page(path)
                }
            })
        })
}

/// Whether a file begins with what every version of the layout began with.
fn begins_as_page(path: &Path) -> bool {
    let text = head(path);
    text.starts_with("<!DOCTYPE html>") && text.contains("style.css") && text.contains(" · ")
}

/// Whether a file begins as one of the readings of a page does.
fn begins_as_readings(path: &Path) -> bool {
    head(path).starts_with("window.ieapReadings=")
}

/// The beginning of a file; empty where it cannot be read.
fn head(path: &Path) -> String {
    /// Bytes within which the layout names its style sheet: the title is the only part before it that grows.
    const HEAD_BYTES: u64 = 4096;
    let mut head = Vec::new();
    let read = fs::File::open_own(path).and_then(|file| file.take(HEAD_BYTES).read_to_end(&mut head));
    match read {
        Ok(_) => String::from_utf8_lossy(&head).into_owned(),
        Err(_) => String::new(),
    }
}

/// The report that stands, as far as its files are as they were written.
struct Standing<'a> {
    folder: &'a Path,
    hashes: &'a BTreeMap<String, String>,
    altered: BTreeSet<&'a str>,
}

impl<'a> Standing<'a> {
    fn of(
        folder: &'a Path,
        hashes: &'a BTreeMap<String, String>,
        altered: &'a [(String, Altered)],
    ) -> Standing<'a> {
        Standing {
            folder,
            hashes,
            altered: altered.iter().map(|(name, _)| name.as_str()).collect(),
        }
    }

    fn is_whole(&self, name: &str) -> bool {
        self.hashes.contains_key(name) && !self.altered.contains(name)
    }

    /// What its pages were made from.
    fn pages(&self) -> Made {
        match fs::read_own_text(self.folder.join(kept::FILE)) {
            Ok(text) if self.is_whole(kept::FILE) => kept::read(&text, |name| self.is_whole(name)),
            _ => Made::new(),
        }
    }
}

fn write_fresh(
    context: &Context,
    (input, values): (&report::Input, &Cache),
    (fresh, earlier): (&Fresh, &Earlier),
    stamp: &str,
    observer: &dyn Observer,
) -> Result<report::Rendered, PipelineError> {
    observer.begin("rendering", input.runs.len() as u64);
    let curves = PageCurves::new(context, &input.runs);
    // Several runs share a page; progress is told in runs.
    let reach = |done: usize, pages: usize| {
        interrupt::check();
        observer.reach((done * input.runs.len() / pages.max(1)) as u64);
    };
    let folder = fresh.path();
    let rendered = report::render(input, &curves, earlier, folder, &reach);
    observer.end();
    let rendered = rendered?;
    let (name, text) = if rendered.faults.is_empty() {
        (STAMP, stamp.to_owned())
    } else {
        (FAULTS, faults_text(stamp, &rendered.faults))
    };
    fs::write(folder.join(name), text).map_err(failed(folder, "stamping the report"))?;
    fs::write(folder.join(KEPT_VALUES), values.bytes())
        .map_err(failed(folder, "keeping values for the next report"))?;
    fresh
        .finish()
        .map_err(failed(folder, "bringing the report to the disk"))?;
    Ok(rendered)
}

fn faults_text(stamp: &str, faults: &[Fault]) -> String {
    let faulty = Faulty {
        made_from: stamp.to_owned(),
        faults: faults.to_vec(),
    };
    serde_json::json!(faulty).to_string()
}

pub(crate) fn input(
    context: &Context,
    changes: u64,
    changed_at: &str,
    kept: &Cache,
) -> Result<report::Input, PipelineError> {
    // Each of these may fail by itself: the report then lacks it, and says so.
    let mut faults = Vec::new();
    let all = standing::all(context)?;
    let found = or_nothing(step("findings", || findings_among(context, &all)), &mut faults)?;
    let ids = step("run sheets", || PlannedIds::of(context, &all));
    let ids = or_nothing(ids, &mut faults)?;
    let Runs {
        speaking: mut runs,
        set_aside,
    } = Runs::of(all);
    same_tags::annotate(&mut runs);
    sequence::annotate(&mut runs);
    let facts = facts(&runs, &context.campaign);
    let of_groups = Findings {
        groups: &found.groups,
        runs: &found.runs,
    };
    let doubts = Doubts::new(of_groups, &runs);
    let doubted = doubts.told(of_groups);
    let curves = step("curves after the steps", || {
        curves_after_steps(context, &runs, kept)
    });
    let curves = or_nothing(curves, &mut faults)?;
    let study = || {
        let evidence = Evidence {
            runs: &runs,
            campaign: &context.campaign,
            doubts: &doubts,
            curves: &curves,
        };
        Ok(Study::kept(evidence, kept).beside(&set_aside))
    };
    let study = or_nothing(step("what the study asked", study), &mut faults)?;
    let findings = or_nothing(
        step("findings", || Ok(findings(context, &runs, found))),
        &mut faults,
    )?;
    let compared = step("models compared", || current_comparisons(context, &runs));
    let (comparisons, outdated_comparisons) = or_nothing(compared, &mut faults)?;
    let plan = || {
        Ok(next_runs::plan_from(
            context,
            (&runs, &ids),
            &study,
            &findings.groups,
        ))
    };
    let plan = or_nothing(step("which runs to make next", plan), &mut faults)?;
    let spectra = step("impedance spectra", || impedance::spectra(context, &[]));
    let spectra = or_nothing(spectra, &mut faults)?;
    let blocked = or_nothing(
        step("blocking forces", || blocked_runs(context, &runs)),
        &mut faults,
    )?;
    let frequency = step("responses against frequency", || frequency_runs(context, &runs));
    let frequency = or_nothing(frequency, &mut faults)?;
    let without_model = step("what runs say without a model", || {
        without_model(context, &runs, kept)
    });
    let without_model = or_nothing(without_model, &mut faults)?;
    let electrodes = step("electrode resistance", || electrode_courses(context));
    let electrodes = or_nothing(electrodes, &mut faults)?;
    let monitoring = || {
        Ok(monitor(monitoring::Evidence {
            runs: &runs,
            campaign: &context.campaign,
            facts: &facts,
            doubts: &doubts,
        }))
    };
    let monitoring = or_nothing(step("monitoring", monitoring), &mut faults)?;
    Ok(report::Input {
        before: Before::default(),
        faults,
        next_runs: plan,
        doubts,
        doubted,
        study,
        monitoring,
        campaign: context.campaign.clone(),
        modulus_logs: standing::modulus_logs(context)?.0,
        spectra,
        blocked,
        frequency,
        model_free: without_model.steps,
        cycles: without_model.trains,
        electrodes,
        set_aside,
        superseded: context.store.superseded_runs()?,
        files: source_files(context)?,
        file_stories: stories(context)?,
        origin: report::Origin {
            program: format!("ieap {CODE_VERSION}"),
            database: format!(
                "change {changes} of {}",
                crate::pipeline::Zone::of(&context.campaign).moment(changed_at)
            ),
        },
        climate: assess::stored(&context.store)?.unwrap_or_default(),
        run_spans_s: runs
            .iter()
            .filter_map(run_window)
            .map(|window| (window.from_s, window.to_s))
            .collect(),
        findings,
        runs,
        comparisons,
        outdated_comparisons,
        templates: BTreeMap::new(),
    })
}

/// The files as they are known, with those that the system could not give among the refused ones.
fn source_files(context: &Context) -> Result<Vec<SourceFile>, PipelineError> {
    let stored = context.store.files()?;
    let mut files: BTreeMap<String, SourceFile> = stored
        .iter()
        .map(|file| (file.path.clone(), file.source_file()))
        .collect();
    for (path, issue) in context.store.unread_files()? {
        let unread = SourceFile::not_read(&path, issue);
        files.insert(path, unread);
    }
    Ok(files.into_values().collect())
}

fn findings(context: &Context, runs: &[RunRecord], found: CurrentFindings) -> report::Findings {
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
    // What follows a tag stands in no list.
    let named = |one: &GroupDiagnosis| {
        let differing = one.differs.iter().map(|own| own.with.clone());
        differing.chain(one.set.iter().cloned()).collect::<Vec<_>>()
    };
    let ids: BTreeSet<String> = found.groups.iter().flat_map(named).collect();
    let of_tags = ids
        .iter()
        .filter(|id| follows_a_tag(id))
        .filter_map(|id| effects::effect(id));
    let of_tags: Vec<&'static dyn Effect> = of_tags.collect();
    let shared = shared_effects(&found.groups, runs, &context.campaign)
        .into_iter()
        .map(|effect| {
            let said = sentence(&effect, &found.groups);
            (effect, said)
        })
        .collect();
    report::Findings {
        shared,
        groups: found.groups,
        runs: found.runs,
        turns: found.turns,
        effects: effects::ALL.iter().chain(&of_tags).map(of_effect).collect(),
        laws: SMOOTH_LAWS
            .iter()
            .map(|law| of_effect(&(*law as &dyn Effect)))
            .collect(),
    }
}
