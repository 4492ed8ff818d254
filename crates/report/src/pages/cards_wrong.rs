//! The card of what the simulation gets wrong: how many groups, their causes, what the model gains with them.

use super::cards::{Card, line};
use super::finding_words::{campaign_lead, verdict_of};
use super::wording::{group_title, listed};
use crate::number::significant;
use crate::site::Site;
use ieap_domain::{GroupDiagnosis, Verdict};

/// What the simulation gets wrong.
pub(super) fn wrong(site: &Site) -> Option<Card> {
    let groups = &site.input.findings.groups;
    if groups.is_empty() {
        return None;
    }
    let count = |is: &dyn Fn(Verdict) -> bool| groups.iter().filter(|found| is(found.verdict)).count();
    let parts = [
        ("named", "with a cause", count(&Verdict::extends_the_model)),
        ("varies", "whose runs differ", count(&|v| v == Verdict::Varies)),
        ("unknown", "unknown", count(&|v| v == Verdict::Unknown)),
        (
            "right",
            "not shown to be wrong",
            count(&|v| matches!(v, Verdict::Consistent | Verdict::Undecided)),
        ),
        (
            "data",
            "with data at fault",
            count(&|v| v == Verdict::DataProblem),
        ),
    ];
    let mis = count(&|v| v.is_misfit() && v != Verdict::Varies);
    let mut lines = vec![line(campaign_lead(groups), "findings.html")];
    let wrong = (0..groups.len()).filter(|&place| groups[place].verdict.is_misfit());
    let mut wrong: Vec<usize> = wrong.collect();
    wrong.sort_by_key(|&place| !groups[place].verdict.names_a_cause());
    let mut told: Vec<&'static str> = Vec::new();
    for place in wrong {
        let (found, verdict) = (&groups[place], verdict_of(&groups[place]));
        // The first of each verdict is what that verdict looks like here; causes are all told.
        let cause = cause_words(found);
        if cause.is_none() && told.contains(&verdict) {
            continue;
        }
        told.push(verdict);
        let said = cause.unwrap_or_else(|| verdict.to_owned());
        let text = format!("{}: {said}", group_title(&found.group));
        lines.push(line(text, &site.finding_href(place)));
    }
    Some(
        Card::new(
            "wrong",
            "What the simulation gets wrong",
            format!("{mis} of {}", groups.len()),
            lines,
        )
        .with_bar(&parts)
        .leading_to("findings.html", "all findings"),
    )
}

/// The cause of a group by its name, and what the model gains with it; none where none is proved.
fn cause_words(found: &GroupDiagnosis) -> Option<String> {
    let names: Vec<String> = found.effects.iter().map(|effect| effect.effect.clone()).collect();
    if !found.verdict.names_a_cause() || !found.gains_clearly() || names.is_empty() {
        return None;
    }
    let proof = &found.gain.as_ref()?.proof;
    let errors = [
        ("current", proof.nrmse_current_before, proof.nrmse_current_after),
        (
            "curvature",
            proof.nrmse_curvature_before,
            proof.nrmse_curvature_after,
        ),
    ];
    // The channel that gains most.
    let gains = errors
        .into_iter()
        .filter_map(|(channel, before, after)| Some((channel, before?, after?)));
    let best = gains.max_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2)));
    let gain = best.filter(|(_, before, after)| after < before).map_or_else(String::new, |(channel, before, after)| {
        let percent = |part: f64| significant(100.0 * part, 2);
        format!(
            "; with it the {channel} that was left out is predicted to {} % of its range, without to {} %",
            percent(after),
            percent(before)
        )
    });
    Some(format!("lacks {}{gain}", listed(&names)))
}
