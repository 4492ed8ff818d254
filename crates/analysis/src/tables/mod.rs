//! The named tables. A table is one file here and one row in [`TABLES`]: a pure function from what the database holds.

mod conditions_table;
pub mod cycles;
mod electrodes;
mod extended;
mod findings;
mod fits;
mod input;
pub mod laws;
mod model_free;
mod monitoring;
pub mod moved;
mod of_condition;
mod of_run;
mod of_several;
mod reductions;
mod refused;
mod runs;
mod runs_used;
mod spread;
mod step_and_spectrum;
pub mod stiffness;
mod table2;
pub mod table3;
mod table4;
mod table5;
mod table6;

use crate::dma;
use crate::frequency;
use crate::impedance::sheet;
use crate::models_compared;
use crate::study;

pub use ieap_show::{Cell, Column, Content, Measured, Notes, Row, Source, SourceOrigin, Table};
use ieap_show::{Frame, frame_of};
pub use input::TableInput;
pub(crate) use of_several::Runs;
pub use table6::rules;

/// What a table is made from beside what is read of the database for every one: it takes long, and is made for those that ask.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// Nothing.
    None,
    /// The readings of all runs.
    Readings,
    /// Current and bending of all runs after their steps.
    Curves,
    /// Every run fitted with other circuits.
    Reductions,
    /// Steps fitted together with spectra.
    OneLikelihood,
    /// What is watched over the life of the samples.
    Monitoring,
}

/// A table that can be asked for.
pub struct NamedTable {
    /// Its name.
    pub name: &'static str,
    /// What it shows, one sentence.
    pub about: &'static str,
    /// Whether its rows are conditions, whose materials may be put together by class.
    pub compares_materials: bool,
    /// What must be made for it.
    pub needs: Need,
    /// Makes it; name, notice and origin are filled in by [`NamedTable::table`].
    make: Make,
}

/// How a table is made.
enum Make {
    /// For people; programs have the numbers of what is shown.
    Shown(fn(&TableInput) -> Table),
    /// For people, and with further columns for files: `ieap export` writes it.
    Written(fn(&TableInput) -> Table, fn(&TableInput) -> Frame),
}

impl NamedTable {
    const fn new(name: &'static str, about: &'static str, make: fn(&TableInput) -> Table) -> NamedTable {
        NamedTable::made(name, about, Make::Shown(make))
    }

    const fn written(
        name: &'static str,
        about: &'static str,
        table: fn(&TableInput) -> Table,
        frame: fn(&TableInput) -> Frame,
    ) -> NamedTable {
        NamedTable::made(name, about, Make::Written(table, frame))
    }

    const fn made(name: &'static str, about: &'static str, make: Make) -> NamedTable {
        NamedTable {
            name,
            about,
            compares_materials: false,
            needs: Need::None,
            make,
        }
    }

    const fn comparing_materials(self) -> NamedTable {
        NamedTable {
            compares_materials: true,
            ..self
        }
    }

    const fn needing(self, needs: Need) -> NamedTable {
        NamedTable { needs, ..self }
    }

    /// The table of that campaign.
    pub fn table(&self, input: &TableInput) -> Table {
        Table {
            name: self.name.to_owned(),
            notice: input.campaign.notice.clone(),
            origin: input.origin.to_owned(),
            ..match self.make {
                Make::Shown(make) => make(input),
                Make::Written(table, _) => table(input),
            }
        }
    }

    /// All its columns, numbers in full, for programs.
    pub fn frame(&self, input: &TableInput) -> Frame {
        match self.make {
            Make::Shown(make) => frame_of(&make(input)),
            Make::Written(_, frame) => frame(input),
        }
    }

    /// Whether `ieap export` writes it: it has columns for files.
    pub fn is_written(&self) -> bool {
        matches!(self.make, Make::Written(..))
    }
}

/// Every table, in the order in which they are listed: a row here is all that one needs beside its file.
#[rustfmt::skip]
pub const TABLES: &[NamedTable] = &[
    NamedTable::new("table2", "What the materials are made of, as campaign.toml states it (the thesis's table 2)", table2::make),
    NamedTable::new("table3", "Parameters of the distributed model, one row a sample (the thesis's table 3)", table3::make),
    NamedTable::new("table4", "Complex modulus before and after each humidity step (the thesis's table 4)", table4::make),
    NamedTable::new("table5", "Parameters of the lumped model by material, environment and voltage (the thesis's table 5)", table5::make).comparing_materials(),
    NamedTable::new("table6", "What happens in which environment at which voltage, in words (the thesis's table 6)", table6::make).comparing_materials(),
    NamedTable::new("contrasts", "What environment, humidity, voltage and material do to each parameter: ratios with intervals, laws, what is alike", |input| study::view::table(&input.study().answers)).needing(Need::Curves),
    NamedTable::new("spread", "Means over repeats with the spread between samples, between runs and the fits' own uncertainty", spread::make).comparing_materials(),
    NamedTable::written("conditions", "Conditions that were measured: runs, mean and spread of each parameter", conditions_table::make, conditions_table::make).comparing_materials(),
    NamedTable::written("runs", "Every run: tags, state, files, goodness of fit", runs::make, runs::make),
    NamedTable::written("tags", "Tags of the runs and their sources", runs::tags, runs::tags),
    NamedTable::written("fits", "Every number of the current fits", fits::make, fits::make),
    NamedTable::written("fits-wide", "Current fits, parameters side by side", fits::wide, fits::wide),
    NamedTable::written("model-free", "What every step says without a model: peak, loss, charge, strain rate, settling time", model_free::make, model_free::make).needing(Need::Readings),
    NamedTable::new("energy", "Electrical energy that went in and came back, elastic energy, efficiency, energy and power density of every step", model_free::energy).needing(Need::Readings),
    NamedTable::written("cycles", "Trains cycle by cycle: amplitude, charge, efficiency, energy, alpha, resistance, trends", cycles::make, cycles::make).needing(Need::Readings),
    NamedTable::new("reductions", "Where a simpler circuit would do in each run, one branch or none to leak, and what it costs", reductions::make).needing(Need::Reductions),
    NamedTable::new("models", "Which model describes which material in which environment, as `ieap compare` found it", |input| models_compared::view::table(input.compared())).comparing_materials(),
    NamedTable::written("findings", "What the model gets wrong in each group of runs and each run, and why", findings::make, findings::make),
    NamedTable::written("laws", "By which factor a parameter goes over humidity, voltage, temperature, use: of the strips measured and of their material", laws::make, laws::make).needing(Need::Curves),
    NamedTable::written("monitoring", "Parameters over the life of each sample", monitoring::make, monitoring::make).needing(Need::Monitoring),
    NamedTable::written("dma", "Every number of the modulus logs", dma::table::make, dma::table::make),
    NamedTable::new("runs-used", "Every law, contrast, fit of a group and diagnosis with the runs that it is made from, and why others were left out", runs_used::make),
    NamedTable::new("electrodes", "Resistance of the electrodes over time, by the four-point probe, with cracks", electrodes::make),
    NamedTable::new("stiffness", "Alpha split into stiffness and coupling, by modulus logs and blocking forces: which of them a change follows", stiffness::make),
    NamedTable::new("impedance", "Circuits fitted to the impedance spectra, one row a spectrum and circuit", |input| sheet::impedance(input.spectra)),
    NamedTable::new("circuits", "Every number of every circuit fitted to the impedance spectra, also of circuits that campaign.toml asks for", |input| sheet::circuits(sheet::fits(input.spectra))),
    NamedTable::new("step-and-spectrum", "A step, a spectrum and the force of the same strip in one likelihood: one set of parameters, and whether all can have it", step_and_spectrum::make).needing(Need::OneLikelihood),
    NamedTable::new("relaxation-times", "Peaks of the distribution of relaxation times of the impedance spectra, one row a peak", |input| sheet::relaxation_times(input.spectra)),
    NamedTable::new("frequency", "Amplitude and phase of current and bending per volt against frequency, of runs under a sine or a chirp", |input| frequency::view::table(input.frequency, input.runs)),
    NamedTable::new("refused", "Files and runs that are not in the other tables, with reason and mend", refused::make),
];

/// The table of that name.
pub fn named(name: &str) -> Option<&'static NamedTable> {
    TABLES.iter().find(|table| table.name == name)
}

#[cfg(test)]
mod tests;
