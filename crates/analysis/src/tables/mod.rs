//! The named tables. A table is one file here and one row in [`TABLES`]: a pure function from what the database holds.

mod conditions_table;
pub mod cycles;
mod electrodes;
mod extended;
mod findings;
mod fits;
mod input;
pub mod model_free;
pub mod moved;
mod of_condition;
mod of_run;
mod of_several;
mod reductions;
mod refused;
mod runs;
mod spread;
mod step_and_spectrum;
pub mod stiffness;
mod table2;
mod table3;
mod table4;
mod table5;
mod table6;

use crate::frequency;
use crate::impedance::sheet;
use crate::models_compared;

pub use ieap_show::{Cell, Column, Content, Measured, Notes, Row, Source, SourceOrigin, Table};
pub use input::TableInput;
pub(crate) use of_condition::{surroundings_text, volts};
pub(crate) use of_several::Runs;
pub use table6::rules;

/// A table that can be asked for.
pub struct NamedTable {
    /// Its name.
    pub name: &'static str,
    /// What it shows, one sentence.
    pub about: &'static str,
    /// Whether its rows are conditions, whose materials may be put together by class.
    pub compares_materials: bool,
    /// Makes it; name, notice and origin are filled in by [`NamedTable::table`].
    make: fn(&TableInput) -> Table,
}

impl NamedTable {
    /// The table of that campaign.
    pub fn table(&self, input: &TableInput) -> Table {
        Table {
            name: self.name.to_owned(),
            notice: input.campaign.notice.clone(),
            origin: input.origin.to_owned(),
            ..(self.make)(input)
        }
    }
}

/// Every table, in the order in which they are listed.
pub const TABLES: [NamedTable; 23] = [
    NamedTable {
        name: "table2",
        about: "What the materials are made of, as campaign.toml states it (the thesis's table 2)",
        compares_materials: false,
        make: table2::make,
    },
    NamedTable {
        name: "table3",
        about: "Parameters of the distributed model, one row a sample (the thesis's table 3)",
        compares_materials: false,
        make: table3::make,
    },
    NamedTable {
        name: "table4",
        about: "Complex modulus before and after each humidity step (the thesis's table 4)",
        compares_materials: false,
        make: table4::make,
    },
    NamedTable {
        name: "table5",
        about: "Parameters of the lumped model by material, environment and voltage (the thesis's table 5)",
        compares_materials: true,
        make: table5::make,
    },
    NamedTable {
        name: "table6",
        about: "What happens in which environment at which voltage, in words (the thesis's table 6)",
        compares_materials: true,
        make: table6::make,
    },
    NamedTable {
        name: "spread",
        about: "Means over repeats with the spread between samples, between runs and the fits' own uncertainty",
        compares_materials: true,
        make: spread::make,
    },
    NamedTable {
        name: "conditions",
        about: "Conditions that were measured, with their runs, samples and total capacitance",
        compares_materials: true,
        make: conditions_table::make,
    },
    NamedTable {
        name: "runs",
        about: "Every run with its tags, state and goodness of fit",
        compares_materials: false,
        make: runs::make,
    },
    NamedTable {
        name: "fits",
        about: "Every run's current fit, all parameters",
        compares_materials: false,
        make: fits::make,
    },
    NamedTable {
        name: "model-free",
        about: "What every step says without a model: peak, time to it, what is lost, charge, strain rate, settling time",
        compares_materials: false,
        make: model_free::make,
    },
    NamedTable {
        name: "energy",
        about: "Electrical energy that went in and came back, elastic energy, efficiency, energy and power density of every step",
        compares_materials: false,
        make: model_free::energy,
    },
    NamedTable {
        name: "cycles",
        about: "Trains cycle by cycle: amplitude, charge in and out, coulombic efficiency, energy, alpha, resistance, with their trends",
        compares_materials: false,
        make: cycles::make,
    },
    NamedTable {
        name: "reductions",
        about: "Where a simpler circuit would do in each run, one branch or none to leak, and what it costs",
        compares_materials: false,
        make: reductions::make,
    },
    NamedTable {
        name: "models",
        about: "Which model describes which material in which environment, as `ieap compare` found it",
        compares_materials: true,
        make: |input| models_compared::view::table(input.compared()),
    },
    NamedTable {
        name: "findings",
        about: "What the model gets wrong in each group of runs, and why",
        compares_materials: false,
        make: findings::make,
    },
    NamedTable {
        name: "electrodes",
        about: "Resistance of the electrodes over time, by the four-point probe, with cracks",
        compares_materials: false,
        make: electrodes::make,
    },
    NamedTable {
        name: "stiffness",
        about: "Alpha split into stiffness and coupling, by modulus logs and blocking forces: which of them a change follows",
        compares_materials: false,
        make: stiffness::make,
    },
    NamedTable {
        name: "impedance",
        about: "Circuits fitted to the impedance spectra, one row a spectrum and circuit",
        compares_materials: false,
        make: |input| sheet::impedance(input.spectra),
    },
    NamedTable {
        name: "circuits",
        about: "Every number of every circuit fitted to the impedance spectra, also of circuits that campaign.toml asks for",
        compares_materials: false,
        make: |input| sheet::circuits(sheet::fits(input.spectra)),
    },
    NamedTable {
        name: "step-and-spectrum",
        about: "A step and a spectrum of the same strip in one likelihood: one set of parameters, and whether both can have it",
        compares_materials: false,
        make: step_and_spectrum::make,
    },
    NamedTable {
        name: "relaxation-times",
        about: "Peaks of the distribution of relaxation times of the impedance spectra, one row a peak",
        compares_materials: false,
        make: |input| sheet::relaxation_times(input.spectra),
    },
    NamedTable {
        name: "frequency",
        about: "Amplitude and phase of current and bending per volt against frequency, of runs under a sine or a chirp",
        compares_materials: false,
        make: |input| frequency::view::table(input.frequency, input.runs),
    },
    NamedTable {
        name: "refused",
        about: "Files and runs that are not in the other tables, with reason and mend",
        compares_materials: false,
        make: refused::make,
    },
];

/// The table of that name.
pub fn named(name: &str) -> Option<&'static NamedTable> {
    TABLES.iter().find(|table| table.name == name)
}
