//! Which records share so many marks with one that they must be looked at.
//!
//! Marks lead to the records that have them, so that a record is held against those it shares marks with and no others.
//! What many records begin with (the same first reading of every run of a condition) is then counted, not searched for.

use std::collections::{BTreeMap, HashMap};

use super::SHARED;

/// Records by their marks.
#[derive(Debug)]
pub struct Alike {
    /// Row id of each record, in order.
    ids: Vec<i64>,
    /// Number of marks of each of the two kinds.
    sizes: Vec<[u16; 2]>,
    /// Places in `ids` of the records that have a mark.
    holders: HashMap<u64, Vec<u32>>,
    /// Marks shared with the record that is asked about, by kind; zero between two questions.
    shared: Vec<[u16; 2]>,
}

impl Alike {
    /// Of records with their marks, each list without doubles, as [`super::marks`] gives them.
    pub fn of(all: &BTreeMap<i64, Vec<u64>>) -> Alike {
        let mut alike = Alike {
            ids: all.keys().copied().collect(),
            sizes: Vec::with_capacity(all.len()),
            holders: HashMap::new(),
            shared: vec![[0; 2]; all.len()],
        };
        for (place, marks) in all.values().enumerate() {
            let mut size = [0; 2];
            for mark in marks {
                size[kind(*mark)] += 1;
                alike.holders.entry(*mark).or_default().push(place as u32);
            }
            alike.sizes.push(size);
        }
        alike
    }

    /// Row ids of the other records that must be looked at beside record `id` with these marks, in order.
    pub fn to(&mut self, id: i64, marks: &[u64]) -> Vec<i64> {
        let mut own = [0; 2];
        let mut touched: Vec<u32> = Vec::new();
        for mark in marks {
            let kind = kind(*mark);
            own[kind] += 1;
            for &place in self.holders.get(mark).into_iter().flatten() {
                let shared = &mut self.shared[place as usize];
                if *shared == [0; 2] {
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

/// The kind of a mark: by time, or by order.
fn kind(mark: u64) -> usize {
    (mark & 1) as usize
}

/// Whether so many marks of a kind are shared by two records with so many.
fn must_be_looked_at(shared: [u16; 2], own: [u16; 2], other: [u16; 2]) -> bool {
    (0..2).any(|kind| {
        let fewer = usize::from(own[kind].min(other[kind]));
        shared[kind] > 0 && usize::from(shared[kind]) >= SHARED.min(fewer)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn alike(lists: &[&[u64]]) -> BTreeMap<i64, Vec<u64>> {
        let lists = lists.iter().map(|list| list.to_vec());
        (1..).zip(lists).collect()
    }

    #[test]
    fn three_marks_of_one_kind_or_all_of_the_fewer_lead_to_a_record() {
        let all = alike(&[
            &[2, 4, 6, 8],    // the one that is asked about
            &[2, 4, 6, 10],   // three
            &[2, 4, 12, 10],  // two of four
            &[2, 4],          // all of two
            &[],              // nothing
            &[3, 5, 7, 2, 4], // two of the one kind, none of the other
        ]);
        let mut records = Alike::of(&all);
        assert_eq!(records.to(1, &all[&1]), [2, 4]);
        // What was counted for one question does not speak in the next.
        assert_eq!(records.to(1, &all[&1]), [2, 4]);
        assert_eq!(records.to(5, &all[&5]), Vec::<i64>::new());
    }

    /// Every record was held against every other that shares its first reading, mark by mark: minutes for 20,000.
    #[test]
    fn a_first_reading_that_all_runs_share_costs_no_search() {
        let time_of = |count: i64| {
            let own = |id: i64| (1..64).map(move |mark| ((id as u64) << 20) + 2 * mark);
            let all: BTreeMap<i64, Vec<u64>> = (1..=count)
                .map(|id| (id, std::iter::once(2).chain(own(id)).collect()))
                .collect();
            let begun = std::time::Instant::now();
            let mut records = Alike::of(&all);
            assert!(all.iter().all(|(id, marks)| records.to(*id, marks).is_empty()));
            begun.elapsed().as_secs_f64()
        };
        // 4 s on a slow machine without optimisation; pair by pair it took ten times as long for a tenth of the records.
        let took_s = time_of(4_000);
        assert!(took_s < 20.0, "{took_s} s");
    }
}
