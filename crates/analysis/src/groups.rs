//! Runs that are diagnosed together: one sample in one environment and humidity, or as `group_by` says.

use std::collections::BTreeMap;

use super::sequence;
use ieap_domain::number::digits;
use ieap_domain::tag::keys;
use ieap_domain::{Issue, RunRecord};

/// Humidities this far above the lowest of a group (percentage points) are still the same humidity: sensors are
/// good to about 2 %. The levels of the tables are wider, but a parameter that follows humidity would move within
/// them by more than its uncertainty.
pub const HUMIDITY_TOLERANCE_PERCENT: f64 = 4.0;

/// What runs are grouped by where campaign.toml does not say.
const DEFAULT_KEYS: [&str; 3] = [keys::SAMPLE, keys::ENVIRONMENT, keys::RELATIVE_HUMIDITY_PERCENT];

/// Runs that are diagnosed together.
#[derive(Debug, Clone, PartialEq)]
pub struct RunGroup {
    /// Its shared tags, `sample=CNaf-01,environment=air`; the humidity stands there where the sample was measured
    /// at more than one in that environment.
    pub name: String,
    /// Indices of its runs, in the order of the runs; never empty.
    pub runs: Vec<usize>,
    /// Why they are set apart, where they are.
    pub set_apart: Option<Issue>,
}

/// Sorts runs into groups, in the order of the groups' names. Runs that carry on the numbers of a series but not
/// its dates are groups of their own. `among` tells which runs take part.
pub fn groups(runs: &[RunRecord], group_by: &[String], among: &dyn Fn(&RunRecord) -> bool) -> Vec<RunGroup> {
    let apart = set_apart(runs);
    let keys: Vec<&str> = match group_by {
        [] => DEFAULT_KEYS.to_vec(),
        stated => stated.iter().map(String::as_str).collect(),
    };
    let by_humidity = keys.contains(&keys::RELATIVE_HUMIDITY_PERCENT);
    let mut alike: BTreeMap<(String, Option<usize>), Vec<usize>> = BTreeMap::new();
    for (index, run) in runs.iter().enumerate().filter(|(_, run)| among(run)) {
        let broken = apart.get(&index).map(|(number, _)| *number);
        alike
            .entry((shared_tags(run, &keys), broken))
            .or_default()
            .push(index);
    }
    let mut found = Vec::new();
    for ((name, _), members) in alike {
        let issue = apart.get(&members[0]).map(|(_, issue)| issue.clone());
        let name = match issue {
            Some(_) => format!("{name},{}={}", keys::STARTED_AT, date(&runs[members[0]])),
            None => name,
        };
        if by_humidity {
            found.extend(by_level(runs, &name, members, issue.as_ref()));
        } else {
            found.push(RunGroup {
                name,
                runs: members,
                set_apart: issue,
            });
        }
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    found
}

/// Runs of broken series that no person said are right, with the number of the break and what to say of it.
fn set_apart(runs: &[RunRecord]) -> BTreeMap<usize, (usize, Issue)> {
    let mut apart = BTreeMap::new();
    for (number, found) in sequence::breaks(runs).iter().enumerate() {
        let issue = found.issue(runs);
        let doubted = found
            .runs
            .iter()
            .filter(|&&index| !runs[index].standing.is_vouched());
        for &index in doubted {
            apart.insert(index, (number, issue.clone()));
        }
    }
    apart
}

/// Values of all keys but the humidity; one that the run lacks is left out.
fn shared_tags(run: &RunRecord, keys: &[&str]) -> String {
    let stated = keys.iter().filter(|key| **key != keys::RELATIVE_HUMIDITY_PERCENT);
    let pairs: Vec<String> = stated
        .filter_map(|key| Some(format!("{key}={}", run.tag(key)?)))
        .collect();
    pairs.join(",")
}

fn date(run: &RunRecord) -> &str {
    let start = run.tag(keys::STARTED_AT).unwrap_or_default();
    start.split('T').next().unwrap_or_default()
}

/// One group for each humidity; runs without one are a group of their own.
fn by_level(runs: &[RunRecord], name: &str, members: Vec<usize>, issue: Option<&Issue>) -> Vec<RunGroup> {
    let humidity = |index: usize| runs[index].tag_number(keys::RELATIVE_HUMIDITY_PERCENT);
    let (mut stated, unstated): (Vec<usize>, Vec<usize>) =
        members.into_iter().partition(|&index| humidity(index).is_some());
    stated.sort_by(|&a, &b| {
        let order = humidity(a).unwrap_or(0.0).total_cmp(&humidity(b).unwrap_or(0.0));
        order.then(a.cmp(&b))
    });
    let mut levels: Vec<(Option<f64>, Vec<usize>)> = Vec::new();
    for index in stated {
        let percent = humidity(index).unwrap_or(0.0);
        match levels.last_mut() {
            Some((Some(lowest), level)) if percent - *lowest <= HUMIDITY_TOLERANCE_PERCENT => {
                level.push(index)
            }
            _ => levels.push((Some(percent), vec![index])),
        }
    }
    if !unstated.is_empty() {
        levels.push((None, unstated));
    }
    let alone = levels.len() == 1;
    let group = |(_, mut level): (Option<f64>, Vec<usize>)| {
        level.sort_unstable();
        let percents: Vec<f64> = level.iter().filter_map(|&index| humidity(index)).collect();
        let name = match percents.len() {
            _ if alone => name.to_owned(),
            0 => format!("{name},{}=unknown", keys::RELATIVE_HUMIDITY_PERCENT),
            count => {
                let mean = percents.iter().sum::<f64>() / count as f64;
                format!("{name},{}={}", keys::RELATIVE_HUMIDITY_PERCENT, digits(mean, 1))
            }
        };
        RunGroup {
            name,
            runs: level,
            set_apart: issue.cloned(),
        }
    };
    levels.into_iter().map(group).collect()
}

/// `CNaf-1 in air, 33 % RH` of a group's name, `sample=CNaf-1,environment=air,relative_humidity_percent=33`.
pub fn title(name: &str) -> String {
    let (mut title, mut rest) = (String::new(), Vec::new());
    for part in name.split(',') {
        match part.split_once('=') {
            Some(("sample", sample)) => title = sample.to_owned(),
            Some(("environment", environment)) => title += &format!(" in {environment}"),
            Some(("relative_humidity_percent", percent)) => rest.push(format!("{percent} % RH")),
            Some((key, value)) => rest.push(format!("{} {value}", key.replace('_', " "))),
            None => rest.push(part.to_owned()),
        }
    }
    if title.is_empty() {
        return rest.join(", ");
    }
    rest.insert(0, title.trim_start().to_owned());
    rest.join(", ")
}

/// Whether a person means that group: by its name, or by its title as it is printed.
pub fn is_called(name: &str, asked: &str) -> bool {
    asked == name || asked == title(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{run, tag};

    #[test]
    fn a_group_is_named_as_one_says_it() {
        let said = title;
        assert_eq!(said("sample=CNaf-1,environment=air"), "CNaf-1 in air");
        assert_eq!(
            said("sample=S,environment=air,relative_humidity_percent=35.2"),
            "S in air, 35.2 % RH"
        );
        assert_eq!(
            said("sample=S,environment=air,started_at=2020-02-03"),
            "S in air, started at 2020-02-03"
        );
        assert_eq!(said("a run"), "a run");
        let name = "sample=CNaf-1,environment=air";
        assert!(is_called(name, name) && is_called(name, "CNaf-1 in air"));
        assert!(!is_called(name, "CNaf-1"));
    }

    fn named(runs: &[RunRecord], group_by: &[String]) -> Vec<(String, Vec<usize>)> {
        let found = groups(runs, group_by, &|_| true);
        found.into_iter().map(|group| (group.name, group.runs)).collect()
    }

    #[test]
    fn a_group_is_a_sample_in_one_environment_and_humidity() {
        let runs = [
            run("a", "S", "air", Some(34.0), 1.2),
            run("b", "S", "air", Some(36.5), 2.0),
            run("c", "S", "air", Some(61.0), 2.0),
            run("d", "S", "vacuum", None, 2.0),
            run("e", "T", "air", Some(30.0), 2.0),
        ];
        let expected = [
            (
                "sample=S,environment=air,relative_humidity_percent=35.2",
                vec![0, 1],
            ),
            ("sample=S,environment=air,relative_humidity_percent=61.0", vec![2]),
            ("sample=S,environment=vacuum", vec![3]),
            ("sample=T,environment=air", vec![4]),
        ];
        let expected: Vec<(String, Vec<usize>)> = expected
            .into_iter()
            .map(|(name, runs)| (name.to_owned(), runs))
            .collect();
        assert_eq!(named(&runs, &[]), expected);
    }

    #[test]
    fn a_chain_of_humidities_is_no_single_one() {
        let runs: Vec<RunRecord> = (0..5)
            .map(|k| run(&format!("r{k}"), "S", "air", Some(30.0 + 3.0 * f64::from(k)), 2.0))
            .collect();
        let sizes: Vec<usize> = named(&runs, &[]).iter().map(|(_, runs)| runs.len()).collect();
        assert_eq!(sizes, [2, 2, 1]);
    }

    #[test]
    fn group_by_puts_other_tags_in_their_place() {
        let mut runs = [
            run("a", "S", "air", Some(34.0), 1.2),
            run("b", "S", "air", Some(61.0), 2.0),
        ];
        runs[1].tags.push(tag("laboratory", "B"));
        let by = |keys: &[&str]| -> Vec<String> { keys.iter().map(|key| (*key).to_owned()).collect() };
        assert_eq!(
            named(&runs, &by(&["sample"])),
            [("sample=S".to_owned(), vec![0, 1])]
        );
        assert_eq!(named(&runs, &by(&["sample", "laboratory"])).len(), 2);
    }

    #[test]
    fn runs_of_another_date_are_set_apart_with_the_reason() {
        let dates = ["2022-05-01", "2022-05-01", "2020-02-03", "2020-02-03"];
        let runs: Vec<RunRecord> = dates
            .iter()
            .enumerate()
            .map(|(k, date)| {
                let mut run = run(&format!("step_{}.csv", k + 1), "S", "air", None, 2.0);
                run.tags.push(tag(keys::STARTED_AT, &format!("{date}T10:00:00Z")));
                run
            })
            .collect();
        let found = groups(&runs, &[], &|_| true);
        assert_eq!(found.len(), 2);
        assert_eq!(
            (found[0].runs.as_slice(), &found[0].set_apart),
            (&[0, 1][..], &None)
        );
        assert_eq!(found[1].runs, [2, 3]);
        assert_eq!(found[1].name, "sample=S,environment=air,started_at=2020-02-03");
        let issue = found[1].set_apart.as_ref().unwrap();
        assert_eq!(issue.code, "series-broken");
        assert!(issue.message.contains("not the same series"), "{issue:?}");
    }
}
