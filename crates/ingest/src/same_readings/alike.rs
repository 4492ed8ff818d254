//! Which records share so many marks with one that they must be looked at.
//!
//! Marks lead to the records that have them, so that a record is held against those it shares marks with and no others.
//! Two records that both have fine marks share none unless they hold the same readings, so that the work grows with the
//! number of records and not with that of pairs; coarse marks count where one of the two prints few digits.

use std::collections::{BTreeMap, HashMap};

use super::marks::{KINDS, is_fine, kind};
use crate::same_readings::policy::SHARED_MARKS;

/// How many marks of each kind there are.
type Counts = [u16; KINDS];

/// Records by their marks.
#[derive(Debug)]
pub struct Alike {
    /// Row id of each record, in order.
    ids: Vec<i64>,
    sizes: Vec<Counts>,
    /// Places in `ids` of the records that have a mark.
    holders: HashMap<u64, Holders>,
    /// Marks shared with the record that is asked about; zero between two questions.
    shared: Vec<Counts>,
}

/// Records that have a mark.
#[derive(Debug, Default)]
struct Holders {
    /// Those that have fine marks.
    fine: Vec<u32>,
    /// Those that have coarse ones alone.
    coarse: Vec<u32>,
}

impl Alike {
    /// Of records with their marks, each list without doubles, as [`super::marks`] gives them.
    pub fn of(all: &BTreeMap<i64, Vec<u64>>) -> Alike {
        let mut alike = Alike {
            ids: all.keys().copied().collect(),
            sizes: all.values().map(|marks| counts(marks)).collect(),
            holders: HashMap::new(),
            shared: vec![Counts::default(); all.len()],
        };
        for (place, marks) in all.values().enumerate() {
            let has_fine = has_fine(&alike.sizes[place]);
            for mark in marks {
                let holders = alike.holders.entry(*mark).or_default();
                if has_fine {
                    holders.fine.push(place as u32)
                } else {
                    holders.coarse.push(place as u32)
                }
            }
        }
        alike
    }

    /// Row ids of the other records that must be looked at beside record `id` with these marks, in order.
    pub fn to(&mut self, id: i64, marks: &[u64]) -> Vec<i64> {
        let own = counts(marks);
        let mut touched: Vec<u32> = Vec::new();
        for mark in marks {
            let kind = kind(*mark);
            let Some(holders) = self.holders.get(mark) else {
                continue;
            };
            // Coarse marks say nothing of two records that both have fine ones.
            let fine = if has_fine(&own) && !is_fine(kind) {
                &[][..]
            } else {
                &holders.fine[..]
            };
            for &place in fine.iter().chain(&holders.coarse) {
                let shared = &mut self.shared[place as usize];
                if *shared == Counts::default() {
                    touched.push(place);
                }
                shared[kind] += 1;
            }
        }
        touched.sort_unstable();
        let mut found = Vec::new();
        for place in touched {
            let place = place as usize;
            let shared = std::mem::take(&mut self.shared[place]);
            if self.ids[place] != id && must_be_looked_at(shared, own, self.sizes[place]) {
                found.push(self.ids[place]);
            }
        }
        found
    }
}

fn counts(marks: &[u64]) -> Counts {
    let mut counts = Counts::default();
    marks.iter().for_each(|mark| counts[kind(*mark)] += 1);
    counts
}

fn has_fine(counts: &Counts) -> bool {
    (0..KINDS).any(|kind| is_fine(kind) && counts[kind] > 0)
}

/// Whether so many marks of a kind are shared by two records with so many.
fn must_be_looked_at(shared: Counts, own: Counts, other: Counts) -> bool {
    (0..KINDS).any(|kind| shared[kind] > 0 && shared[kind] >= SHARED_MARKS.min(own[kind].min(other[kind])))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Marks of the kind `kind` with these numbers.
    fn of_kind(kind: u64, numbers: &[u64]) -> Vec<u64> {
        numbers.iter().map(|number| number * 4 + kind).collect()
    }

    fn numbered(lists: Vec<Vec<u64>>) -> BTreeMap<i64, Vec<u64>> {
        (1..).zip(lists).collect()
    }

    #[test]
    fn three_marks_of_one_kind_or_all_of_the_fewer_lead_to_a_record() {
        let two_kinds = [of_kind(0, &[1, 2]), of_kind(1, &[3, 4, 5])].concat();
        let all = numbered(vec![
            of_kind(0, &[1, 2, 3, 4]), // the one that is asked about
            of_kind(0, &[1, 2, 3, 9]), // three
            of_kind(0, &[1, 2, 8, 9]), // two of four
            of_kind(0, &[1, 2]),       // all of two
            vec![],
            two_kinds, // all of the first kind, none of the second
        ]);
        let mut records = Alike::of(&all);
        assert_eq!(records.to(1, &all[&1]), [2, 4, 6]);
        // What was counted for one question does not speak in the next.
        assert_eq!(records.to(1, &all[&1]), [2, 4, 6]);
        assert_eq!(records.to(5, &all[&5]), Vec::<i64>::new());
    }

    /// 1,500 quiet repeats were all held against each other, which took minutes.
    #[test]
    fn repeats_that_agree_to_three_digits_are_told_by_the_fifth() {
        let coarse = of_kind(0, &[1, 2, 3, 4]);
        let record = |fine: &[u64]| [coarse.clone(), of_kind(2, fine)].concat();
        let all = numbered(vec![
            record(&[1, 2, 3]),
            record(&[4, 5, 6]),
            record(&[1, 2, 3]),
            coarse.clone(), // an export with few digits
        ]);
        let mut records = Alike::of(&all);
        assert_eq!(records.to(1, &all[&1]), [3, 4]);
        assert_eq!(records.to(2, &all[&2]), [4]);
        assert_eq!(records.to(4, &all[&4]), [1, 2, 3]);
    }
}
