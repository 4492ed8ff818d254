//! What the strip is taken to be before the run is made, and what noise its readings have: from an earlier run, or stated.

use std::path::Path;

use crate::domain::tag::keys;
use crate::domain::{ChannelNoise as FoundNoise, Drive, Fit, Quantity, RunRecord};
use crate::fit::FitOptions;
use crate::model::scaling::lumped_model;
use crate::model::scaling::propagation::values;
use crate::model::{FitModel, LumpedModel, ParameterDescription, fit_model};
use crate::pipeline::campaign::standing;
use crate::pipeline::fits::choice::FitChoice;
use crate::pipeline::standalone::forward::AskedStrip;
use crate::pipeline::standalone::forward::grounds::Grounds;
use crate::pipeline::standalone::forward::source::Source;
use crate::pipeline::standalone::simulate::{RunSpec, Spec, hidden_effects};
use crate::pipeline::{Context, PipelineError};
use crate::truth::ChannelNoise;

/// Correlation of neighbouring readings at most: above it no simulation of a run's length is long enough to show its noise.
const MOST_CORRELATED: f64 = 0.99;

/// What a run is simulated from.
#[derive(Debug, Clone)]
pub struct Subject {
    /// Where it comes from, in words.
    pub told_by: String,
    /// How the run will be fitted.
    pub options: FitOptions<'static>,
    /// Parameters.
    pub model: LumpedModel,
    /// Active area, cm2.
    pub area_cm2: f64,
    /// Noise of the current, A.
    pub current_noise: ChannelNoise,
    /// Noise of the curvature, 1/cm; none where bending is not read.
    pub curvature_noise: Option<ChannelNoise>,
    /// The drive of that run.
    pub drive: Drive,
    /// Its length, s.
    pub for_s: f64,
    /// Whether its drive begins at a time that is stated.
    pub start_is_known: bool,
    /// Largest voltage that was measured, V.
    pub largest_v: f64,
    /// What of it is a guess, in sentences.
    pub remarks: Vec<String>,
}

impl Subject {
    /// From the fits of a campaign, for a strip of the size asked for: an earlier run of that path tells, of its own sample in
    /// its environment; where none is named, of the runs of the sample asked for the one nearest to `voltage_v`.
    ///
    /// # Errors
    /// The run or the sample is not there, or its fit tells too little.
    pub fn of_campaign(
        context: &Context,
        asked: AskedStrip,
        path: Option<&str>,
        voltage_v: Option<f64>,
    ) -> Result<Subject, PipelineError> {
        let runs = standing::speaking(context)?;
        let asked = match path {
            None => asked,
            Some(path) => in_surroundings_of(&runs, path, asked)?,
        };
        let grounds = Grounds::of(context, &asked)?;
        let source = match path {
            Some(path) => of_run(&grounds, path)?,
            None => nearest(&grounds, voltage_v.unwrap_or_default())?,
        };
        let record = runs.iter().find(|run| run.path == source.run);
        let (fit, drive) = record
            .and_then(|run| run.fit.as_ref().zip(run.drive.as_ref()))
            .ok_or_else(|| PipelineError::bad_argument("--run", source.run.clone(), "a run with a fit"))?;
        let fit_model = lumped_of(fit, &source.run)?;
        let choice = FitChoice {
            model: Some(fit_model.id.to_owned()),
            ..FitChoice::default()
        };
        let noise_of = |quantity| {
            fit.noise
                .iter()
                .find(|noise| noise.quantity == quantity)
                .map(noise)
        };
        let current_noise = noise_of(Quantity::Current).ok_or_else(|| {
            PipelineError::bad_argument(
                "--run",
                format!("{}, which has no current", source.run),
                "a run with a current",
            )
        })?;
        Ok(Subject {
            told_by: format!("{} ({}){}", source.run, fit.model, grounds.brought_in_short()),
            options: FitOptions {
                // It changes no estimate.
                describes_noise: false,
                ..choice.options(&context.campaign)?
            },
            model: lumped_model(&source.model, &source.size, &grounds.to).map_err(PipelineError::from)?,
            area_cm2: grounds.to.area_cm2(),
            current_noise,
            curvature_noise: noise_of(Quantity::Curvature).filter(|_| source.bends),
            drive: drive.clone(),
            for_s: source.lasted_s,
            start_is_known: drive.segments.first().is_some_and(|first| first.edge.is_stated()),
            largest_v: (grounds.own())
                .map(|source| source.step_v.abs())
                .fold(0.0, f64::max),
            remarks: guessed(fit, &source.bounded, fit_model, &source.model),
        })
    }

    /// From a run of a file as `ieap simulate` takes it: the one of that name, or the first.
    ///
    /// # Errors
    /// The file is none, or holds no such run.
    pub fn of_spec(path: &Path, run: Option<&str>) -> Result<Subject, PipelineError> {
        let spec = Spec::read(path)?;
        let is_meant = |of: &&RunSpec| run.is_none_or(|name| of.file == Path::new(name));
        let found = spec.run.iter().find(is_meant).ok_or_else(|| {
            let known: Vec<String> = spec
                .run
                .iter()
                .map(|run| run.file.display().to_string())
                .collect();
            PipelineError::bad_argument(
                "--run",
                format!("{:?}", run.unwrap_or_default()),
                format!("one of the [[run]] of {}: {}", path.display(), known.join(", ")),
            )
        })?;
        let model = found.model();
        let id = format!("lumped-{}", model.branches.len());
        let fit_model = fit_model(&id).ok_or_else(|| {
            PipelineError::bad_argument(
                "--spec",
                format!("{} branches in {}", model.branches.len(), found.file.display()),
                "one to four branches, as r1_ohm_cm2 and c1_f_per_cm2",
            )
        })?;
        let bends = model.charge_to_curvature_per_c_cm != 0.0;
        let drive = found.drive();
        let hidden = !hidden_effects(&spec, found).is_empty();
        let without =
            "The effects that the file hides in the run are left out: a plan is made with the model alone.";
        Ok(Subject {
            told_by: format!("{} of {}", found.file.display(), path.display()),
            options: FitOptions {
                model: fit_model,
                ..FitOptions::default()
            },
            area_cm2: found.area_cm2,
            current_noise: spec.noise.current(),
            curvature_noise: bends.then(|| spec.noise.curvature()),
            start_is_known: false,
            for_s: spec.sampling.last().map_or(0.0, |last| last.until_s),
            largest_v: drive.largest_v(),
            remarks: hidden.then(|| without.to_owned()).into_iter().collect(),
            model,
            drive,
        })
    }

    /// The parameters that are simulated, with their values, in the order of the model.
    pub(super) fn known(&self) -> Vec<(ParameterDescription, f64)> {
        let described = self.options.model.parameters.iter().filter(|of| !of.derived);
        let branches = self.model.branches.len();
        let own = described.filter(|of| self.branch_of(of.key).is_none_or(|at| at < branches));
        let bends = self.curvature_noise.is_some();
        let is_known = |(of, value): &(&ParameterDescription, f64)| match of.key {
            "rss_ohm_cm2" => value.is_finite(),
            "alpha_per_c_cm" => bends,
            "lambda_per_s" => bends && *value > 0.0,
            _ => true,
        };
        let known = own.zip(values(&self.model)).filter(is_known);
        known.map(|(of, value)| (*of, value)).collect()
    }

    /// Number (from 0 on) of the branch that a parameter belongs to.
    pub(super) fn branch_of(&self, key: &str) -> Option<usize> {
        let number = key.strip_prefix(['r', 'c'])?.chars().next()?.to_digit(10)?;
        (number as usize).checked_sub(1)
    }

    /// Time constants of the branches, s.
    pub(super) fn taus_s(&self) -> Vec<f64> {
        let branches = self.model.branches.iter();
        branches
            .map(|branch| branch.resistance_ohm_cm2 * branch.capacitance_f_per_cm2)
            .collect()
    }
}

/// The run of that path.
fn of_run<'a>(grounds: &'a Grounds, path: &str) -> Result<&'a Source, PipelineError> {
    (grounds.own().find(|source| source.run == path)).ok_or_else(|| {
        let left = grounds.left_out.iter().find(|entry| entry.run == path);
        let why = left.map_or("it is set aside", |entry| &entry.reason);
        let needed = "a run with a lumped fit that determines a circuit";
        PipelineError::bad_argument("--run", format!("{path}: {why}"), needed)
    })
}

/// The run of the sample whose voltage is nearest.
fn nearest(grounds: &Grounds, voltage_v: f64) -> Result<&Source, PipelineError> {
    let apart = |source: &Source| (source.step_v - voltage_v).abs();
    let found = grounds.own().min_by(|a, b| apart(a).total_cmp(&apart(b)));
    found.ok_or_else(|| {
        PipelineError::bad_argument("--sample", grounds.sample.id.clone(), "a sample with fitted runs")
    })
}

/// The lumped model that a run is fitted with.
fn lumped_of(fit: &Fit, run: &str) -> Result<&'static FitModel, PipelineError> {
    let lumped = fit_model(&fit.model).filter(|model| model.id.starts_with("lumped-"));
    lumped.ok_or_else(|| {
        let needed = "a run with a lumped fit; `ieap run --only fit --model lumped-2` makes it";
        PipelineError::bad_argument("--run", format!("{run}, fitted with {}", fit.model), needed)
    })
}

/// The strip of that size that a run was made with, in its environment.
fn in_surroundings_of(runs: &[RunRecord], path: &str, size: AskedStrip) -> Result<AskedStrip, PipelineError> {
    let run = runs.iter().find(|run| run.path == path).ok_or_else(|| {
        PipelineError::bad_argument(
            "--run",
            format!("{path:?}"),
            "the path of a run that results are made from; `ieap status` lists the runs",
        )
    })?;
    let tag = |key: &str| run.tag(key).map(str::to_owned);
    let sample = tag(keys::SAMPLE).ok_or_else(|| {
        PipelineError::bad_argument(
            "--run",
            format!("{path}, which names no sample"),
            "a run with a sample; `ieap tag` states it",
        )
    })?;
    Ok(AskedStrip {
        sample,
        environment: tag(keys::ENVIRONMENT),
        ..size
    })
}

/// Noise as a fit found it, as the simulator makes it.
fn noise(found: &FoundNoise) -> ChannelNoise {
    ChannelNoise {
        standard_deviation: found.standard_deviation,
        autocorrelation: found.residual_autocorrelation.clamp(0.0, MOST_CORRELATED),
        proportional: found.character.proportional,
        step: found.character.quantum,
        ..ChannelNoise::default()
    }
}

/// What the earlier fit leaves open, so that a value had to be taken or nothing can be said.
fn guessed(fit: &Fit, bounded: &[String], model: &FitModel, taken: &LumpedModel) -> Vec<String> {
    let symbol = |key: &str| {
        let described = model.parameters.iter().find(|of| of.key == key);
        described.map_or(key.to_owned(), |of| of.symbol.to_owned())
    };
    let mut remarks: Vec<String> = bounded
        .iter()
        .map(|key| {
            let of = symbol(key);
            format!("Of {of} the earlier run tells a limit only: a value within it is taken, and what is said of {of} is of that size.")
        })
        .collect();
    if taken.branches.len() < model.branches {
        let open = model.parameters.iter().filter(|of| !of.derived);
        let open = open.filter(|of| {
            fit.parameter(of.key).is_some_and(|e| e.value.is_none()) && !bounded.iter().any(|b| b == of.key)
        });
        let names: Vec<&str> = open.map(|of| of.symbol).collect();
        remarks.push(format!(
            "The earlier run does not determine {}: the strip is simulated without, and nothing is said of them. A file for --spec states them.",
            names.join(", ")
        ));
    }
    remarks
}
