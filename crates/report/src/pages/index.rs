//! The overview: what needs a person, what was found, the parameters over the conditions, every run.

use ieap_domain::words::{counted, in_a_row};
use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::answers::{self, Said, coverage};
use super::comparison::{SmallPanel, small_panels};
use super::needs::{Need, needs};
use super::run_fit::symbol_of;
use super::runs_table::{RunsTable, runs_table};
use super::wording::{RunLink, has_warnings, humidity_label, voltage_labels};
use crate::blocks::{self, Writer};
use crate::error::ReportError;
use crate::moved::Was;
use crate::pages::policy::{MOST_FILES_OF_REASON, MOST_MOVED_NAMED};
use crate::site::Site;
use ieap_analysis::study;
use ieap_analysis::witnesses;
use ieap_domain::{Contradiction, FileState, Issue, RunRecord, RunState, Severity, SourceFile, Standing};
use ieap_show::Block;

/// Laws that are drawn at most: one picture. Chosen: two stand beside each other.
const MOST_DRAWN: usize = 2;
/// Voltages from which the matrix is set tighter.
const MANY: usize = 8;

/// The page's text.
#[derive(Debug, Serialize)]
struct Index {
    lead: String,
    /// What the study shows, a paragraph a material.
    said: Vec<Said>,
    /// What else changed with what was compared; empty where nothing did.
    confounded: String,
    /// Runs that are not like their own; empty where none is.
    odd: String,
    /// A law that is told first, drawn.
    blocks: Vec<blocks::Item>,
    /// Else what is told first over the conditions.
    picture: Vec<SmallPanel>,
    answers: Vec<Said>,
    /// Numbers that moved not long ago; empty where none did.
    moved: String,
    needs: Vec<Need>,
    /// Statements about runs that contradict each other.
    questions: Vec<Contradiction>,
    counts: Vec<Count>,
    small: Vec<SmallPanel>,
    coverage: String,
    runs: RunsTable,
    voltages: Vec<String>,
    many_voltages: bool,
    rows: Vec<MatrixRow>,
    unplaced: Vec<RunLink>,
    /// Runs and files with what is to be known of them.
    lists: Vec<blocks::Item>,
}

#[derive(Debug, Serialize)]
struct Count {
    number: usize,
    label: &'static str,
}

#[derive(Debug, Serialize)]
struct MatrixRow {
    /// Set in the first row of a material: its name, and over how many rows it stands.
    material: Option<(String, usize)>,
    environment: String,
    humidity: String,
    cells: Vec<Vec<MatrixRun>>,
}

#[derive(Debug, Serialize)]
struct MatrixRun {
    link: RunLink,
    ordinal: usize,
    /// `fitted`, `warned` or `unfitted`: class and word.
    state: &'static str,
}

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let mut figures = BTreeMap::new();
    let asked = &site.input.study;
    let is_asked = study::view::is_told(asked);
    let laws = study::view::first_charts(asked).into_iter();
    let laws: Vec<Block> = laws.take(MOST_DRAWN).map(Block::Chart).collect();
    let blocks = blocks::items(site, laws, 2, &mut figures)?;
    let small = small_panels(site, &mut figures)?;
    let first = study::first_parameter(asked).or(small.first().map(|panel| panel.key));
    let is_first = |panel: &SmallPanel| blocks.is_empty() && Some(panel.key) == first;
    let (picture, small) = small.into_iter().partition(is_first);
    let mut writer = Writer::new(site, 2, &mut figures);
    write_lists(&mut writer, site)?;
    let lists = writer.taken();
    let said = answers::first_screen(site);
    let index = Index {
        lead: lead(site),
        answers: answers::answers(site, &said),
        said,
        confounded: study::view::confounded(asked)
            .filter(|_| is_asked)
            .unwrap_or_default(),
        odd: study::odd_in_short(&asked.odd)
            .filter(|_| is_asked)
            .unwrap_or_default(),
        blocks,
        picture,
        coverage: coverage(site),
        moved: moved(site),
        needs: needs(site),
        questions: witnesses::questions(site.input.records(), &site.input.campaign),
        counts: counts(site),
        small,
        runs: runs_table(site),
        voltages: voltage_labels(&site.conditions.voltages_v),
        many_voltages: site.conditions.voltages_v.len() > MANY,
        rows: rows(site),
        unplaced: site
            .conditions
            .unplaced
            .iter()
            .map(|&run| RunLink::to(site, run))
            .collect(),
        lists,
    };
    Content::new("index.html", &index, figures)
}

fn lead(site: &Site) -> String {
    let runs = &site.input.runs;
    if runs.is_empty() {
        return without_runs(site);
    }
    let fitted = runs.iter().filter(|run| run.fit.is_some()).count();
    let strips = if site.input.study.has_one_strip_each() {
        ", one strip a material"
    } else {
        ""
    };
    format!(
        "{} in {}{strips}; {} fitted.",
        counted(runs.len(), "run"),
        counted(site.conditions.measured.len(), "condition"),
        if fitted == runs.len() {
            "all are".to_owned()
        } else {
            format!("{fitted} {}", if fitted == 1 { "is" } else { "are" })
        }
    )
}

/// `2 numbers moved since 27 Nov 2026, 15:08 UTC: λ of S1/air.csv from 1.2 ± 0.1 to 1.4 ± 0.1; ...`
fn moved(site: &Site) -> String {
    let mut moved: Vec<_> = site.numbers.moved().collect();
    moved.sort_by(|a, b| b.2.until.cmp(&a.2.until));
    let Some(earliest) = moved.iter().map(|(_, _, was, _)| was.until.as_str()).min() else {
        return String::new();
    };
    let one = |(run, key, was, is): &(&str, &str, &Was, &str)| {
        let name = site.input.campaign.run_name(run);
        format!("{} of {name} from {} to {is}", symbol_of(key), was.text)
    };
    let named: Vec<String> = moved.iter().take(MOST_MOVED_NAMED).map(one).collect();
    let more = match moved.len() - named.len() {
        0 => String::new(),
        more => format!("; {more} more in the table of all runs"),
    };
    format!(
        "{} moved since {}: {}{more}.",
        counted(moved.len(), "number"),
        site.zone().moment(earliest),
        named.join("; ")
    )
}

/// What is there beside runs of a step.
fn without_runs(site: &Site) -> String {
    let input = site.input;
    let others = [
        (input.spectra.runs.len(), "impedance spectrum"),
        (input.modulus_logs.len(), "modulus log"),
    ];
    let others = others.into_iter().filter(|(count, _)| *count > 0);
    let others: Vec<String> = others.map(|(count, noun)| counted(count, noun)).collect();
    match (others.is_empty(), input.set_aside.is_empty()) {
        (true, true) => "No run has been taken in yet.".to_owned(),
        (true, false) => "Every run is set aside: see below.".to_owned(),
        (false, true) => format!("{}; no run of a step.", in_a_row(&others)),
        (false, false) => format!(
            "{}; no run of a step; what is set aside stands below.",
            in_a_row(&others)
        ),
    }
}

fn counts(site: &Site) -> Vec<Count> {
    let runs = &site.input.runs;
    let of_state = |state| runs.iter().filter(|run| run.state == state).count();
    let waiting = runs
        .iter()
        .filter(|run| run.state == RunState::Ready && run.fit.is_none())
        .count();
    let count = |number, one, many| Count {
        number,
        label: if number == 1 { one } else { many },
    };
    let all = vec![
        count(
            runs.iter().filter(|run| has_warnings(run)).count(),
            "with warnings",
            "with warnings",
        ),
        count(waiting, "waiting for a fit", "waiting for a fit"),
        count(site.input.set_aside.len(), "run set aside", "runs set aside"),
        count(of_state(RunState::Untagged), "lacking a tag", "lacking a tag"),
        count(
            of_state(RunState::NotFitted),
            "not a step response",
            "not a step response",
        ),
        count(
            of_state(RunState::NoSteps),
            "without steps of the voltage",
            "without steps of the voltage",
        ),
        count(
            files(site, FileState::Refused).len(),
            "file refused",
            "files refused",
        ),
        count(
            files(site, FileState::Pending).len(),
            "file waiting",
            "files waiting",
        ),
        count(
            site.input.superseded.len(),
            "earlier revision kept",
            "earlier revisions kept",
        ),
        count(site.input.modulus_logs.len(), "modulus log", "modulus logs"),
    ];
    all.into_iter().filter(|count| count.number > 0).collect()
}

fn rows(site: &Site) -> Vec<MatrixRow> {
    let conditions = &site.conditions;
    let span = conditions.surroundings.len();
    let mut rows = Vec::new();
    for (material, name) in conditions.materials.iter().enumerate() {
        for (surroundings, at) in conditions.surroundings.iter().enumerate() {
            let cell = |voltage| match conditions.at(material, surroundings, voltage) {
                Some(condition) => matrix_runs(site, &condition.runs),
                None => vec![],
            };
            rows.push(MatrixRow {
                material: (surroundings == 0).then(|| (name.clone(), span)),
                environment: at.environment.clone(),
                humidity: humidity_label(at),
                cells: (0..conditions.voltages_v.len()).map(cell).collect(),
            });
        }
    }
    rows
}

fn matrix_runs(site: &Site, runs: &[usize]) -> Vec<MatrixRun> {
    let matrix_run = |(ordinal, &run): (usize, &usize)| {
        let record = &site.input.runs[run];
        MatrixRun {
            link: RunLink::to(site, run),
            ordinal: ordinal + 1,
            state: match (record.fit.is_some(), has_warnings(record)) {
                (false, _) => "unfitted",
                (true, true) => "warned",
                (true, false) => "fitted",
            },
        }
    };
    runs.iter().enumerate().map(matrix_run).collect()
}

/// What needs a look, of runs and of files, the gravest first.
fn write_lists(page: &mut Writer, site: &Site) -> Result<(), ReportError> {
    let said =
        "No table, figure, comparison or alarm is made from these runs. Their pages show what was measured.";
    let aside = Block::issues(&set_aside(site)).map(|aside| vec![Block::say(said), aside]);
    list(page, "set-aside", "Runs set aside", aside)?;
    let refused = Block::issues(&first_of_each_reason(files(site, FileState::Refused)));
    let refused = refused.map(|refused| [refused].into_iter().chain(more(site)).collect());
    list(page, "refused", "Files that could not be read", refused)?;
    let untagged = Block::issues(&untagged(site)).map(|untagged| vec![untagged]);
    list(page, "untagged", "Runs that lack a tag", untagged)?;
    let problems = problems(site);
    if !problems.is_empty() {
        page.anchored("warnings", "Warnings", |part| {
            part.issues_of_runs(problems);
            Ok(())
        })?;
    }
    let waiting = Block::issues(&files(site, FileState::Pending)).map(|waiting| vec![waiting]);
    list(page, "waiting", "Files waiting", waiting)
}

/// A list under its anchor, where there is one.
fn list(page: &mut Writer, anchor: &str, title: &str, blocks: Option<Vec<Block>>) -> Result<(), ReportError> {
    match blocks {
        Some(blocks) => page.anchored(anchor, title, |part| part.write(blocks)),
        None => Ok(()),
    }
}

/// The files in that state, each with why it is.
fn files(site: &Site, state: FileState) -> Vec<Issue> {
    let listed = site.input.files.iter();
    let listed = listed.filter(|file| file.state == state && !file.missing);
    let why = |file: &SourceFile| match &file.issue {
        Some(issue) => told_of(&file.path, issue),
        None => Issue {
            severity: Severity::Note,
            code: String::new(),
            place: file.path.clone(),
            message: String::new(),
            mend: String::new(),
        },
    };
    listed.map(why).collect()
}

/// An issue under the name of what it is of, with its place in that where it does not name it itself.
fn told_of(path: &str, issue: &Issue) -> Issue {
    let (place, message) = (&issue.place, &issue.message);
    let said = if message.contains(place.as_str()) {
        message.clone()
    } else {
        format!("{place}: {message}")
    };
    Issue {
        message: said,
        ..issue.clone().at(path)
    }
}

/// The first refused files of each reason.
fn first_of_each_reason(files: Vec<Issue>) -> Vec<Issue> {
    let mut listed: BTreeMap<String, usize> = BTreeMap::new();
    let is_first = |file: &Issue| {
        let of_reason = listed.entry(file.code.clone()).or_insert(0);
        *of_reason += 1;
        *of_reason <= MOST_FILES_OF_REASON
    };
    files.into_iter().filter(is_first).collect()
}

/// How many refused files of each reason are not listed.
fn more(site: &Site) -> Vec<Block> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for file in files(site, FileState::Refused) {
        *counts.entry(file.code).or_insert(0) += 1;
    }
    let unlisted = counts
        .into_iter()
        .filter(|(_, count)| *count > MOST_FILES_OF_REASON);
    let said = unlisted.map(|(code, count)| {
        Block::say(format!(
            "{} more for the same reason ({code}); `ieap status` lists all.",
            counted(count - MOST_FILES_OF_REASON, "file")
        ))
    });
    said.collect()
}

/// Why runs are set aside.
fn set_aside(site: &Site) -> Vec<Issue> {
    let why = |run: &RunRecord| {
        let (word, reason) = (run.standing.key(), run.standing.reason());
        Issue {
            severity: match run.standing {
                Standing::Condemned { .. } => Severity::Warning,
                _ => Severity::Note,
            },
            code: word.to_owned(),
            place: run.path.clone(),
            message: format!("{word}: {reason}"),
            mend: run.standing.mend(&run.path),
        }
    };
    site.input.set_aside.iter().map(why).collect()
}

/// Tags that runs lack.
fn untagged(site: &Site) -> Vec<Issue> {
    let runs = site.input.runs.iter();
    let runs = runs.filter(|run| run.state == RunState::Untagged);
    runs.flat_map(|run| run.issues.iter().map(|issue| told_of(&run.path, issue)))
        .collect()
}

/// Warnings and errors of runs and fits, gathered by code; the worst and the most frequent first.
fn problems(site: &Site) -> Vec<(Issue, Vec<String>)> {
    let mut by_code: BTreeMap<String, (Issue, Vec<String>)> = BTreeMap::new();
    for run in &site.input.runs {
        for issue in worrying(run) {
            let (_, runs) = by_code
                .entry(issue.code.clone())
                .or_insert_with(|| (issue, Vec::new()));
            if runs.last() != Some(&run.path) {
                runs.push(run.path.clone());
            }
        }
    }
    let mut gathered: Vec<(Issue, Vec<String>)> = by_code.into_values().collect();
    gathered.sort_by_key(|(issue, runs)| (std::cmp::Reverse(issue.severity), std::cmp::Reverse(runs.len())));
    gathered
}

/// Issues worth a place on this page: those of a run whose tags are complete, and of its fit.
fn worrying(run: &RunRecord) -> Vec<Issue> {
    let mut issues = match run.state {
        RunState::Untagged | RunState::NoSteps => vec![],
        RunState::Ready | RunState::NotFitted => run.issues.clone(),
    };
    if let Some(fit) = &run.fit {
        issues.extend(fit.issues.iter().cloned());
        if !fit.converged {
            issues.push(Issue::error(
                "fit-not-converged",
                format!("the fit did not converge: {}", fit.why_stopped),
            ));
        }
    }
    issues.retain(|issue| issue.severity >= Severity::Warning);
    issues
}
