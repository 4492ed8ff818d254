//! Trains of cycles: one row a cycle.

use ieap_domain::tag::keys;

use super::TableInput;
use super::of_run::{OfRun, of_runs};
use crate::cycles::{CYCLE_FIGURES, Cycle, CycleRun};
use ieap_show::quantities::{Quantity, SAMPLE};
use ieap_show::{Table, Value};

const CYCLE: Quantity = Quantity::plain("cycle", "Cycle", "number of the cycle");
const START: Quantity = Quantity::new("start_s", "t", "when the cycle begins", "s");
const LOWEST: Quantity = Quantity::new("lowest_v", "V_low", "lowest voltage", "V");
const HIGHEST: Quantity = Quantity::new("highest_v", "V_high", "highest voltage", "V");

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    type OfCycle<'a> = (&'a CycleRun, &'a Cycle);
    let sheet = of_runs::<OfCycle>("cycles", "Trains, cycle by cycle", 2)
        .remarks(
            "Errors are those of the noise and of where the edges lie, or what neighbouring cycles differ by where that is more.",
            "No run has a train of three cycles or more.",
        )
        .column(CYCLE, |(_, (_, cycle))| cycle.number)
        .column(SAMPLE, |(run, _)| run.tag(keys::SAMPLE).map(Value::from))
        .column(START, |(_, (_, cycle))| Value::Rough(cycle.start_s, 6))
        .column(LOWEST, |(_, (own, _))| Value::Rough(own.voltage_v.0, 4))
        .column(HIGHEST, |(_, (own, _))| Value::Rough(own.voltage_v.1, 4))
        .columns_by_place(&CYCLE_FIGURES, |(_, (_, cycle)), at| {
            cycle.values.get(at).map(Value::from)
        });
    let cycles = input.cycles.iter().flat_map(|own| {
        let run = OfRun::new(input, own.run_id, &own.path);
        own.cycles.iter().map(move |cycle| (run, (own, cycle)))
    });
    let said = input.cycles.iter().flat_map(|own| {
        let sentences = own.sentences.iter();
        sentences.map(|sentence| format!("{}: {sentence}", own.path))
    });
    sheet.said(said).over(cycles)
}
