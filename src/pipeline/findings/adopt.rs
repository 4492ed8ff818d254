//! Adopts the extended models that diagnoses found: their groups are fitted with them from then on.
//!
//! What is adopted stands in campaign.toml, at its end, where a person can read it and take it back: a database can be
//! made anew from the files, and must come out the same.

use std::fmt::Write as _;

use crate::analysis::groups::is_called;
use crate::domain::campaign::Adopted;
use crate::domain::{GroupDiagnosis, Verdict};
use crate::ingest::campaign_file::FILE_NAME;
use crate::pipeline::findings::current::current_findings;
use crate::pipeline::infra::whole_file::put_stated;
use crate::pipeline::{Context, PipelineError, failed};
use crate::system::fs;

/// The verb `diagnose --adopt`.
#[derive(Debug, Clone, Default)]
pub struct Adopt {
    /// Only the group of that name; none for every group whose finding names a cause.
    pub group: Option<String>,
}

/// What was adopted.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct AdoptSummary {
    /// Groups with their new model.
    pub adopted: Vec<Adopted>,
    /// Groups whose adopted model is what the finding asks for already.
    pub unchanged: Vec<String>,
    /// Groups whose finding names no cause.
    pub without_cause: Vec<String>,
}

impl Adopt {
    /// Writes what is adopted to the end of campaign.toml and reads it again.
    ///
    /// # Errors
    /// The group named has no finding or none that names a cause; the file or the database cannot be read or written.
    pub fn run(&self, context: &mut Context) -> Result<AdoptSummary, PipelineError> {
        let findings = current_findings(context)?.groups;
        let asked = |found: &&GroupDiagnosis| {
            self.group
                .as_ref()
                .is_none_or(|name| is_called(&found.group, name))
        };
        let mut summary = AdoptSummary::default();
        for found in findings.iter().filter(asked) {
            match wanted(found) {
                None => summary.without_cause.push(found.group.clone()),
                Some(wanted) if current(context, &found.group) == Some(wanted.model.as_str()) => {
                    summary.unchanged.push(found.group.clone());
                }
                Some(wanted) => summary.adopted.push(wanted),
            }
        }
        if let (Some(name), true) = (
            &self.group,
            summary.adopted.is_empty() && summary.unchanged.is_empty(),
        ) {
            return Err(PipelineError::BadArgument {
                what: "--adopt with --group",
                found: name.clone(),
                needed: "a group whose finding tells what is missing (verdict law)".to_owned(),
            });
        }
        if !summary.adopted.is_empty() {
            append(context, &summary.adopted)?;
            context.reload()?;
        }
        Ok(summary)
    }
}

/// The model that a finding asks for: its base with the laws that are told. Of a place alone no law is told, and none is adopted.
fn wanted(found: &GroupDiagnosis) -> Option<Adopted> {
    let are_told = found.missing.iter().all(|law| law.law.is_some());
    let is_extended = found.verdict == Verdict::Law && are_told && !found.effects.is_empty();
    is_extended.then(|| Adopted {
        group: found.group.clone(),
        model: found
            .effects
            .iter()
            .fold(found.base_model.clone(), |model, effect| {
                format!("{model} + {}", effect.effect)
            }),
    })
}

/// The model adopted for the group, if any.
fn current<'a>(context: &'a Context, group: &str) -> Option<&'a str> {
    let of_group = context
        .campaign
        .adopted
        .iter()
        .rev()
        .find(|entry| entry.group == group);
    of_group.map(|entry| entry.model.as_str())
}

/// Adds entries at the end of campaign.toml; the file is exchanged whole.
fn append(context: &Context, adopted: &[Adopted]) -> Result<(), PipelineError> {
    let path = context.folder.join(FILE_NAME);
    let mut text = fs::read_stated_text(&context.folder, &path).map_err(failed(&path, "reading"))?;
    if !text.ends_with('\n') {
        text.push('\n');
    }
    for entry in adopted {
        let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
        let (group, model) = (quoted(&entry.group), quoted(&entry.model));
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "\n# Adopted from the group's finding. Take the entry away to fit the group with the campaign's model again.\n\
             [[adopted]]\ngroup = {group}\nmodel = {model}\n"
        );
    }
    put_stated(&path, text.as_bytes())
}
