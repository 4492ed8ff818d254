//! What the page of a group says first: one picture of the worst run, the errors before and after, what it may be.

use ieap_domain::diagnosis::LAW;
use ieap_domain::words::in_a_row;
use std::collections::BTreeMap;

use serde::Serialize;

use super::finding_gain::{called, extension};
use super::wording::{EstimateText, RunLink, with_index};
use crate::error::ReportError;
use crate::figures::residual::overlay;
use crate::input::{EffectParameterText, Findings};
use crate::site::Site;
use ieap_domain::number::significant;
use ieap_domain::{EffectFinding, GroupDiagnosis, ResidualCurve};
use ieap_show::Block;

/// The open part of the page.
#[derive(Debug, Serialize)]
pub struct Answer {
    /// The run that is drawn.
    run: Option<DrawnLink>,
    /// Ids of its figures, a channel each.
    figures: Vec<String>,
    /// What the line of the extension is called; empty where there is none.
    extension: &'static str,
    /// How large the misfit is over all runs; empty where there is none.
    size: String,
}

#[derive(Debug, Serialize)]
struct DrawnLink {
    link: Option<RunLink>,
    path: String,
    /// `of 3 runs the one with the largest residual`; empty where there is one run.
    which: String,
}

/// The open part of the page of that finding; its figures go to `figures`.
///
/// # Errors
/// [`ReportError::Figure`] where a figure cannot be drawn.
pub fn answer(
    site: &Site,
    found: &GroupDiagnosis,
    figures: &mut BTreeMap<String, String>,
) -> Result<Answer, ReportError> {
    let mut ids = Vec::new();
    let worst = worst_run(found);
    let shown = found
        .residuals
        .iter()
        .filter(|curve| Some(curve.run.as_str()) == worst);
    for curve in shown {
        let id = format!("answer-{}", curve.channel);
        let title = format!("{} of {}, measured and simulated", curve.channel, curve.run);
        let drawn = overlay(
            curve,
            called(found),
            site.clock_of(&curve.run),
            &title,
            &seen(curve, found),
        );
        let drawn = drawn.map_err(ReportError::of_figure(&id))?;
        if let Some(svg) = drawn {
            figures.insert(id.clone(), svg);
            ids.push(id);
        }
    }
    let is_extended = found.residuals.iter().any(|curve| !curve.after_sigma.is_empty());
    Ok(Answer {
        run: worst
            .filter(|_| !ids.is_empty())
            .map(|path| drawn_link(site, found, path)),
        figures: ids,
        extension: if is_extended { extension(found) } else { "" },
        size: size_words(found),
    })
}

/// The run with the largest residual of any channel.
fn worst_run(found: &GroupDiagnosis) -> Option<&str> {
    let worst = found.residuals.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
    worst.map(|curve| curve.run.as_str())
}

/// Mean square of what the base model leaves.
pub fn size(curve: &ResidualCurve) -> f64 {
    let finite = curve.before_sigma.iter().filter(|sigma| sigma.is_finite());
    finite.map(|sigma| sigma * sigma).sum::<f64>() / curve.before_sigma.len().max(1) as f64
}

/// What is seen in the figure: how far the models are off at most.
fn seen(curve: &ResidualCurve, found: &GroupDiagnosis) -> String {
    let most = |sigma: &[f64]| {
        sigma
            .iter()
            .filter(|s| s.is_finite())
            .fold(0.0, |most: f64, s| most.max(s.abs()))
    };
    let before = significant(most(&curve.before_sigma), 2);
    if curve.after_sigma.is_empty() {
        format!("The base model is off by up to {before} standard deviations of the noise.")
    } else {
        format!(
            "The base model is off by up to {before} standard deviations of the noise, the {} by up to {}.",
            extension(found),
            significant(most(&curve.after_sigma), 2)
        )
    }
}

fn drawn_link(site: &Site, found: &GroupDiagnosis, path: &str) -> DrawnLink {
    DrawnLink {
        link: site.run_of(path).map(|run| RunLink::to(site, run)),
        path: path.to_owned(),
        which: match found.runs.len() {
            0 | 1 => String::new(),
            runs => format!("of {runs} runs the one with the largest residual"),
        },
    }
}

/// How large the misfit is, where there is one.
fn size_words(found: &GroupDiagnosis) -> String {
    if !found.verdict.is_misfit() {
        return String::new();
    }
    let size = found.misfit_percent;
    // What is nothing needs no word.
    let of = |percent: Option<f64>, what: &str| {
        let seen = percent.map(|own| significant(own, 2)).filter(|own| own != "0")?;
        Some(format!("{seen} % of {what}"))
    };
    let sizes: Vec<String> = [
        of(size.current, "the range of the current"),
        of(size.curvature, "the range of the curvature"),
        of(size.charge, "the charge in the worst run"),
    ]
    .into_iter()
    .flatten()
    .collect();
    if sizes.is_empty() {
        String::new()
    } else {
        format!("The simulation is off by {}.", in_a_row(&sizes))
    }
}

/// The size of every effect that was found; none where there is none. A law without a name is drawn: the weights of its
/// curve tell nobody anything.
pub fn strengths(found: &GroupDiagnosis, findings: &Findings) -> Option<Block> {
    let named = found.effects.iter().filter(|own| !own.effect.starts_with(LAW));
    let sizes = named.map(|effect| strength(effect, findings));
    let sizes: Vec<Block> = sizes.map(Block::Say).collect();
    (!sizes.is_empty()).then(|| Block::part("How strong it is", sizes))
}

/// `faradaic-leak: i₀ = (2.13 ± 0.12)·10⁻⁵ A/cm2`
fn strength(finding: &EffectFinding, findings: &Findings) -> String {
    let known = findings.effect(&finding.effect);
    let value = |parameter: &ieap_domain::Parameter| {
        let text = known.and_then(|effect| effect.parameters.iter().find(|p| p.key == parameter.key));
        let (symbol, unit) = symbol_and_unit(&parameter.key, text);
        let symbol = with_index(symbol);
        let shown = EstimateText::of(&parameter.estimate, 1.0);
        match shown.kind {
            "missing" => format!("{symbol} is not determined"),
            "bound" => format!("{symbol} {} {unit}", shown.text).trim_end().to_owned(),
            _ => format!("{symbol} = {} {unit}", shown.text).trim_end().to_owned(),
        }
    };
    let values: Vec<String> = finding.parameters.iter().map(value).collect();
    format!("{}: {}", finding.effect, values.join(", "))
}

/// Symbol and unit of an effect's parameter; its key where nothing else is known.
pub fn symbol_and_unit<'a>(key: &'a str, known: Option<&'a EffectParameterText>) -> (&'a str, &'a str) {
    known.map_or((key, ""), |known| (known.symbol.as_str(), known.unit.as_str()))
}
