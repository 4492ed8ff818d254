//! The document that `ieap impedance --json` prints: the spectra of a campaign, and what the steps say beside them.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::fits::as_object;
use crate::analysis::impedance::{BesideRow, Comparison, StepSide};
use crate::domain::tag::keys;
use crate::domain::{
    Consistency, Estimate, Issue, KramersKronig, RelaxationTimes, SpectrumAnalysis, SpectrumRun, Sweep, ZHit,
};
use crate::pipeline::campaign::standing::SetAside;
use crate::pipeline::findings::impedance::Spectra;

/// Every spectrum.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ImpedanceDocument {
    /// Always `ieap/impedance/1`.
    pub schema: &'static str,
    /// Spectra in the order of their names, each sweep by itself.
    pub spectra: Vec<SpectrumEntry>,
    /// Spectra beside the steps of the same sample and condition.
    pub beside_steps: Vec<BesideEntry>,
    /// Spectra that no result is made from, with the reasons.
    pub set_aside: Vec<SetAside>,
    /// Circuits of campaign.toml that are none, with the reasons.
    pub refused_circuits: Vec<Issue>,
}

/// One sweep.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SpectrumEntry {
    /// Path of the run, relative to the campaign.
    pub run: String,
    /// Number of the sweep in it, from 1.
    pub sweep: usize,
    /// Sample id.
    pub sample: Option<String>,
    /// Environment id.
    pub environment: Option<String>,
    /// Humidity, percent.
    pub relative_humidity_percent: Option<f64>,
    /// Active area, cm2.
    pub area_cm2: Option<f64>,
    /// Frequencies.
    pub frequencies: usize,
    /// Lowest frequency, Hz.
    pub lowest_hz: Option<f64>,
    /// Highest frequency, Hz.
    pub highest_hz: Option<f64>,
    /// The Kramers-Kronig test; null where the sweep is not analysed.
    pub kramers_kronig: Option<TestEntry>,
    /// The modulus against that which the phase gives (Z-HIT).
    pub z_hit: Option<ZHitEntry>,
    /// The distribution of relaxation times.
    pub relaxation: Option<RelaxationTimes>,
    /// Circuit with the lowest criterion.
    pub best: Option<String>,
    /// Circuits in the order of the list.
    pub circuits: Vec<CircuitEntry>,
    /// What a reader must know.
    pub issues: Vec<Issue>,
}

/// The Kramers-Kronig test of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TestEntry {
    /// `consistent`, `violated` or `not_tested`.
    pub verdict: Consistency,
    /// Voigt elements.
    pub elements: usize,
    /// Schönleber's criterion.
    pub mu: f64,
    /// Scatter between neighbours, percent of |Z|.
    pub scatter_percent: f64,
    /// Root mean square of the residuals, percent of |Z|.
    pub residual_rms_percent: f64,
    /// Largest mean of neighbouring residuals, percent of |Z|.
    pub largest_mean_percent: f64,
    /// Lowest and highest frequency that is off, Hz.
    pub off_hz: Option<(f64, f64)>,
}

/// Z-HIT of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ZHitEntry {
    /// Whether the modulus of the lowest frequencies lies further from what the phase gives than noise and the method's own
    /// error explain.
    pub drifts: bool,
    /// Mean over the lowest frequencies by which |Z| lies above what the phase gives, percent.
    pub lowest_percent: f64,
    /// The mean that noise and the method's own error explain, percent.
    pub limit_percent: f64,
    /// The lowest frequencies, from and to, Hz.
    pub lowest_hz: (f64, f64),
}

/// One circuit.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CircuitEntry {
    /// Its id, or the circuit as a text.
    pub circuit: String,
    /// Whether it describes the sweep.
    pub describes: bool,
    /// What it leaves, percent of |Z|.
    pub residual_rms_percent: f64,
    /// Bayesian information criterion above that of the best.
    pub bic_above_best: f64,
    /// Numbers by key, Ohm and F.
    #[serde(serialize_with = "as_object")]
    #[schemars(with = "BTreeMap<String, Estimate>")]
    pub parameters: Vec<(String, Estimate)>,
}

/// A sweep beside steps.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BesideEntry {
    /// Path of the spectrum's run.
    pub run: String,
    /// Number of the sweep in it, from 1.
    pub sweep: usize,
    /// The circuit of both.
    pub circuit: String,
    /// Steps at the lowest voltage.
    pub steps: SideEntry,
    /// Steps at the highest voltage, where there are several.
    pub steps_at_highest: Option<SideEntry>,
    /// The numbers, per unit area.
    pub numbers: Vec<NumberEntry>,
    /// Effects that would make the difference.
    pub effects: Vec<&'static str>,
    /// What follows, in sentences.
    pub sentences: Vec<String>,
}

/// Steps at one voltage.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SideEntry {
    /// Voltage, V.
    pub voltage_v: f64,
    /// Runs.
    pub runs: Vec<String>,
}

/// A number from both.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct NumberEntry {
    /// Key with the unit.
    pub key: &'static str,
    /// From the spectrum.
    pub spectrum: Estimate,
    /// From the steps at the lowest voltage.
    pub step: Estimate,
    /// From those at the highest.
    pub step_at_highest: Option<Estimate>,
    /// Step over spectrum.
    pub step_over_spectrum: Estimate,
    /// Whether both can be the same; null where either says nothing.
    pub agrees: Option<bool>,
}

/// The document of what was found.
pub fn impedance_document(spectra: &Spectra) -> ImpedanceDocument {
    let entries = spectra.runs.iter().flat_map(|run| {
        let sweeps = run.sweeps.iter().enumerate();
        sweeps.map(move |(at, sweep)| entry(run, at, sweep))
    });
    ImpedanceDocument {
        schema: "ieap/impedance/1",
        spectra: entries.collect(),
        beside_steps: spectra.beside.iter().map(beside).collect(),
        set_aside: spectra.set_aside.clone(),
        refused_circuits: spectra.refused.clone(),
    }
}

fn entry(run: &SpectrumRun, at: usize, sweep: &Sweep) -> SpectrumEntry {
    let record = &run.run;
    let range = sweep.spectrum.range_hz();
    let found = sweep.analysis.as_ref().ok();
    let refused = sweep.analysis.as_ref().err();
    let of_sweep = found.into_iter().flat_map(|found| &found.issues).chain(refused);
    SpectrumEntry {
        run: record.path.clone(),
        sweep: at + 1,
        sample: record.tag(keys::SAMPLE).map(str::to_owned),
        environment: record.tag(keys::ENVIRONMENT).map(str::to_owned),
        relative_humidity_percent: record.tag_number(keys::RELATIVE_HUMIDITY_PERCENT),
        area_cm2: record.area_cm2,
        frequencies: sweep.spectrum.len(),
        lowest_hz: range.map(|range| range.0),
        highest_hz: range.map(|range| range.1),
        kramers_kronig: found.map(|found| test(&found.kramers_kronig)),
        z_hit: found.and_then(|found| found.z_hit.as_ref()).map(z_hit),
        relaxation: found.and_then(|found| found.relaxation.clone()),
        best: found.map(|found| found.best.clone()),
        circuits: found.map_or_else(Vec::new, circuits),
        issues: record.issues.iter().chain(of_sweep).cloned().collect(),
    }
}

fn test(found: &KramersKronig) -> TestEntry {
    TestEntry {
        verdict: found.verdict,
        elements: found.elements,
        mu: found.mu,
        scatter_percent: found.scatter_percent,
        residual_rms_percent: found.residual_rms_percent,
        largest_mean_percent: found.largest_mean_percent,
        off_hz: found.off_hz,
    }
}

fn z_hit(found: &ZHit) -> ZHitEntry {
    ZHitEntry {
        drifts: found.drifts,
        lowest_percent: found.lowest_percent,
        limit_percent: found.limit_percent,
        lowest_hz: found.lowest_hz,
    }
}

fn circuits(found: &SpectrumAnalysis) -> Vec<CircuitEntry> {
    let fits = found.circuits.iter();
    fits.map(|fit| CircuitEntry {
        circuit: fit.circuit.clone(),
        describes: fit.describes,
        residual_rms_percent: fit.residual_rms_percent,
        bic_above_best: fit.bic_above_best,
        parameters: (fit.parameters.iter())
            .map(|parameter| (parameter.key.clone(), parameter.estimate.clone()))
            .collect(),
    })
    .collect()
}

fn beside(found: &Comparison) -> BesideEntry {
    BesideEntry {
        run: found.spectrum.clone(),
        sweep: found.sweep + 1,
        circuit: found.circuit.clone(),
        steps: side(&found.lowest),
        steps_at_highest: found.highest.as_ref().map(side),
        numbers: found.rows.iter().map(number).collect(),
        effects: found.effects.clone(),
        sentences: found.sentences.clone(),
    }
}

fn side(side: &StepSide) -> SideEntry {
    SideEntry {
        voltage_v: side.voltage_v,
        runs: side.runs.clone(),
    }
}

fn number(row: &BesideRow) -> NumberEntry {
    NumberEntry {
        key: row.key,
        spectrum: row.spectrum.clone(),
        step: row.step.clone(),
        step_at_highest: row.step_at_highest.clone(),
        step_over_spectrum: row.ratio.clone(),
        agrees: row.agrees,
    }
}
