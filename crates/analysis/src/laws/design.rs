//! Which covariates a design lets nobody tell apart: variance inflation, by the covariates that cause it.

use std::collections::{BTreeMap, BTreeSet};

use super::covariate::{Covariate, Kind};
use super::facts::RunFacts;
use super::policy::{INFLATION_LIMIT, MOST_LEVELS, STATED_PART, WITHIN_PART};
use ieap_numerics::grouped::{Grouped, dot};

/// Where a covariate differs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub enum Level {
    /// Between the runs of a sample.
    Within,
    /// Between samples only: samples are what is compared.
    Between,
}

/// Rows that are compared: runs with the sample as their group, or samples in one group.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// Where they differ.
    pub level: Level,
    /// Group of each row.
    pub group: Vec<usize>,
    /// Facts that each row stands for: one run, or all runs of a sample.
    pub members: Vec<Vec<usize>>,
    /// Columns of each covariate that differs here.
    pub columns: BTreeMap<Covariate, Vec<Vec<f64>>>,
    /// Covariates that are one finding, each set in their own order; single ones alone.
    pub sets: Vec<Vec<Covariate>>,
    /// Covariates that make each one's inflation.
    pub confounded: BTreeMap<Covariate, BTreeSet<Covariate>>,
}

/// The rows of `places` (indices in `facts`) at each level, with the covariates that differ there and the sets that
/// cannot be told apart.
pub fn rows(facts: &[RunFacts], places: &[usize]) -> [Rows; 2] {
    let mut levels = columns_by_level(facts, places, &asked(facts, places));
    for rows in &mut levels {
        rows.find_sets();
    }
    levels
}

/// The rows of these covariates, as far as the runs state them, without the sets, which take longest to find.
pub fn columns_by_level(facts: &[RunFacts], places: &[usize], of: &BTreeSet<Covariate>) -> [Rows; 2] {
    let mut samples: Vec<&str> = places.iter().map(|&place| facts[place].sample.as_str()).collect();
    samples.sort_unstable();
    samples.dedup();
    let group: Vec<usize> = places
        .iter()
        .map(|&place| samples.binary_search(&facts[place].sample.as_str()).unwrap_or(0))
        .collect();
    let mut of_sample = vec![Vec::new(); samples.len()];
    for (&place, &g) in places.iter().zip(&group) {
        of_sample[g].push(place);
    }
    let mut within = Rows {
        level: Level::Within,
        group: group.clone(),
        members: places.iter().map(|&place| vec![place]).collect(),
        columns: BTreeMap::new(),
        sets: Vec::new(),
        confounded: BTreeMap::new(),
    };
    let mut between = Rows {
        level: Level::Between,
        group: vec![0; samples.len()],
        members: of_sample,
        columns: BTreeMap::new(),
        sets: Vec::new(),
        confounded: BTreeMap::new(),
    };
    for &covariate in of {
        let Some(columns) = columns(facts, places, covariate) else {
            continue;
        };
        match level_of(&columns, &group) {
            Some(Level::Within) => {
                within.columns.insert(covariate, columns);
            }
            Some(Level::Between) => {
                let means = columns.iter().map(|column| group_means(column, &group)).collect();
                between.columns.insert(covariate, means);
            }
            None => {}
        }
    }
    [within, between]
}

/// Covariates that any of the runs states, in the order of [`Covariate::ALL`], declared tags last.
fn asked(facts: &[RunFacts], places: &[usize]) -> BTreeSet<Covariate> {
    let of_run = |&place: &usize| facts[place].numbers.keys().chain(facts[place].names.keys());
    let stated = places.iter().flat_map(of_run).copied();
    stated
        .filter(|covariate| *covariate != Covariate::Sample)
        .collect()
}

impl Rows {
    /// What covariates leave unclear in each other.
    fn find_sets(&mut self) {
        let names: Vec<Covariate> = self.columns.keys().copied().collect();
        let mut edges: BTreeMap<Covariate, BTreeSet<Covariate>> = BTreeMap::new();
        let mut join = |a: Covariate, b: Covariate| {
            edges.entry(a).or_default().insert(b);
            edges.entry(b).or_default().insert(a);
        };
        for &one in &names {
            let others: Vec<Covariate> = names.iter().copied().filter(|other| *other != one).collect();
            let alone: Vec<bool> = others
                .iter()
                .map(|&other| self.inflation(one, &[other]) > INFLATION_LIMIT)
                .collect();
            for (&other, _) in others.iter().zip(&alone).filter(|(_, too_much)| **too_much) {
                join(one, other);
            }
            let clear: Vec<Covariate> = others
                .iter()
                .zip(&alone)
                .filter(|(_, too_much)| !**too_much)
                .map(|(&other, _)| other)
                .collect();
            for (k, &first) in clear.iter().enumerate() {
                for &second in &clear[k + 1..] {
                    if self.inflation(one, &[first, second]) > INFLATION_LIMIT {
                        join(one, first);
                        join(one, second);
                    }
                }
            }
        }
        self.sets = components(&names, &edges);
        self.confounded = edges;
    }

    /// Generalised variance inflation of `one` by `others` (Fox and Monette 1992), per degree of freedom, comparable
    /// with the inflation of a single column.
    pub fn inflation(&self, one: Covariate, others: &[Covariate]) -> f64 {
        let own = &self.columns[&one];
        let others: Vec<Vec<f64>> = others
            .iter()
            .flat_map(|other| self.columns[other].clone())
            .collect();
        let even = vec![1.0; self.group.len()];
        let before = Grouped::new(&even, &self.group, &[]);
        let after = Grouped::new(&even, &self.group, &others);
        if after.freedom() == 0 {
            return f64::INFINITY;
        }
        let (mut log_ratio, mut rank) = (0.0, 0_usize);
        let (mut before, mut after) = (before, after);
        for column in own {
            let whole = square(&before.residual(column));
            if !before.take_out(column) {
                continue;
            }
            rank += 1;
            let left = square(&after.residual(column));
            after.take_out(column);
            if left <= 1e-8 * whole {
                return f64::INFINITY;
            }
            log_ratio += (whole / left).ln();
        }
        (log_ratio / rank.max(1) as f64).exp()
    }

    /// The set that a covariate belongs to.
    pub fn set_of(&self, covariate: Covariate) -> &[Covariate] {
        self.sets
            .iter()
            .find(|set| set.contains(&covariate))
            .map_or(&[], Vec::as_slice)
    }
}

fn square(column: &[f64]) -> f64 {
    dot(column, column)
}

fn components(names: &[Covariate], edges: &BTreeMap<Covariate, BTreeSet<Covariate>>) -> Vec<Vec<Covariate>> {
    let mut seen = BTreeSet::new();
    let mut sets = Vec::new();
    for &name in names {
        if !seen.insert(name) {
            continue;
        }
        let mut set = BTreeSet::from([name]);
        let mut open = vec![name];
        while let Some(at) = open.pop() {
            for &next in edges.get(&at).into_iter().flatten() {
                if set.insert(next) {
                    seen.insert(next);
                    open.push(next);
                }
            }
        }
        sets.push(set.into_iter().collect());
    }
    sets
}

/// Columns of a covariate over `places`: the number, or one column for each name but the first. None where too few
/// runs state it or it does not differ.
fn columns(facts: &[RunFacts], places: &[usize], covariate: Covariate) -> Option<Vec<Vec<f64>>> {
    match covariate.kind() {
        Kind::Number => {
            let numbers: Vec<Option<f64>> = places
                .iter()
                .map(|&place| facts[place].numbers.get(&covariate).map(|known| known.value))
                .collect();
            number_column(covariate, &numbers).map(|column| vec![column])
        }
        Kind::Category => {
            let names: Vec<Option<&str>> = places
                .iter()
                .map(|&place| facts[place].names.get(&covariate).map(String::as_str))
                .collect();
            name_columns(&names)
        }
    }
}

fn number_column(covariate: Covariate, numbers: &[Option<f64>]) -> Option<Vec<f64>> {
    let stated: Vec<f64> = numbers.iter().copied().flatten().collect();
    if (stated.len() as f64) < STATED_PART * numbers.len() as f64 || stated.len() < 2 {
        return None;
    }
    let mean = stated.iter().sum::<f64>() / stated.len() as f64;
    let spread = stated.iter().map(|x| (x - mean).abs()).fold(0.0, f64::max);
    // Rests are told apart by ratio; what is not stated stands at the mean and says nothing.
    let scaled = |x: f64| match covariate {
        Covariate::RestBefore => (x.max(0.0) + 1.0).ln(),
        _ => x,
    };
    if spread <= 1e-9 * mean.abs().max(1e-9) {
        return None;
    }
    let middle = stated.iter().map(|&x| scaled(x)).sum::<f64>() / stated.len() as f64;
    Some(
        numbers
            .iter()
            .map(|x| x.map_or(0.0, |x| scaled(x) - middle))
            .collect(),
    )
}

fn name_columns(names: &[Option<&str>]) -> Option<Vec<Vec<f64>>> {
    let mut distinct: Vec<&str> = names.iter().copied().flatten().collect();
    if (distinct.len() as f64) < STATED_PART * names.len() as f64 {
        return None;
    }
    distinct.sort_unstable();
    distinct.dedup();
    if !(2..=MOST_LEVELS).contains(&distinct.len()) {
        return None;
    }
    let column = |level: &&str| {
        names
            .iter()
            .map(|name| if *name == Some(level) { 1.0 } else { 0.0 })
            .collect()
    };
    Some(distinct[1..].iter().map(column).collect())
}

/// Where columns differ; none where they do not.
fn level_of(columns: &[Vec<f64>], group: &[usize]) -> Option<Level> {
    let (mut whole, mut within) = (0.0, 0.0);
    for column in columns {
        let even = vec![1.0; column.len()];
        whole += square(&Grouped::new(&even, &vec![0; column.len()], &[]).residual(column));
        within += square(&Grouped::new(&even, group, &[]).residual(column));
    }
    match whole > 0.0 {
        true if within >= WITHIN_PART * whole => Some(Level::Within),
        true => Some(Level::Between),
        false => None,
    }
}

/// Mean of a column in each group.
pub fn group_means(column: &[f64], group: &[usize]) -> Vec<f64> {
    let groups = group.iter().max().map_or(0, |last| last + 1);
    let (mut sums, mut counts) = (vec![0.0; groups], vec![0.0; groups]);
    for (x, &g) in column.iter().zip(group) {
        sums[g] += x;
        counts[g] += 1.0;
    }
    sums.iter()
        .zip(counts)
        .map(|(sum, count)| sum / f64::max(count, 1.0))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::facts::Known;

    fn fact(sample: &str, numbers: &[(Covariate, f64)], names: &[(Covariate, &str)]) -> RunFacts {
        RunFacts {
            run: 0,
            sample: sample.to_owned(),
            material: "m".to_owned(),
            numbers: numbers
                .iter()
                .map(|&(covariate, value)| {
                    let known = Known {
                        value,
                        standard_error: None,
                    };
                    (covariate, known)
                })
                .collect(),
            names: names.iter().map(|&(c, name)| (c, name.to_owned())).collect(),
        }
    }

    /// Environments one after the other, voltages rising in each, as in the thesis.
    fn thesis() -> Vec<RunFacts> {
        let mut facts = Vec::new();
        for (e, environment) in ["vacuum", "inert", "air"].iter().enumerate() {
            for (v, volts) in ["1.20", "2.00", "2.50"].iter().enumerate() {
                let cycle = (3 * e + v + 1) as f64;
                facts.push(fact(
                    "CNaf-1",
                    &[(Covariate::Cycle, cycle)],
                    &[(Covariate::Environment, environment), (Covariate::Voltage, volts)],
                ));
            }
        }
        facts
    }

    #[test]
    fn the_order_of_the_thesis_is_one_set() {
        let facts = thesis();
        let [within, _] = rows(&facts, &(0..9).collect::<Vec<_>>());
        assert_eq!(
            within.sets,
            [vec![Covariate::Cycle, Covariate::Environment, Covariate::Voltage]]
        );
        // Environment and age are tied by themselves, the voltage only by both.
        assert!(within.inflation(Covariate::Voltage, &[Covariate::Cycle]) < 2.0);
        assert!(within.inflation(Covariate::Cycle, &[Covariate::Environment]) > 5.0);
    }

    #[test]
    fn a_shuffled_order_ties_nothing() {
        let mut facts = thesis();
        for (fact, cycle) in facts
            .iter_mut()
            .zip([5.0, 2.0, 9.0, 8.0, 4.0, 1.0, 3.0, 7.0, 6.0])
        {
            fact.numbers.get_mut(&Covariate::Cycle).unwrap().value = cycle;
        }
        let [within, _] = rows(&facts, &(0..9).collect::<Vec<_>>());
        assert_eq!(within.sets.len(), 3, "{:?}", within.sets);
    }

    #[test]
    fn what_differs_between_samples_only_is_asked_of_samples() {
        let mut facts = Vec::new();
        for k in 0..6 {
            for volts in ["1.20", "2.00"] {
                facts.push(fact(
                    &format!("s{k}"),
                    &[(Covariate::RelativeHumidity, 20.0 * f64::from(k % 3))],
                    &[
                        (Covariate::Voltage, volts),
                        (Covariate::Batch, ["a", "b"][k as usize % 2]),
                    ],
                ));
            }
        }
        let [within, between] = rows(&facts, &(0..12).collect::<Vec<_>>());
        assert_eq!(within.sets, [vec![Covariate::Voltage]]);
        assert_eq!(between.group.len(), 6);
        assert_eq!(
            between.sets,
            [vec![Covariate::RelativeHumidity], vec![Covariate::Batch]]
        );
    }
}
