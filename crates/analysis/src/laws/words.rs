//! Answers as sentences, no stronger than they are.

use super::covariate::Covariate;
use super::dependence::Dependence;
use super::design::Level;
use super::doubt::{Doubted, Treatment};
use super::find::{CampaignLaws, TiedSet};
use super::fitted::{Fitted, Interval};
use super::offset::LengthDoubt;
use super::parts::Lacking;
use super::selection::Selection;
use super::shape::Law;
use crate::false_discovery::CLAIMED_BELOW;
use crate::parameters::ParameterInfo;
use ieap_domain::number::{rounded_bound, significant};
use ieap_domain::words::{capital, counted, in_a_row};

/// Symbol of a parameter; its key where it has none.
pub fn symbol(key: &str) -> &str {
    ParameterInfo::of(key).map_or(key, |parameter| parameter.symbol)
}

/// The answer in a sentence or a few: what changes by how much, or why it cannot be told.
pub fn sentence(found: &Dependence) -> String {
    let lead = match () {
        () if found.covariate == Covariate::Sample => sample_sentence(found),
        () if found.is_blurred() => return blurred(found),
        () if found.q <= CLAIMED_BELOW => claim(found),
        () => return open(found),
    };
    let mut text = if found.confounded_with.is_empty() {
        lead
    } else {
        format!("{} {lead}", tied_sentence(found))
    };
    text += &told_apart(found);
    if found.differs_between_samples {
        text += " Samples follow it by different factors; the interval allows for that.";
    }
    if !found.not_adjusted_for.is_empty() {
        text += &format!(
            " {} also changed with it and could not be allowed for, for want of runs.",
            capital(&listed(&found.not_adjusted_for))
        );
    }
    text
}

/// A claim in a few words, under the name of its parameter: `falls by a factor of 4.2 [3.1, 5.6] from 20 to 80 % RH`.
pub fn brief(found: &Dependence) -> String {
    if found.covariate == Covariate::Sample {
        return "differs between samples by more than between runs".to_owned();
    }
    let between = match (&found.jump, found.span) {
        (Some(jump), _) => format!("from {} to {}", jump.from, jump.to),
        (None, Some(span)) => range(found.covariate, span.low, span.high),
        (None, None) => String::new(),
    };
    match found.change() {
        Some(change) if change.is_directed() => format!("{} {between}", moves(change, found.is_log)),
        Some(_) => format!(
            "changes with {}, by no law that is known here",
            found.covariate.label()
        ),
        None => format!("differs with {}", found.covariate.label()),
    }
}

/// What the readings allow where nothing is claimed: `a factor of 1.1 [0.8, 1.6]`; empty where that says nothing.
pub fn allowed(found: &Dependence) -> String {
    match (found.change(), found.is_log) {
        (Some(change), true) if !matches!(found.covariate, Covariate::FirstRun | Covariate::Direction) => {
            format!(
                "a factor of {}{}",
                round(change.value.exp(), change.value.exp()),
                ends(change.low_95, change.high_95, f64::exp)
            )
        }
        _ => String::new(),
    }
}

fn claim(found: &Dependence) -> String {
    let what = format!("{} of {}", symbol(&found.parameter), found.material);
    let n = counted(found.samples.len(), "sample");
    let Some(change) = found.change() else {
        return format!("{what} differs with {} ({n}).", found.covariate.label());
    };
    let between = match (&found.jump, found.span) {
        (Some(jump), _) => format!("from {} {} to {}", found.covariate.label(), jump.from, jump.to),
        (None, Some(span)) => range(found.covariate, span.low, span.high),
        (None, None) => String::new(),
    };
    // The forms that are asked about are more than the laws that are stated.
    if !change.is_directed() {
        let ends = if found.is_log {
            ends(change.low_95, change.high_95, f64::exp)
        } else {
            ends(change.low_95, change.high_95, |x| x)
        };
        return format!(
            "{what} changes with {}, but by no law that is known here: what it changes by {between} cannot be told{ends}, {n}.",
            found.covariate.label()
        );
    }
    format!(
        "{what} {} {between}, {n}{}.",
        moves(change, found.is_log),
        law_words(found)
    )
}

/// `from 20 to 80 % RH`.
fn range(covariate: Covariate, low: f64, high: f64) -> String {
    let unit = covariate.unit();
    let space = if unit.is_empty() { "" } else { " " };
    match covariate {
        Covariate::FirstRun => "in the first run of a sample".to_owned(),
        Covariate::Direction => "from drying to wetting at the same humidity".to_owned(),
        Covariate::RestBefore => format!(
            "after a rest of {} s against an endless one",
            end(low, high - low)
        ),
        Covariate::RelativeHumidity | Covariate::Temperature => {
            format!(
                "from {} to {}{space}{unit}",
                end(low, high - low),
                end(high, high - low)
            )
        }
        _ => format!(
            "from {} {} to {}{space}{unit}",
            covariate.label(),
            end(low, high - low),
            end(high, high - low)
        ),
    }
}

fn law_words(found: &Dependence) -> String {
    let Some(law) = found.laws.first() else {
        return String::new();
    };
    if matches!(law.law, Law::Jump | Law::Decay) {
        return String::new();
    }
    let as_good = found.as_good();
    let others: Vec<&str> = as_good
        .iter()
        .filter(|other| **other != law.law)
        .map(|other| other.key())
        .collect();
    let bend = law
        .bend_at
        .map_or_else(String::new, |at| bend_words(found, law, at));
    if others.is_empty() {
        format!("; the law is {}{bend}", law.law.key())
    } else {
        format!("; {}{bend} as well as {}", law.law.key(), others.join(", "))
    }
}

fn bend_words(found: &Dependence, law: &Fitted, at: Interval) -> String {
    let unit = found.covariate.unit();
    let width = found.span.map_or(1.0, |span| span.length());
    let name = match law.law {
        Law::Approach => "with a constant of",
        _ => "at",
    };
    let within = match (at.low_95, at.high_95) {
        (Some(low), Some(high)) => format!(" [{}, {}]", round(low, width), round(high, width)),
        _ => String::new(),
    };
    format!(" {name} {}{within} {unit}", round(at.value, width))
        .trim_end()
        .to_owned()
}

/// `rises by a factor of 1.8 [1.5, 2.2]`.
pub fn moves(change: Interval, is_log: bool) -> String {
    if !is_log {
        let ends = ends(change.low_95, change.high_95, |x| x);
        return format!("changes by {}{ends}", short(change.value));
    }
    let verb = if change.value >= 0.0 { "rises" } else { "falls" };
    // Of a fall the other ends count.
    let (near, far) = if change.value >= 0.0 {
        (change.low_95, change.high_95)
    } else {
        (change.high_95.map(|x| -x), change.low_95.map(|x| -x))
    };
    let ends = ends(near, far, f64::exp);
    let half = near
        .zip(far)
        .map(|(near, far)| 0.5 * (far.exp() - near.exp()).abs());
    format!(
        "{verb} by a factor of {}{ends}",
        round(change.value.abs().exp(), half.unwrap_or(1.0) * 4.0)
    )
}

/// ` [1.5, 2.2]`: the ends of an interval on another scale, where there are any.
pub fn ends(low: Option<f64>, high: Option<f64>, scale: fn(f64) -> f64) -> String {
    match (low.map(scale), high.map(scale)) {
        (Some(low), Some(high)) => {
            let width = 2.0 * (high - low);
            format!(" [{}, {}]", round(low, width), round(high, width))
        }
        (Some(low), None) => format!(" [above {}]", rounded_bound(low, false).value_text()),
        (None, Some(high)) => format!(" [below {}]", rounded_bound(high, true).value_text()),
        (None, None) => String::new(),
    }
}

fn sample_sentence(found: &Dependence) -> String {
    let deviation = found.jump.as_ref().map_or(0.0, |jump| jump.size.value);
    let n = counted(found.samples.len(), "sample");
    let what = format!("{} of {}", symbol(&found.parameter), found.material);
    match found.q <= CLAIMED_BELOW {
        true if found.is_log => format!(
            "{what} differs between samples by more than between runs: standard deviation {} ({n}).",
            // A factor of 1.0 would say nothing.
            if deviation < std::f64::consts::LN_2 {
                format!("{} %", short(100.0 * deviation.exp_m1()))
            } else {
                format!("a factor of {}", short(deviation.exp()))
            }
        ),
        true => format!("{what} differs between samples by more than between runs ({n})."),
        false => format!(
            "That samples of {} differ in {} is not shown ({n}).",
            found.material,
            symbol(&found.parameter)
        ),
    }
}

/// Why it cannot be told, with what can: the change that the readings allow.
fn open(found: &Dependence) -> String {
    let what = format!("{} of {}", symbol(&found.parameter), found.material);
    let n = counted(found.samples.len(), "sample");
    let allowed = match (found.change(), found.span, found.is_log) {
        (Some(change), Some(span), true)
            if !matches!(found.covariate, Covariate::FirstRun | Covariate::Direction) =>
        {
            let ends = ends(change.low_95, change.high_95, f64::exp);
            format!(
                ": a factor of {}{ends} {} is what the readings allow",
                round(change.value.exp(), change.value.exp()),
                range(found.covariate, span.low, span.high)
            )
        }
        _ => String::new(),
    };
    let tied = if found.confounded_with.is_empty() {
        String::new()
    } else {
        format!(", and {} changed with it", listed(&found.confounded_with))
    };
    format!(
        "Whether {what} follows {} cannot be told{allowed} (q = {}, {}, {n}{tied}).",
        found.covariate.label(),
        short(found.q),
        counted(found.runs, "run")
    )
}

fn blurred(found: &Dependence) -> String {
    format!(
        "Whether {} of {} follows {} cannot be told: most of what was measured of it is the error of its sensor.",
        symbol(&found.parameter),
        found.material,
        found.covariate.label()
    )
}

/// Of several names that cannot be told apart, before what one of them would say.
fn tied_sentence(found: &Dependence) -> String {
    let what = format!("{} of {}", symbol(&found.parameter), found.material);
    if found.covariate == Covariate::Sample {
        return format!(
            "Samples of {} also differ in {}: what follows one of them cannot be told from the samples.",
            found.material,
            listed(&found.confounded_with)
        );
    }
    let place = match found.level {
        Level::Within => "together",
        Level::Between => "from sample to sample together",
    };
    let mut names = vec![found.covariate];
    names.extend(&found.confounded_with);
    // What the drive or the surroundings were set to is named before what use or order may do.
    names.sort_by_key(|name| !name.is_factor());
    format!(
        "{what} changes, but {} changed {place}: which of them it follows cannot be told. Over the {}:",
        listed(&names),
        found.covariate.label()
    )
}

/// By how much the readings rule out what changed together with the covariate that is named.
fn told_apart(found: &Dependence) -> String {
    let told = &found.told_apart;
    if told.ruled_out.is_empty() {
        return String::new();
    }
    let names: Vec<Covariate> = told.ruled_out.iter().map(|rival| rival.covariate).collect();
    let left: Vec<String> = told
        .ruled_out
        .iter()
        .map(|rival| format!("{} leaves {}", rival.covariate.label(), percent(rival.left)))
        .collect();
    let place = match found.level {
        Level::Within => "changed with it",
        Level::Between => "changed with it from sample to sample",
    };
    format!(
        " {} {place}, but the readings tell: of the variation {} alone leaves {}, {}.",
        capital(&listed(&names)),
        found.covariate.label(),
        percent(told.left),
        left.join(", ")
    )
}

fn percent(part: f64) -> String {
    format!("{} %", short(100.0 * part))
}

/// What the design lets nobody tell apart, and of which parameters the readings do: what [`in_runs_of`] makes a sentence.
pub fn tied(set: &TiedSet, laws: &CampaignLaws) -> String {
    let where_ = match set.level {
        Level::Within => "within samples",
        Level::Between => "between samples",
    };
    let is_told = |found: &&Dependence| {
        found.material == set.material
            && found.level == set.level
            && set.covariates.contains(&found.covariate)
            && !found.told_apart.ruled_out.is_empty()
            && found.confounded_with.is_empty()
    };
    let told: Vec<&str> = laws
        .claimed()
        .filter(is_told)
        .map(|found| symbol(&found.parameter))
        .collect();
    let all_the_same = if told.is_empty() {
        String::new()
    } else {
        format!(" Of {} the readings themselves tell.", in_a_row(&told))
    };
    format!(
        "{} are confounded: {where_} they changed together, and by the design alone what follows one of them cannot be told from what follows another.{all_the_same}",
        listed(&set.covariates)
    )
}

/// A sentence about the runs of these materials, of what holds in them.
pub fn in_runs_of<T: AsRef<str>>(materials: &[T], rest: &str) -> String {
    format!("In the runs of {}, {rest}", in_a_row(materials))
}

/// What some runs do not state, in a sentence: `Relative humidity: 6 of 27 runs of NC state none (in vacuum); what follows it
/// is told from the other 21.`
pub fn lacking(found: &Lacking) -> String {
    let environments: Vec<&str> = found.environments.iter().map(String::as_str).collect();
    let place = match environments.as_slice() {
        [] => String::new(),
        named => format!(" (in {})", in_a_row(named)),
    };
    format!(
        "{}: {} of {} of {} state none{place}; what follows it is told from the other {}.",
        capital(found.covariate.label()),
        found.without.len(),
        counted(found.runs, "run"),
        found.material,
        found.runs - found.without.len()
    )
}

/// Fits in doubt in a sentence.
pub fn doubted(found: &Doubted) -> String {
    let runs = counted(found.runs.len(), "run");
    let why = match found.causes.as_slice() {
        [] => "no cause of it is known".to_owned(),
        causes => format!("{} explains it", causes.join(" with ")),
    };
    let what = match found.treatment {
        Treatment::Widened => format!(
            "the errors of {runs} hold what the extended model moves each parameter by; `ieap diagnose --adopt` fits it instead"
        ),
        Treatment::LeftOut => format!("{runs} of it take part in no question across runs"),
    };
    format!(
        "The model is wrong for {}, and {why}: {what}.",
        crate::groups::title(&found.group)
    )
}

/// A doubtful length in a sentence.
pub fn length(found: &LengthDoubt) -> String {
    let ends = ends(found.factor.low_95, found.factor.high_95, |x| x);
    format!(
        "The parameters of sample {} lie off those of {} as a free length of {} times the stated one{ends} would put them: measure it again.",
        found.sample,
        counted(found.samples - 1, "other sample"),
        round(found.factor.value, 0.1)
    )
}

/// Uneven failures in a sentence.
pub fn selection(found: &Selection) -> String {
    let how = match (found.shift, &found.worst) {
        (Some(shift), _) => {
            let (unit, what) = match found.covariate {
                "voltage_v" => ("V", "voltage"),
                _ => ("% RH", "relative humidity"),
            };
            let side = if shift > 0.0 { "above" } else { "below" };
            format!(
                "their {what} lies {} {unit} {side} that of the usable runs",
                short(shift.abs())
            )
        }
        (None, Some((name, failed, all))) => format!("{failed} of {all} failed in {name}"),
        (None, None) => String::new(),
    };
    format!(
        "{} of {} runs failed or never came, and not at random: {how}. A law over the runs that are left may be one of the failures.",
        found.failed, found.attempts
    )
}

/// Labels in a row: `a, b and c`.
pub fn listed(covariates: &[Covariate]) -> String {
    let labels: Vec<&str> = covariates.iter().map(|covariate| covariate.label()).collect();
    in_a_row(&labels)
}

/// A number to the digits that a width of its interval carries: a tenth of it counts.
pub fn round(value: f64, width: f64) -> String {
    let place = (width.abs().max(1e-300) / 10.0).log10().floor() as i32;
    let largest = value.abs().max(1e-300).log10().floor() as i32;
    // Never fewer than two digits nor more than four.
    significant(value, (largest - place + 1).clamp(2, 4))
}

/// An end of a span: no zeros that say nothing.
fn end(value: f64, width: f64) -> String {
    if value.abs() < 1e-9 * width {
        return "0".to_owned();
    }
    let text = round(value, width);
    if text.contains('.') && !text.contains('·') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Two digits.
pub fn short(value: f64) -> String {
    significant(value, 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_read_as_people_say_them() {
        let change = |value: f64, low: f64, high: f64| Interval {
            value: value.ln(),
            low_95: Some(low.ln()),
            high_95: Some(high.ln()),
        };
        assert_eq!(
            moves(change(1.8, 1.5, 2.2), true),
            "rises by a factor of 1.8 [1.5, 2.2]"
        );
        assert_eq!(
            moves(change(0.5, 0.4, 0.8), true),
            "falls by a factor of 2.0 [1.3, 2.5]"
        );
    }

    #[test]
    fn numbers_have_the_digits_that_they_carry() {
        assert_eq!(round(1.8234, 1.4), "1.8");
        assert_eq!(round(19.321, 8.0), "19.3");
        assert_eq!(round(1234.5, 400.0), "1230");
        assert_eq!(short(0.0312), "0.031");
        assert_eq!(round(80.2, 60.0), "80");
    }
}
