//! Long columns whose memory the same thread uses again: fetching fresh pages for every fit of a long record costs
//! a quarter of its time.

use std::cell::RefCell;
use std::ops::{Deref, DerefMut};

/// Columns kept by a thread.
const KEPT: usize = 6;

thread_local! {
    static SPARE: RefCell<Vec<Vec<f64>>> = const { RefCell::new(Vec::new()) };
}

/// A column of numbers; when it is dropped its memory is kept for the next one.
#[derive(Debug, Default, PartialEq)]
pub struct LongColumn {
    values: Vec<f64>,
}

impl LongColumn {
    /// An empty column with room for `capacity` numbers.
    pub fn with_capacity(capacity: usize) -> LongColumn {
        let spare = SPARE.try_with(|spare| spare.borrow_mut().pop()).ok().flatten();
        let mut values = spare.unwrap_or_default();
        values.clear();
        values.reserve(capacity);
        LongColumn { values }
    }
}

impl Drop for LongColumn {
    fn drop(&mut self) {
        let values = std::mem::take(&mut self.values);
        if values.capacity() > 0 {
            // A thread that ends has no store any more; the memory is then simply freed.
            let _ = SPARE.try_with(|spare| {
                let mut spare = spare.borrow_mut();
                if spare.len() < KEPT {
                    spare.push(values);
                }
            });
        }
    }
}

impl Clone for LongColumn {
    fn clone(&self) -> LongColumn {
        let mut copy = LongColumn::with_capacity(self.values.len());
        copy.values.extend_from_slice(&self.values);
        copy
    }
}

impl From<Vec<f64>> for LongColumn {
    fn from(values: Vec<f64>) -> LongColumn {
        LongColumn { values }
    }
}

impl Deref for LongColumn {
    type Target = Vec<f64>;

    fn deref(&self) -> &Vec<f64> {
        &self.values
    }
}

impl DerefMut for LongColumn {
    fn deref_mut(&mut self) -> &mut Vec<f64> {
        &mut self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_begins_empty_whatever_its_memory_held() {
        for n in [3, 5000, 10] {
            let mut column = LongColumn::with_capacity(n);
            assert!(column.is_empty() && column.capacity() >= n);
            column.extend((0..n).map(|k| k as f64));
            assert_eq!(column.clone(), column);
        }
        let many: Vec<LongColumn> = (0..20).map(|n| LongColumn::from(vec![1.0; n])).collect();
        drop(many);
        assert!(SPARE.with(|spare| spare.borrow().len()) <= KEPT);
    }
}
