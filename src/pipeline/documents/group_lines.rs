//! A finding as the terminal prints it: the sentence, and the numbers behind it.

use super::diagnosis::{EffectEntry, GroupEntry, group_title};
use crate::domain::diagnosis::LAW;
use crate::domain::finding_words::{account_words, gain_words, short_name};
use crate::domain::number::estimates::{in_words, interval_in_words};
use crate::domain::number::probabilities::{counted_with_q, equation_of, share};
use crate::domain::number::significant;
use crate::domain::words::counted;
use crate::domain::{Gain, MissingLaw, Verdict};
use crate::model::effects;

/// Lines about a group whose chances are counted from so many draws, its heading first.
pub fn lines(group: &GroupEntry, draws: usize) -> Vec<String> {
    let mut lines = vec![format!("    {}", group.sentence)];
    let condemned = group.condemned.iter();
    lines.extend(condemned.map(|own| format!("    {} is set aside: {}", own.run, own.reason)));
    // The weights of a law without an equation tell nobody anything: its curve is drawn on its page.
    let equations = group.effects.iter().filter(|own| !own.effect.starts_with(LAW));
    lines.extend(equations.flat_map(|effect| of_effect(effect, draws)));
    lines.extend(
        group
            .account
            .iter()
            .filter(|own| own.beyond_noise() > 0.0)
            .map(|own| format!("    of the error beyond noise: {}", account_words(own))),
    );
    lines.extend(group.missing.iter().map(|law| of_law("missing", law)));
    lines.extend(group.gain.iter().map(|gain| of_gain(gain, group.verdict)));
    lines.extend(group.next_run.iter().map(|next| {
        format!(
            "    measure next: {}; tells apart {}",
            next.drive,
            next.splits.join(", ")
        )
    }));
    // The clearest run is among the remarks already.
    let told = group.lumped_or_distributed.iter();
    let told = told.map(|told| format!("{}: {}", told.run, told.sentence));
    let told = told.filter(|line| !group.remarks.contains(line));
    lines.extend(told.map(|line| format!("    lumped or distributed: {line}")));
    lines.extend(group.remarks.iter().map(|remark| format!("    note: {remark}")));
    let runs = counted(group.runs.len(), "run");
    let heading = format!("{} ({runs}): {}", group_title(&group.group), group.verdict.key());
    lines.insert(0, heading);
    lines
}

/// A missing law: what it is, how probable, and its held-out error.
fn of_law(what: &str, law: &MissingLaw) -> String {
    let held_out = &law.held_out;
    let errors = held_out.error_percent_before.zip(held_out.error_percent_after);
    let gain = errors.map_or_else(String::new, |(before, after)| {
        format!(
            "; held-out error from {} to {} % of the range, {} parts better",
            significant(before, 2),
            significant(after, 2),
            held_out.better_parts
        )
    });
    format!(
        "    {what}: {} ({} %){gain}",
        short_name(law),
        share(law.probability)
    )
}

/// What the sentence does not say of a gain: what is left, and later times.
fn of_gain(gain: &Gain, verdict: Verdict) -> String {
    let with = match verdict {
        Verdict::Unexplained => "what was tried",
        Verdict::Differs => "parameters of each run's own",
        _ => "it",
    };
    let outside = gain.outside.as_ref().map_or_else(String::new, |outside| {
        let what = "held-out runs that lie outside what the others measured";
        format!(" {}", gain_words(with, what, outside, &[]))
    });
    let later = gain.later.as_ref().map_or_else(String::new, |later| {
        let what = "ends of runs (the last 40 %, from the first 60 % of all)";
        format!(" {}", gain_words(with, what, later, &[]))
    });
    format!(
        "    residuals of the fit with {with}: from {} to {} times the noise.{outside}{later}",
        significant(gain.residual_rms_sigma_before, 3),
        significant(gain.residual_rms_sigma_after, 3)
    )
}

fn of_effect(effect: &EffectEntry, draws: usize) -> Vec<String> {
    let variant = effect
        .variant
        .as_ref()
        .map_or_else(String::new, |variant| format!(" ({variant})"));
    let (p, q) = counted_with_q(Some(effect.p), effect.q, draws);
    let q = match effect.q {
        Some(_) => format!(", {}", equation_of("q", &q)),
        None => String::new(),
    };
    let about = effects::effect(&effect.effect).map(|effect| effect.about());
    let parameters = effect.parameters.iter().map(|(key, parameter)| {
        let unit = about
            .and_then(|about| about.parameters.iter().find(|known| known.key == key))
            .map_or("", |known| known.unit);
        let value = format!("{}{}", in_words(parameter), interval_in_words(parameter));
        format!("        {key:<26} {value}  [{unit}]")
    });
    let head = format!("    {}{variant}  {}{q}", effect.effect, equation_of("p", &p));
    std::iter::once(head).chain(parameters).collect()
}
