//! Searches for variances that were made before: a search is long, what it finds follows from the model, and a model that did
//! not change since need not be searched again.
//!
//! Searches lie many calls deep, and no number depends on whether one was made before: as with [`crate::interrupt`] it is the
//! thread that knows, and nothing between has to pass it on.

use std::cell::RefCell;
use std::sync::Arc;

use super::estimated::Estimated;
use super::model::MixedModel;
use ieap_domain::InputHash;

/// What a search found: the variances, and which of them the design tells apart.
pub type Search = (Vec<f64>, Vec<usize>);

/// Where searches are kept, each under a hash of all that it depends on.
pub trait Memory {
    /// What was found before; none where nothing is known of it.
    fn earlier(&self, hash: &str) -> Option<Search>;
    /// Keeps what was found.
    fn keep(&self, hash: &str, found: &Search);
}

thread_local! {
    static OF_THREAD: RefCell<Option<Arc<dyn Memory>>> = const { RefCell::new(None) };
}

/// What this thread had before, which it has again afterwards, also where the work is given up.
struct Before(Option<Arc<dyn Memory>>);

impl Drop for Before {
    fn drop(&mut self) {
        OF_THREAD.set(self.0.take());
    }
}

/// Does work whose searches on this thread are taken from `memory` where they were made before.
pub fn with_memory<R>(memory: Arc<dyn Memory>, work: impl FnOnce() -> R) -> R {
    let _before = Before(OF_THREAD.replace(Some(memory)));
    work()
}

/// The memory of this thread.
pub(super) fn of_thread() -> Option<Arc<dyn Memory>> {
    OF_THREAD.with_borrow(Clone::clone)
}

/// Hash of all that a search depends on: the model, and where it begins.
pub(super) fn hash(model: &MixedModel, near: Option<&Estimated>) -> String {
    let mut hash = InputHash::new();
    hash.count(model.component_of.len());
    for of in &model.component_of {
        hash.count(*of);
    }
    hash.flag(near.is_some());
    if let Some(near) = near {
        hash.numbers(&near.variances);
    }
    for unit in &model.units {
        hash.count(unit.block);
        hash.numbers(&unit.fixed).numbers(&unit.random);
        hash.count(unit.readings.len());
        for reading in &unit.readings {
            hash.number(reading.value)
                .number(reading.variance)
                .number(reading.weight);
        }
    }
    hash.finished()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Mutex;

    use super::super::model::{Reading, Unit};
    use super::*;

    #[derive(Default)]
    struct Kept(Mutex<BTreeMap<String, Search>>);

    impl Memory for Kept {
        fn earlier(&self, hash: &str) -> Option<Search> {
            self.0.lock().unwrap().get(hash).cloned()
        }

        fn keep(&self, hash: &str, found: &Search) {
            self.0.lock().unwrap().insert(hash.to_owned(), found.clone());
        }
    }

    fn model(last: f64) -> MixedModel {
        let values = [1.0, 1.3, 2.1, 2.6, 4.0, last];
        let unit = |(k, value): (usize, &f64)| Unit {
            block: k / 2,
            fixed: vec![1.0],
            random: vec![1.0],
            readings: vec![Reading::new(*value, 0.01)],
        };
        MixedModel {
            units: values.iter().enumerate().map(unit).collect(),
            component_of: vec![0],
        }
    }

    #[test]
    fn a_search_that_was_made_before_gives_the_same_to_the_last_bit() {
        let kept = Arc::new(Kept::default());
        let alone = [4.4, 4.5].map(|last| model(last).estimated().unwrap());
        for times in [1, 2] {
            let found = with_memory(kept.clone(), || {
                [4.4, 4.5].map(|last| model(last).estimated().unwrap())
            });
            assert_eq!(found, alone, "{times}");
            assert_eq!(kept.0.lock().unwrap().len(), 2);
        }
        assert!(of_thread().is_none());
    }
}
