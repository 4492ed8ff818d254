//! What runs wait for, each mend once with all runs that need it.

use std::path::Path;

use super::places::BEYOND_STRIP;
use super::tagging::NO_AREA;
use super::unread::RESPONSE_MISSING;
use crate::domain::{RunKind, Severity};
use crate::ingest::name_pattern::{self, NoSurroundings, ProposedPattern};
use crate::ingest::tags::{self, MISSING, MISSPELT, UNDECLARED, UNKNOWN_SAMPLE};
use crate::pipeline::infra::mends::{Together, together};
use crate::pipeline::{Context, PipelineError};

/// Tag keys that are neither known nor declared, each with the runs that have it.
///
/// # Errors
/// The database cannot be read.
pub fn undeclared_tags(context: &Context) -> Result<Vec<Together>, PipelineError> {
    let mut found = context.store.issues_of_code(MISSPELT)?;
    found.extend(context.store.issues_of_code(UNDECLARED)?);
    let entries = found
        .iter()
        .map(|(path, issue)| (path.as_str(), vec![issue.clone()]));
    Ok(together(entries))
}

/// Columns of runs that are probably a response and are not used, each with the runs that have it.
///
/// # Errors
/// The database cannot be read.
pub fn unused_columns(context: &Context) -> Result<Vec<Together>, PipelineError> {
    let found = context.store.issues_of_code(RESPONSE_MISSING)?;
    let entries = found
        .iter()
        .map(|(path, issue)| (path.as_str(), vec![issue.clone()]));
    Ok(together(entries))
}

/// What runs wait for before they can be fitted, each mend with all runs that need it: tags, samples, their sizes.
///
/// # Errors
/// The database cannot be read.
pub fn waiting_for(context: &Context) -> Result<Vec<Together>, PipelineError> {
    let mut found = Vec::new();
    for code in [MISSING, UNKNOWN_SAMPLE, NO_AREA, BEYOND_STRIP] {
        found.extend(context.store.issues_of_code(code)?);
    }
    found.retain(|(_, issue)| issue.severity == Severity::Error);
    let entries = found
        .iter()
        .map(|(path, issue)| (path.as_str(), vec![issue.clone()]));
    Ok(together(entries))
}

/// The name pattern that would tag the most of these runs, where it tags two or more and is not the campaign's.
pub fn proposed_pattern<'a>(
    context: &Context,
    untagged: impl Iterator<Item = &'a str>,
) -> Option<ProposedPattern> {
    let runs = untagged.filter(|path| context.campaign.kind_of(path) == RunKind::Actuation);
    let stems: Vec<String> = runs.map(|path| tags::stem(Path::new(path))).collect();
    let stems: Vec<&str> = stems.iter().map(String::as_str).collect();
    let none = NoSurroundings::among(stems.iter().copied());
    let found = name_pattern::propose(&stems, &none)?;
    let is_new = context.campaign.name_pattern.as_ref() != Some(&found.pattern);
    (found.explains >= 2 && is_new).then_some(found)
}
