//! Sheets whose rows are each of a condition.

use super::TableInput;
use super::extended::shared_notes;
use super::of_several::Runs;
use crate::conditions::{Condition, Conditions, Surroundings, volts};
use ieap_show::quantities::{ENVIRONMENT, HUMIDITY, MATERIAL, VOLTAGE};
use ieap_show::{Printed, Sheet, Value};

/// The condition that a row is of.
#[derive(Clone)]
pub struct OfCondition<'a> {
    conditions: &'a Conditions,
    condition: &'a Condition,
    /// Its runs.
    pub runs: Runs<'a>,
}

/// Of a condition, and what else a row is made from.
pub type Own<'a, X> = (OfCondition<'a>, X);

impl<'a> OfCondition<'a> {
    /// One of the conditions.
    pub fn new(
        input: &TableInput<'a>,
        conditions: &'a Conditions,
        condition: &'a Condition,
    ) -> OfCondition<'a> {
        OfCondition {
            conditions,
            condition,
            runs: Runs::new(input, condition.runs.as_slice()),
        }
    }

    /// Its surroundings.
    pub fn surroundings(&self) -> &'a Surroundings {
        &self.conditions.surroundings[self.condition.surroundings]
    }

    /// Its material.
    pub fn material(&self) -> &'a str {
        &self.conditions.materials[self.condition.material]
    }

    fn voltage_v(&self) -> f64 {
        self.conditions.voltages_v[self.condition.voltage]
    }

    /// `CNaf, air, 2.0 V`
    pub fn label(&self) -> String {
        let surroundings = self.surroundings().text();
        format!("{}, {surroundings}, {}", self.material(), volts(self.voltage_v()))
    }
}

/// A sheet that begins with the condition.
pub fn of_conditions<'s, 'a: 's, X: 's>(
    name: &'static str,
    stub: usize,
    title: &'static str,
) -> Sheet<'s, Own<'a, X>> {
    of_surroundings(Sheet::<Own<X>>::new(name, title, stub).column(MATERIAL, |(of, _)| of.material()))
}

/// The surroundings and the voltage, after what a sheet has of its own; every row is called by its condition.
pub fn of_surroundings<'s, 'a: 's, X: 's>(sheet: Sheet<'s, Own<'a, X>>) -> Sheet<'s, Own<'a, X>> {
    sheet
        .called(|(of, _)| of.label())
        .made_from(|(of, _)| of.runs.sources())
        .column(ENVIRONMENT, |(of, _)| of.surroundings().environment.clone())
        .column(HUMIDITY, |(of, _)| of.surroundings().humidity_text())
        .column(VOLTAGE, |(of, _)| {
            let noted = Value::from(of.voltage_v()).noted(shared_notes(&of.runs));
            Printed(of.voltage_v(), noted)
        })
}
