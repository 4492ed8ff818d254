//! Many tables, counted by what became of them.

use std::collections::BTreeMap;
use std::fmt::Write;

use rayon::prelude::*;

use crate::dialect::{self, Dialect};
use crate::dice::Dice;
use crate::judge::{Outcome, judge};
use crate::truth;
use crate::write::{Table, table};

/// Outcomes by seed.
pub struct Counts(Vec<(u64, Outcome)>);

/// The table of a seed.
pub fn of_seed(seed: u64) -> (bool, Dialect, Table) {
    let mut dice = Dice::of(seed);
    let truth = truth::random(&mut dice);
    let dialect = dialect::random(&mut dice, &truth);
    let table = table(&mut dice, &truth, &dialect);
    (truth.is_log, dialect, table)
}

/// Judges the tables of so many seeds.
pub fn count(count: u64, first: u64) -> Counts {
    let of = |seed: u64| {
        let (is_log, _, table) = of_seed(seed);
        (seed, judge(&table, is_log))
    };
    Counts((first..first + count).into_par_iter().map(of).collect())
}

impl Counts {
    /// How many were misread in silence.
    pub fn wrong(&self) -> usize {
        self.0
            .iter()
            .filter(|(_, outcome)| matches!(outcome, Outcome::Wrong { .. }))
            .count()
    }

    /// Seeds by kind of silent error, the most frequent first.
    fn kinds(&self) -> Vec<(String, Vec<(u64, String)>)> {
        let mut kinds: BTreeMap<String, Vec<(u64, String)>> = BTreeMap::new();
        for (seed, outcome) in &self.0 {
            if let Outcome::Wrong { kind, detail } = outcome {
                kinds
                    .entry(kind.clone())
                    .or_default()
                    .push((*seed, detail.clone()));
            }
        }
        let mut kinds: Vec<_> = kinds.into_iter().collect();
        kinds.sort_by_key(|(_, seeds)| std::cmp::Reverse(seeds.len()));
        kinds
    }

    /// Counts in words; of each kind of silent error the first `show` tables.
    pub fn text(&self, show: usize) -> String {
        let (mut right, mut partly, mut told) = (0, 0, 0);
        let mut codes = BTreeMap::<(bool, &str), usize>::new();
        for (_, outcome) in &self.0 {
            match outcome {
                Outcome::Right { uninterpreted: 0 } => right += 1,
                Outcome::Right { .. } => partly += 1,
                Outcome::Asked(code) => *codes.entry((true, code)).or_default() += 1,
                Outcome::Refused(code) => *codes.entry((false, code)).or_default() += 1,
                Outcome::Told => told += 1,
                Outcome::Wrong { .. } => {}
            }
        }
        let mut text = format!("{right} right\n{partly} right, a measured column kept without its meaning\n");
        for (is_asked, word) in [(true, "asked"), (false, "refused")] {
            let mut of: Vec<(usize, &str)> = codes
                .iter()
                .filter(|((asked, _), _)| *asked == is_asked)
                .map(|((_, code), n)| (*n, *code))
                .collect();
            of.sort_by(|a, b| b.cmp(a));
            let _ = writeln!(text, "{} {word}", of.iter().map(|(n, _)| n).sum::<usize>());
            for (n, code) in of.iter().take(10) {
                let _ = writeln!(text, "    {n:5} {code}");
            }
        }
        let _ = writeln!(
            text,
            "{told} of freezing air in °F that name no unit, read in °C, which a note tells"
        );
        self.write_odd(&mut text);
        let _ = writeln!(text, "{} SILENTLY WRONG", self.wrong());
        for (kind, seeds) in self.kinds() {
            let _ = writeln!(text, "    {:5} {kind}", seeds.len());
            for (seed, detail) in seeds.iter().take(show) {
                let _ = writeln!(
                    text,
                    "          seed {seed}: {detail}\n            {}",
                    of_seed(*seed).1.words()
                );
            }
        }
        text
    }

    /// What became of tables with an oddity.
    fn write_odd(&self, text: &mut String) {
        let mut odd = BTreeMap::<String, [usize; 3]>::new();
        for (seed, outcome) in &self.0 {
            let place = match outcome {
                Outcome::Right { .. } | Outcome::Told => 0,
                Outcome::Asked(_) | Outcome::Refused(_) => 1,
                Outcome::Wrong { .. } => 2,
            };
            for word in of_seed(*seed).1.oddities() {
                odd.entry(word).or_default()[place] += 1;
            }
        }
        for (word, [right, refused, wrong]) in odd {
            let _ = writeln!(
                text,
                "{word}: {right} right, {refused} asked or refused, {wrong} wrong"
            );
        }
    }

    /// Keeps the tables that are shown in a folder.
    pub fn write(&self, folder: &str, show: usize) {
        for (_, seeds) in self.kinds() {
            for (seed, _) in seeds.iter().take(show) {
                let path = format!("{folder}/{seed}.csv");
                if let Err(error) = std::fs::write(&path, of_seed(*seed).2.bytes) {
                    eprintln!("{path}: {error}");
                }
            }
        }
    }
}
