//! Everything derived again: a database is made anew in a folder of its own from archive and journal, results are made in it,
//! and the two are held against each other, table by table.

use crate::domain::words::counted;
use crate::system::passing::Passing;
use std::collections::BTreeSet;
use std::path::Path;

use super::differs_in;
use super::part::Part;
use crate::domain::Issue;
use crate::ingest::archive::Archive;
use crate::pipeline::campaign::context::{CODE_VERSION, now};
use crate::pipeline::intake::ingest::{IngestSummary, retag_runs};
use crate::pipeline::upkeep::rebuild::replay::{Lost, replay};
use crate::pipeline::{AnalyseModulus, Context, DiagnoseRuns, FitRuns, Observer, PipelineError, failed};
use crate::store::{How, ResultKind, RowDiffers, Store, journal};

/// Makes the database anew and compares: what was stored, and results.
///
/// # Errors
/// The folder for the copies cannot be made, a database or the archive refuses, or a model is not known.
pub fn parts(
    context: &Context,
    diagnoses: bool,
    observer: &dyn Observer,
) -> Result<[Part; 2], PipelineError> {
    let made = Passing::made(tempfile::tempdir, |folder| folder.path().to_owned());
    let (folder, _passing) = made.map_err(in_temporary)?;
    let [one, other] = ["stored", "made"].map(|name| folder.path().join(name));
    for folder in [&one, &other] {
        crate::system::fs::create_dir(folder).map_err(in_temporary)?;
    }
    // Others go on writing meanwhile: it is one moment that is compared.
    let stored = context.store.copy_in(&one)?;
    let (mut anew, lost) = made_anew(context, &stored, &other, observer)?;
    let (kinds, made) = results(&mut anew, diagnoses, observer)?;
    let (differing, tables) = stored.table_by_table(&anew.store, &kinds)?;
    let lost = Lasting::of(lost, &differing);
    let (of_results, of_tables): (Vec<_>, Vec<_>) =
        (differing.iter()).partition(|differs| differs.table == "result");
    let out_of_date: BTreeSet<&str> = of_tables
        .iter()
        .filter(|differs| is_out_of_date(differs))
        .map(|differs| differs.key.as_str())
        .collect();
    let of_tables = of_tables
        .into_iter()
        .filter(|differs| !lost.explains(differs))
        .map(|differs| of_table(differs, out_of_date.contains(differs.key.as_str())));
    let tables: Vec<String> = tables.into_iter().filter(|table| table != "result").collect();
    Ok([
        Part {
            part: "tables",
            looked_at: format!(
                "every row of {} against a database that was made anew from archive and journal",
                tables.join(", ")
            ),
            findings: of_tables
                .collect::<Vec<_>>()
                .into_iter()
                .chain(lost.issues())
                .collect(),
        },
        Part {
            part: "results",
            looked_at: made,
            findings: of_results.into_iter().map(of_result).collect(),
        },
    ])
}

fn in_temporary(source: std::io::Error) -> PipelineError {
    failed(
        &std::env::temp_dir(),
        "making a folder for a copy of the database",
    )(source)
}

/// A database in `folder` of all that the journal says up to where `stored` has it, tagged as the files say now.
fn made_anew(
    context: &Context,
    stored: &Store,
    folder: &Path,
    observer: &dyn Observer,
) -> Result<(Context, Vec<Lost>), PipelineError> {
    let mut store = Store::open(folder)?;
    store.keep_journal_heard();
    let mut anew = context.with_store(store)?;
    let mut lines = journal::read(&context.folder)?.unwrap_or_default().lines;
    let end = stored.last_said()?.n;
    lines.retain(|line| line.n <= end);
    let replayed = replay(&mut anew, &lines, observer)?;
    if let Some(id) = Archive::new(&context.folder).owner()? {
        anew.store.take_identity(&now(), &id)?;
    }
    retag_runs(&mut anew, &mut IngestSummary::default(), observer)?;
    Ok((anew, replayed.lost))
}

/// Makes results in the new database; gives their kinds, and what was made in words.
fn results(
    anew: &mut Context,
    diagnoses: bool,
    observer: &dyn Observer,
) -> Result<(Vec<ResultKind>, String), PipelineError> {
    let fits = FitRuns::default().run(anew, observer)?;
    let modulus = AnalyseModulus::default().run(anew, observer)?;
    let mut kinds = vec![ResultKind::Fit, ResultKind::Modulus];
    let mut made = format!(
        "{} and {} made again",
        counted(fits.fitted + fits.failed.len(), "fit"),
        counted(modulus.analysed + modulus.failed.len(), "modulus analysis")
    );
    if diagnoses {
        let found = DiagnoseRuns::default().run(anew, observer)?;
        made += &format!(", {}", counted(found.diagnosed, "diagnosis"));
        kinds.extend([ResultKind::Group, ResultKind::Run]);
    }
    Ok((kinds, made))
}

/// Runs and logs of the database whose raw files do not give them again.
struct Lasting(Vec<Lost>);

impl Lasting {
    fn of(mut lost: Vec<Lost>, differing: &[RowDiffers]) -> Lasting {
        let is_there = |name: &str| {
            differing
                .iter()
                .any(|differs| differs.how == How::OnlyHere && is_of(differs, name))
        };
        lost.retain(|lost| is_there(&lost.name));
        Lasting(lost)
    }

    fn explains(&self, differs: &RowDiffers) -> bool {
        self.0.iter().any(|lost| is_of(differs, &lost.name))
    }

    fn issues(self) -> impl Iterator<Item = Issue> {
        self.0.into_iter().map(|lost| lost.issue.at(&lost.name))
    }
}

/// Whether a row is of a run or log of that name, or hangs on it.
fn is_of(differs: &RowDiffers, name: &str) -> bool {
    let rest = differs.key.strip_prefix(name);
    rest.is_some_and(|rest| rest.starts_with(' '))
}

/// Whether what a row was made from is no more what it would be made from now.
fn is_out_of_date(differs: &RowDiffers) -> bool {
    let has =
        |column: &str| matches!(&differs.how, How::Columns(columns) if columns.iter().any(|of| of == column));
    match differs.table.as_str() {
        "run" => has("tag_digest") && !has("data_hash"),
        "result" => has("key"),
        _ => false,
    }
}

fn of_table(differs: &RowDiffers, out_of_date: bool) -> Issue {
    let (of, what) = (differs_in::subject(differs), differs_in::words(differs));
    if out_of_date {
        return Issue::note(
            "result-out-of-date",
            format!("tags, campaign.toml or climate are others now than when it was tagged: {what}"),
        )
        .at(of)
        .mend("`ieap run` tags it anew");
    }
    let of_readings = ["run", "channel", "climate_log", "climate_series"];
    if of_readings.contains(&differs.table.as_str()) {
        Issue::error(
            "readings-differ",
            format!("the raw bytes and what was said give other readings or tags than are stored: {what}"),
        )
        .at(of)
        .mend("where the program is newer than the readings, the next `ieap run` reads the file anew; else report it with the file")
    } else {
        Issue::error(
            "table-differs",
            format!("archive and journal give something else than is stored: {what}"),
        )
        .at(of)
        .mend("`ieap rebuild` makes the database anew from archive and journal")
    }
}

fn of_result(differs: &RowDiffers) -> Issue {
    let (of, what) = (differs_in::subject(differs), differs_in::words(differs));
    if matches!(differs.how, How::Columns(_)) && !is_out_of_date(differs) {
        let message =
            format!("made again by this program (version {CODE_VERSION}), it has other numbers: {what}");
        Issue::error("result-differs", message).at(of).mend(
            "if another version of the program made it, `ieap run --only fit --again` or `ieap diagnose --again` makes it \
             anew; else report it with the campaign",
        )
    } else {
        let message = format!("it was made from other readings, tags or options than hold now: {what}");
        Issue::note("result-out-of-date", message)
            .at(of)
            .mend("`ieap run` makes it anew")
    }
}
