//! Trains of cycles: one row a cycle.

use ieap_domain::tag::keys;

use super::TableInput;
use super::of_run::{OfRun, Own, of_runs};
use crate::cycles::{CYCLE_FIGURES, Cycle, CycleRun};
use ieap_show::quantities::{Quantity, SAMPLE};
use ieap_show::{Frame, Made, Rough, Sheet};

const CYCLE: Quantity = Quantity::plain("cycle", "Cycle", "number of the cycle");
const START: Quantity = Quantity::new("start_s", "t", "when the cycle begins", "s");
const LOWEST: Quantity = Quantity::new("lowest_v", "V_low", "lowest voltage", "V");
const HIGHEST: Quantity = Quantity::new("highest_v", "V_high", "highest voltage", "V");

type OfCycle<'a> = Own<'a, (&'a CycleRun, &'a Cycle)>;

fn sheet<'a>() -> Sheet<'a, OfCycle<'a>> {
    of_runs("cycles", "Trains, cycle by cycle", 2)
        .remarks(
            "Errors are those of the noise and of where the edges lie, or what neighbouring cycles differ by where that is more.",
            "No run has a train of three cycles or more.",
        )
        .column(CYCLE, |(_, (_, cycle)): &OfCycle| cycle.number)
        .column(SAMPLE, |(run, _)| run.tag(keys::SAMPLE))
        .column(START, |(_, (_, cycle))| Rough(cycle.start_s, 6))
        .column(LOWEST, |(_, (own, _))| Rough(own.voltage_v.0, 4))
        .column(HIGHEST, |(_, (own, _))| Rough(own.voltage_v.1, 4))
        .columns_by_place(&CYCLE_FIGURES, |(_, (_, cycle)), at| cycle.values.get(at).cloned())
}

/// Makes the table.
pub fn make<M: Made>(input: &TableInput) -> M {
    let said = input.cycles.iter().flat_map(|own| {
        let sentences = own.sentences.iter();
        sentences.map(|sentence| format!("{}: {sentence}", own.path))
    });
    let runs = input.by_id();
    let rows = input.cycles.iter().flat_map(|own| {
        let run = runs.run(own.run_id, &own.path);
        own.cycles.iter().map(move |cycle| (run, (own, cycle)))
    });
    sheet().said(said).made(rows)
}

/// The same of a train that no campaign holds.
pub fn frame_alone(train: &CycleRun) -> Frame {
    let of_cycle = |cycle| (OfRun::alone(&train.path), (train, cycle));
    sheet().frame(train.cycles.iter().map(of_cycle))
}
