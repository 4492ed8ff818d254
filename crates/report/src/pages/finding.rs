//! The page of one group: what the simulation gets wrong there, the cause, the extended model and its gain.

use ieap_domain::finding_words::verdict_word;
use ieap_domain::words::in_a_row;
use std::collections::BTreeMap;

use serde::Serialize;

use super::Content;
use super::finding_alone::alone;
use super::finding_answer::{Answer, answer, size, strengths, symbol_and_unit};
use super::finding_differs as differs;
use super::finding_effect::effect;
use super::finding_gain::{called, called_held_out, errors, extension, gain_section};
use super::finding_law::{AccountPart, account_parts, laws};
use super::finding_posterior::{HypothesisRow, hypothesis_rows};
use super::finding_words::{shift_words, test_words};
use super::wording::{readable, shown_as};
use crate::blocks::{Item, Writer};
use crate::error::ReportError;
use crate::figures::profile::profile;
use crate::figures::residual::{Called, residual};
use crate::input::{EffectText, Findings};
use crate::pages::policy::{MOST_HELD_OUT_FIGURES, MOST_RESIDUAL_FIGURES};
use crate::site::Site;
use ieap_domain::campaign::Adopted;
use ieap_domain::number::{fixed, measured, significant};
use ieap_domain::{GroupDiagnosis, MisfitStretch, NextRun, ParameterShift, ResidualCurve, Verdict};
use ieap_show::{Block, Rough, Sheet, Source};

#[derive(Debug, Serialize)]
struct FindingPage {
    verdict: &'static str,
    /// The answer in a sentence.
    lead: String,
    answer: Answer,
    /// What to measure next.
    next: Option<String>,
    /// The model adopted for the group, or how to adopt the one that was found.
    adoption: Option<String>,
    /// Of what the error is made, as one bar.
    account: Vec<AccountPart>,
    /// The laws that are missing, and the parameters that differ.
    missing: Vec<Item>,
    errors: Vec<Item>,
    hypotheses: Vec<HypothesisRow>,
    /// Causes that these runs do not tell apart, and how strong those are that were found.
    causes: Vec<Item>,
    /// How it was found.
    how: Vec<Item>,
}

/// Makes the page of group number `place`.
pub fn content(site: &Site, place: usize) -> Result<Content, ReportError> {
    let findings = &site.input.findings;
    let found = &findings.groups[place];
    let mut figures = BTreeMap::new();
    let answer = answer(site, found, &mut figures)?;
    let mut blocks = Writer::new(site, 2, &mut figures);
    laws(&mut blocks, found)?;
    differs::drawn(&mut blocks, found)?;
    let missing = blocks.taken();
    blocks.write(errors(found))?;
    let errors = blocks.taken();
    blocks.write(set(found, findings).into_iter().chain(strengths(found, findings)))?;
    let causes = blocks.taken();
    blocks.folded("How this was found", |part| how_found(part, site, found))?;
    let page = FindingPage {
        verdict: verdict_word(found.verdict),
        lead: readable(&found.sentence),
        answer,
        next: found.next_run.as_ref().map(next_words),
        adoption: adoption(site, found),
        account: account_parts(found.account.as_ref()),
        missing,
        errors,
        hypotheses: hypothesis_rows(found, findings),
        causes,
        how: blocks.taken(),
    };
    Content::new("finding.html", &page, figures)
}

/// The next run; what it leaves open is said where that is more than one cause.
fn next_words(next: &NextRun) -> String {
    let left = if next.expected_set_size.round() > 1.0 {
        format!(
            "; about {} of them would be left",
            fixed(next.expected_set_size, 0)
        )
    } else {
        String::new()
    };
    format!(
        "Next: {}. It tells apart {}{left}.",
        next.drive,
        in_a_row(&next.splits)
    )
}

/// Members of a set of several; a single cause stands above.
fn set(found: &GroupDiagnosis, findings: &Findings) -> Option<Block> {
    if found.set.len() < 2 || found.verdict == Verdict::Differs {
        return None;
    }
    let known = |id: &str, of: fn(&EffectText) -> &String| Some(of(findings.effect(id)?).clone());
    let table = Sheet::<&String>::new("set", "", 1)
        .plain("Cause", |id| id.as_str())
        .plain("What it is", move |id| known(id, |effect| &effect.summary))
        .plain("Told from the others by", move |id| {
            known(id, |effect| &effect.separated_by)
        })
        .over(&found.set);
    let said = "These runs do not tell which of these causes it is; another kind of run may:";
    let blocks = vec![Block::say(said), Block::Table(table)];
    Some(Block::part("Which cause it is", blocks))
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

/// The tests, the effects, and everything that the answer rests on.
fn how_found(page: &mut Writer, site: &Site, found: &GroupDiagnosis) -> Result<(), ReportError> {
    let findings = &site.input.findings;
    let shifts = found.shifts.iter();
    let shifts = shifts.filter_map(|shift| shift_words(shift, shown_as(&shift.key).0));
    let tests = test_words(found).into_iter();
    page.write(tests.chain(shifts.map(|words| words + ".")).map(Block::Say))?;
    page.write(differs::tables(found))?;
    page.write(found.effects.iter().map(|own| effect(own, found.draws, findings)))?;
    profiles(page, found, findings)?;
    if let Some(section) = gain_section(found) {
        page.part(&section.heading, |part| {
            part.write(section.blocks())?;
            part.write([Block::say(format!(
                "Gain is the fall of the deviance: how far the readings lie from what was predicted of them, in units of the noise, with what the prediction itself does not know; positive where the {} predicts better.",
                extension(found)
            ))])?;
            held_out(part, site, found)
        })?;
    }
    page.write(shifted(found))?;
    residuals(page, site, found)?;
    page.write(alone(found))?;
    let remarks: Vec<Block> = found.remarks.iter().map(Block::say).collect();
    page.write((!remarks.is_empty()).then(|| Block::part("Remarks", remarks)))?;
    page.write([Block::Runs("Runs", found.runs.clone())])
}

/// Base parameters before and after.
fn shifted(found: &GroupDiagnosis) -> Option<Block> {
    let shown = |shift: &ParameterShift| shown_as(&shift.key).2;
    let table = Sheet::<&ParameterShift>::new("shifts", "", 1)
        .plain("Parameter", |shift| shown_as(&shift.key).0)
        .plain("Base model", move |shift| Rough(shift.before * shown(shift), 4))
        .plain("Extended model", move |shift| {
            measured(shift.after * shown(shift), shift.standard_error * shown(shift))
        })
        .plain("Unit", |shift| shown_as(&shift.key).1)
        .over(&found.shifts);
    let title = "Base parameters before and after";
    (!found.shifts.is_empty()).then(|| Block::part(title, vec![Block::Table(table)]))
}

/// The residuals that are drawn, the largest first.
fn residuals(page: &mut Writer, site: &Site, found: &GroupDiagnosis) -> Result<(), ReportError> {
    let mut curves: Vec<&ResidualCurve> = found.residuals.iter().collect();
    let all = curves.len();
    if curves.is_empty() {
        return Ok(());
    }
    if all > MOST_RESIDUAL_FIGURES {
        curves.sort_by(|a, b| size(b).total_cmp(&size(a)));
        curves.truncate(MOST_RESIDUAL_FIGURES);
    }
    let desc = format!(
        "Dots: measured minus base model; line: measured minus {}; band: two standard deviations of single readings.",
        extension(found)
    );
    let not_drawn = match curves.len() {
        drawn if drawn < all => format!(" {drawn} of {all} residuals are drawn, the largest first."),
        _ => String::new(),
    };
    page.part("What the simulation leaves", |part| {
        draw(part, site, ("residual", "Residual", &desc), &curves, called(found))?;
        part.below(&format!(
            "Measured minus simulated, in standard deviations σ of the noise, neighbours averaged. Dots: base model; line: {}, where there is one. Single readings stay within the grey band of ±2 σ in 95 of 100 cases, averaged ones more often; a curve that runs outside it, or to one side of zero for long, is a misfit.{not_drawn}",
            extension(found)
        ));
        part.write(stretches(found))
    })
}

/// What the models leave of what took no part in their fits, the largest misfits of the base first.
fn held_out(page: &mut Writer, site: &Site, found: &GroupDiagnosis) -> Result<(), ReportError> {
    let mut curves: Vec<&ResidualCurve> = found.held_out_residuals.iter().collect();
    curves.sort_by(|a, b| size(b).total_cmp(&size(a)));
    curves.truncate(MOST_HELD_OUT_FIGURES);
    if curves.is_empty() {
        return Ok(());
    }
    let desc = format!(
        "Measured minus what models predict that were fitted without these readings. Dots: base model; line: {}.",
        extension(found)
    );
    let kind = ("held-out", "Held-out residual", desc.as_str());
    page.part("Predicted without having been seen", |part| {
        draw(part, site, kind, &curves, called_held_out(found))?;
        part.below(&format!(
            "Measured minus predicted, in standard deviations σ of the noise, by models that were fitted without these readings. Dots: base model; line: {}.",
            extension(found)
        ));
        Ok(())
    })
}

/// Residuals of one kind, each drawn where there is enough of it.
fn draw(
    page: &mut Writer,
    site: &Site,
    (id, what, desc): (&str, &str, &str),
    curves: &[&ResidualCurve],
    called: Called,
) -> Result<(), ReportError> {
    for (place, curve) in curves.iter().enumerate() {
        let title = format!("{what} of the {} of {}", curve.channel, curve.run);
        let drawn = residual(curve, called, site.clock_of(&curve.run), &title, desc);
        let heading = format!("{}: {}", curve.run, curve.channel);
        if let Some(drawn) = drawn.transpose() {
            page.drawing(&format!("{id}-{}", place + 1), (&heading, ""), drawn)?;
        }
    }
    Ok(())
}

/// How the sum of squares rises with the strength of every accepted effect.
fn profiles(page: &mut Writer, found: &GroupDiagnosis, findings: &Findings) -> Result<(), ReportError> {
    if found.profiles.is_empty() {
        return Ok(());
    }
    let desc = "Rise of the weighted sum of squares with all other parameters fitted anew; the level line bounds a 95 % interval.";
    page.part("How sharp the strength is", |part| {
        for (place, of) in found.profiles.iter().enumerate() {
            let title = format!("Profile of the strength of {}", of.effect);
            let known = findings.effect(&of.effect);
            let known = known.and_then(|effect| effect.parameters.iter().find(|p| p.key == of.key));
            let axis = symbol_and_unit(&of.key, known);
            let drawn = profile((&of.values, &of.rises), axis, &title, desc);
            let meaning = known.map_or(axis.0, |known| known.meaning.as_str());
            if let Some(drawn) = drawn.transpose() {
                let heading = format!("{}: {meaning}", of.effect);
                part.drawing(&format!("profile-{}", place + 1), (&heading, ""), drawn)?;
            }
        }
        part.below("Rise of the weighted sum of squares as the strength leaves its best value, all other parameters fitted anew. Values below the level line belong to the 95 % interval; a flat curve means that the runs do not tell the strength.");
        Ok(())
    })
}

/// Where the simulation is worst; none where nothing says so.
fn stretches(found: &GroupDiagnosis) -> Option<Block> {
    let stretches = found.whereabouts.as_ref()?.segments.iter();
    let table = Sheet::<&MisfitStretch>::new("stretches", "", 1)
        .made_from(|stretch| vec![Source::file(&stretch.run)])
        .plain("Run", |stretch| stretch.run.as_str())
        .plain("Channel", |stretch| stretch.channel.as_str())
        .plain("Time", |stretch| {
            let [from, to] = [stretch.from_s, stretch.to_s].map(|time_s| significant(time_s, 3));
            format!("{from} to {to} s")
        })
        .plain("Measured minus simulated / standard error", |stretch| {
            fixed(stretch.sigma, 1)
        })
        .over(stretches);
    (!table.rows.is_empty()).then(|| Block::part("Worst stretches", vec![Block::Table(table)]))
}
