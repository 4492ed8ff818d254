//! What a prediction rests on: the runs that tell, what they do not, and what the model gets wrong.

use super::asked::{AskedStrip, size_of};
use super::misfit::{KnownMisfit, found_onset, known_misfit};
use super::source::{LeftOutEntry, Source, applied};
use super::surroundings::{BroughtEntry, Surroundings};
use crate::analysis::forecast::{Applied, Beside, Forecast, Told, forecast, is_alike};
use crate::domain::tag::keys;
use crate::domain::{Drive, Estimate, Quantity, RunRecord, Sample, range_of};
use crate::model::scaling::prediction::LINKS;
use crate::model::scaling::{CarriedBy, Prediction, Series, StripSize, predict};
use crate::pipeline::campaign::standing;
use crate::pipeline::findings::current::current_findings;
use crate::pipeline::findings::strip_modulus::{StripModulus, strip_modulus};
use crate::pipeline::fits::drawn::DrawnFits;
use crate::pipeline::{Context, PipelineError};

/// What a prediction rests on.
pub(in crate::pipeline::standalone) struct Grounds {
    /// Sample asked for.
    pub sample: Sample,
    /// Environment of the runs.
    pub environment: String,
    /// Humidity asked for, else the mean of the runs of the sample, percent, where all state one.
    pub humidity_percent: Option<f64>,
    /// Runs that tell; those of the sample first.
    pub sources: Vec<Source>,
    /// Runs in the same surroundings that tell nothing.
    pub left_out: Vec<LeftOutEntry>,
    /// What brought the runs to conditions in which none was made, as entries and in words.
    pub(super) brought: (Vec<BroughtEntry>, Vec<String>),
    /// Size of the sample.
    pub from: StripSize,
    /// Size of the strip asked for.
    pub to: StripSize,
    /// Whether that is another strip.
    pub is_another: bool,
    /// Resistance along the electrodes, Ohm per square.
    pub electrode_resistance_ohm_per_sq: Option<f64>,
    /// What the model gets wrong.
    pub(super) misfit: KnownMisfit,
    /// Modulus of the strip.
    pub modulus: StripModulus,
    /// Onset of electrolysis as a diagnosis found it, V.
    pub onset_v: Option<Estimate>,
}

/// Forecasts of every response, one a time.
pub(super) struct Forecasts {
    pub current_a: Vec<Forecast>,
    pub charge_c: Vec<Forecast>,
    pub leaked_charge_c: Vec<Forecast>,
    /// Empty where no run tells how the strip bends.
    pub curvature_per_cm: Vec<Forecast>,
    pub tip_displacement_mm: Vec<Forecast>,
    /// One list of times a link.
    pub local_curvature_per_cm: Vec<Vec<Forecast>>,
    pub carried_by: CarriedBy,
    /// Largest share by which the lumped model is wrong at the tip, over the sources.
    pub lumped_error: Option<f64>,
}

impl Grounds {
    /// Looks for runs that tell.
    ///
    /// # Errors
    /// The sample or its size is not known, no run of it tells, or the database cannot be read.
    pub fn of(context: &Context, asked: &AskedStrip) -> Result<Grounds, PipelineError> {
        let sample = context.campaign.sample(&asked.sample).ok_or_else(|| {
            let known: Vec<&str> = context.campaign.samples.iter().map(|s| s.id.as_str()).collect();
            PipelineError::bad_argument(
                "--sample",
                format!("{:?}", asked.sample),
                format!("one of {}", known.join(", ")),
            )
        })?;
        let speaking = standing::speaking(context)?;
        let is_of_material = |run: &&RunRecord| {
            let of = run.tag(keys::SAMPLE).and_then(|id| context.campaign.sample(id));
            of.is_some_and(|of| of.material == sample.material)
        };
        let of_material: Vec<RunRecord> = speaking.iter().filter(is_of_material).cloned().collect();
        let environment = environment(&of_material, asked)?;
        let of_environment = |run: &&RunRecord| run.tag(keys::ENVIRONMENT) == Some(&environment);
        let of_environment: Vec<RunRecord> = of_material.iter().filter(of_environment).cloned().collect();
        let surroundings = Surroundings::of(context, &speaking, of_environment, asked, &sample.material)?;
        let runs = &surroundings.runs;
        let from = size_of(sample)?;
        let (mut sources, mut left_out) = (Vec::new(), surroundings.left_out.clone());
        let mut others: Vec<&str> = Vec::new();
        let drawn = DrawnFits::new(context);
        for run in runs {
            let id = run.tag(keys::SAMPLE).unwrap_or_default();
            let number = if id == sample.id {
                0
            } else {
                number_of(&mut others, id)
            };
            let size = match context.campaign.sample(id) {
                Some(of) if number > 0 => size_of(of).map_err(|error| error.to_string()),
                _ => Ok(from),
            };
            let curves = drawn.of(run)?.curves;
            let source = size.and_then(|size| Source::of(run, &curves, number, &size));
            let is_elsewhere = asked.is_another() || surroundings.brings();
            match source.and_then(|source| with_its_laws(source, is_elsewhere, &sources)) {
                Ok(mut source) => {
                    surroundings.bring(&mut source);
                    sources.push(source);
                }
                Err(reason) => left_out.push(LeftOutEntry {
                    run: run.path.clone(),
                    reason,
                }),
            }
        }
        sources.sort_by_key(|source| source.sample);
        if sources.first().is_none_or(|source| source.sample != 0) {
            let why = left_out.first().map_or(String::new(), |entry| {
                format!(" ({}: {})", entry.run, entry.reason)
            });
            let found = format!(
                "{:?}, of which no run in {environment} tells anything{why}",
                sample.id
            );
            return Err(PipelineError::bad_argument(
                "--sample",
                found,
                "a sample with fitted runs; `ieap run --only fit` makes them".to_owned(),
            ));
        }
        let curves_of = |run: &RunRecord, quantity: Quantity| -> Result<Vec<f64>, PipelineError> {
            let curves = drawn.of(run)?.curves;
            let of = curves.into_iter().find(|curve| curve.quantity == quantity);
            Ok(of.map(|curve| curve.measured).unwrap_or_default())
        };
        let findings = current_findings(context)?;
        let humidity_percent = asked
            .humidity_percent()
            .or_else(|| mean_humidity(runs, &sample.id));
        let modulus = match asked.modulus_mpa {
            Some(given) => StripModulus {
                modulus_mpa: Estimate {
                    standard_error: Some(given.standard_error),
                    ..Estimate::exact(given.value)
                },
                source: "modulus as given".to_owned(),
            },
            None => strip_modulus(context, sample, humidity_percent)?,
        };
        let of_fits = sources
            .iter()
            .find_map(|source| source.electrode_resistance_ohm_per_sq);
        Ok(Grounds {
            environment,
            humidity_percent,
            misfit: known_misfit(&findings.groups, &sources, runs, curves_of)?,
            onset_v: found_onset(&findings.groups, &sources),
            to: asked.size(&from),
            from,
            is_another: asked.is_another(),
            electrode_resistance_ohm_per_sq: asked
                .electrode_resistance_ohm_per_sq
                .or(sample.electrode_resistance_ohm_per_sq)
                .or(of_fits),
            sample: sample.clone(),
            modulus,
            brought: (
                surroundings.brought(),
                surroundings.sentences(&all_keys(&sources)),
            ),
            sources,
            left_out,
        })
    }

    /// To which conditions the runs were taken, after the name of one; nothing where they were made there.
    pub fn brought_in_short(&self) -> String {
        let of = |brought: &BroughtEntry| {
            format!(
                ", taken to {} {} by the laws of the study",
                brought.to, brought.unit
            )
        };
        self.brought.0.iter().map(of).collect()
    }

    /// The runs of the sample itself.
    pub fn own(&self) -> impl Iterator<Item = &Source> {
        self.sources.iter().filter(|source| source.sample == 0)
    }

    /// Whether any run of the sample tells how it bends.
    pub fn bends(&self) -> bool {
        self.own().any(|source| source.bends)
    }

    /// Whether the parameters change under the drive.
    pub fn changes(&self) -> bool {
        self.sources.iter().any(|source| !source.changes.is_empty())
    }

    /// The last time that a run of the sample shows, s after its drive began.
    pub fn longest_s(&self) -> f64 {
        self.own().map(|source| source.lasted_s).fold(0.0, f64::max)
    }

    /// Largest and smallest voltage of the sample's runs, V.
    pub fn measured_v(&self) -> (f64, f64) {
        range_of(self.own().map(|source| source.step_v))
    }

    /// Whether a run tells of the strip asked for: of another one those of all samples do.
    pub fn tells(&self, source: &Source) -> bool {
        source.sample == 0 || self.is_another
    }

    /// What every one of these says of the drive.
    fn told<'a>(
        &self,
        sources: &'a [Source],
        drive: &Drive,
        time_s: &[f64],
    ) -> Result<Vec<(&'a Source, Prediction)>, PipelineError> {
        let said = |source: &'a Source| -> Result<(&'a Source, Prediction), PipelineError> {
            let identified = source.identified(self.electrode_resistance_ohm_per_sq);
            let mut to = self.to;
            if source.sample != 0 {
                // Whether strips of one material are one laminate is what their spread says.
                to.thickness_mm = source.size.thickness_mm;
            }
            Ok((source, predict(&identified, &to, drive, time_s)?))
        };
        let telling = sources.iter().filter(|source| self.tells(source));
        telling.map(said).collect()
    }

    /// Curvature and tip as the centre of all sources has them, without intervals.
    pub fn centre(&self, drive: &Drive, time_s: &[f64]) -> Result<(Vec<f64>, Vec<f64>), PipelineError> {
        let exact: Vec<Source> = self.sources.iter().map(without_errors).collect();
        let told = self.told(&exact, drive, time_s)?;
        let applied = applied_until(drive, time_s);
        let centre = |of: &dyn Fn(&Prediction) -> &Series| {
            let all = self.of_series(&[told.as_slice()], applied, true, 0.0, of);
            all.iter().map(|forecast| forecast.value).collect()
        };
        Ok((
            centre(&|prediction| &prediction.curvature_per_cm),
            centre(&|prediction| &prediction.tip_displacement_mm),
        ))
    }

    /// Forecasts of a drive.
    ///
    /// # Errors
    /// The strip is of another laminate, or charges unevenly under an open circuit.
    pub(super) fn forecasts(&self, drive: &Drive, time_s: &[f64]) -> Result<Forecasts, PipelineError> {
        let told = self.told(&self.sources, drive, time_s)?;
        let applied = applied_until(drive, time_s);
        let variants = self.sources.first().map_or(0, |source| source.variants.len());
        let others: Vec<Vec<Source>> = (0..variants).map(|which| self.variant(which)).collect();
        let told_by_others: Vec<Vec<(&Source, Prediction)>> = others
            .iter()
            .map(|other| self.told(other, drive, time_s))
            .collect::<Result<_, _>>()?;
        let mut all = vec![told.as_slice()];
        all.extend(told_by_others.iter().map(Vec::as_slice));
        let of = |bends: bool, share: f64, of: &dyn Fn(&Prediction) -> &Series| {
            self.of_series(&all, applied, bends, share, of)
        };
        let misfit = &self.misfit;
        let distributed = |(_, p): &(&Source, Prediction)| p.carried_by == CarriedBy::Distributed;
        let errors = told.iter().filter_map(|(_, p)| p.lumped_error);
        let of_tip = errors.map(|error| error.first_displacement.max(error.final_displacement));
        Ok(Forecasts {
            current_a: of(false, misfit.current, &|p| &p.current_a),
            charge_c: of(false, misfit.charge, &|p| &p.charge_c),
            leaked_charge_c: of(false, misfit.charge, &|p| &p.leaked_charge_c),
            curvature_per_cm: of(true, misfit.curvature, &|p| &p.curvature_per_cm),
            tip_displacement_mm: of(true, misfit.curvature, &|p| &p.tip_displacement_mm),
            local_curvature_per_cm: (0..LINKS)
                .map(|k| of(true, misfit.curvature, &|p| &p.local_curvature_per_cm[k]))
                .collect(),
            lumped_error: of_tip.reduce(f64::max),
            carried_by: if told.iter().any(distributed) {
                CarriedBy::Distributed
            } else {
                CarriedBy::Lumped
            },
        })
    }

    /// What a variant of the laws makes of the sources.
    fn variant(&self, which: usize) -> Vec<Source> {
        let varied = |source: &Source| Source {
            model: source.variants[which].clone(),
            changes: source.variant_changes.get(which).cloned().unwrap_or_default(),
            ..without_errors(source)
        };
        self.sources.iter().map(varied).collect()
    }

    /// Forecasts of one response over its times; what the model gets wrong is a share of its range. First what the sources
    /// tell, then what each variant of the laws would.
    fn of_series(
        &self,
        told: &[&[(&Source, Prediction)]],
        applied: Applied,
        needs_bending: bool,
        misfit: f64,
        of: &dyn Fn(&Prediction) -> &Series,
    ) -> Vec<Forecast> {
        let times = told[0].first();
        let times = times.map_or(0, |(_, prediction)| of(prediction).value.len());
        let at = |which: usize, k: usize, beside: Beside| {
            let bending = told[which]
                .iter()
                .filter(|(source, _)| source.bends || !needs_bending);
            let values: Vec<Told> = bending
                .map(|(source, prediction)| Told {
                    sample: source.sample,
                    step_v: source.step_v,
                    value: of(prediction).value[k],
                    standard_error: of(prediction).standard_error[k],
                })
                .collect();
            forecast(&values, applied, self.is_another, beside)
        };
        let centre = |which: usize, k: usize| Some(at(which, k, Beside::default())?.value);
        let centres: Vec<f64> = (0..times).filter_map(|k| centre(0, k)).collect();
        let (low, high) = range_of(centres.iter().copied().chain([0.0]));
        let moved_by = |which: usize, k: usize| Some(centre(which, k)? - centres.get(k)?);
        let of_laws = |k: usize| -> f64 {
            let squares = (1..told.len()).filter_map(|which| Some(moved_by(which, k)?.powi(2)));
            squares.sum::<f64>().sqrt()
        };
        let beside = |k: usize| Beside {
            conditions: of_laws(k),
            misfit: misfit * (high - low),
        };
        (0..times).filter_map(|k| at(0, k, beside(k))).collect()
    }
}

/// Keys of the parameters of all sources, each once.
fn all_keys(sources: &[Source]) -> Vec<String> {
    let mut keys: Vec<String> = Vec::new();
    for key in sources.iter().flat_map(|source| &source.keys) {
        if !keys.contains(key) {
            keys.push(key.clone());
        }
    }
    keys
}

/// The voltages of a drive up to the last of the times.
pub(super) fn applied_until(drive: &Drive, time_s: &[f64]) -> Applied {
    applied(drive, time_s.iter().copied().fold(0.0, f64::max))
}

/// A run whose group was fitted with laws, or why it tells nothing: laws are known of the strip and the conditions that they were
/// found in, and runs of one group at one voltage share all of their parameters.
fn with_its_laws(source: Source, is_elsewhere: bool, before: &[Source]) -> Result<Source, String> {
    if source.laws.is_empty() {
        return Ok(source);
    }
    if is_elsewhere {
        return Err(format!(
            "it is fitted with {}, whose laws are known of that strip and these conditions alone",
            source.fitted_with
        ));
    }
    let is_same = |other: &&Source| {
        (&other.model, &other.laws) == (&source.model, &source.laws) && is_alike(other.step_v, source.step_v)
    };
    match before.iter().find(is_same) {
        Some(first) => Err(format!(
            "it was fitted together with {}, which tells the same",
            first.run
        )),
        None => Ok(source),
    }
}

fn without_errors(source: &Source) -> Source {
    Source {
        covariance: vec![0.0; source.covariance.len()],
        ..source.clone()
    }
}

/// Number of another sample, from 1 on.
fn number_of<'a>(others: &mut Vec<&'a str>, id: &'a str) -> usize {
    let at = others.iter().position(|other| *other == id);
    1 + at.unwrap_or_else(|| {
        others.push(id);
        others.len() - 1
    })
}

/// The environment asked for, or the only one in which the sample was measured.
fn environment(runs: &[RunRecord], asked: &AskedStrip) -> Result<String, PipelineError> {
    let own = runs
        .iter()
        .filter(|run| run.tag(keys::SAMPLE) == Some(&asked.sample));
    let mut known: Vec<&str> = own.filter_map(|run| run.tag(keys::ENVIRONMENT)).collect();
    known.sort_unstable();
    known.dedup();
    let needed = format!("one of {}", known.join(", "));
    match (&asked.environment, known.as_slice()) {
        (Some(asked), known) if known.contains(&asked.as_str()) => Ok(asked.clone()),
        (Some(found), [_, ..]) => Err(PipelineError::bad_argument(
            "--environment",
            format!("{found:?}"),
            needed,
        )),
        (None, [only]) => Ok((*only).to_owned()),
        (None, [_, ..]) => Err(PipelineError::bad_argument(
            "--environment",
            "nothing".to_owned(),
            needed,
        )),
        (_, []) => Err(PipelineError::bad_argument(
            "--sample",
            format!("{:?}, which has no run in results", asked.sample),
            "a sample with fitted runs; `ieap status` lists the runs".to_owned(),
        )),
    }
}

fn mean_humidity(runs: &[RunRecord], sample: &str) -> Option<f64> {
    let own = runs.iter().filter(|run| run.tag(keys::SAMPLE) == Some(sample));
    let stated: Option<Vec<f64>> = own
        .map(|run| run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT))
        .collect();
    let stated = stated.filter(|stated| !stated.is_empty())?;
    Some(stated.iter().sum::<f64>() / stated.len() as f64)
}
