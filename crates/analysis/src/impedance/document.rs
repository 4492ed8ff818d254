//! The spectra of a campaign, as documents have them.

use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use ieap_domain::tag::keys;
use ieap_domain::{Issue, SetAside, SpectrumAnalysis, SpectrumRun, Sweep};

use super::beside::Comparison;

/// Every spectrum of a campaign.
#[derive(Debug, Clone, Default, PartialEq, Serialize, JsonSchema)]
pub struct Spectra {
    /// Spectra that results are made from, in the order of their names, each sweep by itself.
    #[serde(rename = "spectra", serialize_with = "each_sweep")]
    #[schemars(with = "Vec<SweepDocument>")]
    pub runs: Vec<SpectrumRun>,
    /// Spectra beside the steps of the same sample and condition.
    pub beside_steps: Vec<Comparison>,
    /// Spectra that no result is made from, with the reasons.
    pub set_aside: Vec<SetAside>,
    /// Circuits of campaign.toml that are none, with the reasons.
    pub refused_circuits: Vec<Issue>,
}

/// One sweep.
#[derive(Debug, Serialize, JsonSchema)]
pub struct SweepDocument<'a> {
    /// Path of the run, relative to the campaign.
    run: &'a str,
    /// Number of the sweep in it, from 1.
    sweep: usize,
    /// Sample id.
    sample: Option<&'a str>,
    /// Environment id.
    environment: Option<&'a str>,
    /// Humidity, percent.
    relative_humidity_percent: Option<f64>,
    /// Active area, cm2.
    area_cm2: Option<f64>,
    /// Frequencies.
    frequencies: usize,
    /// Lowest frequency, Hz.
    lowest_hz: Option<f64>,
    /// Highest frequency, Hz.
    highest_hz: Option<f64>,
    /// What is found; without it the issues say why.
    #[serde(flatten)]
    found: Option<&'a SpectrumAnalysis>,
    /// What a reader must know.
    issues: Vec<&'a Issue>,
}

impl<'a> SweepDocument<'a> {
    fn of(run: &'a SpectrumRun, at: usize, sweep: &'a Sweep) -> SweepDocument<'a> {
        let record = &run.run;
        let own = SweepDocument::at_hand(&record.path, sweep);
        SweepDocument {
            sweep: at + 1,
            sample: record.tag(keys::SAMPLE),
            environment: record.tag(keys::ENVIRONMENT),
            relative_humidity_percent: record.tag_number(keys::RELATIVE_HUMIDITY_PERCENT),
            area_cm2: record.area_cm2,
            issues: record.issues.iter().chain(own.issues).collect(),
            ..own
        }
    }

    /// A sweep that no campaign holds.
    pub fn at_hand(run: &'a str, sweep: &'a Sweep) -> SweepDocument<'a> {
        let range = sweep.spectrum.range_hz();
        let found = sweep.analysis.as_ref().ok();
        let of_sweep = match &sweep.analysis {
            Ok(found) => found.issues.as_slice(),
            Err(issue) => std::slice::from_ref(issue),
        };
        SweepDocument {
            run,
            sweep: 1,
            sample: None,
            environment: None,
            relative_humidity_percent: None,
            area_cm2: None,
            frequencies: sweep.spectrum.len(),
            lowest_hz: range.map(|range| range.0),
            highest_hz: range.map(|range| range.1),
            found,
            issues: of_sweep.iter().collect(),
        }
    }
}

fn each_sweep<S: Serializer>(runs: &[SpectrumRun], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(runs.iter().flat_map(|run| {
        let sweeps = run.sweeps.iter().enumerate();
        sweeps.map(move |(at, sweep)| SweepDocument::of(run, at, sweep))
    }))
}
