//! The archive: the bytes of every raw file against the hash that it is named by.

use crate::domain::words::counted;
use std::collections::BTreeSet;
use std::path::Path;

use super::part::Part;
use crate::domain::Issue;
use crate::ingest::archive::{Archive, Archived, BlobFinding};
use crate::pipeline::infra::mends::Reasoned;
use crate::pipeline::{Context, Observer, PipelineError};
use crate::store::RunContent;

/// Name of the part.
const NAME: &str = "archive";

/// Reads every raw file that the database names, and every other that lies there.
///
/// # Errors
/// The archive or the database cannot be read.
pub fn part(context: &Context, observer: &dyn Observer) -> Result<Part, PipelineError> {
    let archive = Archive::new(&context.folder);
    // A database whose rows are damaged may not say which there should be.
    let Ok(contents) = context.store.contents() else {
        return alone(&context.folder);
    };
    let wanted = wanted(&contents);
    let named: BTreeSet<&str> = wanted.iter().map(|wanted| wanted.hash.as_str()).collect();
    let mut beside = archive.entries()?;
    beside.retain(|entry| !named.contains(entry.hash.as_str()));
    observer.begin("checking raw files", 2);
    let mut findings: Vec<Issue> = archive
        .verify(&wanted)?
        .iter()
        .map(|found| found.issue())
        .collect();
    observer.advance();
    findings.extend(archive.verify(&beside)?.iter().map(|found| found.issue()));
    observer.end();
    findings.extend(beside.iter().map(|entry| {
        Issue::note("raw-file-of-no-run", "no run or log of the database is of it")
            .at(&entry.path)
            .mend("nothing needs to be done: a reading that was cut short leaves such files")
    }));
    let looked_at = format!(
        "hashes of {} of runs and logs, and of {} beside them",
        counted(wanted.len(), "raw file"),
        counted(beside.len(), "file")
    );
    Ok(Part {
        part: NAME,
        looked_at,
        findings,
    })
}

/// What the archive must hold of what a database names.
pub fn wanted(contents: &[RunContent]) -> Vec<Archived> {
    let of = |content: &RunContent| Archived {
        hash: content.hash.clone(),
        path: content.archive_path.clone(),
        size_bytes: content.size_bytes,
    };
    contents.iter().map(of).collect()
}

/// The same where no database says which files there should be.
///
/// # Errors
/// The archive cannot be read.
pub fn alone(folder: &Path) -> Result<Part, PipelineError> {
    let archive = Archive::new(folder);
    let there = archive.entries()?;
    Ok(Part {
        part: NAME,
        looked_at: format!("hashes of {}", counted(there.len(), "raw file")),
        findings: archive
            .verify(&there)?
            .iter()
            .map(|found| found.issue())
            .collect(),
    })
}

/// Raw files that the archive lacks, by names and sizes.
///
/// # Errors
/// The database or the archive cannot be read.
pub fn raw_files_lost(context: &Context) -> Result<Vec<Reasoned>, PipelineError> {
    let contents = context.store.contents()?;
    let path_of = |hash: &str| {
        let at = contents.binary_search_by(|content| content.hash.as_str().cmp(hash));
        at.map_or_else(|_| String::new(), |at| contents[at].path.clone())
    };
    let lost = Archive::new(&context.folder).missing(&wanted(&contents))?;
    let reasoned = |finding: BlobFinding| Reasoned {
        path: path_of(&finding.wanted.hash),
        issues: vec![finding.issue()],
    };
    Ok(lost.into_iter().map(reasoned).collect())
}
