//! What diagnoses found: one row a group of runs, then one row a run by itself.

use std::collections::BTreeMap;

use super::TableInput;
use crate::conditions::material;
use crate::json_rows::list;
use ieap_domain::tag::keys;
use ieap_domain::{Gain, GroupDiagnosis, HeldOutGain, RunRecord};
use ieap_show::quantities::{ENVIRONMENT, MATERIAL, Quantity, SAMPLE};
use ieap_show::{Made, Printed, Rough, Sheet, Source, SourceOrigin};

/// Digits of a probability, and of a gain.
const DIGITS: i32 = 2;

const KIND: Quantity = Quantity::plain("kind", "Of", "of a group of runs, or of one by itself");
const NAME: Quantity = Quantity::plain("name", "Group or run", "name of the group, or path of the run");
const RUNS: Quantity = Quantity::plain("run_count", "Runs", "how many runs");
const VERDICT: Quantity = Quantity::plain("verdict", "Verdict", "what is said");
const EFFECTS: Quantity = Quantity::plain("effects", "Accepted effects", "accepted effects");
const SET: Quantity = Quantity::plain("as_good", "Possible causes", "effects that may be the cause");
const P: Quantity = Quantity::plain(
    "p_misfit",
    "p",
    "probability of such residuals where the base model is right",
);
const Q: Quantity = Quantity::plain("q_misfit", "q", "the same over all of its kind");
const BEFORE: Quantity = Quantity::plain(
    "residual_before",
    "Residual before",
    "residual of the base model in units of the noise",
);
const AFTER: Quantity = Quantity::plain(
    "residual_after",
    "Residual after",
    "residual of the extended model in units of the noise",
);

/// Makes the table.
pub fn make<M: Made>(input: &TableInput) -> M {
    let by_path: BTreeMap<&str, &RunRecord> = input.runs.iter().map(|run| (run.path.as_str(), run)).collect();
    let by_path = &by_path;
    // What all runs of a finding share.
    let shared = |found: &GroupDiagnosis, of: &dyn Fn(&RunRecord) -> Option<String>| {
        let mut values = found.runs.iter().map(|path| of(by_path.get(path.as_str())?));
        let first = values.next()??;
        values
            .all(|value| value.as_ref() == Some(&first))
            .then_some(first)
    };
    let tag = |found: &GroupDiagnosis, key: &str| shared(found, &|run| run.tag(key).map(str::to_owned));
    let rough = |number: Option<f64>| Some(Rough(number.filter(|number| number.is_finite())?, DIGITS));
    let residual = move |found: &GroupDiagnosis, of: fn(&Gain) -> f64| rough(found.gain.as_ref().map(of));
    let proof = |found: &GroupDiagnosis, of: fn(&HeldOutGain) -> Option<f64>| of(&found.gain.as_ref()?.proof);
    let groups = input.groups.iter().map(|found| ("group", found));
    let rows = groups.chain(input.alone.iter().map(|found| ("run", found)));
    Sheet::<(&str, &GroupDiagnosis)>::new("findings", "What the base model gets wrong", 2)
        .remarks(
            "Residuals are the root mean square of the whitened residuals, 1 where only noise is left.",
            "Nothing is diagnosed yet: `ieap diagnose` does it.",
        )
        .called(|(_, found)| found.group.clone())
        .made_from(|(kind, found)| {
            let run = by_path.get(found.group.as_str()).filter(|_| *kind == "run");
            let origin = run.map_or(SourceOrigin::Diagnosis, |run| SourceOrigin::Run(run.id));
            vec![Source::of(origin, &found.group)]
        })
        .column(KIND, |(kind, _)| *kind)
        .column(NAME, |(kind, found)| {
            let words = match *kind {
                "group" => crate::groups::title(&found.group),
                _ => found.group.clone(),
            };
            Printed(
                found.group.as_str(),
                Some(words).filter(|words| !words.is_empty()).into(),
            )
        })
        .in_files(|sheet| {
            sheet
                .column(MATERIAL, move |(_, found)| {
                    shared(found, &|run| material(run, input.campaign).map(str::to_owned))
                })
                .column(SAMPLE, move |(_, found)| tag(found, keys::SAMPLE))
                .column(ENVIRONMENT, move |(_, found)| tag(found, keys::ENVIRONMENT))
                .plain("sentence", |(_, found)| found.sentence.as_str())
                .plain("base_model", |(_, found)| found.base_model.as_str())
                .plain("runs", |(_, found)| list(&found.runs, ", "))
        })
        .column(RUNS, |(_, found)| found.runs.len())
        .column(VERDICT, |(_, found)| found.verdict.key())
        .column(EFFECTS, |(_, found)| {
            let effects: Vec<&str> = found.effects.iter().map(|own| own.effect.as_str()).collect();
            list(&effects, ", ")
        })
        .column(SET, |(_, found)| list(&found.set, ", "))
        .column(P, move |(_, found)| rough(found.p_misfit))
        .column(Q, move |(_, found)| rough(found.q_misfit))
        .column(BEFORE, move |(_, found)| {
            residual(found, |gain| gain.residual_rms_sigma_before)
        })
        .column(AFTER, move |(_, found)| {
            residual(found, |gain| gain.residual_rms_sigma_after)
        })
        .in_files(|sheet| {
            sheet
                .plain("most_probable", |(_, found)| {
                    let first = found.posterior.first().and_then(|first| first.effect.clone());
                    list(&first.into_iter().collect::<Vec<String>>(), ", ")
                })
                .plain("most_probable_mass", |(_, found)| {
                    Some(found.posterior.first()?.mass)
                })
                .plain("held_out", |(_, found)| {
                    Some(found.gain.as_ref()?.held_out.clone())
                })
                .plain("gain_deviance", move |(_, found)| {
                    proof(found, |of| Some(of.deviance))
                })
                .plain("gain_standard_error", move |(_, found)| {
                    proof(found, |of| Some(of.standard_error))
                })
                .plain("gain_is_clear", |(_, found)| {
                    Some(found.gain.as_ref()?.proof.is_clear())
                })
                .plain("nrmse_current_before", move |(_, found)| {
                    proof(found, |of| of.nrmse_current_before)
                })
                .plain("nrmse_current_after", move |(_, found)| {
                    proof(found, |of| of.nrmse_current_after)
                })
                .plain("nrmse_curvature_before", move |(_, found)| {
                    proof(found, |of| of.nrmse_curvature_before)
                })
                .plain("nrmse_curvature_after", move |(_, found)| {
                    proof(found, |of| of.nrmse_curvature_after)
                })
                .plain("next_run", |(_, found)| {
                    Some(found.next_run.as_ref()?.drive.clone())
                })
        })
        .made(rows)
}
