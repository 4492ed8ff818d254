//! Laws: by which factor a parameter goes over the range of what it follows, of the strips measured and of their material.

use super::TableInput;
use crate::study::{Answer, InScope, Study, in_short, symbol};
use ieap_domain::Estimate;
use ieap_domain::number::significant;
use ieap_show::quantities::{MATERIAL, Quantity, RUNS, SAMPLES};
use ieap_show::{Rough, Sheet, Table, Value};

const KIND: Quantity = Quantity::plain("question", "Question", "what is asked");
const PARAMETER: Quantity = Quantity::plain("parameter", "Parameter", "parameter");
const FOLLOWS: Quantity = Quantity::plain("x", "x", "what it follows");
const SHOWN: Quantity = Quantity::plain("shown", "shown", "what is shown");
const FACTOR: Quantity = Quantity::plain(
    "factor",
    "from x₀ to x₁",
    "factor, or points, over the range of x",
);
const INTERVAL: Quantity = Quantity::plain("interval_95", "95 %", "its 95 % interval");
const SCOPE: Quantity = Quantity::plain("scope", "of", "of whom it is told");
const OF_MATERIAL: Quantity = Quantity::plain(
    "of_material",
    "of the material",
    "95 % interval of the same told of the material: strips differ by chance",
);
const LOW: Quantity = Quantity::plain("low", "x₀", "low end of x");
const HIGH: Quantity = Quantity::plain("high", "x₁", "high end of x");
const UNIT: Quantity = Quantity::plain("unit", "Unit of x", "unit of x");
const Q: Quantity = Quantity::plain(
    "q_value",
    "q",
    "false-discovery rate at which it would be claimed",
);
const STRIPS: Quantity = Quantity::plain(
    "single_strips",
    "in single strips",
    "the least and the largest of the strips' own",
);
const ALSO: Quantity = Quantity::plain(
    "also_changed",
    "changed with it",
    "what else changed with it, so that it may be the cause",
);
const REMARK: &str = "By one mixed model a parameter: x is followed by the same factor for every unit. Of two materials the factor of one over that of the other. Points are of bending lost in an hour. Intervals are 95 %.";

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    of(&input.study())
}

/// The same of a study that is known.
pub fn of(study: &Study) -> Table {
    Sheet::<&Answer>::new("laws", "Laws", 3)
        .remarks(
            REMARK,
            "No law can be asked for: nothing that a parameter may follow was measured at enough places, or nothing tells the scatter from run to run.",
        )
        .column(KIND, |own| own.kind.label())
        .column(MATERIAL, |own| match &own.against_material {
            Some(other) if own.kind.is_by_material() => format!("{} / {other}", own.material),
            _ => own.material.clone(),
        })
        .column(PARAMETER, |own| symbol(own.parameter).to_owned())
        .column(FOLLOWS, |own| {
            let names = [own.upper.as_str(), own.lower.as_str()].join(" over ");
            names.trim_end_matches(" over ").to_owned()
        })
        .column(SHOWN, |own| in_short(own))
        .column(FACTOR, |own| Value::from(factor(own)))
        .column(INTERVAL, |own| ends(&factor(own)))
        .column(SCOPE, |own| own.scope.label())
        .column(OF_MATERIAL, |own| {
            let of: &InScope = own.of_material.as_ref()?;
            ends(&estimate(own, [of.value, of.low_95, of.high_95].map(Some)))
        })
        .column(STRIPS, |own| {
            let (least, largest) = own.strips_from_to?;
            let of = |number| significant(own.over_all(number), 2);
            Some(format!("{} to {}", of(least), of(largest)))
        })
        .column(LOW, |own| own.from_to.map(|ends| Rough(ends.0, 3)))
        .column(HIGH, |own| own.from_to.map(|ends| Rough(ends.1, 3)))
        .column(UNIT, |own| Some(own.unit()).filter(|unit| !unit.is_empty()))
        .column(Q, |own| own.q.map(|q| Rough(q, 2)))
        .column(RUNS, |own| own.of_runs.len())
        .column(SAMPLES, |own| own.samples)
        .column(ALSO, |own| own.also_changed.join("; "))
        .over(study.laws())
}

fn ends(of: &Estimate) -> Option<String> {
    let (low, high) = of.low_95.zip(of.high_95)?;
    Some(format!("{} to {}", significant(low, 3), significant(high, 3)))
}

fn factor(own: &Answer) -> Estimate {
    estimate(own, [own.value, own.low_95, own.high_95])
}

/// A law over the range of what it follows.
fn estimate(own: &Answer, numbers: [Option<f64>; 3]) -> Estimate {
    let [value, low_95, high_95] = numbers.map(|number| number.map(|number| own.over_all(number)));
    Estimate {
        value,
        low_95,
        high_95,
        ..Estimate::default()
    }
}
