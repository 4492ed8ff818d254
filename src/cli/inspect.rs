//! `ieap inspect`.

use std::path::PathBuf;

use clap::Args;

use super::exit::{CliError, DONE, SOME_REFUSED};
use super::output::Output;
use crate::pipeline::standalone::inspect::{Inspection, inspect};

/// Show what is read of a file, without storing it
#[derive(Debug, Args)]
pub struct InspectArgs {
    /// The file
    #[arg(value_name = "FILE")]
    file: PathBuf,
}

pub fn run(args: &InspectArgs, output: &Output) -> Result<u8, CliError> {
    let inspection = inspect(&args.file).map_err(|error| CliError::usage(&error.to_string()))?;
    print(&inspection, output);
    output.document(&inspection)?;
    Ok(if inspection.format.is_some() {
        DONE
    } else {
        SOME_REFUSED
    })
}

/// Prints what was seen, for people.
pub fn print(inspection: &Inspection, output: &Output) {
    let format = inspection.format.as_deref().unwrap_or("no format");
    output.result(&format!("{}: {format}, {}", inspection.file, inspection.status));
    if inspection.format.is_some() {
        output.result(&format!("  status: {}", inspection.status_evidence));
    }
    if let Some(profile) = &inspection.profile {
        output.result(&format!(
            "  profile: {} version {} ({})",
            profile.id,
            profile.version,
            &profile.digest[..12]
        ));
    }
    for candidate in &inspection.candidates {
        output.result(&format!(
            "  candidate: {} ({}) {}",
            candidate.id, candidate.score, candidate.reason
        ));
    }
    let facts = [
        ("technique", &inspection.technique),
        ("encoding", &inspection.encoding),
    ];
    for (name, fact) in facts {
        fact.iter()
            .for_each(|fact| output.result(&format!("  {name}: {fact}")));
    }
    if let Some(started) = &inspection.started_at {
        let local = started.local.as_deref().unwrap_or("not certain");
        let zone = started.offset.as_deref().unwrap_or(", no zone stated");
        output.result(&format!(
            "  date: {} -> {} {local}{zone} ({})",
            started.raw,
            started.kind.key(),
            started.basis
        ));
    }
    for (key, value, origin) in &inspection.header_tags {
        output.result(&format!("  tag {key} = {value} (from {origin})"));
    }
    for table in &inspection.runs {
        output.result(&format!("  table {} with {} rows", table.name, table.rows));
        if let Some(printed) = &table.printed_time {
            output.result(&format!("    the time is rebuilt; {printed} holds it as printed"));
        }
        for flag in &table.flags {
            let effect = if flag.excludes { "left out of fits" } else { "kept" };
            output.result(&format!(
                "    {} {} from {} s to {} s: {} readings, {effect}",
                flag.column, flag.flag, flag.from_s, flag.to_s, flag.readings
            ));
        }
        for column in &table.columns {
            let canonical = column.canonical.unwrap_or("kept under its own name");
            let ends = match (column.first, column.last, column.smallest, column.largest) {
                (Some(first), Some(last), Some(smallest), Some(largest)) => {
                    format!("first {first}, last {last}; between {smallest} and {largest}")
                }
                _ => "no reading".to_owned(),
            };
            let excluded = if column.excluded > 0 {
                format!(", {} left out", column.excluded)
            } else {
                String::new()
            };
            output.result(&format!(
                "    {} [{}] -> {canonical}: {} readings{excluded}, {ends}",
                column.name, column.unit, column.readings
            ));
        }
    }
    if let Some(stored) = &inspection.stored {
        let fitted = stored
            .model
            .as_deref()
            .map_or("not fitted".to_owned(), |model| format!("fitted with {model}"));
        output.result(&format!("  stored as the run {}, {fitted}", stored.run));
        if let Some(aside) = &stored.set_aside {
            output.result(&format!("  set aside, in no result: {}", aside.reason));
        }
        if let Some(told) = &stored.lumped_or_distributed {
            output.result(&format!("  lumped or distributed: {}", told.sentence));
            told.mend
                .iter()
                .for_each(|mend| output.result(&format!("    -> {mend}")));
        }
    }
    for issue in &inspection.issues {
        let place = if issue.place.is_empty() {
            String::new()
        } else {
            format!("{}: ", issue.place)
        };
        output.result(&format!("  {}: {place}{}", issue.severity.key(), issue.message));
        if !issue.mend.is_empty() {
            output.result(&format!("    -> {}", issue.mend));
        }
    }
}
