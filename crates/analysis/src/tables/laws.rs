//! Laws: by which factor a parameter goes over the range of what it follows, of the strips measured and of their material.

use super::TableInput;
use crate::json_rows::list;
use crate::study::{Answer, InScope, Study, Verdict, in_short, sentence, symbol};
use ieap_show::quantities::{MATERIAL, Quantity, RUNS, SAMPLES};
use ieap_show::{Made, Printed, Rough, Sheet};

/// Digits of a number, and of a chance.
const DIGITS: (i32, i32) = (3, 2);

const KIND: Quantity = Quantity::plain("question", "Question", "what is asked");
const PARAMETER: Quantity = Quantity::plain("parameter", "Parameter", "parameter");
const FOLLOWS: Quantity = Quantity::plain("follows", "x", "what it follows");
const VERDICT: Quantity = Quantity::plain("verdict", "shown", "what is shown");
const CHANGE: [Quantity; 3] = [
    Quantity::plain(
        "change",
        "from x₀ to x₁",
        "factor, or points, over the range of x",
    ),
    Quantity::plain("change_low_95", "95 % from", "lower end of its 95 % interval"),
    Quantity::plain("change_high_95", "to", "upper end of its 95 % interval"),
];
const SCOPE: Quantity = Quantity::plain("scope", "of", "of whom it is told");
const OF_MATERIAL: [Quantity; 2] = [
    Quantity::plain(
        "change_of_material_low_95",
        "of the material from",
        "lower end of the 95 % interval of the same told of the material: strips differ by chance",
    ),
    Quantity::plain(
        "change_of_material_high_95",
        "to",
        "upper end of the 95 % interval of the same told of the material",
    ),
];
const STRIPS: [Quantity; 2] = [
    Quantity::plain(
        "change_of_strips_least",
        "in single strips from",
        "the least of the strips' own",
    ),
    Quantity::plain("change_of_strips_largest", "to", "the largest of the strips' own"),
];
const LOW: Quantity = Quantity::plain("low_end", "x₀", "low end of x");
const HIGH: Quantity = Quantity::plain("high_end", "x₁", "high end of x");
const UNIT: Quantity = Quantity::plain("unit", "Unit of x", "unit of x");
const Q: Quantity = Quantity::plain("q", "q", "false-discovery rate at which it would be claimed");
const ALSO: Quantity = Quantity::plain(
    "also_changed",
    "changed with it",
    "what else changed with it, so that it may be the cause",
);
const REMARK: &str = "By one mixed model a parameter: x is followed by the same factor for every unit. Of two materials the factor of one over that of the other. Points are of bending lost in an hour. Intervals are 95 %.";

/// Makes the table.
pub fn make<M: Made>(input: &TableInput) -> M {
    of(&input.study())
}

/// The same of a study that is known.
pub fn of<M: Made>(study: &Study) -> M {
    fn of_material<V>(own: &Answer, read: fn(&InScope) -> V) -> Option<V> {
        own.of_material.as_ref().map(read)
    }
    let rough = |number: Option<f64>| number.map(|number| Rough(number, DIGITS.0));
    let chance = |number: Option<f64>| number.map(|number| Rough(number, DIGITS.1));
    let over = move |own: &Answer, number: Option<f64>| rough(number.map(|number| own.over_all(number)));
    Sheet::<&Answer>::new("laws", "Laws", 3)
        .remarks(
            REMARK,
            "No law can be asked for: nothing that a parameter may follow was measured at enough places, or nothing tells the scatter from run to run.",
        )
        .column(KIND, |own| Printed(own.kind.key(), own.kind.label().into()))
        .column(MATERIAL, |own| {
            let other = own.against_material.as_ref().filter(|_| own.kind.is_by_material());
            let words = other.map_or(own.material.clone(), |other| format!("{} / {other}", own.material));
            Printed(own.material.as_str(), words.into())
        })
        .column(PARAMETER, |own| Printed(own.parameter, symbol(own.parameter).into()))
        .column(FOLLOWS, |own| {
            let names = [own.upper.as_str(), own.lower.as_str()].join(" over ");
            Printed(own.upper.as_str(), names.trim_end_matches(" over ").into())
        })
        .in_files(|sheet| {
            sheet
                .plain("against_material", |own| own.against_material.clone())
                .plain("covariate", |own| own.covariate.unwrap_or("voltage_v"))
                .plain("over", |own| (!own.lower.is_empty()).then(|| own.lower.clone()))
                .plain("claimed", |own| own.verdict == Verdict::Differs)
                .plain("certainty", |own| own.certainty.key())
        })
        .column(VERDICT, |own| in_short(own))
        .columns_by_place(&CHANGE, move |own, at| {
            over(own, [own.value, own.low_95, own.high_95][at])
        })
        .column(SCOPE, |own| Printed(own.scope.key(), own.scope.label().into()))
        .columns_by_place(&OF_MATERIAL, move |own, at| {
            let ends = of_material(own, |law| [law.low_95, law.high_95]);
            over(own, ends.map(|ends| ends[at]))
        })
        .columns_by_place(&STRIPS, move |own, at| {
            over(own, own.strips_from_to.map(|(least, largest)| [least, largest][at]))
        })
        .column(LOW, move |own| rough(own.from_to.map(|ends| ends.0)))
        .column(HIGH, move |own| rough(own.from_to.map(|ends| ends.1)))
        .column(UNIT, |own| Some(own.unit()).filter(|unit| !unit.is_empty()))
        .column(Q, move |own| chance(own.q))
        .column(RUNS, |own| own.of_runs.len())
        .column(SAMPLES, |own| own.samples)
        .column(ALSO, |own| list(&own.also_changed, "; "))
        .in_files(|sheet| {
            sheet
                .plain("scale", |own| own.scale.key())
                .plain("per_unit", |own| own.value)
                .plain("per_unit_low_95", |own| own.low_95)
                .plain("per_unit_high_95", |own| own.high_95)
                .plain("p", |own| own.p)
                .plain("of_material", |own| of_material(own, |law| law.value))
                .plain("of_material_low_95", |own| of_material(own, |law| law.low_95))
                .plain("of_material_high_95", |own| of_material(own, |law| law.high_95))
                .plain("of_material_q", |own| own.of_material.as_ref()?.q)
                .plain("strips_differ_p", |own| own.strips_differ_p)
                .plain("sentence", |own| sentence(own))
        })
        .made(study.laws())
}
