//! Readings as a diagnosis takes them, a batch of groups at a time.

use super::subject::Subject;
use crate::diagnose::RunInput;
use crate::domain::{Channel, GroupDiagnosis};
use crate::fit::FitInput;
use crate::ingest::derived;
use crate::store::FitTask;

/// Subjects diagnosed between two commits: bounds memory, and what an interruption costs.
pub(super) const BATCH: usize = 8;

/// Calls `then` with the runs as a diagnosis takes them; `channels` are theirs as they are stored.
pub(super) fn with_inputs<R>(
    subject: &Subject,
    tasks: &[FitTask],
    channels: &[Vec<Channel>],
    then: impl FnOnce(&[RunInput]) -> R,
) -> R {
    let members = &subject.members;
    let responses: Vec<Vec<Channel>> = members
        .iter()
        .zip(channels)
        .map(|(&index, channels)| {
            derived::responses(channels, tasks[index].length_cm, Some(&tasks[index].drive))
        })
        .collect();
    let inputs: Vec<RunInput> = members
        .iter()
        .zip(&responses)
        .zip(&subject.tags)
        .map(|((&index, channels), tags)| RunInput {
            name: &tasks[index].path,
            input: FitInput {
                channels,
                drive: &tasks[index].drive,
                area_cm2: tasks[index].area_cm2,
            },
            length_cm: tasks[index].length_cm,
            is_right: subject.right.contains(&index),
            tags,
        })
        .collect();
    then(&inputs)
}

/// The runs that a finding is about.
pub(super) fn not_condemned<'a>(inputs: &[RunInput<'a>], found: &GroupDiagnosis) -> Vec<RunInput<'a>> {
    let is_condemned = |input: &&RunInput| found.condemned.iter().any(|odd| odd.run == input.name);
    inputs
        .iter()
        .filter(|input| !is_condemned(input))
        .copied()
        .collect()
}
