//! The tags of a run, by what states them.

use serde::Serialize;

use ieap_analysis::zone::Zone;
use ieap_domain::tag::{keys, spoken};
use ieap_domain::{RunRecord, TagSource};

/// Where a sidecar lies, whose name is the file's with `.toml`.
const BESIDE: &str = "beside the file";

/// A tag in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TagText {
    source: TagSource,
    detail: String,
    /// Whether a stronger source overruled it.
    overruled: bool,
    key: String,
    value: String,
}

/// Tags that one source states.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub struct TagGroup {
    origin: &'static str,
    detail: String,
    /// Whether stronger sources overruled them.
    overruled: bool,
    /// Keys as they are said, with their values.
    tags: Vec<(String, String)>,
}

/// The tags in stored order, moments by the clock of `zone`; after the first of a key, others are overruled, and left out where they say the same.
pub fn tags(record: &RunRecord, zone: &Zone) -> Vec<TagText> {
    let mut texts: Vec<TagText> = Vec::new();
    for (index, tag) in record.tags.iter().enumerate() {
        let ruling = record.tags[..index].iter().find(|earlier| earlier.key == tag.key);
        if ruling.is_none_or(|ruling| ruling.value != tag.value) {
            texts.push(TagText {
                source: tag.source,
                detail: match tag.detail.strip_prefix(record.path.as_str()) {
                    Some(".toml") => BESIDE.to_owned(),
                    _ => by_clock(&tag.detail, zone),
                },
                overruled: ruling.is_some(),
                key: tag.key.clone(),
                value: match tag.key.as_str() {
                    keys::STARTED_AT => zone.moment(&tag.value),
                    _ => tag.value.clone(),
                },
            });
        }
    }
    texts
}

/// Who set a tag by hand, and when: the moment at the end of it, as in `vk, 2026-11-20T06:00:00Z`, by the clock of `zone`.
fn by_clock(detail: &str, zone: &Zone) -> String {
    match detail.rsplit_once(", ") {
        Some((who, moment)) => format!("{who}, {}", zone.moment(moment)),
        None => detail.to_owned(),
    }
}

/// Takes out of the tags of every run what the same kind of source states for all of them. Where it does so in another
/// place for each, as sidecars do, the place is that of each run.
pub fn take_common(runs: &mut [Vec<TagText>]) -> Vec<TagText> {
    let Some((first, others)) = runs.split_first() else {
        return Vec::new();
    };
    let alike = |a: &TagText, b: &TagText| {
        (a.source, a.overruled, &a.key, &a.value) == (b.source, b.overruled, &b.key, &b.value)
    };
    let common = first.iter().filter_map(|tag| {
        let mut same: Vec<&TagText> = Vec::new();
        for other in others {
            same.push(other.iter().find(|other| alike(tag, other))?);
        }
        let one_place = same.iter().all(|other| other.detail == tag.detail);
        Some(TagText {
            detail: if one_place {
                tag.detail.clone()
            } else {
                "of each run".to_owned()
            },
            ..tag.clone()
        })
    });
    let common: Vec<TagText> = common.collect();
    for tags in runs {
        tags.retain(|tag| !common.iter().any(|shared| alike(shared, tag)));
    }
    common
}

/// The tags by source, what was overruled last.
pub fn grouped(tags: Vec<TagText>) -> Vec<TagGroup> {
    let mut groups: Vec<TagGroup> = Vec::new();
    for tag in tags {
        let origin = tag.source.label();
        let alike = |group: &&mut TagGroup| {
            (group.origin, group.detail.as_str(), group.overruled)
                == (origin, tag.detail.as_str(), tag.overruled)
        };
        let pair = match spoken(&tag.key) {
            (words, "") => (words, tag.value),
            (words, unit) => (words, format!("{}\u{a0}{unit}", tag.value)),
        };
        match groups.iter_mut().find(alike) {
            Some(group) => group.tags.push(pair),
            None => groups.push(TagGroup {
                origin,
                detail: tag.detail,
                overruled: tag.overruled,
                tags: vec![pair],
            }),
        }
    }
    groups.sort_by_key(|group| group.overruled);
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(key: &str, value: &str, detail: &str) -> TagText {
        TagText {
            source: TagSource::Sidecar,
            detail: detail.to_owned(),
            overruled: false,
            key: key.to_owned(),
            value: value.to_owned(),
        }
    }

    #[test]
    fn who_set_a_tag_by_hand_is_shown_with_the_moment_by_the_clock_of_the_page() {
        let zone = Zone::utc();
        assert_eq!(
            by_clock("vk, 2026-11-20T06:00:00Z", &zone),
            "vk, 20 Nov 2026, 06:00 UTC"
        );
        assert_eq!(by_clock("a, b.toml", &zone), "a, b.toml");
    }

    #[test]
    fn what_all_runs_state_is_taken_out_and_the_rest_stays() {
        let mut runs = vec![
            vec![text("sample", "S", "a.toml"), text("cycle", "1", "a.toml")],
            vec![text("cycle", "2", "b.toml"), text("sample", "S", "b.toml")],
        ];
        assert_eq!(take_common(&mut runs), [text("sample", "S", "of each run")]);
        assert_eq!(runs[0], [text("cycle", "1", "a.toml")]);
        assert_eq!(runs[1], [text("cycle", "2", "b.toml")]);
    }

    #[test]
    fn tags_of_one_source_stand_together() {
        let groups = grouped(vec![
            text("sample", "S", "a"),
            text("note", "n", "b"),
            text("cycle", "1", "a"),
        ]);
        assert_eq!(groups.len(), 2);
        assert_eq!(groups[0].tags.len(), 2);
    }
}
