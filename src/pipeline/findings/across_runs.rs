//! What holds across the runs of a campaign, found from the current fits whenever it is read.

use crate::analysis::cache::{Cache, Hash};
use crate::analysis::laws::doubt::{Doubts, Findings};
use crate::analysis::laws::facts::{RunFacts, facts};
use crate::analysis::laws::{Attempt, CampaignLaws, Evidence, find};
use crate::analysis::study::{self, Study};
use crate::domain::tag::keys;
use crate::domain::{FileState, Quantity, RunCurve, RunRecord, RunState, RunStatus};
use crate::ingest::name_pattern::{KnownIds, NameMatch, NamePattern};
use crate::pipeline::PipelineError;
use crate::pipeline::campaign::context::Context;
use crate::pipeline::campaign::planned::{PlannedRow, planned};
use crate::pipeline::findings::current::CurrentFindings;
use crate::pipeline::fits::drawn::DrawnFits;
use crate::pipeline::infra::fault::step;

/// Seed of the draws where none is asked for.
const SEED: u64 = 1;

/// Seeks laws, offsets and selection over the current runs, of which a diagnosis found this; what was found of a material before is taken from `kept`.
///
/// # Errors
/// The database cannot be read, or a fault of the program stops the search.
pub fn campaign_laws(
    context: &Context,
    (runs, findings): (&[RunRecord], &CurrentFindings),
    seed: Option<u64>,
    kept: &Cache,
) -> Result<CampaignLaws, PipelineError> {
    let charge_c = charges(context, runs, kept)?;
    let attempts = attempts(context, runs)?;
    let findings = Findings {
        groups: &findings.groups,
        runs: &findings.runs,
    };
    step("what holds across runs", || {
        let study = Study::of(study::Evidence {
            runs,
            campaign: &context.campaign,
            doubts: &Doubts::new(findings, runs),
            curves: &[],
        });
        Ok(find(&Evidence {
            findings,
            of_humidity: &study.of_humidity(),
            runs,
            campaign: &context.campaign,
            charge_c: &charge_c,
            attempts: &attempts,
            seed: seed.unwrap_or(SEED),
            kept,
        }))
    })
}

/// What is known of these runs that a parameter may follow, with the charge that passed before each.
///
/// # Errors
/// The database cannot be read.
pub(crate) fn campaign_facts(
    context: &Context,
    runs: &[RunRecord],
    kept: &Cache,
) -> Result<Vec<RunFacts>, PipelineError> {
    Ok(facts(runs, &context.campaign, &charges(context, runs, kept)?))
}

/// Charge that passed in each run, C: the magnitude of the current integrated over the curve of its fit, which keeps the
/// extremes of each stretch of time.
fn charges(context: &Context, runs: &[RunRecord], kept: &Cache) -> Result<Vec<Option<f64>>, PipelineError> {
    let drawn = DrawnFits::new(context);
    let read = |run: &RunRecord| -> Result<Option<f64>, PipelineError> {
        let curves = drawn.of(run)?.curves;
        let current = curves.iter().find(|curve| curve.quantity == Quantity::Current);
        Ok(current.map(integral))
    };
    let charge = |run: &RunRecord| {
        if run.fit.is_none() {
            return Ok(None);
        }
        let state = context.store.state_of_curves(run.id)?;
        let hash = Hash::default().with(&"charge").with(&state).text();
        if let Some(charge) = kept.earlier(&hash) {
            return Ok(charge);
        }
        let charge = read(run)?;
        kept.put(&hash, &charge);
        Ok(charge)
    };
    runs.iter().map(charge).collect()
}

fn integral(curve: &RunCurve) -> f64 {
    let pairs = curve.time_s.windows(2).zip(curve.measured.windows(2));
    pairs
        .map(|(time, current)| (time[1] - time[0]) * 0.5 * (current[0].abs() + current[1].abs()))
        .sum()
}

/// Every run that was tried: stored ones, refused files whose name says what they were, and planned ones that were
/// passed over.
fn attempts(context: &Context, runs: &[RunRecord]) -> Result<Vec<Attempt>, PipelineError> {
    let mut attempts: Vec<Attempt> = runs
        .iter()
        .filter(|run| run.state != RunState::Untagged)
        .map(attempt)
        .collect();
    attempts.extend(refused(context)?);
    attempts.extend(passed_over(context, runs)?);
    Ok(attempts)
}

fn attempt(run: &RunRecord) -> Attempt {
    let usable = run.fit.as_ref().is_some_and(|fit| fit.converged);
    let broken = matches!(run.status, RunStatus::Aborted | RunStatus::Cut);
    Attempt {
        environment: run.tag(keys::ENVIRONMENT).map(str::to_owned),
        voltage_v: run.tag_number(keys::VOLTAGE_V).map(f64::abs),
        relative_humidity_percent: run.tag_number(keys::RELATIVE_HUMIDITY_PERCENT),
        failed: !usable || broken,
    }
}

/// Planned runs that never came: open rows of run sheets of which a later one has been made.
fn passed_over(context: &Context, runs: &[RunRecord]) -> Result<Vec<Attempt>, PipelineError> {
    let open = planned(context, runs)?.open.into_iter();
    let attempt = |row: PlannedRow| Attempt {
        environment: row.row.environment,
        voltage_v: row.row.voltage_v.map(f64::abs),
        relative_humidity_percent: row.row.relative_humidity_percent,
        failed: true,
    };
    Ok(open.filter(|row| row.passed_over).map(attempt).collect())
}

/// Refused files of runs whose name gives a tag.
fn refused(context: &Context) -> Result<Vec<Attempt>, PipelineError> {
    let campaign = &context.campaign;
    let Some(pattern) = campaign
        .name_pattern
        .as_deref()
        .and_then(|text| NamePattern::compile(text).ok())
    else {
        return Ok(Vec::new());
    };
    let samples: Vec<&str> = campaign.samples.iter().map(|sample| sample.id.as_str()).collect();
    let environments: Vec<&str> = campaign
        .environments
        .iter()
        .map(|known| known.id.as_str())
        .collect();
    let known = KnownIds {
        samples: &samples,
        environments: &environments,
    };
    let files = context.store.files()?;
    let refused = files
        .iter()
        .filter(|file| file.state == FileState::Refused && file.missing_since.is_none());
    let attempt = |path: &str| {
        let name = path.rsplit('/').next().unwrap_or(path);
        let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
        let tags = match pattern.match_stem(stem, known) {
            NameMatch::One(tags) => tags,
            NameMatch::Several { agreed, .. } => agreed,
            NameMatch::None => return None,
        };
        let tag = |key: &str| {
            tags.iter()
                .find(|(known, _)| known == key)
                .map(|(_, value)| value.as_str())
        };
        let number = |key: &str| tag(key)?.parse::<f64>().ok();
        Some(Attempt {
            environment: tag(keys::ENVIRONMENT).map(str::to_owned),
            voltage_v: number(keys::VOLTAGE_V).map(f64::abs),
            relative_humidity_percent: number(keys::RELATIVE_HUMIDITY_PERCENT),
            failed: true,
        })
    };
    Ok(refused.filter_map(|file| attempt(&file.path)).collect())
}
