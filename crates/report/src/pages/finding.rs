//! The page of one group: what the simulation gets wrong there, the cause, the extended model and its gain.

use ieap_domain::diagnosis::LAW;
use ieap_domain::finding_words::verdict_word;
use ieap_domain::number::probabilities::{counted_with_q, equation_of};
use ieap_domain::words::in_a_row;
use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::finding_alone::{AloneRow, alone_rows};
use super::finding_answer::{Answer, answer, size, symbol_and_unit};
use super::finding_differs::{DiffersBlock, differs_blocks};
use super::finding_gain::{GainSection, called, called_held_out, extension, gain_section};
use super::finding_law::{AccountPart, LawBlock, account_parts, law_blocks};
use super::finding_posterior::{HypothesisRow, hypothesis_rows};
use super::finding_words::{shift_words, test_words};
use super::wording::{EstimateText, RunLink, group_title, readable, with_index};
use crate::error::ReportError;
use crate::figures::profile::profile;
use crate::figures::residual::residual;
use crate::input::{EffectText, Findings};
use crate::pages::policy::{MOST_HELD_OUT_FIGURES, MOST_RESIDUAL_FIGURES};
use crate::site::Site;
use ieap_analysis::ParameterInfo;
use ieap_domain::campaign::Adopted;
use ieap_domain::number::{fixed, measured, significant};
use ieap_domain::{EffectFinding, GroupDiagnosis, ParameterShift, ResidualCurve, Verdict};

#[derive(Debug, Serialize)]
struct FindingPage {
    name: String,
    verdict: &'static str,
    key: &'static str,
    /// The answer in a sentence.
    lead: String,
    answer: Answer,
    /// How often chance gives as much.
    summary: Vec<String>,
    runs: Vec<NamedRun>,
    /// Parameters that differ, where that is the finding.
    differs: Vec<DiffersBlock>,
    /// Of what the error is made, as one bar.
    account: Vec<AccountPart>,
    /// The laws that are missing.
    laws: Vec<LawBlock>,
    hypotheses: Vec<HypothesisRow>,
    effects: Vec<EffectBlock>,
    set: Vec<SetMember>,
    next_run: Option<NextRunText>,
    shifts: Vec<ShiftRow>,
    shift_words: Vec<String>,
    /// The model adopted for the group, or how to adopt the one that was found.
    adoption: Option<String>,
    gain: Option<GainSection>,
    /// What the line of a figure is called: `extended model`, or what was tried.
    extension: &'static str,
    profiles: Vec<ResidualBlock>,
    held_out: Vec<ResidualBlock>,
    residuals: Vec<ResidualBlock>,
    not_drawn: String,
    stretches: Vec<StretchRow>,
    remarks: Vec<String>,
    alone: Vec<AloneRow>,
}

#[derive(Debug, Serialize)]
struct NamedRun {
    /// None where the run is gone.
    link: Option<RunLink>,
    path: String,
}

#[derive(Debug, Serialize)]
struct EffectBlock {
    id: String,
    variant: String,
    summary: String,
    equation: String,
    parameters: Vec<ParameterRow>,
    p: String,
    q: String,
    twins: String,
    separated_by: String,
}

#[derive(Debug, Serialize)]
struct ParameterRow {
    symbol: String,
    meaning: String,
    unit: String,
    estimate: EstimateText,
}

#[derive(Debug, Serialize)]
struct SetMember {
    id: String,
    summary: String,
    separated_by: String,
}

#[derive(Debug, Serialize)]
struct NextRunText {
    drive: String,
    splits: String,
    expected: String,
}

#[derive(Debug, Serialize)]
struct ShiftRow {
    symbol: String,
    unit: String,
    before: String,
    after: String,
}

#[derive(Debug, Serialize)]
struct ResidualBlock {
    heading: String,
    figure: String,
}

#[derive(Debug, Serialize)]
struct StretchRow {
    run: String,
    channel: String,
    times: String,
    sigma: String,
}

/// Makes the page of group number `place`.
pub fn content(site: &Site, place: usize) -> Result<Content, ReportError> {
    let findings = &site.input.findings;
    let found = &findings.groups[place];
    let mut figures = BTreeMap::new();
    let answer = answer(site, found, &mut figures)?;
    let residuals = residuals(site, found, &mut figures)?;
    let held_out = held_out(site, found, &mut figures)?;
    let profiles = profiles(found, findings, &mut figures)?;
    let laws = law_blocks(found, &mut figures)?;
    let differs = match found.verdict {
        Verdict::Differs => differs_blocks(found, &mut figures)?,
        _ => Vec::new(),
    };
    let shifts = found.shifts.iter();
    let drawn_of = found.residuals.len();
    let page = FindingPage {
        name: group_title(&found.group),
        verdict: verdict_word(found.verdict),
        key: found.verdict.key(),
        lead: readable(&found.sentence),
        answer,
        summary: test_words(found),
        runs: found.runs.iter().map(|path| named_run(site, path)).collect(),
        differs,
        account: account_parts(found.account.as_ref()),
        laws,
        hypotheses: hypothesis_rows(found, findings),
        effects: found
            .effects
            .iter()
            .map(|effect| effect_block(effect, found.draws, findings))
            .collect(),
        set: set(found, findings),
        next_run: found.next_run.as_ref().map(|next| NextRunText {
            drive: next.drive.clone(),
            splits: in_a_row(&next.splits),
            expected: significant(next.expected_set_size, 2),
        }),
        shift_words: shifts
            .clone()
            .filter_map(|s| shift_words(s, &symbol(&s.key).0))
            .collect(),
        shifts: shifts.map(shift_row).collect(),
        adoption: adoption(site, found),
        gain: gain_section(found),
        extension: extension(found),
        profiles,
        held_out,
        not_drawn: if drawn_of > residuals.len() {
            format!(
                "{} of {drawn_of} residuals are drawn, the largest first.",
                residuals.len()
            )
        } else {
            String::new()
        },
        residuals,
        stretches: stretches(found),
        remarks: found.remarks.clone(),
        alone: alone_rows(&found.alone, found.draws),
    };
    Content::new("finding.html", &page, figures)
}

fn named_run(site: &Site, path: &str) -> NamedRun {
    NamedRun {
        link: site.run_of(path).map(|run| RunLink::to(site, run)),
        path: path.to_owned(),
    }
}

fn effect_block(finding: &EffectFinding, draws: usize, findings: &Findings) -> EffectBlock {
    let known = findings.effect(&finding.effect);
    let text = |of: fn(&EffectText) -> &String| known.map_or_else(String::new, |effect| of(effect).clone());
    let parameter = |parameter: &ieap_domain::Parameter| {
        let known = known.and_then(|effect| effect.parameters.iter().find(|p| p.key == parameter.key));
        ParameterRow {
            symbol: known.map_or_else(|| parameter.key.clone(), |p| with_index(&p.symbol)),
            meaning: known.map_or_else(String::new, |p| p.meaning.clone()),
            unit: known.map_or_else(String::new, |p| p.unit.clone()),
            estimate: EstimateText::of(&parameter.estimate, 1.0),
        }
    };
    let (p, q) = counted_with_q(Some(finding.p), finding.q, draws);
    EffectBlock {
        id: finding.effect.clone(),
        variant: finding.variant.clone().unwrap_or_default(),
        summary: text(|effect| &effect.summary),
        equation: text(|effect| &effect.equation),
        parameters: if finding.effect.starts_with(LAW) {
            Vec::new()
        } else {
            finding.parameters.iter().map(parameter).collect()
        },
        p: equation_of("p", &p),
        q: equation_of("q", &q),
        twins: in_a_row(&finding.twins),
        separated_by: text(|effect| &effect.separated_by),
    }
}

/// Members of a set of several; a single cause stands above.
fn set(found: &GroupDiagnosis, findings: &Findings) -> Vec<SetMember> {
    if found.set.len() < 2 || found.verdict == Verdict::Differs {
        return Vec::new();
    }
    let member = |id: &String| {
        let known = findings.effect(id);
        SetMember {
            id: id.clone(),
            summary: known.map_or_else(String::new, |effect| effect.summary.clone()),
            separated_by: known.map_or_else(String::new, |effect| effect.separated_by.clone()),
        }
    };
    found.set.iter().map(member).collect()
}

/// Symbol, unit and factor under which a base parameter is shown.
fn symbol(key: &str) -> (String, String, f64) {
    match ParameterInfo::of(key) {
        Some(known) => (
            known.symbol.to_owned(),
            known.shown_unit.to_owned(),
            known.shown_factor,
        ),
        None => (key.to_owned(), String::new(), 1.0),
    }
}

/// What was adopted for the group, or the command that would.
fn adoption(site: &Site, found: &GroupDiagnosis) -> Option<String> {
    let of_group = |entry: &&Adopted| entry.group == found.group;
    if let Some(entry) = site.input.campaign.adopted.iter().rev().find(of_group) {
        return Some(format!(
            "Adopted in campaign.toml: the runs of this group are fitted with {}, with one parameter set for all.",
            entry.model
        ));
    }
    let is_extended = found.verdict == Verdict::Law && !found.effects.is_empty();
    is_extended.then(|| {
        format!(
            "The runs are fitted with {}; `ieap diagnose --adopt --group \"{}\"` fits them with the extended model.",
            found.base_model, found.group
        )
    })
}

fn shift_row(shift: &ParameterShift) -> ShiftRow {
    let (symbol, unit, factor) = symbol(&shift.key);
    ShiftRow {
        symbol,
        unit,
        before: significant(shift.before * factor, 4),
        after: measured(shift.after * factor, shift.standard_error * factor),
    }
}

/// The residuals that are drawn, the largest first.
fn residuals(
    site: &Site,
    found: &GroupDiagnosis,
    figures: &mut BTreeMap<String, String>,
) -> Result<Vec<ResidualBlock>, ReportError> {
    let mut curves: Vec<&ResidualCurve> = found.residuals.iter().collect();
    if curves.len() > MOST_RESIDUAL_FIGURES {
        curves.sort_by(|a, b| size(b).total_cmp(&size(a)));
        curves.truncate(MOST_RESIDUAL_FIGURES);
    }
    let mut blocks = Vec::new();
    for (place, curve) in curves.iter().enumerate() {
        let id = format!("residual-{}", place + 1);
        let heading = format!("{}: {}", curve.run, curve.channel);
        let title = format!("Residual of the {} of {}", curve.channel, curve.run);
        let desc = format!(
            "Dots: measured minus base model; line: measured minus {}; band: two standard deviations of single readings.",
            extension(found)
        );
        let drawn = residual(curve, called(found), site.clock_of(&curve.run), &title, &desc);
        blocks.extend(block(id, heading, drawn, figures)?);
    }
    Ok(blocks)
}

/// A figure with its heading; none where there was too little to draw.
fn block(
    id: String,
    heading: String,
    drawn: Result<Option<String>, String>,
    figures: &mut BTreeMap<String, String>,
) -> Result<Option<ResidualBlock>, ReportError> {
    let drawn = drawn.map_err(|reason| ReportError::Figure {
        figure: id.clone(),
        reason,
    })?;
    Ok(drawn.map(|svg| {
        figures.insert(id.clone(), svg);
        ResidualBlock { heading, figure: id }
    }))
}

/// What the models leave of what took no part in their fits, the largest misfits of the base first.
fn held_out(
    site: &Site,
    found: &GroupDiagnosis,
    figures: &mut BTreeMap<String, String>,
) -> Result<Vec<ResidualBlock>, ReportError> {
    let mut curves: Vec<&ResidualCurve> = found.held_out_residuals.iter().collect();
    curves.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let mut blocks = Vec::new();
    for (place, curve) in curves.into_iter().take(MOST_HELD_OUT_FIGURES).enumerate() {
        let id = format!("held-out-{}", place + 1);
        let title = format!("Held-out residual of the {} of {}", curve.channel, curve.run);
        let desc = format!(
            "Measured minus what models predict that were fitted without these readings. Dots: base model; line: {}.",
            extension(found)
        );
        let drawn = residual(
            curve,
            called_held_out(found),
            site.clock_of(&curve.run),
            &title,
            &desc,
        );
        let heading = format!("{}: {}", curve.run, curve.channel);
        blocks.extend(block(id, heading, drawn, figures)?);
    }
    Ok(blocks)
}

/// How the sum of squares rises with the strength of every accepted effect.
fn profiles(
    found: &GroupDiagnosis,
    findings: &Findings,
    figures: &mut BTreeMap<String, String>,
) -> Result<Vec<ResidualBlock>, ReportError> {
    let mut blocks = Vec::new();
    for (place, of) in found.profiles.iter().enumerate() {
        let id = format!("profile-{}", place + 1);
        let title = format!("Profile of the strength of {}", of.effect);
        let desc = "Rise of the weighted sum of squares with all other parameters fitted anew; the level line bounds a 95 % interval.";
        let known = findings.effect(&of.effect);
        let known = known.and_then(|effect| effect.parameters.iter().find(|p| p.key == of.key));
        let axis = symbol_and_unit(&of.key, known);
        let drawn = profile((&of.values, &of.rises), axis, &title, desc);
        let heading = format!(
            "{}: {}",
            of.effect,
            known.map_or(axis.0, |known| known.meaning.as_str())
        );
        blocks.extend(block(id, heading, drawn, figures)?);
    }
    Ok(blocks)
}

fn stretches(found: &GroupDiagnosis) -> Vec<StretchRow> {
    let segments = found.whereabouts.iter().flat_map(|place| &place.segments);
    segments
        .map(|segment| StretchRow {
            run: segment.run.clone(),
            channel: segment.channel.clone(),
            times: format!(
                "{} to {} s",
                significant(segment.from_s, 3),
                significant(segment.to_s, 3)
            ),
            sigma: fixed(segment.sigma, 1),
        })
        .collect()
}
