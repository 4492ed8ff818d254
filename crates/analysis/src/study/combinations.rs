//! The combinations of the conditions of one parameter of one material. What they share is made once: the model in which every
//! strip has a level of its own, and a combination that is asked again.

use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::ops::Deref;
use std::rc::Rc;

use super::leveled::Leveled;
use super::measured::{Measured, Value};
use super::scoped::{Columns, Scoped, Told};

/// Values of a parameter of a material with the combinations of their conditions that were asked.
pub(super) struct Combinations {
    of: Rc<Measured>,
    /// With what the runs of a strip share in surroundings, and without.
    leveled: [OnceCell<Option<Leveled>>; 2],
    made: RefCell<BTreeMap<Vec<u64>, Rc<Scoped>>>,
}

impl Deref for Combinations {
    type Target = Measured;

    fn deref(&self) -> &Measured {
        &self.of
    }
}

impl Combinations {
    /// Of these values, nothing asked yet.
    pub fn new(of: Measured) -> Combinations {
        Combinations {
            of: Rc::new(of),
            leveled: Default::default(),
            made: RefCell::default(),
        }
    }

    /// A combination in both scopes.
    pub fn scoped(&self, factors: &[f64]) -> Rc<Scoped> {
        let bits: Vec<u64> = factors.iter().map(|own| own.to_bits()).collect();
        if let Some(made) = self.made.borrow().get(&bits) {
            return Rc::clone(made);
        }
        let made = Rc::new(self.made(factors));
        self.made.borrow_mut().insert(bits, Rc::clone(&made));
        made
    }

    /// Of the material it is told by the conditions' own model, in which strips differ by chance in each of the surroundings.
    /// Where every condition has one run, and of one strip, that model says all there is.
    fn made(&self, factors: &[f64]) -> Scoped {
        let side = |own: &Value| self.of.at(own.cell).map_or(0.0, |at| factors[at]);
        let side: Vec<f64> = self.of.values.iter().map(side).collect();
        let columns = Columns::of_conditions(&self.of, factors, side.clone());
        let columns = columns.filter(|own| own.samples > 1 && !self.of.is_of_single_runs());
        let is_of_surroundings = columns.as_ref().is_some_and(|own| own.is_of_surroundings);
        let within = columns.as_ref().filter(|_| !is_of_surroundings);
        let material = within.and_then(Columns::of_material).unwrap_or(Told {
            of: Rc::clone(&self.of),
            factors: factors.to_vec(),
            side,
            fitted: Vec::new(),
        });
        let strips = columns.and_then(|own| own.of_strips(|| self.of_all_strips(&own, factors)));
        let (strips, differ) = strips.unzip();
        Scoped {
            strips,
            material: Some(material),
            differ: differ.flatten(),
            is_of_surroundings,
        }
    }

    /// The combination by the model in which every strip has a level; none where levels hold it.
    fn of_all_strips(&self, columns: &Columns, factors: &[f64]) -> Option<Told> {
        let kept = &self.leveled[usize::from(columns.has_parts())];
        let leveled = kept.get_or_init(|| Leveled::of(&self.of, columns));
        columns.is_told_beside_levels().then_some(())?;
        Some(leveled.as_ref()?.told(factors, columns.side.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Values of some strips in a room of conditions of which some are missing.
    fn values(random: &mut ChaCha8Rng) -> Vec<Value> {
        let mut values = Vec::new();
        for place in 0..60 {
            let (sample, cell) = (
                random.random_range(0..3),
                (random.random_range(0..3), random.random_range(0..3)),
            );
            if (sample + cell.0 + cell.1) % 4 == 3 {
                continue;
            }
            values.push(Value {
                place,
                sample,
                cell,
                humidity_percent: None,
                y: 0.3 * sample as f64 + 0.1 * cell.0 as f64 + random.random_range(-0.1..0.1),
                variance: random.random_range(1e-4..4e-3),
                weight: 1.0,
                off: None,
            });
        }
        values
    }

    #[test]
    fn one_model_with_levels_tells_what_a_model_of_each_combination_does() {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let mut compared = 0;
        for _ in 0..20 {
            let of = Combinations::new(Measured::new(values(&mut random), BTreeMap::new(), &[], None));
            let mut factors = vec![0.0; of.cells.len()];
            let (above, below) = (
                random.random_range(0..factors.len()),
                random.random_range(0..factors.len()),
            );
            factors[above] += 1.0;
            factors[below] -= 1.0;
            let side = |own: &Value| of.at(own.cell).map_or(0.0, |at| factors[at]);
            let side = of.values.iter().map(side).collect();
            let Some(columns) = Columns::of_conditions(&of.of, &factors, side) else {
                continue;
            };
            let both = [of.of_all_strips(&columns, &factors), columns.of_one_number()];
            let told = |own: &Told| own.of.with_scatter(&own.factors).unwrap().0;
            let [shared, own] = both.map(|own| own.as_ref().map(told));
            let (Some(shared), Some(own)) = (&shared, &own) else {
                assert!(shared.is_none() && own.is_none());
                continue;
            };
            compared += 1;
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * own.error();
            assert!(near(shared.mean(), own.mean()), "{shared:?} {own:?}");
            let (ends, other) = (shared.ends_95(), own.ends_95());
            assert!(
                near(ends.0, other.0) && near(ends.1, other.1),
                "{shared:?} {own:?}"
            );
        }
        assert!(compared > 10, "{compared}");
    }
}
