//! An effect that was accepted: what it is, its numbers, and what else it may be.

use super::estimates::{self, Number};
use super::wording::with_index;
use crate::input::{EffectText, Findings};
use ieap_domain::diagnosis::LAW;
use ieap_domain::number::probabilities::{counted_with_q, equation_of};
use ieap_domain::words::in_a_row;
use ieap_domain::{EffectFinding, Parameter};
use ieap_show::Block;

/// What is told of it; chances are counted from so many draws.
pub fn effect(finding: &EffectFinding, draws: usize, findings: &Findings) -> Block {
    let known = findings.effect(&finding.effect);
    let mut blocks = Vec::new();
    blocks.extend(known.map(|known| Block::say(&known.summary)));
    let equation = known.map(|known| known.equation.as_str());
    blocks.extend(
        equation
            .filter(|own| !own.is_empty())
            .map(|own| Block::say(format!("`{own}`"))),
    );
    // The weights of a law without an equation tell nobody anything.
    if !finding.effect.starts_with(LAW) && !finding.parameters.is_empty() {
        let numbers = finding.parameters.iter().map(|own| number(own, known));
        let numbers: Vec<Number> = numbers.collect();
        blocks.push(Block::Table(estimates::table("Parameter", &numbers)));
    }
    blocks.push(Block::Facts(facts(finding, draws, known)));
    let variant = finding.variant.iter();
    let title = [&finding.effect].into_iter().chain(variant);
    Block::part(title.map(String::as_str).collect::<Vec<_>>().join(", "), blocks)
}

fn number(parameter: &Parameter, effect: Option<&EffectText>) -> Number {
    let known = effect.and_then(|effect| effect.parameters.iter().find(|p| p.key == parameter.key));
    Number {
        symbol: known.map_or_else(|| parameter.key.clone(), |p| with_index(&p.symbol)),
        name: known.map_or_else(String::new, |p| p.meaning.clone()),
        unit: known.map_or_else(String::new, |p| p.unit.clone()),
        estimate: parameter.estimate.clone(),
    }
}

fn facts(finding: &EffectFinding, draws: usize, known: Option<&EffectText>) -> Vec<(&'static str, String)> {
    let (p, q) = counted_with_q(Some(finding.p), finding.q, draws);
    let [p, q] = [("p", p), ("q", q)].map(|(symbol, text)| equation_of(symbol, &text));
    let separated_by = known.map_or_else(String::new, |known| known.separated_by.clone());
    let mut facts = vec![
        (
            "by chance",
            format!("{p}, over all candidates; {q}, over all groups"),
        ),
        ("may also be", in_a_row(&finding.twins)),
        ("told apart by", separated_by),
    ];
    facts.retain(|(_, text)| !text.is_empty());
    facts
}
