//! What the fit of one run says: its parameters, how it ended, how its residuals compare with the noise.

use ieap_domain::words::{counted, in_a_row};

use super::estimates::{self, Number};
use super::run_evidence::Fact;
use super::wording::in_unit;
use crate::pages::policy::{CORRELATED_FROM, SYSTEMATIC_FROM, WITHIN_NOISE};
use ieap_analysis::cycles::CycleRun;
use ieap_analysis::laws::doubt::Doubts;
use ieap_analysis::model_free::{ENERGIES, FIGURES, ModelFree};
use ieap_analysis::parameters::shown_in;
use ieap_domain::ParameterInfo;
use ieap_domain::number::{score, significant};
use ieap_domain::{ChannelNoise, Estimate, Fit, Parameter, Quantity, RunRecord};
use ieap_show::Block;

/// How the residuals compare with the noise, what the run does not determine, or why there is no fit.
///
/// A fit of one run can follow its readings where the model is wrong: `doubted`, that the misfit of its group is claimed, is
/// said in the same breath.
pub fn summary(record: &RunRecord, doubted: bool) -> Vec<String> {
    let Some(fit) = &record.fit else {
        return vec![format!("Not fitted: {}.", record.state.why_unfitted())];
    };
    let mut sentences = Vec::new();
    if !fit.converged {
        sentences.push(format!(
            "The fit did not converge: {}. Its numbers are not to be used.",
            fit.why_stopped
        ));
    }
    if fit.noise.len() > 1 && fit.noise.iter().all(is_described) {
        sentences.push(described_sentence(&fit.noise))
    } else {
        sentences.extend(fit.noise.iter().map(noise_sentence))
    }
    if doubted && fit.noise.iter().any(is_described) {
        sentences.push(
            "By itself, that is: over all runs of its group the model is shown to be wrong.".to_owned(),
        );
    }
    let undetermined = fit
        .parameters
        .iter()
        .filter(|parameter| parameter.estimate.value.is_none());
    let symbols: Vec<String> = undetermined.map(|parameter| symbol_of(&parameter.key)).collect();
    if !symbols.is_empty() {
        sentences.push(format!("Not determined by this run: {}.", in_a_row(&symbols)));
    }
    sentences
}

/// Rms of the residual of a quantity over its noise; none where it was not fitted or its noise is not known.
pub fn residual_over_noise(fit: &Fit, quantity: Quantity) -> Option<String> {
    let noise = fit.noise.iter().find(|noise| noise.quantity == quantity)?;
    let ratio = noise.residual_rms / noise.standard_deviation;
    ratio.is_finite().then(|| significant(ratio, 2))
}

/// Whether the residual of a channel is what noise would leave.
pub fn is_described(noise: &ChannelNoise) -> bool {
    noise.residual_rms / noise.standard_deviation <= WITHIN_NOISE
        && noise.residual_autocorrelation < CORRELATED_FROM
}

/// `The fit follows the readings: it leaves 1.0 (current) and 0.81 (curvature) × the noise.`
fn described_sentence(noise: &[ChannelNoise]) -> String {
    let one = |noise: &ChannelNoise| {
        let ratio = significant(noise.residual_rms / noise.standard_deviation, 2);
        format!("{ratio} ({})", noise.quantity.label().to_lowercase())
    };
    let each: Vec<String> = noise.iter().map(one).collect();
    format!(
        "The fit follows the readings: it leaves {} × the noise.",
        in_a_row(&each)
    )
}

/// How the residual of one channel compares with its noise.
fn noise_sentence(noise: &ChannelNoise) -> String {
    let channel = noise.quantity.label();
    let ratio = noise.residual_rms / noise.standard_deviation;
    if !ratio.is_finite() {
        return format!("{channel}: the noise could not be estimated, so the residuals cannot be judged.");
    }
    let times = format!("{} × the noise", significant(ratio, 2));
    let correlated = noise.residual_autocorrelation >= CORRELATED_FROM;
    if is_described(noise) {
        return format!("{channel}: the fit follows the readings and leaves {times}.");
    }
    if ratio >= SYSTEMATIC_FROM {
        return format!("{channel}: the fit leaves {times}; the model lacks something.");
    }
    if correlated {
        return format!(
            "{channel}: the fit leaves {times}, but neighbouring residuals go together: a small systematic misfit."
        );
    }
    format!("{channel}: the fit leaves {times}: more than noise alone.")
}

/// Symbol of a parameter; its key where it is not known.
pub fn symbol_of(key: &str) -> String {
    ParameterInfo::of(key).map_or_else(|| key.to_owned(), |parameter| parameter.symbol.to_owned())
}

/// The parameters of a fit, with what a finding says against them.
pub fn parameters(doubts: &Doubts, run: &str, fit: &Fit) -> Vec<Number> {
    let number = |parameter: &Parameter| {
        let known = ParameterInfo::of(&parameter.key);
        let (unit, factor) = known.map_or(("", 1.0), |known| shown_in(known, fit));
        let stated = doubts.stated(run, &parameter.key, &parameter.estimate);
        Number {
            symbol: symbol_of(&parameter.key),
            name: known.map_or_else(String::new, |known| known.name.to_owned()),
            unit: unit.to_owned(),
            estimate: stated.scaled(factor),
        }
    };
    fit.parameters.iter().map(number).collect()
}

/// What a run says without a model.
pub fn model_free(own: &ModelFree) -> Block {
    let number = |(figure, estimate): (&ieap_show::Quantity, &Estimate)| Number {
        symbol: figure.symbol.to_owned(),
        name: figure.name.to_owned(),
        unit: figure.unit.to_owned(),
        estimate: estimate.clone(),
    };
    let step = FIGURES.iter().zip(&own.values);
    let numbers = step.chain(ENERGIES.iter().zip(&own.energies)).map(number);
    let numbers: Vec<Number> = numbers.collect();
    let table = Block::Table(estimates::table("Of the first level", &numbers));
    Block::part("Without a model", vec![table])
}

/// What a train says of its cycles, in sentences.
pub fn cycles(own: &CycleRun) -> Block {
    let mut sentences: Vec<Block> = own.sentences.iter().map(Block::say).collect();
    if sentences.is_empty() {
        sentences.push(Block::say("No number of the cycles has a trend."));
    }
    sentences.push(Block::say(format!(
        "{} are told apart; every one stands in the table cycles (`ieap table cycles`).",
        counted(own.cycles.len(), "cycle")
    )));
    Block::part("Cycles", sentences)
}

/// How the fit was made and ended.
pub fn facts(fit: &Fit, record: &RunRecord) -> Vec<Fact> {
    let program = record
        .fit_made_by
        .as_ref()
        .map_or("a program version that is not stored", |by| &by.version);
    let verb = if fit.converged {
        "converged"
    } else {
        "did not converge"
    };
    // Where a search ended well there is one reason, which says nothing of this run.
    let why = if fit.converged {
        String::new()
    } else {
        format!(": {}", said_once(&fit.why_stopped))
    };
    let evaluations = counted(fit.evaluations as usize, "evaluation");
    let mut facts = vec![
        (
            "Model".to_owned(),
            format!("{} version {}, fitted by {program}", fit.model, fit.model_version),
        ),
        ("Search".to_owned(), fit.method.clone()),
        ("Fit".to_owned(), format!("{verb} after {evaluations}{why}")),
    ];
    facts.extend(fit.noise.iter().map(noise_fact));
    facts
}

/// R² by what it is of.
pub fn r_squared(fit: &Fit) -> Vec<Fact> {
    let both = [
        ("current", fit.r_squared_current),
        ("curvature", fit.r_squared_curvature),
    ];
    both.into_iter()
        .filter_map(|(of, value)| Some((format!("R² of {of}"), score(value?))))
        .collect()
}

/// `current: x; curvature: x` as `x`.
fn said_once(reasons: &str) -> &str {
    let of_each = || {
        reasons
            .split("; ")
            .map(|reason| reason.split_once(": ").map(|(_, why)| why))
    };
    match of_each().next().flatten() {
        Some(first) if of_each().count() > 1 && of_each().all(|reason| reason == Some(first)) => first,
        _ => reasons,
    }
}

/// Noise of a channel and where its estimate comes from.
fn noise_fact(noise: &ChannelNoise) -> Fact {
    let amount = in_unit(noise.standard_deviation, noise.quantity.unit());
    let label = format!("{} noise", noise.quantity.label().to_lowercase());
    let told = match noise.character.runs_of_instrument {
        0 => String::new(),
        others => format!(
            "; how slow it may be {} of the instrument told as well",
            counted(others as usize, "other run")
        ),
    };
    (
        label,
        format!(
            "{amount} ({}; {}{told})",
            noise.basis,
            counted(noise.readings, "reading")
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(residual_rms: f64, residual_autocorrelation: f64) -> ChannelNoise {
        ChannelNoise {
            quantity: Quantity::Current,
            standard_deviation: 1e-6,
            basis: "differences of neighbours".to_owned(),
            character: Default::default(),
            residual_autocorrelation,
            residual_rms,
            readings: 1200,
            r_squared: None,
        }
    }

    #[test]
    fn residuals_are_judged_against_noise_and_correlation() {
        assert!(
            noise_sentence(&noise(1.2e-6, 0.1)).contains("follows the readings and leaves 1.2 × the noise")
        );
        assert!(noise_sentence(&noise(1.2e-6, 0.9)).contains("small systematic misfit"));
        assert!(noise_sentence(&noise(20e-6, 0.99)).contains("leaves 20 × the noise; the model lacks"));
        assert!(noise_sentence(&noise(2e-6, 0.0)).contains("more than noise alone"));
        let silent = ChannelNoise {
            standard_deviation: 0.0,
            ..noise(1.0, 0.0)
        };
        assert!(noise_sentence(&silent).contains("could not be estimated"));
    }

    #[test]
    fn noise_that_other_runs_told_of_says_how_many() {
        let alone = noise(1e-6, 0.0);
        assert!(!noise_fact(&alone).1.contains("instrument"));
        let mut told = alone;
        told.character.runs_of_instrument = 1;
        assert!(noise_fact(&told).1.contains("1 other run of the instrument"));
        told.character.runs_of_instrument = 15;
        assert!(noise_fact(&told).1.contains("15 other runs of the instrument"));
    }
}
