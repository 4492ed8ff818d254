//! Which runs are fitted together.

use std::collections::BTreeMap;

use crate::analysis::conditions::HUMIDITY_GAP_PERCENT;
use crate::domain::RunRecord;
use crate::domain::tag::keys;
use crate::store::FitTask;

/// Tags that the runs of a group have in common where campaign.toml names none.
pub const DEFAULT_KEYS: [&str; 3] = [keys::SAMPLE, keys::ENVIRONMENT, keys::RELATIVE_HUMIDITY_PERCENT];

/// Runs that are fitted together.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// What they have in common, `sample=CNaf-01,environment=air`; a tag that they all lack is left out.
    pub name: String,
    /// The runs, by name.
    pub tasks: Vec<FitTask>,
}

/// Sorts the runs that can be fitted by the tags `group_by`, or [`DEFAULT_KEYS`].
///
/// Humidity is measured, not set: runs whose humidities lie next to each other, not further apart than the
/// levels of a report, are one group.
pub fn groups(runs: &[RunRecord], tasks: Vec<FitTask>, group_by: &[String]) -> Vec<Group> {
    let group_keys: Vec<&str> = match group_by {
        [] => DEFAULT_KEYS.to_vec(),
        own => own.iter().map(String::as_str).collect(),
    };
    let by_humidity = group_keys.contains(&keys::RELATIVE_HUMIDITY_PERCENT);
    let by_id: BTreeMap<i64, &RunRecord> = runs.iter().map(|run| (run.id, run)).collect();
    let mut sorted: BTreeMap<Vec<Option<String>>, Vec<(Option<f64>, FitTask)>> = BTreeMap::new();
    for task in tasks {
        let Some(run) = by_id.get(&task.run_id) else {
            continue;
        };
        let tags = group_keys.iter().map(|key| match *key {
            keys::RELATIVE_HUMIDITY_PERCENT => None,
            key => run.tag(key).map(str::to_owned),
        });
        let humidity = run
            .tag_number(keys::RELATIVE_HUMIDITY_PERCENT)
            .filter(|_| by_humidity);
        sorted.entry(tags.collect()).or_default().push((humidity, task));
    }
    let mut found = Vec::new();
    for (tags, members) in sorted {
        let named: Vec<String> = group_keys
            .iter()
            .zip(tags)
            .filter_map(|(key, tag)| Some(format!("{key}={}", tag?)))
            .collect();
        for (humidity, tasks) in levels(members) {
            let mut name = named.clone();
            if let Some((low, high)) = humidity {
                let level = if low == high {
                    format!("{low}")
                } else {
                    format!("{low}..{high}")
                };
                name.push(format!("{}={level}", keys::RELATIVE_HUMIDITY_PERCENT));
            }
            found.push(Group {
                name: name.join(","),
                tasks,
            });
        }
    }
    found
}

/// Lowest and highest humidity, and the runs.
type HumidityGroup = (Option<(f64, f64)>, Vec<FitTask>);

/// Runs of one kind by level of humidity; those without one stand by themselves, first.
fn levels(mut members: Vec<(Option<f64>, FitTask)>) -> Vec<HumidityGroup> {
    members.sort_by(|(a, one), (b, other)| {
        let by_humidity = a
            .unwrap_or(f64::NEG_INFINITY)
            .total_cmp(&b.unwrap_or(f64::NEG_INFINITY));
        by_humidity.then_with(|| one.path.cmp(&other.path))
    });
    let mut found: Vec<HumidityGroup> = Vec::new();
    for (humidity, task) in members {
        match (found.last_mut(), humidity) {
            (Some((None, tasks)), None) => tasks.push(task),
            (Some((Some((_, high)), tasks)), Some(own)) if own - *high <= HUMIDITY_GAP_PERCENT => {
                *high = own;
                tasks.push(task);
            }
            _ => found.push((humidity.map(|own| (own, own)), vec![task])),
        }
    }
    for (_, tasks) in &mut found {
        tasks.sort_by(|a, b| a.path.cmp(&b.path));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Drive;

    fn member(path: &str, humidity: Option<f64>) -> (Option<f64>, FitTask) {
        let task = FitTask {
            run_id: 0,
            path: path.to_owned(),
            drive: Drive::step(1.0),
            area_cm2: 0.1,
            length_cm: None,
            electrode_resistance_ohm_per_sq: None,
            data_hash: String::new(),
            done_input_hash: None,
        };
        (humidity, task)
    }

    #[test]
    fn humidities_next_to_each_other_are_one_level() {
        let members = vec![
            member("e", Some(60.0)),
            member("a", Some(36.5)),
            member("b", None),
            member("c", Some(28.0)),
            member("d", Some(32.0)),
        ];
        let found = levels(members);
        let names = |index: usize| -> Vec<&str> {
            let tasks: &Vec<FitTask> = &found[index].1;
            tasks.iter().map(|task| task.path.as_str()).collect()
        };
        assert_eq!(found.len(), 3);
        assert_eq!((found[0].0, names(0)), (None, vec!["b"]));
        assert_eq!((found[1].0, names(1)), (Some((28.0, 36.5)), vec!["a", "c", "d"]));
        assert_eq!((found[2].0, names(2)), (Some((60.0, 60.0)), vec!["e"]));
    }
}
