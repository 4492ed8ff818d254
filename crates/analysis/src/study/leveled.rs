//! The conditions of a parameter where every strip has a level of its own: one model for all combinations of them.

use std::rc::Rc;

use ieap_numerics::grouped::Grouped;

use super::measured::{Measured, Value, one_of};
use super::scoped::{Columns, Told};

/// The model, and its column of each condition; none of those that levels and the conditions before tell.
pub(super) struct Leveled {
    of: Rc<Measured>,
    column_of: Vec<Option<usize>>,
}

impl Leveled {
    /// Of the columns of any combination: the values, their strips and what runs share are those of all. None where nothing is
    /// left to tell a condition from.
    pub fn of(measured: &Measured, columns: &Columns) -> Option<Leveled> {
        let mut grouped = Grouped::new(&vec![1.0; columns.values.len()], &columns.sample, &[]);
        let mut kept: Vec<Vec<f64>> = Vec::new();
        let mut column_of = Vec::new();
        for cell in &measured.cells {
            let is_of = |value: &Value| f64::from(u8::from(value.cell == *cell));
            let column: Vec<f64> = columns.values.iter().map(is_of).collect();
            column_of.push(grouped.take_out(&column).then(|| {
                kept.push(column);
                columns.samples + kept.len() - 1
            }));
        }
        let samples: Vec<usize> = (0..columns.samples).collect();
        let levels = |k: usize| one_of(&samples, &columns.sample[k]);
        let of = columns.with_fixed(|k| [levels(k), kept.iter().map(|own| own[k]).collect()].concat())?;
        Some(Leveled {
            of: Rc::new(of),
            column_of,
        })
    }

    /// A combination of conditions; `side`: on which side of it each value stands.
    pub fn told(&self, of_conditions: &[f64], side: Vec<f64>) -> Told {
        let count = self.column_of.iter().flatten().max().map_or(0, |last| last + 1);
        let mut factors = vec![0.0; count];
        for (column, factor) in self.column_of.iter().zip(of_conditions) {
            if let Some(column) = column {
                factors[*column] = *factor;
            }
        }
        Told {
            of: Rc::clone(&self.of),
            factors,
            side,
            fitted: Vec::new(),
        }
    }
}
