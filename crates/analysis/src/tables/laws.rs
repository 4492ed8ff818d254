//! Laws across runs: which parameter follows what, by which law, with its coefficient where it is claimed.

use super::TableInput;
use crate::laws::shape::{Law, form};
use crate::laws::{Covariate, Dependence, words};
use crate::parameters::ParameterInfo;
use ieap_show::quantities::{MATERIAL, Quantity, RUNS, SAMPLES};
use ieap_show::{Rough, Sheet, Table, Value};

const PARAMETER: Quantity = Quantity::plain("parameter", "Parameter", "parameter");
const COVARIATE: Quantity = Quantity::plain("covariate", "x", "what it may follow");
const STANDING: Quantity = Quantity::plain("standing", "Standing", "whether it is claimed");
const FORM: Quantity = Quantity::plain("law", "Law", "form of the law");
const COEFFICIENT: Quantity = Quantity::plain("coefficient", "b", "coefficient of the law");
const COEFFICIENT_UNIT: Quantity =
    Quantity::plain("coefficient_unit", "Unit of b", "unit of the coefficient");
const BEND: Quantity = Quantity::plain(
    "bend",
    "c",
    "threshold, knee, step or time constant, in the unit of x",
);
const START: Quantity = Quantity::plain("start", "a", "value at the low end, of the mean sample");
const START_UNIT: Quantity = Quantity::plain("start_unit", "Unit of a", "unit of the value");
const LOW: Quantity = Quantity::plain("low", "x₀", "low end of x");
const HIGH: Quantity = Quantity::plain("high", "x₁", "high end of x");
const UNIT: Quantity = Quantity::plain("unit", "Unit of x", "unit of x");
const Q: Quantity = Quantity::plain("q_value", "q", "false discovery rate at which it is claimed");
const REMARK: &str = "b stands only where a law is claimed; of the others a footnote says why not. Confounded: it changes, and x may be another covariate. Laws hold between x₀ and x₁. Samples of another length than stated, and failures that are not at random, stand in `ieap export --what laws`.";

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let laws = input.laws.into_iter().flat_map(|laws| &laws.dependences);
    let of_claimed = |found: &Dependence| found.span.filter(|_| found.stated().is_some());
    Sheet::<&Dependence>::new("laws", "Laws across runs", 3)
        .remarks(
            REMARK,
            "No question across runs can be asked: nothing that a parameter may follow differs among the fitted runs, or too few of them state it.",
        )
        .column(MATERIAL, |found| found.material.as_str())
        .column(PARAMETER, |found| words::symbol(&found.parameter).to_owned())
        .column(COVARIATE, |found| found.covariate.label())
        .column(STANDING, |found| standing(found))
        .column(FORM, |found| {
            let (law, _) = found.stated()?;
            Some(form(
                law,
                words::symbol(&found.parameter),
                symbol(found.covariate),
                found.is_log,
            ))
        })
        .column(COEFFICIENT, |found| match found.stated() {
            Some((_, coefficient)) => Value::from(coefficient.estimate()),
            None => Value::Missing.noted([words::sentence(found)]),
        })
        .column(COEFFICIENT_UNIT, |found| {
            unit(found).filter(|unit| !unit.is_empty())
        })
        .column(BEND, |found| {
            of_claimed(found)?;
            found.laws.first()?.bend_at.map(|at| at.estimate())
        })
        .column(START, move |found| {
            of_claimed(found)?;
            let start = if found.is_log {
                found.start.exp()
            } else {
                found.start
            };
            Some(Rough(
                start * ParameterInfo::of(&found.parameter)?.shown_factor,
                3,
            ))
        })
        .column(START_UNIT, move |found| {
            of_claimed(found)?;
            Some(ParameterInfo::of(&found.parameter)?.shown_unit)
        })
        .column(LOW, |found| found.span.map(|span| Rough(span.low, 3)))
        .column(HIGH, |found| found.span.map(|span| Rough(span.high, 3)))
        .column(UNIT, |found| {
            Some(found.covariate.unit()).filter(|unit| !unit.is_empty())
        })
        .column(Q, |found| Rough(found.q, 2))
        .column(RUNS, |found| found.runs)
        .column(SAMPLES, |found| found.samples.len())
        .over(laws)
}

/// `claimed`, `confounded` where what it follows may be another covariate, or `open`.
fn standing(found: &Dependence) -> Value {
    match (found.is_claimed(), found.confounded_with.is_empty()) {
        (false, _) => Value::from("open"),
        (true, true) => Value::from("claimed"),
        (true, false) => Value::from("confounded").noted([words::sentence(found)]),
    }
}

fn symbol(covariate: Covariate) -> &'static str {
    match covariate {
        Covariate::RelativeHumidity => "RH",
        Covariate::Temperature => "T",
        _ => "x",
    }
}

/// Unit of the coefficient: of a part or a logarithm per unit of x; of the parameter itself where it may be negative.
fn unit(found: &Dependence) -> Option<String> {
    let (law, _) = found.stated()?;
    let of = match (law, found.covariate.unit()) {
        (Law::Exponential | Law::Linear | Law::Threshold | Law::Knee, "% RH") => "%⁻¹".to_owned(),
        (Law::Exponential | Law::Linear | Law::Threshold | Law::Knee, of) if !of.is_empty() => {
            format!("({of})⁻¹")
        }
        (Law::SquareRoot, of) if !of.is_empty() => format!("({of})^-½"),
        _ => String::new(),
    };
    let info = ParameterInfo::of(&found.parameter).filter(|_| !found.is_log);
    Some(
        format!("{} {of}", info.map_or("", |info| info.unit))
            .trim()
            .to_owned(),
    )
}
