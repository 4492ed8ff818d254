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
