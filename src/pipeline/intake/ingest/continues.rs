//! Whether bytes that lie under a name are what lay there before, measured on or mended, or another measurement.
//!
//! A mend changes few lines of a file, and measuring on adds some; of another measurement hardly a line is the same, for
//! readings have their noise. So it is asked of which most lines stand in the other, and lies far from a half either way. A file
//! that was exported anew has other lines and the same readings.

use std::collections::BTreeSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use crate::domain::Channel;
use crate::ingest::archive::{Archive, ArchiveError};
use crate::ingest::same_readings::Record;
use crate::pipeline::{Context, PipelineError};
use crate::store::{Continues, RunContent};

/// Says it of a run of that name that was read from files with these contents; another one, where there is none.
///
/// # Errors
/// The database cannot be read.
pub fn continues(
    context: &Context,
    name: &str,
    contents: &[RunContent],
    channels: &[Channel],
) -> Result<Continues, PipelineError> {
    let before = context.store.contents_of(name)?;
    let Some(run_id) = context.store.id_of_run(name)? else {
        return Ok(Continues::Another);
    };
    let hashes: Vec<&str> = before.iter().map(|(_, hash)| hash.as_str()).collect();
    let shares_file = contents
        .iter()
        .any(|content| hashes.contains(&content.hash.as_str()));
    if shares_file {
        return Ok(Continues::Same);
    }
    let archive = Archive::new(&context.folder);
    // Where the earlier bytes are lost nothing tells them from these, and what was said stays with the name.
    let Some(earlier) = lines(&archive, hashes.iter().copied())? else {
        return Ok(Continues::Same);
    };
    let own = contents.iter().map(|content| content.hash.as_str());
    let is_same = lines(&archive, own)?.is_none_or(|own| share_lines(&earlier, &own))
        || share_readings(&context.store.channels_as_read(run_id)?, channels);
    Ok(if is_same {
        Continues::Same
    } else {
        Continues::Another
    })
}

/// The lines of files of the archive, as hashes; of a file that is not a text what lies between its line feeds. None where
/// the archive has lost one, or holds it damaged.
fn lines<'a>(
    archive: &Archive,
    hashes: impl Iterator<Item = &'a str>,
) -> Result<Option<BTreeSet<u64>>, PipelineError> {
    let mut lines = BTreeSet::new();
    for hash in hashes {
        let bytes = match archive.read(hash) {
            Ok(bytes) => bytes,
            Err(ArchiveError::Absent { .. } | ArchiveError::Damaged { .. }) => return Ok(None),
            Err(error) => return Err(error.into()),
        };
        let of_file = bytes.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
        lines.extend(of_file.filter(|line| !line.is_empty()).map(hashed));
    }
    Ok(Some(lines))
}

fn hashed(line: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    line.hash(&mut hasher);
    hasher.finish()
}

/// Whether most lines of the one with fewer stand in the other.
fn share_lines(one: &BTreeSet<u64>, other: &BTreeSet<u64>) -> bool {
    let fewer = one.len().min(other.len());
    2 * one.intersection(other).count() > fewer
}

/// Whether all readings of one stand in the other.
fn share_readings(one: &[Channel], other: &[Channel]) -> bool {
    let (one, other) = (Record::of(one), Record::of(other));
    one.stands_in(&other) || other.stands_in(&one)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> BTreeSet<u64> {
        text.lines().map(|line| hashed(line.as_bytes())).collect()
    }

    fn table(rows: std::ops::Range<u32>, seed: u32) -> String {
        let row = |k: u32| format!("{}.5,2.0,{}\n", k, (k * 7919 + seed * 104_729) % 99_991);
        format!(
            "time_s,voltage_v,current_a\n{}",
            rows.map(row).collect::<String>()
        )
    }

    #[test]
    fn what_was_measured_on_or_mended_is_the_same_and_a_repeat_is_not() {
        let first = table(0..50, 1);
        for (other, same) in [
            (table(0..500, 1), true),
            (table(0..10, 1), true),
            (first.replacen("current_a", "current_ma", 1), true),
            (first.replacen("3.5,2.0", "3.5,2.1", 1), true),
            (table(0..50, 2), false),
            (table(0..500, 3), false),
            (String::new(), false),
        ] {
            assert_eq!(share_lines(&of(&first), &of(&other)), same, "{other}");
            assert_eq!(share_lines(&of(&other), &of(&first)), same, "{other}");
        }
    }
}
