//! The list of groups with what was found in each, and the ledger of every test made.

use ieap_domain::words::counted;

use super::Content;
use super::answers::next_words;
use super::finding_words::campaign_lead;
use super::wording::{group_title, readable};
use crate::blocks;
use crate::error::ReportError;
use crate::input::Findings;
use crate::site::Site;
use ieap_analysis::shared_effects::{SharedEffect, SharedParameter, left_out};
use ieap_domain::finding_words::verdict_word;
use ieap_domain::number::probabilities::{counted_with_q, probability};
use ieap_domain::number::{interval, measured};
use ieap_domain::{Estimate, FromOthers, GroupDiagnosis, Verdict};
use ieap_show::{Block, Rough, Sheet, Source, SourceOrigin, Table};

const LEAD: &str = "A group is what one parameter set should describe: the runs of one sample in one environment and humidity. Each name leads to its page.";
const CHANCES: &str = "p: how often chance alone leaves residuals at least as bad, if the simulation is right. q: where all findings up to this one are claimed, the share of them that is expected to be chance; nothing above 0.05 is claimed.";
const LEFT_OUT: &str = "A sample that is left out gives its own base parameters, and of the cause its strength or nothing. The fall of the sum of squares is beside the base model refitted alone, in units of the noise: above zero the cause, as the other samples know it, describes this one better.";
const ALONE: &str = "q looks at all runs at once. While runs arrive nobody knows how many will come, so each is also tested against a level that only those before it decide: a run with p at or below it is claimed to be wrong, and of all that is so claimed at most 5 % is expected to be chance.";

/// Makes the page.
pub fn content(site: &Site) -> Result<Content, ReportError> {
    let findings = &site.input.findings;
    let groups = &findings.groups;
    blocks::page(site, "findings.html", |page| {
        page.write([Block::say(campaign_lead(groups))])?;
        if !groups.is_empty() {
            page.write([Block::say(asked(findings))])?;
        }
        if let Some(next) = next_words(site) {
            page.leading("", "study.html", next);
        }
        if groups.is_empty() {
            return Ok(());
        }
        let table = Block::Table(of_groups(groups));
        page.write([Block::part("Groups", vec![Block::say(LEAD), table])])?;
        page.write(shared(findings))?;
        page.folded("Every test made", |part| {
            part.write([Block::Table(of_tests(groups))])?;
            let alone = Block::Table(of_runs(site));
            let alone = Block::part("Every run alone", vec![alone]);
            part.write((!findings.runs.is_empty()).then_some(alone))
        })
    })
}

/// How much was asked.
fn asked(findings: &Findings) -> String {
    format!(
        "{} and each of {} alone were asked whether the simulation leaves more than noise: {} laws as free curves, and {} textbook curves.",
        counted(findings.groups.len(), "group"),
        counted(findings.runs.len(), "run"),
        findings.laws.len(),
        findings.effects.len()
    )
}

/// Effects that may be the cause; none where there are none.
fn causes(found: &GroupDiagnosis) -> Option<String> {
    (!found.set.is_empty()).then(|| found.set.join(", "))
}

/// p and q of a misfit.
fn chances(found: &GroupDiagnosis) -> (String, String) {
    counted_with_q(found.p_misfit, found.q_misfit, found.draws)
}

fn of_groups(groups: &[GroupDiagnosis]) -> Table {
    Sheet::<&GroupDiagnosis>::new("groups", "", 1)
        .remarks(CHANCES, "")
        .made_from(|found| vec![Source::of(SourceOrigin::Diagnosis, &found.group)])
        .plain("Group", |found| group_title(&found.group))
        .plain("Runs", |found| found.runs.len())
        .plain("Verdict", |found| verdict_word(found.verdict))
        .plain("Finding", |found| readable(&found.sentence))
        // Parameters that differ are in the sentence.
        .plain("Possible causes", |found| {
            causes(found).filter(|_| found.verdict != Verdict::Differs)
        })
        .plain("p", |found| chances(found).0)
        .plain("q", |found| chances(found).1)
        .over(groups)
}

/// Causes of several samples.
fn shared(findings: &Findings) -> Option<Block> {
    let of_effect = |(effect, said): &(SharedEffect, String)| {
        let mut blocks = vec![Block::say(said), Block::Table(of_parameters(effect))];
        let left_out = of_left_out(effect, &findings.groups);
        blocks.extend((!left_out.rows.is_empty()).then_some(Block::Table(left_out)));
        Block::part(format!("{} in {}", effect.effect, effect.material), blocks)
    };
    let mut blocks: Vec<Block> = findings.shared.iter().map(of_effect).collect();
    if blocks.is_empty() {
        return None;
    }
    blocks.push(Block::say(LEFT_OUT));
    Some(Block::part("The same cause in several samples", blocks))
}

fn of_parameters(effect: &SharedEffect) -> Table {
    Sheet::<&SharedParameter>::new("shared", "", 1)
        .plain("Parameter", |own| own.key.as_str())
        .plain("Mean of samples", |own| match own.mean {
            Some(mean) => Estimate::determined(mean.value, mean.standard_error, mean.low_95, mean.high_95),
            None => Estimate::not_determined("no sample determines it"),
        })
        .plain("95 % interval", |own| {
            own.mean.map(|mean| interval(mean.low_95, mean.high_95))
        })
        .plain("Between samples", |own| {
            Some(Rough(own.mean?.between_samples?, 2))
        })
        .plain("Samples", |own| match own.p_equal {
            Some(_) if own.is_one() => "one value for all",
            Some(_) => "samples differ",
            None => "not asked: no errors",
        })
        .over(&effect.parameters)
}

fn of_left_out(effect: &SharedEffect, groups: &[GroupDiagnosis]) -> Table {
    type Held<'a> = (&'a str, &'a str, &'a FromOthers);
    Sheet::<Held>::new("left-out", "", 1)
        .plain("Sample left out", |(sample, ..)| *sample)
        .plain("Group", |(_, group, _)| *group)
        .plain("Parameters from", |(.., held)| held.samples.join(", "))
        .plain("Fall, shape from others", |(.., held)| {
            Some(Rough(held.fall_own_strength, 4)).filter(|own| own.0.is_finite())
        })
        .plain("Fall, strength too", |(.., held)| match held.fall {
            fall if fall.is_finite() => measured(fall, held.standard_error),
            _ => "cannot be held against it".to_owned(),
        })
        .over(left_out(effect, groups))
}

/// A test: of which group, what was asked, and how often chance answers as strongly.
struct Test<'a> {
    found: &'a GroupDiagnosis,
    question: String,
    p: Option<f64>,
    q: Option<f64>,
}

impl Test<'_> {
    fn chances(&self) -> (String, String) {
        counted_with_q(self.p, self.q, self.found.draws)
    }
}

/// The ledger.
fn of_tests(groups: &[GroupDiagnosis]) -> Table {
    Sheet::<Test>::new("tests", "", 1)
        .plain("Group", |test| group_title(&test.found.group))
        .plain("Question", |test| test.question.clone())
        .plain("p", |test| test.chances().0)
        .plain("q", |test| test.chances().1)
        .over(groups.iter().flat_map(tests))
}

fn tests(found: &GroupDiagnosis) -> Vec<Test<'_>> {
    let test = |question: &str, p, q| Test {
        found,
        question: question.to_owned(),
        p,
        q,
    };
    let mut tests = Vec::new();
    if found.p_misfit.is_some() {
        let question = "Does the simulation leave more than noise?";
        tests.push(test(question, found.p_misfit, found.q_misfit));
    }
    for effect in &found.effects {
        let question = format!(
            "Does {} describe the readings better than chance would?",
            effect.effect
        );
        tests.push(test(&question, Some(effect.p), effect.q));
    }
    if found.p_leftover.is_some() {
        let question = "Does the extended simulation leave more than noise?";
        tests.push(test(question, found.p_leftover, None));
    }
    tests
}

/// Every run by itself, with its place in the order of arrival and what could be claimed then.
fn of_runs(site: &Site) -> Table {
    let findings = &site.input.findings;
    let turn = |found: &GroupDiagnosis| findings.turns.get(&found.group);
    Sheet::<&GroupDiagnosis>::new("alone", "", 1)
        .remarks(ALONE, "")
        .made_from(|found| vec![Source::file(&found.group)])
        .plain("Run", |found| site.input.campaign.run_name(&found.group))
        .plain("Verdict", |found| verdict_word(found.verdict))
        .plain("Possible causes", |found| causes(found))
        .plain("p", |found| chances(found).0)
        .plain("q", |found| chances(found).1)
        .plain("Arrived", move |found| turn(found).map(|turn| turn.place))
        .plain("Level then", move |found| {
            turn(found).map(|turn| probability(turn.level))
        })
        .plain("Claimed then", move |found| match turn(found) {
            Some(turn) if turn.is_claimed => "wrong",
            Some(_) => "not shown",
            None => "",
        })
        .over(&findings.runs)
}
