//! The thesis's table 3: parameters of the distributed model, one row a sample.

use super::TableInput;
use super::of_several::{Runs, pooled_remark};
use crate::conditions::material;
use ieap_domain::ParameterInfo;
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, RunRecord, Sample};
use ieap_show::quantities::{MATERIAL, Quantity, R_SQUARED_CURVATURE, RUNS, SAMPLE};
use ieap_show::{Sheet, Table};

/// A parameter that only the distributed model has: its fits are told by it.
const MARK: &str = "re_ohm_per_sq";

const SHOWN: [&str; 7] = [
    MARK,
    "c_f_per_cm2",
    "rc_ohm_cm2",
    "rss_ohm_cm2",
    "mu_per_c",
    "alpha_per_c_cm",
    "lambda_per_s",
];
const DIMENSIONS: Quantity = Quantity::new(
    "dimensions_mm",
    "Dimensions",
    "free length, width, thickness",
    "mm",
);
const NONE: &str = "No run is fitted with the distributed model: say `model = \"distributed\"` in campaign.toml, or fit with `ieap run --only fit --model distributed`.";

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    let campaign = input.campaign;
    let is_distributed = |run: &RunRecord| run.fit.as_ref().is_some_and(|fit| fit.parameter(MARK).is_some());
    let of_sample = |id| {
        let of = |run: &RunRecord| run.tag(keys::SAMPLE) == Some(id) && is_distributed(run);
        let at: Vec<usize> = (0..input.runs.len()).filter(|&at| of(&input.runs[at])).collect();
        (!at.is_empty()).then(|| (id, Runs::new(input, at)))
    };
    let shown: Vec<Quantity> = SHOWN
        .into_iter()
        .filter_map(ParameterInfo::of)
        .map(in_units_of_the_thesis)
        .collect();
    Sheet::<(&str, Runs)>::new(
        "table3",
        "Parameters of the distributed model, normalised by the dimensions of the samples",
        3,
    )
    .remarks(pooled_remark(), NONE)
    .called(|(id, _)| (*id).to_owned())
    .made_from(|(_, runs)| runs.sources())
    .column(SAMPLE, |(id, _)| *id)
    .column(MATERIAL, |(_, runs)| {
        runs.records().next().and_then(|run| material(run, campaign))
    })
    .column(DIMENSIONS, |(id, _)| campaign.sample(id).and_then(dimensions))
    .columns(&shown, |(_, runs), of| runs.parameter(of.key))
    .column(R_SQUARED_CURVATURE, |(_, runs)| {
        runs.score(|fit| fit.r_squared_curvature)
    })
    .column(RUNS, |(_, runs)| runs.at.len())
    .over(sample_ids(campaign, input.runs).into_iter().filter_map(of_sample))
}

/// Resistances of the distributed model are a few Ω cm², also the steady-state one.
fn in_units_of_the_thesis(of: &ParameterInfo) -> Quantity {
    let quantity = Quantity::from(of);
    let display = quantity.display.filter(|_| of.unit() != "Ω cm²");
    Quantity { display, ..quantity }
}

/// `45 × 3 × 0.24`
fn dimensions(sample: &Sample) -> Option<String> {
    let mut text = format!("{} × {}", sample.length_mm?, sample.width_mm?);
    if let Some(thickness_mm) = sample.thickness_mm {
        text += &format!(" × {thickness_mm}");
    }
    Some(text)
}

/// Samples of the campaign that these runs were made on, in the order of the campaign.
fn sample_ids<'a>(campaign: &'a Campaign, runs: &'a [RunRecord]) -> Vec<&'a str> {
    let used: Vec<&str> = runs.iter().filter_map(|run| run.tag(keys::SAMPLE)).collect();
    let known = campaign.samples.iter().map(|sample| sample.id.as_str());
    let mut ids: Vec<&str> = known.filter(|id| used.contains(id)).collect();
    for id in used {
        if !ids.contains(&id) {
            ids.push(id);
        }
    }
    ids
}
