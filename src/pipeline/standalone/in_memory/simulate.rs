//! Curves of a model under a drive, with effects and noise, as `ieap simulate` writes them into run files.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::exact::exact;
use super::run::{NO_AREA, Strip, sample};
use crate::domain::Issue;
use crate::pipeline::standalone::simulate::{Noise, RunSpec, SegmentSpec};
use crate::truth::noise::NoisyChannel;
use crate::truth::{HiddenEffect, noise};

/// What is to be simulated.
#[derive(Debug, Clone)]
pub struct CurvesAsked {
    /// Id of the model, `lumped-2`.
    pub model: String,
    /// Parameters by their stored keys; those left out are 0, or absent branches. A rival's own cannot be left out.
    pub parameters: BTreeMap<String, f64>,
    /// The strip; some effects need its length.
    pub strip: Strip,
    /// Voltage held before the drive, V.
    pub baseline_v: f64,
    /// Start (s) and voltage (V, none: open circuit) of each segment.
    pub drive: Vec<(f64, Option<f64>)>,
    /// Effects that act in the run.
    pub effects: Vec<HiddenEffect>,
    /// Noise of the readings; none by default.
    pub noise: Noise,
    /// Seed of the noise.
    pub seed: u64,
    /// Times of the readings, s, rising.
    pub time_s: Vec<f64>,
    /// Places at which the distributed model gives the curvature, mm from the clamp; the others bend evenly.
    pub places_mm: Vec<f64>,
}

/// Simulated readings, one for each time.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// Times, s.
    pub time_s: Vec<f64>,
    /// Applied voltage, V; NaN in an open circuit.
    pub voltage_v: Vec<f64>,
    /// Whether the circuit is open.
    pub is_open: Vec<bool>,
    /// Current, A.
    pub current_a: Vec<f64>,
    /// Curvatures: one of a strip that bends evenly, else one for each place.
    pub curvatures: Vec<Curvature>,
}

/// The curvature of a strip, or of a place of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Curvature {
    /// The place, mm from the clamp; none: the whole strip.
    pub place_mm: Option<f64>,
    /// Curvature at each time, 1/cm.
    pub per_cm: Vec<f64>,
}

impl Curvature {
    pub(super) fn whole(per_cm: Vec<f64>) -> Curvature {
        Curvature {
            place_mm: None,
            per_cm,
        }
    }
}

/// Simulates readings. The same request gives the same bytes.
///
/// # Errors
/// A parameter, the drive, an effect or the noise makes no sense, or the equations have no solution.
pub fn simulate(asked: &CurvesAsked) -> Result<Curves, Issue> {
    let rise = !asked.time_s.is_empty() && asked.time_s.is_sorted_by(|a, b| a < b);
    let why = match () {
        () if !rise => Some("the times of the readings do not rise, or there are none"),
        () if !asked.time_s.iter().all(|time| time.is_finite()) => {
            Some("a time of the readings is no finite number")
        }
        () => None,
    };
    if let Some(why) = why {
        let issue = Issue::error("bad-value", why).at("time_s");
        return Err(issue.mend("give finite times in s, each later than the one before"));
    }
    let run = run_spec(asked)?;
    let drive = run.drive();
    let exact = exact(asked, run)?;
    let bent = exact.curvatures.iter().flat_map(|own| &own.per_cm);
    if !exact.current_a.iter().chain(bent).all(|value| value.is_finite()) {
        let issue = Issue::error("not-solved", "the equations give no finite current or curvature");
        return Err(issue.at("parameters").mend("give values that a strip can have"));
    }
    let noisy = |signal: &[f64], channel, own: crate::truth::ChannelNoise, stream| {
        noise(
            signal,
            &own.with_effects(channel, &asked.effects),
            asked.seed,
            stream,
        )
    };
    let noisy_curvature = |(own, stream): (Curvature, u64)| Curvature {
        per_cm: noisy(
            &own.per_cm,
            NoisyChannel::Curvature,
            asked.noise.curvature(),
            stream,
        ),
        ..own
    };
    let applied = asked.time_s.iter().map(|&time_s| drive.level_at(time_s).volts());
    let applied: Vec<Option<f64>> = applied.collect();
    Ok(Curves {
        time_s: asked.time_s.clone(),
        voltage_v: applied.iter().map(|volts| volts.unwrap_or(f64::NAN)).collect(),
        is_open: applied.iter().map(Option::is_none).collect(),
        current_a: noisy(&exact.current_a, NoisyChannel::Current, asked.noise.current(), 0),
        curvatures: exact
            .curvatures
            .into_iter()
            .zip(1..)
            .map(noisy_curvature)
            .collect(),
    })
}

fn run_spec(asked: &CurvesAsked) -> Result<RunSpec, Issue> {
    let strip = asked.strip;
    let centimetres = |millimetres: Option<f64>| millimetres.map(|length| length / 10.0);
    let (length_cm, width_cm) = (centimetres(strip.length_mm), centimetres(strip.width_mm));
    let area_cm2 = sample(&strip).active_area_cm2().ok_or_else(|| {
        let issue = Issue::error(NO_AREA, "the active area of the strip is not stated").at("area_cm2");
        issue.mend("state area_cm2, or length_mm and width_mm")
    })?;
    let segment = |&(start_s, voltage_v): &(f64, Option<f64>)| SegmentSpec { start_s, voltage_v };
    Ok(RunSpec {
        file: PathBuf::from("simulated"),
        area_cm2,
        length_cm,
        width_cm,
        baseline_v: asked.baseline_v,
        voltage_v: None,
        drive: asked.drive.iter().map(segment).collect(),
        pulses: None,
        wave: None,
        parameters: asked.parameters.clone(),
        effect: Vec::new(),
        tags: toml::Table::new(),
    })
}
