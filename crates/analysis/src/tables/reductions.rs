//! Where a simpler circuit would do: one row for each circuit of each run.

use ieap_domain::tag::keys;

use super::TableInput;
use super::of_run::of_runs_and_what;
use crate::reductions::ReducedCircuit;
use ieap_show::quantities::{Quantity, VOLTAGE};
use ieap_show::{Table, Value};

const REMARK: &str = "Each circuit is fitted to both responses at once and held against two branches beside R_ss. It is enough where the readings have nothing against it (p 0.05 or more); by how much its current and curvature differ from the full circuit's is the root mean square in percent of their range. R_a, R_b and C are the elements of figure 7F of the thesis, which has the same impedance as one branch beside R_ss (7G).";

/// A chance below this is told as this: tails that far out are those of the formula, not of readings.
const LEAST_CHANCE: f64 = 1e-9;

const CIRCUIT: Quantity = Quantity::plain("circuit", "Circuit", "circuit");
const ENOUGH: Quantity = Quantity::plain("is_enough", "Enough", "whether it is enough");
const SAVES: Quantity = Quantity::plain("parameters_saved", "saves", "parameters saved");
const CURRENT: Quantity = Quantity::new(
    "current_differs_percent",
    "current",
    "difference of the current from the full circuit's",
    "%",
);
const CURVATURE: Quantity = Quantity::new(
    "curvature_differs_percent",
    "curvature",
    "difference of the curvature from the full circuit's",
    "%",
);
const RISE: Quantity = Quantity::plain("chi_square_rise", "Δχ²", "rise of the weighted sum of squares");
const CHANCE: Quantity = Quantity::plain("p", "p", "chance of such a rise");
const ELEMENTS: [Quantity; 3] = [
    Quantity::new("ra_ohm_cm2", "Rₐ", "resistor before, figure 7F", "Ω cm²"),
    Quantity::new("rb_ohm_cm2", "R_b", "leak of the capacitor, figure 7F", "Ω cm²"),
    Quantity::new("one_branch_f_per_cm2", "C", "capacitance, figure 7F", "F cm⁻²"),
];

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    // A circuit, or why there is none.
    type Reduced<'a> = Result<&'a ReducedCircuit, &'a String>;
    fn told<V: Into<Value>>(own: &Reduced, of: impl Fn(&ReducedCircuit) -> V) -> Value {
        own.map_or(Value::Missing, |circuit| of(circuit).into())
    }
    let rough = |number: Option<f64>, digits| number.map(|number| Value::Rough(number, digits));
    let sheet = of_runs_and_what::<Reduced>("reductions", "Where a simpler circuit would do")
        .remarks(REMARK, "No run steps its voltage and has a current.")
        .column(VOLTAGE, |(run, _)| run.number(keys::VOLTAGE_V))
        .column(CIRCUIT, |(_, own)| match own {
            Ok(circuit) => Value::from(circuit.circuit),
            Err(why) => Value::Missing.noted([why.to_string()]),
        })
        .column(ENOUGH, |(_, own)| {
            told(own, |circuit| if circuit.is_enough() { "yes" } else { "no" })
        })
        .column(SAVES, |(_, own)| told(own, |circuit| circuit.parameters_saved))
        .column(CURRENT, move |(_, own)| {
            told(own, |circuit| rough(Some(circuit.current_differs_percent), 2))
        })
        .column(CURVATURE, move |(_, own)| {
            told(own, |circuit| rough(circuit.curvature_differs_percent, 2))
        })
        .column(RISE, move |(_, own)| {
            told(own, |circuit| rough(Some(circuit.chi_square_rise), 3))
        })
        .column(CHANCE, move |(_, own)| {
            told(own, |circuit| rough(Some(circuit.p.max(LEAST_CHANCE)), 2))
        })
        .columns_by_place(&ELEMENTS, move |(_, own), at| {
            told(own, |circuit| {
                rough(circuit.series_elements().map(|all| all[at]), 4)
            })
        });
    let runs = input.by_id();
    sheet.over(input.reductions.iter().flat_map(|own| {
        let run = runs.run(own.run_id, &own.path);
        let circuits: Vec<Reduced> = match &own.found {
            Ok(found) => found.iter().map(Ok).collect(),
            Err(why) => vec![Err(why)],
        };
        circuits.into_iter().map(move |circuit| (run, circuit))
    }))
}
