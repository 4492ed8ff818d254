//! Tags that differ between the runs of a group, as a diagnosis asks for them.

use crate::domain::tag::keys;
use crate::domain::{InputHash, RunRecord};
use crate::model::effects::{TagAt, tag_places};

/// Where each run lies among the values of the tags that campaign.toml declares, and of who measured.
pub(crate) fn group_tags(runs: &[&RunRecord], declared: &[String]) -> Vec<Vec<TagAt>> {
    let mut asked: Vec<&str> = declared.iter().map(String::as_str).collect();
    asked.push(keys::OPERATOR);
    asked.sort_unstable();
    asked.dedup();
    let mut places = vec![Vec::new(); runs.len()];
    for key in asked {
        let values: Vec<Option<&str>> = runs.iter().map(|run| run.tag(key)).collect();
        for (places, own) in places.iter_mut().zip(tag_places(key, &values)) {
            places.extend(own);
        }
    }
    places
}

/// Adds to a hash what a group's result follows from these tags; nothing where none differs.
pub(crate) fn take_tags(hash: &mut InputHash, places: &[Vec<TagAt>]) {
    for place in places.iter().flatten() {
        hash.text(place.id).number(place.at);
    }
}
