//! BioLogic EC-Lab binary file (.mpr): modules of settings, readings, log and loops.
//!
//! Columns have ids whose list grows with every version of EC-Lab. Ids that files have shown are read; from the first
//! unknown one on the columns of a row are left out, with a warning, and the row width given by the module's length is
//! held against that of the known columns. The log, with the start in local time, is appended when the run ends, so a
//! file without it was still being written. A module that is shorter than it says shows a cut. The technique `Wait` has
//! no rows and is a sidecar. Readings of module versions other than 2, 3 and 11 were never seen and are refused.

use super::mpr_columns::{self, Stored};
use super::mpt_header;
use crate::formats::assemble::{Raw, assemble_untimed};
use crate::formats::cells::CellTable;
use crate::formats::recognition::{FileHead, Match};
use crate::formats::{About, Format, ReadContext, ReadError, stamp};
use crate::text::Cell;
use crate::text::header::Meaning;
use crate::{Reading, StartedAt, Timestamp};
use ieap_domain::{Issue, RunStatus};

/// Reader of EC-Lab binary files.
pub struct BiologicMpr;

const MAGIC: &[u8] = b"BIO-LOGIC MODULAR FILE\x1a";
/// Bytes of the magic with its padding.
const MAGIC_BYTES: usize = 52;
/// Where the log holds the start, days since 1899-12-30.
const LOG_START: usize = 585;

/// One module.
struct Module<'a> {
    name: &'a str,
    version: u32,
    body: &'a [u8],
    declared: usize,
    offset: usize,
}

impl Format for BiologicMpr {
    fn about(&self) -> About {
        About {
            id: "biologic-mpr",
            title: "BioLogic EC-Lab binary file (.mpr)",
            extensions: &["mpr"],
            version: 5,
        }
    }

    fn recognise(&self, head: &FileHead<'_>) -> Match {
        Match::certain_if(
            head.bytes.starts_with(MAGIC),
            "the file begins with BIO-LOGIC MODULAR FILE",
        )
    }

    fn read(&self, bytes: &[u8], _context: &ReadContext) -> Result<Reading, ReadError> {
        if bytes.is_empty() {
            return Err(ReadError::Empty);
        }
        let modules = modules(bytes)?;
        let of = |name: &str| modules.iter().find(|module| module.name == name);
        let technique_id = of("VMP Set").and_then(|module| module.body.first()).copied();
        let technique = technique_id.and_then(mpr_columns::technique);
        let Some(readings) = of("VMP data") else {
            return Err(ReadError::header_only(
                0,
                format!("{} modules, none with readings", modules.len()),
            ));
        };
        let mut issues = Vec::new();
        let (raw, evidence) = raw(readings, &mut issues)?;
        if technique == Some("Wait") && raw.cells.rows() == 0 {
            return Err(ReadError::Sidecar {
                kind: "EC-Lab pause",
                sign: "the technique Wait without rows",
            });
        }
        let is_step_response = technique.is_some_and(super::mode_and_error::holds_the_voltage);
        let log = of("VMP LOG").filter(|log| log.body.len() == log.declared);
        let (status, status_evidence) = match (evidence, log) {
            (Some(evidence), _) => (RunStatus::Cut, evidence),
            (None, Some(_)) => (RunStatus::Complete, "the log that ends a run is there".to_owned()),
            (None, None) => (
                RunStatus::StillRunning,
                "the log that ends a run is not there".to_owned(),
            ),
        };
        Ok(Reading {
            technique: technique
                .map(str::to_owned)
                .or(technique_id.map(|id| format!("technique {id} of EC-Lab"))),
            is_step_response,
            status,
            status_evidence,
            started_at: log.and_then(started_at),
            tables: vec![assemble_untimed(raw, &mut issues)?],
            original_metadata: modules
                .iter()
                .map(|module| (module.name.to_owned(), format!("version {}", module.version)))
                .collect(),
            issues,
            ..self.reading()
        })
    }
}

fn modules(bytes: &[u8]) -> Result<Vec<Module<'_>>, ReadError> {
    let mut modules = Vec::new();
    let mut at = MAGIC_BYTES;
    while at < bytes.len() {
        if !bytes[at..].starts_with(b"MODULE") {
            let whole = b"MODULE".starts_with(&bytes[at..]);
            if whole {
                break;
            }
            return Err(ReadError::Structure {
                offset: at as u64,
                found: "no module begins here".to_owned(),
                needed: "MODULE",
            });
        }
        let Some((module, end)) = module(bytes, at) else {
            break;
        };
        modules.push(module);
        at = end;
    }
    Ok(modules)
}

/// The module at a place and where the next one starts; none where the file ends in its header.
fn module(bytes: &[u8], at: usize) -> Option<(Module<'_>, usize)> {
    const IS_LONG_HEADER: u32 = u32::MAX;
    let number = |place: usize| -> Option<u32> {
        Some(u32::from_le_bytes(
            bytes.get(at + place..at + place + 4)?.try_into().ok()?,
        ))
    };
    let name = std::str::from_utf8(bytes.get(at + 6..at + 16)?).ok()?.trim();
    let (length, version, header) = match number(41)? {
        IS_LONG_HEADER => (number(45)?, number(53)?, 65),
        length => (length, number(45)?, 57),
    };
    let offset = at.checked_add(header)?;
    let rest = bytes.get(offset..)?;
    let declared = length as usize;
    let module = Module {
        name,
        version,
        body: &rest[..declared.min(rest.len())],
        declared,
        offset,
    };
    Some((module, offset.saturating_add(declared)))
}

/// Where ids and rows stand in the readings' module: bytes of the count of columns, and before the rows.
fn layout(version: u32) -> Result<(usize, usize), ReadError> {
    match version {
        2 => Ok((1, 405)),
        3 => Ok((1, 406)),
        11 => Ok((2, 1007)),
        _ => Err(ReadError::NeverSeen {
            what: "this version of the readings of EC-Lab",
            found: format!("version {version}"),
        }),
    }
}

/// The table, and why it is not whole.
fn raw(module: &Module<'_>, issues: &mut Vec<Issue>) -> Result<(Raw, Option<String>), ReadError> {
    let (count_bytes, rows_at) = layout(module.version)?;
    let broken = |found: String, needed: &'static str| ReadError::Structure {
        offset: module.offset as u64,
        found,
        needed,
    };
    let waits = || ReadError::header_only(0, "the file ends before the first row");
    let head = module.body.get(..rows_at).ok_or_else(waits)?;
    let declared = u32::from_le_bytes([head[0], head[1], head[2], head[3]]) as usize;
    let columns = match count_bytes {
        1 => usize::from(head[4]),
        _ => usize::from(u16::from_le_bytes([head[4], head[5]])),
    };
    let first_id = 4 + count_bytes;
    let ids = head
        .get(first_id..first_id + 2 * columns)
        .ok_or_else(|| broken(format!("{columns} columns"), "ids of all columns before the rows"))?;
    let ids: Vec<u16> = ids
        .chunks_exact(2)
        .map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
        .collect();
    let values = module.declared.saturating_sub(rows_at);
    if declared == 0 {
        return Ok((table(&ids, &[], 1, issues).0, None));
    }
    if values % declared != 0 {
        return Err(broken(
            format!("{values} bytes for {declared} rows"),
            "rows of equal width",
        ));
    }
    let width = values / declared;
    let rows = &module.body[rows_at..];
    let (raw, known) = table(&ids, rows, width, issues);
    let is_all_known = ids.iter().all(|id| mpr_columns::column(*id).is_some());
    if known > width || (is_all_known && known != width) {
        return Err(broken(
            format!("rows of {width} bytes"),
            "rows as wide as their columns",
        ));
    }
    let found = raw.cells.rows();
    let evidence = (found < declared).then(|| format!("the module declares {declared} rows, {found} found"));
    Ok((raw, evidence))
}

/// Columns up to the first unknown one, and the bytes of a row that they take.
fn table(ids: &[u16], rows: &[u8], width: usize, issues: &mut Vec<Issue>) -> (Raw, usize) {
    let mut columns: Vec<(&str, Stored, usize)> = Vec::new();
    let (mut next, mut flags_at) = (0, None);
    for (index, &id) in ids.iter().enumerate() {
        let Some((name, stored)) = mpr_columns::column(id) else {
            let message = format!(
                "column id {id} is not known; it and the {} columns behind it are left out",
                ids.len() - index - 1
            );
            let mend = "export the run as text (.mpt) from EC-Lab";
            issues.push(
                Issue::warning("unknown-column", message)
                    .at(format!("column {}", index + 1))
                    .mend(mend),
            );
            break;
        };
        let at = match stored {
            Stored::Flag { .. } => *flags_at.get_or_insert_with(|| {
                next += 1;
                next - 1
            }),
            _ => next,
        };
        columns.push((name, stored, at));
        next += stored.size();
    }
    let names: Vec<&str> = columns.iter().map(|(name, _, _)| *name).collect();
    let mut headers = mpt_header::headers(&names.join("\t"));
    if names.contains(&"freq/Hz") {
        // Rows of a spectrum stand for frequencies; their times may repeat.
        let times = headers.iter_mut().filter(|header| header.raw_name == "time/s");
        times.for_each(|header| header.meaning = Meaning::Other);
    }
    let mut cells = CellTable::new(0, &vec![false; headers.len()], rows.len() / width.max(1));
    for (number, row) in rows.chunks_exact(width.max(1)).enumerate() {
        for (column, (_, stored, at)) in cells.columns.iter_mut().zip(&columns) {
            let value = row.get(*at..).and_then(|bytes| stored.value(bytes));
            let cell = match value {
                Some(value) if value.is_finite() => Cell::Number(value),
                Some(_) => Cell::NotFinite,
                None => Cell::Empty,
            };
            column.push(number + 1, cell, || "NaN".to_owned());
        }
        cells.end_row(number + 1, headers.len());
    }
    super::mode_and_error::judge_control(&mut headers, &cells);
    let raw = Raw {
        flags: super::mode_and_error::marks(&headers, &cells),
        ..Raw::of_instrument(String::new(), headers, cells)
    };
    (raw, next)
}

fn started_at(log: &Module<'_>) -> Option<StartedAt> {
    let days = f64::from_le_bytes(log.body.get(LOG_START..LOG_START + 8)?.try_into().ok()?);
    // The years 1990 to 2100: other numbers are no date.
    let days = (32_874.0..73_051.0).contains(&days).then_some(days)?;
    Some(StartedAt {
        raw: days.to_string(),
        kind: Timestamp::Start,
        local: Some(stamp::from_day_number(days, true)?.to_string()),
        offset: None,
        basis: "days since 1899-12-30 in the log".to_owned(),
    })
}
