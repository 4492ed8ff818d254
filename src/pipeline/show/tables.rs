//! The verb `table`: a named table of the campaign, in a format; and what moved in it since earlier fits.

use schemars::JsonSchema;
use serde::Serialize;

use crate::analysis::cache::Cache;
use crate::analysis::frequency::FrequencyRun;
use crate::analysis::impedance::OneLikelihood;
use crate::analysis::laws::doubt::{Doubts, Findings};
use crate::analysis::model_free::curves::StepCurves;
use crate::analysis::monitoring::Monitoring;
use crate::analysis::probe::Course;
use crate::analysis::reductions::RunReductions;
use crate::analysis::tables::moved::{Moved, MovedCell, moved};
use crate::analysis::tables::{NamedTable, Need, TABLES, Table, TableInput, named};
use crate::domain::{
    BlockedRun, GroupDiagnosis, MaterialClass, ModulusLog, RunComparison, RunRecord, SourceFile, SpectrumRun,
};
use crate::pipeline::campaign::context::CODE_VERSION;
use crate::pipeline::campaign::standing::{self, Runs};
use crate::pipeline::findings::alarms::watched;
use crate::pipeline::findings::blocked::blocked_runs;
use crate::pipeline::findings::compare::current_comparisons;
use crate::pipeline::findings::current::current_findings;
use crate::pipeline::findings::frequency::frequency_runs;
use crate::pipeline::findings::kept;
use crate::pipeline::findings::model_free::{WithoutModel, curves_after_steps, without_model};
use crate::pipeline::findings::one_likelihood::in_one_likelihood;
use crate::pipeline::findings::reductions::reductions_of;
use crate::pipeline::intake::climate::electrode_courses;
use crate::pipeline::{Context, PipelineError};
use crate::report::tables::{FORMATS, Format, format_named, text_of};
pub use crate::report::tables::{write_with_decimal_comma, write_within};
use crate::show::Frame;
use crate::store::Earlier;

/// What tables are made from, read from the database.
pub(crate) struct TableData {
    runs: Vec<RunRecord>,
    set_aside: Vec<RunRecord>,
    modulus_logs: Vec<ModulusLog>,
    spectra: Vec<SpectrumRun>,
    blocked: Vec<BlockedRun>,
    frequency: Vec<FrequencyRun>,
    without_model: WithoutModel,
    curves: Vec<StepCurves>,
    reductions: Vec<RunReductions>,
    one_likelihood: Vec<OneLikelihood>,
    electrodes: Vec<Course>,
    files: Vec<SourceFile>,
    groups: Vec<GroupDiagnosis>,
    alone: Vec<GroupDiagnosis>,
    monitoring: Option<Monitoring>,
    doubts: Doubts,
    comparisons: Vec<RunComparison>,
    outdated_comparisons: usize,
    kept: Cache,
    origin: String,
}

impl TableData {
    /// Everything as it is now.
    pub(crate) fn current(context: &Context) -> Result<TableData, PipelineError> {
        let Runs { speaking, set_aside } = standing::runs(context)?;
        let (modulus_logs, _) = standing::modulus_logs(context)?;
        TableData::with(context, speaking, set_aside, modulus_logs)
    }

    /// Runs and logs as they were; files and diagnoses as they are now.
    fn earlier(context: &Context, earlier: &Earlier) -> Result<TableData, PipelineError> {
        let runs = standing::speaking_earlier(context, earlier)?;
        let set_aside = standing::runs(context)?.set_aside;
        let earlier_logs = context.store.modulus_logs_earlier(earlier)?;
        let (modulus_logs, _) = standing::split_logs(context, earlier_logs)?;
        TableData::with(context, runs, set_aside, modulus_logs)
    }

    fn with(
        context: &Context,
        runs: Vec<RunRecord>,
        set_aside: Vec<RunRecord>,
        modulus_logs: Vec<ModulusLog>,
    ) -> Result<TableData, PipelineError> {
        let (changes, changed_at) = context.store.changes()?;
        let (comparisons, outdated_comparisons) = current_comparisons(context, &runs)?;
        let found = current_findings(context)?;
        let doubts = Doubts::new(
            Findings {
                groups: &found.groups,
                runs: &found.runs,
            },
            &runs,
        );
        Ok(TableData {
            comparisons,
            outdated_comparisons,
            kept: kept::values(context),
            blocked: blocked_runs(context, &runs)?,
            frequency: frequency_runs(context, &runs)?,
            without_model: WithoutModel::default(),
            curves: Vec::new(),
            reductions: Vec::new(),
            one_likelihood: Vec::new(),
            electrodes: electrode_courses(context)?,
            runs,
            set_aside,
            modulus_logs,
            spectra: crate::pipeline::findings::impedance::spectra(context, &[])?.runs,
            files: context
                .store
                .files()?
                .iter()
                .map(|file| file.source_file())
                .collect(),
            groups: found.groups,
            alone: found.runs,
            monitoring: None,
            doubts,
            origin: format!(
                "ieap {CODE_VERSION}, campaign {}, change {changes} of {changed_at}",
                context.campaign.id
            ),
        })
    }

    /// The same with what the table needs of every reading, which takes long.
    pub(crate) fn read_for(
        mut self,
        context: &Context,
        named: &NamedTable,
    ) -> Result<TableData, PipelineError> {
        match named.needs {
            Need::None => {}
            Need::Readings => self.without_model = without_model(context, &self.runs, &self.kept)?,
            Need::Curves => self.curves = curves_after_steps(context, &self.runs, &self.kept)?,
            Need::Reductions => self.reductions = reductions_of(context, &self.runs)?,
            Need::OneLikelihood => {
                self.one_likelihood = in_one_likelihood(context, &self.runs, &self.spectra)?;
            }
            Need::Monitoring => self.monitoring = Some(watched(context, &self.runs, &self.doubts)?),
        }
        Ok(self)
    }

    pub(crate) fn table(&self, context: &Context, named: &NamedTable) -> Table {
        named.table(&self.input(context))
    }

    fn input<'a>(&'a self, context: &'a Context) -> TableInput<'a> {
        TableInput {
            campaign: &context.campaign,
            runs: &self.runs,
            set_aside: &self.set_aside,
            modulus_logs: &self.modulus_logs,
            spectra: &self.spectra,
            blocked: &self.blocked,
            frequency: &self.frequency,
            model_free: &self.without_model.steps,
            curves: &self.curves,
            cycles: &self.without_model.trains,
            reductions: &self.reductions,
            one_likelihood: &self.one_likelihood,
            electrodes: &self.electrodes,
            files: &self.files,
            groups: &self.groups,
            alone: &self.alone,
            monitoring: self.monitoring.as_ref(),
            doubts: &self.doubts,
            comparisons: &self.comparisons,
            outdated_comparisons: self.outdated_comparisons,
            told: None,
            kept: Some(&self.kept),
            origin: &self.origin,
        }
    }

    pub(crate) fn run(&self, id: i64) -> Option<&RunRecord> {
        self.runs.iter().find(|run| run.id == id)
    }

    pub(crate) fn comparison(&self, run: &str) -> Option<&RunComparison> {
        self.comparisons.iter().find(|one| one.run == run)
    }

    pub(crate) fn modulus_log(&self, id: i64) -> Option<&ModulusLog> {
        self.modulus_logs.iter().find(|log| log.run.id == id)
    }
}

/// A table by its name.
///
/// # Errors
/// There is none of that name; the message lists those there are.
pub fn find_table(name: &str) -> Result<&'static NamedTable, PipelineError> {
    named(name).ok_or_else(|| PipelineError::BadArgument {
        what: "table",
        found: format!("{name:?}"),
        needed: format!("one of {}", names(TABLES.iter().map(|table| table.name))),
    })
}

/// A format by its name or by the ending of a file.
///
/// # Errors
/// There is none of that name; the message lists those there are.
pub fn find_format(name: &str) -> Result<&'static Format, PipelineError> {
    format_named(name).ok_or_else(|| PipelineError::BadArgument {
        what: "--format",
        found: format!("{name:?}"),
        needed: format!("one of {}", names(FORMATS.iter().map(|format| format.name))),
    })
}

/// Name and description of every table.
pub fn listed() -> impl Iterator<Item = (&'static str, &'static str)> {
    TABLES.iter().map(|table| (table.name, table.about))
}

fn names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}

/// The table of that name as it is now.
///
/// # Errors
/// There is none of that name, or the database cannot be read.
pub fn table(context: &Context, name: &str) -> Result<Table, PipelineError> {
    let named = find_table(name)?;
    Ok(TableData::current(context)?
        .read_for(context, named)?
        .table(context, named))
}

/// All columns of the table of that name as it is now, for programs.
///
/// # Errors
/// There is none of that name, or the database cannot be read.
pub fn frame(context: &Context, name: &str) -> Result<Frame, PipelineError> {
    let named = find_table(name)?;
    let data = TableData::current(context)?.read_for(context, named)?;
    Ok(named.frame(&data.input(context)))
}

/// Puts the materials of a table together by a class: `electrode`, `membrane` or `electrolyte`.
///
/// # Errors
/// It is none of these, or the table compares no materials.
pub fn compared_by(context: &mut Context, table: &str, class: &str) -> Result<(), PipelineError> {
    if !find_table(table)?.compares_materials {
        let comparing = TABLES.iter().filter(|named| named.compares_materials);
        return Err(PipelineError::BadArgument {
            what: "--by",
            found: format!("table {table}, which puts no materials together"),
            needed: format!("one of {}", names(comparing.map(|named| named.name))),
        });
    }
    let found = MaterialClass::from_key(class).ok_or_else(|| PipelineError::BadArgument {
        what: "--by",
        found: format!("{class:?}"),
        needed: format!(
            "one of {}",
            names(MaterialClass::ALL.iter().map(|class| class.key()))
        ),
    })?;
    context.campaign.compare.by = Some(found);
    Ok(())
}

/// The table with the columns that are asked for, each by number, key, symbol or a part of one, in their order.
///
/// # Errors
/// A column is not known, or fits several; the message lists them.
pub fn chosen_columns(table: &Table, asked: &[String]) -> Result<Table, PipelineError> {
    let one = |asked: &String| {
        table
            .column_named(asked.trim())
            .map_err(|needed| PipelineError::BadArgument {
                what: "--columns",
                found: format!("{asked:?}"),
                needed,
            })
    };
    let columns: Vec<usize> = asked.iter().map(one).collect::<Result<_, _>>()?;
    Ok(table.with_columns(&columns))
}

/// The document that `ieap table NAME --moved --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct MovedDocument {
    /// Always `ieap/moved/1`.
    pub schema: &'static str,
    /// Name of the table.
    pub table: String,
    /// What it was held against, in words.
    pub against: String,
    /// Cells that were compared.
    pub compared: usize,
    /// Cells that moved by more than one standard error of what stood there, or became something else.
    pub beyond_one_sigma: usize,
    /// Cells that moved: those that became something else, then the farthest, then what has no error. A cell without an
    /// error that is printed as before is none.
    pub cells: Vec<MovedEntry>,
    /// Rows that are gone.
    pub rows_gone: Vec<String>,
    /// Rows that are new.
    pub rows_new: Vec<String>,
}

/// One cell that moved.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MovedEntry {
    /// Label of its row.
    pub row: String,
    /// Key of its column.
    pub column: String,
    /// Unit of its column.
    pub unit: String,
    /// What stood there, as printed.
    pub before: String,
    /// What stands there now.
    pub after: String,
    /// Distance in standard errors of what stood there; null where either is no value.
    pub sigma: Option<f64>,
}

/// What moved in a table since earlier fits.
///
/// # Errors
/// There is no table of that name, or the database cannot be read.
pub fn moved_since(context: &Context, name: &str, earlier: &Earlier) -> Result<MovedDocument, PipelineError> {
    let named = find_table(name)?;
    let before = TableData::earlier(context, earlier)?.read_for(context, named)?;
    let before = before.table(context, named);
    let after = TableData::current(context)?.read_for(context, named)?;
    let after = after.table(context, named);
    let Moved {
        compared,
        cells,
        rows_gone,
        rows_new,
    } = moved(&before, &after);
    Ok(MovedDocument {
        schema: "ieap/moved/1",
        table: name.to_owned(),
        against: match earlier {
            Earlier::BeforeRefit => "the fits that the current ones replaced".to_owned(),
            Earlier::At(moment) => format!("the fits of {moment}"),
        },
        compared,
        beyond_one_sigma: cells
            .iter()
            .filter(|cell| cell.became_other() || cell.sigma.is_some_and(|sigma| sigma > 1.0))
            .count(),
        cells: cells
            .into_iter()
            .map(entry)
            .filter(|entry| entry.sigma.is_some() || entry.before != entry.after)
            .collect(),
        rows_gone,
        rows_new,
    })
}

fn entry(cell: MovedCell) -> MovedEntry {
    MovedEntry {
        before: text_of(&cell.before),
        after: text_of(&cell.after),
        row: cell.row,
        column: cell.column,
        unit: cell.unit,
        sigma: cell.sigma,
    }
}

/// A moment that a person typed, as the database writes moments: a date alone is its first moment in the campaign's
/// time zone.
///
/// # Errors
/// It is neither a date nor a time with a zone.
pub fn moment(context: &Context, typed: &str) -> Result<String, PipelineError> {
    let zone = context.campaign.timezone.as_deref().unwrap_or("UTC");
    let zoned = || {
        let date: jiff::civil::Date = typed.parse().ok()?;
        Some(date.in_tz(zone).ok()?.timestamp())
    };
    let found = typed.parse::<jiff::Timestamp>().ok().or_else(zoned);
    let found = found.ok_or_else(|| PipelineError::BadArgument {
        what: "--since",
        found: format!("{typed:?}"),
        needed: "a date (2026-11-20) or a time with its zone (2026-11-20T10:00:00+02:00)".to_owned(),
    })?;
    Ok(found.strftime("%Y-%m-%dT%H:%M:%SZ").to_string())
}
