//! Tags that differ between the runs of a group, and in how many orders their values can be dealt to the runs.

use ieap_domain::number::fixed;
use ieap_model::effects::{Effect, effect};

use crate::readings::group::RunGroup;
use crate::readings::policy::FEWEST_ORDERS;

/// A tag that differs between the runs of a group: id of its effect, and place of every run.
pub(crate) struct Tag {
    pub(crate) id: &'static str,
    pub(crate) at: Vec<f64>,
}

impl Tag {
    /// Whether its values can be dealt to the runs in so many orders that chance can be told from an answer.
    pub(crate) fn can_be_told(&self) -> bool {
        orders(&self.at) >= FEWEST_ORDERS
    }
}

/// Effects that follow a tag whose order among the runs can be told from chance.
pub(crate) fn asked(group: &RunGroup) -> Vec<&'static dyn Effect> {
    let tags = tags(group).into_iter().filter(Tag::can_be_told);
    tags.filter_map(|tag| effect(tag.id)).collect()
}

/// What is said of tags that differ in too few runs to be asked.
pub(crate) fn not_asked(group: &RunGroup) -> Vec<String> {
    let few = tags(group).into_iter().filter(|tag| !tag.can_be_told());
    few.filter_map(|tag| {
        let about = effect(tag.id)?.about();
        Some(format!(
            "{} is not asked for: its values can be dealt to {} runs in {} orders, and a finding needs {}",
            about.summary,
            tag.at.len(),
            fixed(orders(&tag.at), 0),
            fixed(FEWEST_ORDERS, 0)
        ))
    })
    .collect()
}

/// Tags whose values are not the same in all runs.
pub(crate) fn tags(group: &RunGroup) -> Vec<Tag> {
    let Some(first) = group.runs.first() else {
        return Vec::new();
    };
    let of = |(k, tag): (usize, &ieap_model::effects::TagAt)| {
        let at = group
            .runs
            .iter()
            .map(|run| run.given.tags.get(k).map_or(0.0, |tag| tag.at));
        Tag {
            id: tag.id,
            at: at.collect(),
        }
    };
    let differs = |tag: &Tag| tag.at.iter().any(|x| *x != tag.at[0]);
    first
        .given
        .tags
        .iter()
        .enumerate()
        .map(of)
        .filter(differs)
        .collect()
}

/// Number of different orders of these values.
fn orders(at: &[f64]) -> f64 {
    let mut sorted = at.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut orders = 1.0;
    let mut alike = 0.0;
    for (k, value) in sorted.iter().enumerate() {
        alike = if k > 0 && *value == sorted[k - 1] {
            alike + 1.0
        } else {
            1.0
        };
        orders *= (k + 1) as f64 / alike;
    }
    orders
}

#[cfg(test)]
mod tests {
    use super::orders;

    #[test]
    fn values_have_as_many_orders_as_are_different() {
        assert_eq!(orders(&[1.0, 2.0, 3.0, 4.0]), 24.0);
        assert!((orders(&[0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0]) - 70.0).abs() < 1e-9);
        assert_eq!(orders(&[3.0, 3.0]), 1.0);
    }
}
