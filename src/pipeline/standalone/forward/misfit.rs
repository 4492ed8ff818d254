//! What the model is known to get wrong, as a share of what is predicted: from the diagnosis, else from the fits.

use super::source::Source;
use crate::domain::{Estimate, GroupDiagnosis, Quantity, RunRecord, range_of};
use crate::pipeline::PipelineError;

/// Id of the effect whose onset is that of electrolysis.
const ELECTROLYSIS: &str = "faradaic-leak";

/// Root mean squares beyond the noise, as shares of the range of each response.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct KnownMisfit {
    /// Of the current.
    pub current: f64,
    /// Of the curvature.
    pub curvature: f64,
    /// Of the charge.
    pub charge: f64,
    /// Where this is from, one sentence.
    pub source: String,
}

/// The largest misfit of the groups that the sources lie in; without a diagnosis what the fits leave.
pub(super) fn known_misfit(
    groups: &[GroupDiagnosis],
    sources: &[Source],
    runs: &[RunRecord],
    measured: impl Fn(&RunRecord, Quantity) -> Result<Vec<f64>, PipelineError>,
) -> Result<KnownMisfit, PipelineError> {
    // A diagnosis says what the base model gets wrong: of a model that has laws it is what its own fits leave.
    let of_sources = diagnosed(groups, sources.iter().filter(|source| source.laws.is_empty()));
    let has_laws = sources.iter().any(|source| !source.laws.is_empty());
    let largest = |percent: &dyn Fn(&GroupDiagnosis) -> Option<f64>| {
        let all = of_sources.iter().filter_map(|group| percent(group));
        all.reduce(f64::max).map(|percent| percent / 100.0)
    };
    let current = largest(&|group| group.misfit_percent.current);
    let curvature = largest(&|group| group.misfit_percent.curvature);
    let charge = largest(&|group| group.misfit_percent.charge);
    if current.is_some() || curvature.is_some() {
        let current = current.unwrap_or(0.0);
        return Ok(KnownMisfit {
            current,
            curvature: curvature.unwrap_or(0.0),
            charge: charge.unwrap_or(current),
            source: format!(
                "What the model gets wrong is from the diagnosis: {}",
                of_sources[0].sentence
            ),
        });
    }
    let left = |quantity| {
        let mut largest = 0.0_f64;
        for run in runs {
            if sources.iter().any(|source| source.run == run.path) {
                largest = largest.max(left_by_fit(run, quantity, &measured)?);
            }
        }
        Ok::<_, PipelineError>(largest)
    };
    let current = left(Quantity::Current)?;
    Ok(KnownMisfit {
        current,
        curvature: left(Quantity::Curvature)?,
        charge: current,
        source: if has_laws {
            "What the fits with their laws leave beyond the noise stands for what the model gets wrong."
                .to_owned()
        } else {
            "No diagnosis is stored for these runs: what their fits leave beyond the noise stands for what the model gets wrong (`ieap diagnose` says more)."
                .to_owned()
        },
    })
}

fn diagnosed<'a, 's>(
    groups: &'a [GroupDiagnosis],
    sources: impl Iterator<Item = &'s Source> + Clone,
) -> Vec<&'a GroupDiagnosis> {
    let own = |group: &&GroupDiagnosis| {
        let mut of_sample = sources.clone().filter(|source| source.sample == 0);
        of_sample.any(|source| group.runs.contains(&source.run))
    };
    groups.iter().filter(own).collect()
}

/// What a run's fit leaves beyond the noise, as a part of the range of the response; nothing where it has none.
fn left_by_fit(
    run: &RunRecord,
    quantity: Quantity,
    measured: &impl Fn(&RunRecord, Quantity) -> Result<Vec<f64>, PipelineError>,
) -> Result<f64, PipelineError> {
    let mut noises = run.fit.iter().flat_map(|fit| &fit.noise);
    let Some(noise) = noises.find(|noise| noise.quantity == quantity) else {
        return Ok(0.0);
    };
    let beyond = noise.residual_rms.powi(2) - noise.standard_deviation.powi(2);
    let (low, high) = range_of(measured(run, quantity)?);
    Ok(if high > low {
        beyond.max(0.0).sqrt() / (high - low)
    } else {
        0.0
    })
}

/// Onset of electrolysis that a diagnosis of the sources accepted, V; the lowest where there are several.
pub(super) fn found_onset(groups: &[GroupDiagnosis], sources: &[Source]) -> Option<Estimate> {
    let findings = diagnosed(groups, sources.iter())
        .into_iter()
        .flat_map(|group| &group.effects);
    let onsets = findings.filter(|finding| finding.effect == ELECTROLYSIS);
    let onsets = onsets.flat_map(|finding| &finding.parameters);
    let onsets = onsets.filter(|parameter| parameter.key == "onset_v");
    let known = onsets
        .map(|parameter| &parameter.estimate)
        .filter(|estimate| estimate.value.is_some());
    known
        .min_by(|a, b| a.value.partial_cmp(&b.value).unwrap_or(std::cmp::Ordering::Equal))
        .cloned()
}

#[cfg(test)]
mod tests {
    use super::ELECTROLYSIS;

    #[test]
    fn electrolysis_is_an_effect_with_an_onset() {
        let effect = crate::model::effects::effect(ELECTROLYSIS).unwrap();
        assert!(
            effect
                .about()
                .parameters
                .iter()
                .any(|parameter| parameter.key == "onset_v")
        );
    }
}
