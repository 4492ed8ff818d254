//! The questions: which combination of conditions answers each. Those about environments stand in `environments`, laws in
//! `laws`, what is held against what in `pairs`; a combination becomes an answer in `combined`.

use std::collections::BTreeMap;

use ieap_domain::{Factor, StudyRules};

use super::answer::{Answer, Kind};
use super::combinations::Combinations;
use super::combined::Term;
use super::curves::Curves;
use super::measured::{Cell, Measured};
use super::slope::{Other, Slope};
use crate::conditions::Conditions;
use crate::laws::facts::RunFacts;

/// All that questions are asked of.
pub struct Asking<'a> {
    pub rules: &'a StudyRules,
    pub compared: &'a [Factor],
    pub conditions: &'a Conditions,
    pub facts: &'a [RunFacts],
    /// Of each material and parameter; why its values cannot be compared, where they cannot.
    pub measured: BTreeMap<(usize, &'static str), Result<Combinations, &'static str>>,
    /// Slopes over the humidity.
    pub slopes: BTreeMap<(usize, &'static str), Slope>,
    /// Slopes over what else differs.
    pub others: BTreeMap<(usize, &'static str), Vec<Other>>,
    /// Curves of each material.
    pub curves: BTreeMap<(usize, &'static str), Curves>,
}

impl Asking<'_> {
    /// Every answer about a parameter of a material by itself.
    pub fn alone(&self, material: usize, key: &'static str) -> Vec<Answer> {
        let mut found = self.environments(material, key);
        found.extend(self.voltages(material, key));
        found.extend(self.humidity_law(material, key));
        found.extend(self.other_laws(material, key));
        found
    }

    /// Every answer about a parameter of a material held against the first.
    pub fn against_first(&self, material: usize, key: &'static str) -> Vec<Answer> {
        let both: Vec<&Measured> = [material, 0]
            .iter()
            .filter_map(|at| self.measured(*at, key).map(|of| &**of))
            .collect();
        let pairs = self.pairs(material, &both).into_iter();
        let mut found: Vec<Answer> = pairs
            .filter_map(|pair| self.by_material(&pair, material, key))
            .collect();
        found.extend(self.humidity_by_material(material, key));
        found.extend(self.materials(material, key));
        found
    }

    pub(super) fn measured(&self, material: usize, key: &'static str) -> Option<&Combinations> {
        self.measured.get(&(material, key))?.as_ref().ok()
    }

    pub(super) fn asks(&self, factor: Factor) -> bool {
        self.compared.contains(&factor)
    }

    /// Surroundings in which a material was measured.
    pub(super) fn surroundings(&self, material: usize) -> Vec<usize> {
        let of = self
            .conditions
            .measured
            .iter()
            .filter(|own| own.material == material);
        let mut found: Vec<usize> = of.map(|own| own.surroundings).collect();
        found.dedup();
        found
    }

    /// A material against the first, over the conditions that both have.
    fn materials(&self, material: usize, key: &'static str) -> Option<Answer> {
        if material == 0 {
            return None;
        }
        let (own, first) = (self.measured(material, key)?, self.measured(0, key)?);
        let shared: Vec<Cell> = own
            .cells
            .iter()
            .copied()
            .filter(|&cell| first.at(cell).is_some())
            .collect();
        if shared.is_empty() {
            return None;
        }
        let terms = [(own, 1.0), (first, -1.0)].map(|(of, sign)| {
            let factor = |cell: &Cell| {
                if shared.contains(cell) {
                    sign / shared.len() as f64
                } else {
                    0.0
                }
            };
            Term::of_conditions(of, of.cells.iter().map(factor).collect())
        });
        let blank = self.blank_of_materials(material, key);
        let mut voltages: Vec<usize> = shared.iter().map(|cell| cell.1).collect();
        voltages.sort_unstable();
        voltages.dedup();
        Some(self.answer(&terms, &voltages, false, blank))
    }

    /// A material against the first.
    pub(super) fn blank_of_materials(&self, material: usize, key: &'static str) -> Answer {
        let [own, first] = [material, 0].map(|at| self.conditions.materials[at].as_str());
        Answer {
            against_material: Some(first.to_owned()),
            ..self.blank(Kind::Material, material, key, (own, first))
        }
    }
}
