//! Which runs share a page: those that are diagnosed together, so that what their conditions change is seen side by side
//! and what they have in common is said once.

use super::input::Input;
use super::slug::slugs;
use ieap_analysis::conditions::{VOLTAGE_STEP_V, nominal_voltage_v};
use ieap_analysis::groups::groups;
use ieap_domain::number::digits;
use ieap_domain::tag::keys;
use ieap_domain::{RunRecord, RunState};

/// Most runs of a page: more make it slow to open and long to scroll through.
const MOST_RUNS: usize = 10;

/// A page of runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunPage {
    /// Name of its file, without folder and ending.
    pub slug: String,
    /// What its runs share, `sample=CNaf-01,environment=air`; empty where it is a run without a group.
    pub group: String,
    /// Indices of its runs, in the order of the page: rising voltage, then start; never empty.
    pub runs: Vec<usize>,
    /// Which of the pages of its group it is, from 1.
    pub part: usize,
    /// How many pages its group has.
    pub parts: usize,
}

/// The pages of all runs of `input`, in the order of the groups' names; then those of runs that lack a needed tag or a
/// sample, and so have no group, and of those that are set aside: each on a page of its own.
pub fn run_pages(input: &Input) -> Vec<RunPage> {
    let runs = &input.runs;
    let among = |run: &RunRecord| run.state != RunState::Untagged && run.tag(keys::SAMPLE).is_some();
    let groups = groups(runs, &input.campaign.group_by, &among);
    let files = groups.iter().map(|group| file_name(&group.name));
    let set_aside = (0..input.set_aside.len()).map(|place| runs.len() + place);
    let without_group = (0..runs.len()).filter(|&run| !among(&runs[run]));
    let alone: Vec<usize> = without_group.chain(set_aside).collect();
    let paths = alone.iter().map(|&run| input.record(run).path.clone());
    let names: Vec<String> = files.chain(paths).collect();
    let slugs = slugs(names.iter().map(String::as_str));
    let mut pages = Vec::new();
    for (group, slug) in groups.into_iter().zip(&slugs) {
        let mut members = group.runs;
        members.sort_by_key(|&run| (voltage_step(&runs[run]), runs[run].tag(keys::STARTED_AT), run));
        let parts = members.len().div_ceil(MOST_RUNS);
        for (part, members) in even(&members, parts).enumerate() {
            pages.push(RunPage {
                slug: match part {
                    0 => slug.clone(),
                    more => format!("{slug}-{}", more + 1),
                },
                group: group.name.clone(),
                runs: members.to_vec(),
                part: part + 1,
                parts,
            });
        }
    }
    let own = alone.iter().zip(slugs.iter().skip(slugs.len() - alone.len()));
    pages.extend(own.map(|(&run, slug)| RunPage {
        slug: slug.clone(),
        group: String::new(),
        runs: vec![run],
        part: 1,
        parts: 1,
    }));
    pages
}

/// Voltages that are one condition are one number; a run without a voltage stands last.
fn voltage_step(run: &RunRecord) -> i64 {
    nominal_voltage_v(run).map_or(i64::MAX, |voltage| (voltage / VOLTAGE_STEP_V).round() as i64)
}

/// `members` in that many stretches whose lengths differ by one at most.
fn even(members: &[usize], parts: usize) -> impl Iterator<Item = &[usize]> {
    let ends = move |part: usize| part * members.len() / parts;
    (0..parts).map(move |part| &members[ends(part)..ends(part + 1)])
}

/// The values of a group's name. Humidities are whole, so that an address outlives most runs that join the group.
fn file_name(group: &str) -> String {
    let value = |part: &str| match part.split_once('=') {
        Some((keys::RELATIVE_HUMIDITY_PERCENT, value)) => value.parse::<f64>().map_or_else(
            |_| value.to_owned(),
            |percent| format!("rh{}", digits(percent, 0)),
        ),
        Some((_, value)) => value.to_owned(),
        None => part.to_owned(),
    };
    let values: Vec<String> = group.split(',').map(value).collect();
    values.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_group_goes_on_in_even_pages() {
        let members: Vec<usize> = (0..23).collect();
        let sizes: Vec<usize> = even(&members, 3).map(<[usize]>::len).collect();
        assert_eq!(sizes, [7, 8, 8]);
        assert_eq!(even(&members, 3).flatten().copied().collect::<Vec<_>>(), members);
        assert_eq!(even(&[], 0).count(), 0);
    }

    #[test]
    fn an_address_says_what_the_group_shares() {
        assert_eq!(
            file_name("sample=CNaf-1,environment=air,relative_humidity_percent=20.3"),
            "CNaf-1 air rh20"
        );
        assert_eq!(file_name("sample=a,b=c,d"), "a c d");
    }
}
