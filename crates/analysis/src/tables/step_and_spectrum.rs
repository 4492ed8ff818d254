//! A step, a spectrum and the force of one strip in one likelihood: a row of each, and one of all together.

use ieap_domain::Estimate;
use ieap_domain::tag::keys;

use super::TableInput;
use super::of_run::Own;
use super::of_several::contribution;
use crate::impedance::{Both, OneLikelihood};
use crate::stiffness::PER_CHARGE;
use ieap_domain::ParameterInfo;
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

const REMARK: &str = "Both: one circuit for the readings of the step and of the spectrum, each weighted by its noise; that of the spectrum is what the same circuit leaves of it alone. All: with the run of the held strip, whose moment relaxes as the curvature does. p: chance of a difference as large where all have one circuit; below 0.05 the numbers of both or all are those of no strip. Steps at the lowest voltage, at which they are nearest to a spectrum.";
const SPECTRUM: Quantity = Quantity::plain("spectrum", "Spectrum", "run of the spectrum");
const HELD: Quantity = Quantity::plain("held", "Held", "run of the held strip");
const FROM: Quantity = Quantity::plain("from", "From", "what tells");
const AGREES: Quantity = Quantity::plain("agrees", "One circuit", "whether all can have one circuit");
const P: Quantity = Quantity::plain("p", "p", "chance of a difference as large");

/// What tells, the verdict where it is all together, and its numbers.
struct Told<'a> {
    own: &'a OneLikelihood,
    from: &'static str,
    both: Option<&'a Result<Both, String>>,
    numbers: [Option<Estimate>; SHOWN.len()],
    moment: Option<Estimate>,
}

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    type Of<'a> = Own<'a, Told<'a>>;
    let known = SHOWN.into_iter().filter_map(ParameterInfo::of);
    let runs = input.by_id();
    let shown: Vec<Quantity> = known.map(Quantity::from).collect();
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
        .column(HELD, |(_, told)| told.own.held.as_deref())
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
        .column(PER_CHARGE, |(_, told)| told.moment.as_ref().map(Value::from))
        .over(input.one_likelihood.iter().flat_map(|own| {
            let run = runs.run(own.run_id, &own.path);
            told(input, own).into_iter().map(move |told| (run, told))
        }))
}

fn told<'a>(input: &TableInput<'a>, own: &'a OneLikelihood) -> Vec<Told<'a>> {
    let number_of = |path: &str, key: &str| {
        let run = input.runs.iter().find(|run| run.path == path)?;
        Some(contribution(input.doubts, run, key).estimate.ok()?.into_owned())
    };
    let of_spectrum = |key: &str| {
        let found = own.of_spectrum.iter().find(|(known, _)| *known == key);
        found.map(|(_, estimate)| estimate.clone())
    };
    let both = own.both.as_ref().ok();
    let of_both = |key: &str| {
        let found = both?.parameters.iter().find(|own| own.key == key);
        found.map(|own| own.estimate.clone())
    };
    let told = |from, numbers| Told {
        own,
        from,
        both: None,
        numbers,
        moment: None,
    };
    let force = own.held.as_deref().map(|held| {
        let alone = input.blocked.iter().find(|blocked| blocked.path == held);
        let numbers = SHOWN.map(|key| match key {
            // Its moment relaxes; a curvature it has not.
            "lambda_per_s" => alone.map(|alone| alone.relaxation_per_s.clone()),
            key => number_of(held, key),
        });
        Told {
            moment: alone.map(|alone| alone.per_charge_mn_mm_per_c.clone()),
            ..told("force", numbers)
        }
    });
    let all = Told {
        both: Some(&own.both),
        moment: both.and_then(|both| both.moment_mn_mm_per_c.clone()),
        ..told(if force.is_some() { "all" } else { "both" }, SHOWN.map(of_both))
    };
    let alone = [
        told("step", SHOWN.map(|key| number_of(&own.path, key))),
        told("spectrum", SHOWN.map(of_spectrum)),
    ];
    alone.into_iter().chain(force).chain([all]).collect()
}
