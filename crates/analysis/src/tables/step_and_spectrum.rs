//! A step and a spectrum of one strip in one likelihood: three rows a pair, the step, the spectrum, and both.

use ieap_domain::tag::keys;
use ieap_domain::{Estimate, RunRecord};

use super::TableInput;
use super::of_run::{OfRun, Own};
use super::of_several::contribution;
use crate::impedance::{Both, OneLikelihood};
use crate::laws::doubt::Doubts;
use crate::parameters::ParameterInfo;
use ieap_show::quantities::{Quantity, RUN, SAMPLE, VOLTAGE};
use ieap_show::{Sheet, Table, Value};

/// What is shown of each.
const SHOWN: [&str; 9] = [
    "r1_ohm_cm2",
    "c1_f_per_cm2",
    "r2_ohm_cm2",
    "c2_f_per_cm2",
    "rss_ohm_cm2",
    "c_total_f_per_cm2",
    "r_parallel_ohm_cm2",
    "alpha_per_c_cm",
    "lambda_per_s",
];

const REMARK: &str = "Both: one circuit for the readings of the step and of the spectrum, each weighted by its noise; that of the spectrum is what the same circuit leaves of it alone. p: chance of a difference as large where both have one circuit; below 0.05 the numbers of both are those of no strip. Steps at the lowest voltage, at which they are nearest to a spectrum.";
const SPECTRUM: Quantity = Quantity::plain("spectrum", "Spectrum", "run of the spectrum");
const FROM: Quantity = Quantity::plain("from", "From", "what tells");
const AGREES: Quantity = Quantity::plain("agrees", "One circuit", "whether both can have one circuit");
const P: Quantity = Quantity::plain("p", "p", "chance of a difference as large");

/// What tells, the verdict where it is both, and its numbers.
struct Told<'a> {
    own: &'a OneLikelihood,
    from: &'static str,
    both: Option<&'a Result<Both, String>>,
    numbers: [Option<Estimate>; SHOWN.len()],
}

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    type Of<'a> = Own<'a, Told<'a>>;
    let known = SHOWN.into_iter().filter_map(ParameterInfo::of);
    let shown: Vec<Quantity> = known.map(ParameterInfo::quantity).collect();
    Sheet::<Of>::new("step-and-spectrum", "Steps and spectra in one likelihood", 2)
        .remarks(
            REMARK,
            "No spectrum has a step of the same sample and condition beside it.",
        )
        .called(|(_, told)| format!("{}, {}, {}", told.own.path, told.own.spectrum, told.from))
        .made_from(|(run, _)| run.sources())
        .column(RUN.called("Step", "run of the step"), |(_, told)| {
            told.own.path.as_str()
        })
        .column(SPECTRUM, |(_, told)| told.own.spectrum.as_str())
        .column(SAMPLE, |(run, _)| run.tag(keys::SAMPLE))
        .column(VOLTAGE, |(run, _)| run.number(keys::VOLTAGE_V))
        .column(FROM, |(_, told)| told.from)
        .column(AGREES, |(_, told)| match told.both {
            Some(Ok(both)) => Value::from(if both.agrees() { "yes" } else { "no" }),
            Some(Err(why)) => Value::Missing.noted([why.clone()]),
            None => Value::Missing,
        })
        .column(P, |(_, told)| match told.both {
            Some(Ok(both)) => Value::Rough(both.p, 2),
            _ => Value::Missing,
        })
        .columns_by_place(&shown, |(_, told), at| told.numbers[at].as_ref().map(Value::from))
        .over(input.one_likelihood.iter().flat_map(|own| {
            let run = OfRun::new(input.of_runs(), own.run_id, &own.path);
            told(input.doubts, own, run.record).map(|told| (run, told))
        }))
}

fn told<'a>(doubts: &'a Doubts, own: &'a OneLikelihood, run: Option<&'a RunRecord>) -> [Told<'a>; 3] {
    let of_step = move |key: &str| {
        let estimate = contribution(doubts, run?, key).estimate.ok()?;
        Some(estimate.into_owned())
    };
    let of_spectrum = |key: &str| {
        let found = own.of_spectrum.iter().find(|(known, _)| *known == key);
        found.map(|(_, estimate)| estimate.clone())
    };
    let of_both = |key: &str| {
        let mut found = own.both.as_ref().ok()?.parameters.iter();
        let found = found.find(|own| own.key == key);
        found.map(|own| own.estimate.clone())
    };
    let told = |from, both, numbers| Told {
        own,
        from,
        both,
        numbers,
    };
    [
        told("step", None, SHOWN.map(of_step)),
        told("spectrum", None, SHOWN.map(of_spectrum)),
        told("both", Some(&own.both), SHOWN.map(of_both)),
    ]
}
