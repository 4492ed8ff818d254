//! What a finding says, in words for people who do not work with probabilities.

use crate::pages::policy::CLEAR_SHIFT_SIGMAS;
use ieap_domain::diagnosis::follows_a_tag;
use ieap_domain::number::probabilities::{counted, equation_of, is_least, probability};
use ieap_domain::number::{fixed, significant};
use ieap_domain::words::counted as count_of;
use ieap_domain::{GroupDiagnosis, ParameterShift, Verdict};

/// Parameters that follow from others: a shift of theirs says nothing of its own.
const DERIVED: [&str; 4] = ["c_total_f_per_cm2", "r_parallel_ohm_cm2", "tau1_s", "tau2_s"];

/// How often chance alone gives as much, in words.
pub fn chance(p: f64) -> String {
    match p {
        p if !p.is_finite() => "not known how often".to_owned(),
        p if p >= 0.1 => format!("in {} of 100 cases", fixed(100.0 * p, 0)),
        p if p >= 1e-4 => format!("in 1 of {} cases", significant(1.0 / p, 2)),
        _ => "in fewer than 1 of 10000 cases".to_owned(),
    }
}

/// The tests of a group in words; nothing where the readings allow no finding.
pub fn test_words(found: &GroupDiagnosis) -> Vec<String> {
    let Some(p) = found.p_misfit.filter(|_| found.verdict != Verdict::DataProblem) else {
        return Vec::new();
    };
    let misfit = format!(
        "If the simulation were right, chance alone would leave residuals at least as bad {} ({}).",
        if is_least(p, found.draws) {
            chance(p).replacen("in 1 of", "in at most 1 of", 1)
        } else {
            chance(p)
        },
        equation_of("p", &counted(Some(p), found.draws))
    );
    let together = found.q_misfit.filter(|_| found.verdict != Verdict::Right).map(|q| {
        format!(
            "Of all findings of this campaign that are as clear as this one, a share of {} or less is expected to be chance (q).",
            probability(q).trim_start_matches("< ")
        )
    });
    [Some(misfit), together].into_iter().flatten().collect()
}

/// What the extension did to the base parameters: `α was 14 % too small: 5 standard errors`.
pub fn shift_words(shift: &ParameterShift, symbol: &str) -> Option<String> {
    let errors = (shift.after - shift.before).abs() / shift.standard_error;
    if DERIVED.contains(&shift.key.as_str()) || !errors.is_finite() || errors < CLEAR_SHIFT_SIGMAS {
        return None;
    }
    let relative = (shift.before / shift.after - 1.0) * 100.0;
    if !relative.is_finite() || shift.before * shift.after <= 0.0 {
        return Some(format!("{symbol} changes its sign or vanishes"));
    }
    let direction = if relative < 0.0 { "too small" } else { "too large" };
    let size = match relative.abs() {
        far if far >= 300.0 => format!("{} times", significant(shift.before / shift.after, 2)),
        near => format!("{} %", significant(near, 2)),
    };
    Some(format!(
        "{symbol} was {size} {direction}: {} standard errors",
        significant(errors, 2)
    ))
}

/// What a finding says of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// It is wrong, and a cause or a mechanism is told and proved on readings that were left out.
    WrongWithCause,
    /// It is wrong, and no cause is proved.
    Wrong,
    /// The runs differ from each other or scatter; each is described by its own parameters.
    Differs,
    /// It describes the readings to within the noise, or chance can look like what it leaves.
    Described,
    /// The readings do not allow a finding.
    NotAsked,
}

/// What the finding of a group says of the model. Runs that differ by what a tag says, or in a parameter that wanders from
/// run to run, are no error of the model.
pub fn outcome_of(found: &GroupDiagnosis) -> Outcome {
    let is_between = |id: &String| follows_a_tag(id) || id.starts_with("varies:");
    let between_alone = !found.set.is_empty() && found.set.iter().all(is_between);
    match found.verdict {
        Verdict::DataProblem => Outcome::NotAsked,
        Verdict::Right | Verdict::Undecided | Verdict::Instrument => Outcome::Described,
        Verdict::Differs => Outcome::Differs,
        _ if between_alone => Outcome::Differs,
        Verdict::Law => Outcome::WrongWithCause,
        _ => Outcome::Wrong,
    }
}

/// In how many groups the model is wrong, as a clause.
pub fn wrong_in(groups: &[GroupDiagnosis]) -> String {
    let count = |wanted: Outcome| groups.iter().filter(|found| outcome_of(found) == wanted).count();
    let asked = groups.len() - count(Outcome::NotAsked);
    match (count(Outcome::WrongWithCause) + count(Outcome::Wrong), asked) {
        (_, 0) => "The readings of no group allow a finding".to_owned(),
        (0, _) => format!(
            "In none of {} is the model shown to be wrong",
            count_of(asked, "group")
        ),
        (1, 1) => "The model is wrong in the one group".to_owned(),
        (n, _) if n == asked => format!("The model is wrong in all {n} groups"),
        (n, _) => format!("The model is wrong in {n} of {asked} groups"),
    }
}

/// What the campaign's groups say together: in how many the model is wrong, in how many the runs differ, how many are fine.
pub fn campaign_lead(groups: &[GroupDiagnosis]) -> String {
    if groups.is_empty() {
        return "No group of runs has been diagnosed yet: `ieap run` or `ieap diagnose` does it.".to_owned();
    }
    let count = |wanted: Outcome| groups.iter().filter(|found| outcome_of(found) == wanted).count();
    let (caused, uncaused) = (count(Outcome::WrongWithCause), count(Outcome::Wrong));
    let (differs, described) = (count(Outcome::Differs), count(Outcome::Described));
    let asked = groups.len() - count(Outcome::NotAsked);
    let causes = match (caused, uncaused) {
        (1, 0) => "what is missing is told".to_owned(),
        (_, 0) => "what is missing is told in each".to_owned(),
        (0, 1) => "what it misses cannot be told".to_owned(),
        (0, _) => "what it misses cannot be told in any".to_owned(),
        (some, none) => format!("what is missing is told in {some}, not in {none}"),
    };
    let mut lead = wrong_in(groups);
    if caused + uncaused > 0 {
        lead += &format!(": {causes}");
    }
    if differs > 0 {
        lead += &format!(". In {differs} the runs differ or scatter, and each is described by itself");
    }
    if described > 0 && described < asked {
        lead += &format!(". In {described} nothing is seen to be missing");
    }
    lead + "."
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{finding, shift};

    #[test]
    fn shifts_say_how_wrong_the_base_was() {
        let words = |before, after, error| shift_words(&shift("alpha_per_c_cm", before, after, error), "α");
        assert_eq!(
            words(0.86, 1.0, 0.028).unwrap(),
            "α was 14 % too small: 5.0 standard errors"
        );
        assert_eq!(
            words(5.0, 1.0, 0.1).unwrap(),
            "α was 5.0 times too large: 40 standard errors"
        );
        assert_eq!(words(1.01, 1.0, 0.02), None);
        assert_eq!(words(1.0, -1.0, 0.02).unwrap(), "α changes its sign or vanishes");
        assert_eq!(words(1.0, 2.0, 0.0), None);
    }

    #[test]
    fn probabilities_are_plain_numbers() {
        let text = |p: f64| probability(p);
        assert_eq!(
            [0.001, 0.31, 0.0448, 1.0, 0.00401, 1e-7].map(text),
            ["0.001", "0.31", "0.045", "1", "0.004", "< 0.0001"]
        );
        assert_eq!(probability(Some(f64::NAN)), "–");
    }

    #[test]
    fn a_chance_that_no_draw_reached_is_told_as_a_bound() {
        let said = |p| {
            test_words(&GroupDiagnosis {
                verdict: Verdict::Unexplained,
                p_misfit: Some(p),
                draws: 999,
                ..finding()
            })
            .remove(0)
        };
        let (least, counted) = (said(0.001), said(0.003));
        assert!(
            least.ends_with("in at most 1 of 1000 cases (p ≤ 0.001)."),
            "{least}"
        );
        assert!(counted.ends_with("in 1 of 330 cases (p = 0.003)."), "{counted}");
    }

    #[test]
    fn chance_is_told_in_cases() {
        assert_eq!(chance(0.31), "in 31 of 100 cases");
        assert_eq!(chance(0.001), "in 1 of 1000 cases");
        assert_eq!(chance(1e-6), "in fewer than 1 of 10000 cases");
    }

    #[test]
    fn campaigns_in_one_sentence() {
        let group = |verdict| GroupDiagnosis { verdict, ..finding() };
        assert_eq!(
            campaign_lead(&[group(Verdict::Right), group(Verdict::DataProblem)]),
            "In none of 1 group is the model shown to be wrong."
        );
        assert_eq!(
            campaign_lead(&[
                group(Verdict::Right),
                group(Verdict::Law),
                group(Verdict::Unexplained)
            ]),
            "The model is wrong in 2 of 3 groups: what is missing is told in 1, not in 1. In 1 nothing is seen to be missing."
        );
        // Runs that differ are no error of the model.
        assert_eq!(
            campaign_lead(&[group(Verdict::Right), group(Verdict::Differs)]),
            "In none of 2 groups is the model shown to be wrong. In 1 the runs differ or scatter, and each is described by \
             itself. In 1 nothing is seen to be missing."
        );
    }
}
