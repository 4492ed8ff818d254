//! Every file of a campaign and what became of it, as a table.

use ieap_domain::file_story::FileStory;
use ieap_domain::tag::said;
use ieap_domain::words::counted;
use ieap_show::quantities::Quantity;
use ieap_show::{Block, Sheet, Table};
use std::collections::BTreeMap;

/// One row a file.
pub fn table(files: &[FileStory]) -> Table {
    let words = |file: &&FileStory| {
        let words = file
            .words
            .iter()
            .map(|word| format!("{}: {}", word.word, word.taken_for));
        words.collect::<Vec<_>>().join("; ")
    };
    // The tags of one source together.
    let tags = |file: &&FileStory| {
        let mut told: Vec<(&str, Vec<String>)> = Vec::new();
        for tag in &file.tags {
            let text = said(&tag.key, &tag.value);
            let stem = tag.from.strip_suffix(".toml");
            let from = match stem {
                Some(stem) if stem.ends_with(file.path.as_str()) => "its sidecar",
                _ => &tag.from,
            };
            match told.iter_mut().find(|(known, _)| *known == from) {
                Some((_, tags)) => tags.push(text),
                None => told.push((from, vec![text])),
            }
        }
        let told = told
            .iter()
            .map(|(from, tags)| format!("{} ({from})", tags.join(", ")));
        told.collect::<Vec<_>>().join("; ")
    };
    let why = |file: &&FileStory| {
        let why = file.why.iter().map(|issue| match issue.mend.as_str() {
            "" => issue.message.clone(),
            mend => format!("{}. {mend}", issue.message),
        });
        why.collect::<Vec<_>>().join("; ")
    };
    Sheet::<&FileStory>::new("files", "Every file, and what became of it", 1)
        .column(
            Quantity::plain("file", "File", "the file, relative to the campaign"),
            |file| file.path.clone(),
        )
        .column(
            Quantity::plain("became", "Became", "what it was taken for"),
            |file| file.became.clone(),
        )
        .column(
            Quantity::plain(
                "partner",
                "Partner",
                "the other file of the run, or the one that it waits for",
            ),
            |file| file.partner.clone(),
        )
        .column(
            Quantity::plain("read_by", "Read by", "the format or profile that read it"),
            |file| file.read_by.clone(),
        )
        .column(
            Quantity::plain(
                "words",
                "Words of its name",
                "what each word of the name was taken for",
            ),
            words,
        )
        .column(
            Quantity::plain("tags", "Tags", "the tags of its run, each with its source"),
            tags,
        )
        .column(
            Quantity::plain(
                "why",
                "To know",
                "why nothing, or not everything, is made of it, and what to do",
            ),
            why,
        )
        .over(files.iter())
}

/// What is shown: counts first, then the table.
pub fn view(files: &[FileStory]) -> Vec<Block> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for file in files {
        *counts.entry(&file.became).or_insert(0) += 1;
    }
    let told: Vec<String> = counts
        .iter()
        .map(|(became, count)| format!("{count} {became}"))
        .collect();
    let say = format!("{}: {}.", counted(files.len(), "file"), told.join(", "));
    vec![Block::say(say), Block::Table(table(files))]
}
