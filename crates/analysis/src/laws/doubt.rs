//! Fits that a diagnosis found wrong: what the claimed misfit may do to a parameter is part of its error, and a fit of
//! which nobody knows what is wrong is no evidence.

use ieap_domain::quantiles::NORMAL_95;
use ieap_domain::words::in_a_row;
use std::borrow::Cow;
use std::collections::BTreeMap;

use crate::false_discovery::CLAIMED_BELOW;
use ieap_domain::diagnosis::follows_a_tag;
use ieap_domain::finding_words::short_name;
use ieap_domain::{Estimate, GroupDiagnosis, ParameterShift, RunRecord, Verdict};

/// What the current findings say against fits of single runs.
#[derive(Debug, Clone, Copy, Default)]
pub struct Findings<'a> {
    /// Of groups.
    pub groups: &'a [GroupDiagnosis],
    /// Of single runs.
    pub runs: &'a [GroupDiagnosis],
}

/// What is done with the fits of a group whose misfit is claimed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Treatment {
    /// Their errors hold what the extended model moves the parameters by.
    Widened,
    /// They take part in no question.
    LeftOut,
}

/// A group whose fits are in doubt, with the runs that this is about.
#[derive(Debug, Clone, PartialEq)]
pub struct Doubted {
    /// Name of the group.
    pub group: String,
    /// What is done.
    pub treatment: Treatment,
    /// Runs, by name.
    pub runs: Vec<String>,
    /// Ids of the causes that the finding names; empty where it names none.
    pub causes: Vec<String>,
}

/// Doubts of every run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Doubts {
    /// By the run's name.
    of_runs: BTreeMap<String, Doubt>,
}

/// What a finding says against the fit of a run.
#[derive(Debug, Clone, PartialEq)]
enum Doubt {
    /// A cause is named: what it moves the parameters by widens their errors.
    Widened {
        shifts: Vec<ParameterShift>,
        causes: Vec<String>,
    },
    /// No cause is: the run is left out.
    LeftOut,
}

impl Doubts {
    /// What `findings` say of the fits of `runs`.
    ///
    /// The fits of an extended model hold what its finding said. A run that is right by itself, in a group that has no
    /// named cause or one that follows a tag from run to run, is right: the runs of such a group differ, and that is what
    /// is asked across runs.
    pub fn new(findings: Findings, runs: &[RunRecord]) -> Doubts {
        let is_right_alone = |name: &str| {
            let alone = findings.runs.iter().find(|found| found.group == name);
            alone.is_some_and(|found| found.verdict == Verdict::Right)
        };
        let fits_base = |name: &str| {
            let run = runs.iter().find(|run| run.path == name);
            run.and_then(|run| run.fit.as_ref())
                .is_some_and(|fit| !fit.is_of_group())
        };
        let mut of_runs = BTreeMap::new();
        for group in findings.groups.iter().filter(|group| is_claimed(group)) {
            let is_between_runs = group.effects.iter().any(|own| follows_a_tag(&own.effect));
            let names_cause = group.verdict == Verdict::Law && !group.shifts.is_empty() && !is_between_runs;
            for name in group.runs.iter().filter(|name| fits_base(name)) {
                if names_cause {
                    let doubt = Doubt::Widened {
                        shifts: group.shifts.clone(),
                        causes: group.missing.iter().map(short_name).collect(),
                    };
                    of_runs.insert(name.clone(), doubt);
                } else if !is_right_alone(name) {
                    of_runs.insert(name.clone(), Doubt::LeftOut);
                }
            }
        }
        Doubts { of_runs }
    }

    /// Everything that is said against the fit of the run, to be hashed.
    pub fn of(&self, run: &str) -> impl std::fmt::Debug {
        self.of_runs.get(run)
    }

    /// Whether a finding says anything against the fit of the run.
    pub fn is_of(&self, run: &str) -> bool {
        self.of_runs.contains_key(run)
    }

    /// Whether the run takes part in no question.
    pub fn leaves_out(&self, run: &str) -> bool {
        self.of_runs.get(run) == Some(&Doubt::LeftOut)
    }

    /// What the misfit may do to the parameter of a run: the size of its shift on the scale of logarithms, or of the
    /// values. 0 where nothing is known against the fit; none where it cannot be said.
    pub fn shift(&self, run: &str, key: &str, is_log: bool) -> Option<f64> {
        let shifts = match self.of_runs.get(run) {
            None => return Some(0.0),
            Some(Doubt::LeftOut) => return None,
            Some(Doubt::Widened { shifts, .. }) => shifts,
        };
        let (before, after) = both_ways(shifts, key)?;
        let shift = if is_log {
            (before / after).ln()
        } else {
            before - after
        };
        shift.is_finite().then_some(shift.abs())
    }

    /// The estimate of a run with what the misfit may do to it in its error and its interval; none where it cannot be said,
    /// and of a bound in doubt.
    pub fn widened(&self, run: &str, key: &str, estimate: &Estimate) -> Option<Estimate> {
        let ends = estimate.low_95.zip(estimate.high_95);
        let is_log = estimate.value.is_some_and(|value| value > 0.0) && ends.is_none_or(|(low, _)| low > 0.0);
        let shift = self.shift(run, key, is_log)?;
        if shift == 0.0 {
            return Some(estimate.clone());
        }
        let (value, (low, high)) = estimate.value.zip(ends)?;
        let scale = |x: f64| if is_log { x.ln() } else { x };
        let back = |y: f64| if is_log { y.exp() } else { y };
        let (y, reach) = (scale(value), NORMAL_95 * shift);
        let slope = if is_log { value } else { 1.0 };
        Some(Estimate {
            low_95: Some(back(y - (y - scale(low)).hypot(reach))),
            high_95: Some(back(y + (scale(high) - y).hypot(reach))),
            standard_error: estimate.standard_error.map(|error| error.hypot(slope * shift)),
            ..estimate.clone()
        })
    }

    /// The estimate of a run as pages and tables state it: in doubt with the widened interval, or where how wide it is cannot
    /// be said with that of the noise alone, and with the reason.
    pub fn stated<'a>(&self, run: &str, key: &str, estimate: &'a Estimate) -> Cow<'a, Estimate> {
        let Some(doubt) = self.of_runs.get(run) else {
            return Cow::Borrowed(estimate);
        };
        let widened = self.widened(run, key, estimate);
        let reason = match (doubt, &widened) {
            (Doubt::Widened { causes, .. }, Some(_)) => format!(
                "the model lacks {} here: the interval allows for what that does to the value",
                in_a_row(causes)
            ),
            (Doubt::Widened { causes, .. }, None) => format!(
                "the model lacks {} here, and what that does to the value is not known: the interval holds the noise alone",
                in_a_row(causes)
            ),
            (Doubt::LeftOut, _) => {
                "the model does not describe this group: the interval holds the noise alone".to_owned()
            }
        };
        let reason = match &estimate.reason {
            Some(own) => format!("{own}; {reason}"),
            None => reason,
        };
        Cow::Owned(Estimate {
            reason: Some(reason),
            ..widened.unwrap_or_else(|| estimate.clone())
        })
    }

    /// The groups in doubt, in the order of `findings`.
    pub fn told(&self, findings: Findings) -> Vec<Doubted> {
        let of_group = |group: &GroupDiagnosis| {
            let with = |treatment: Treatment| {
                let is_so = |name: &&String| match self.of_runs.get(name.as_str()) {
                    Some(Doubt::Widened { .. }) => treatment == Treatment::Widened,
                    Some(Doubt::LeftOut) => treatment == Treatment::LeftOut,
                    None => false,
                };
                let runs: Vec<String> = group.runs.iter().filter(is_so).cloned().collect();
                (!runs.is_empty()).then(|| Doubted {
                    group: group.group.clone(),
                    treatment,
                    runs,
                    causes: group.missing.iter().map(short_name).collect(),
                })
            };
            [with(Treatment::Widened), with(Treatment::LeftOut)]
        };
        findings.groups.iter().flat_map(of_group).flatten().collect()
    }
}

/// Whether the misfit of a group may be claimed, and doubts the fits of its runs: where the runs only differ in their
/// parameters, each fit is right.
fn is_claimed(group: &GroupDiagnosis) -> bool {
    let is_wrong = group.verdict.is_misfit() && group.verdict != Verdict::Differs;
    is_wrong
        && group
            .q_misfit
            .or(group.p_misfit)
            .is_none_or(|chance| chance <= CLAIMED_BELOW)
}

/// A parameter of the base model and of the extended one, fitted to the group; sums and products of such as well.
fn both_ways(shifts: &[ParameterShift], key: &str) -> Option<(f64, f64)> {
    let of = |key: &str| {
        let shift = shifts.iter().find(|shift| shift.key == key)?;
        Some((shift.before, shift.after))
    };
    let branches = |name: &dyn Fn(usize) -> String| (1..).map_while(|k| of(&name(k))).collect::<Vec<_>>();
    let sum = |terms: Vec<(f64, f64)>| {
        let add = |all: (f64, f64), term: (f64, f64)| (all.0 + term.0, all.1 + term.1);
        terms.into_iter().reduce(add)
    };
    let inverse = |(before, after): (f64, f64)| (before.recip(), after.recip());
    match key {
        "c_total_f_per_cm2" => sum(branches(&|k| format!("c{k}_f_per_cm2"))),
        "r_parallel_ohm_cm2" => {
            let conductances = branches(&|k| format!("r{k}_ohm_cm2")).into_iter().map(inverse);
            sum(conductances.collect()).map(inverse)
        }
        _ => match key.strip_prefix("tau").and_then(|rest| rest.strip_suffix("_s")) {
            Some(k) => {
                let (r, c) = (of(&format!("r{k}_ohm_cm2"))?, of(&format!("c{k}_f_per_cm2"))?);
                Some((r.0 * c.0, r.1 * c.1))
            }
            None => of(key),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::testing::{self, fit, known, run};

    fn finding(group: &str, runs: &[&str], verdict: Verdict, q: f64) -> GroupDiagnosis {
        GroupDiagnosis {
            group: group.to_owned(),
            runs: runs.iter().map(|run| (*run).to_owned()).collect(),
            verdict,
            q_misfit: Some(q),
            ..testing::finding()
        }
    }

    fn shift(key: &str, before: f64, after: f64) -> ParameterShift {
        testing::shift(key, before, after, 0.01)
    }

    #[test]
    fn what_a_claimed_misfit_may_do_is_part_of_the_error_and_what_is_not_known_takes_no_part() {
        let mut runs: Vec<RunRecord> = ["a", "b", "c", "d"]
            .iter()
            .map(|name| run(name, "CNaf-01", "air", Some(34.0), 2.0))
            .collect();
        for run in &mut runs {
            run.fit = Some(fit(&[("rss_ohm_cm2", known(2.0, 0.1))]));
        }
        runs[3].fit.as_mut().unwrap().model = "lumped-2 + faradaic-leak".to_owned();
        let [a, b, c, d] = [0, 1, 2, 3].map(|k: usize| runs[k].path.clone());
        let mut named = finding("n", &[&a, &d], Verdict::Law, 0.001);
        named.shifts = vec![
            shift("rss_ohm_cm2", 2.0, 4.0),
            shift("r1_ohm_cm2", 2.0, 2.0),
            shift("r2_ohm_cm2", 2.0, 6.0),
            shift("c1_f_per_cm2", 1.0, 1.0),
        ];
        let groups = [named, finding("u", &[&b, &c], Verdict::Unexplained, 0.001)];
        let alone = [finding(&c, &[&c], Verdict::Right, 0.9)];
        let findings = Findings {
            groups: &groups,
            runs: &alone,
        };
        let doubts = Doubts::new(findings, &runs);
        let widened = doubts.shift(&a, "rss_ohm_cm2", true).unwrap();
        assert!((widened - 2.0_f64.ln()).abs() < 1e-12);
        assert_eq!(doubts.shift(&a, "rss_ohm_cm2", false), Some(2.0));
        // 1 and 1.5 in parallel to 2 and 6.
        let parallel = doubts.shift(&a, "r_parallel_ohm_cm2", false).unwrap();
        assert!((parallel - 0.5).abs() < 1e-12, "{parallel}");
        assert_eq!(doubts.shift(&a, "tau1_s", true), Some(0.0));
        assert_eq!(doubts.shift(&a, "lambda_per_s", true), None);
        let stated = known(2.0, 0.1);
        let wide = doubts.widened(&a, "rss_ohm_cm2", &stated).unwrap();
        assert!(
            wide.low_95.unwrap() < 0.55 && wide.high_95.unwrap() > 7.5,
            "{wide:?}"
        );
        assert_eq!(doubts.widened(&c, "rss_ohm_cm2", &stated), Some(stated.clone()));
        assert_eq!(doubts.widened(&b, "rss_ohm_cm2", &stated), None);
        let bound = Estimate::below(3.0, "search limit");
        assert_eq!(doubts.widened(&a, "rss_ohm_cm2", &bound), None);
        assert!(doubts.leaves_out(&b) && !doubts.leaves_out(&a));
        assert!(!doubts.leaves_out(&c), "right by itself");
        assert_eq!(doubts.shift(&d, "rss_ohm_cm2", true), Some(0.0), "extended");
        let told = doubts.told(findings);
        let what: Vec<_> = told
            .iter()
            .map(|one| (one.group.as_str(), one.treatment, one.runs.len()))
            .collect();
        assert_eq!(what, [("n", Treatment::Widened, 1), ("u", Treatment::LeftOut, 1)]);
    }

    #[test]
    fn runs_that_differ_as_a_tag_says_are_right_by_themselves() {
        let mut runs = [
            run("a", "CNaf-01", "air", Some(34.0), 2.0),
            run("b", "CNaf-01", "air", Some(34.0), 2.0),
        ];
        for run in &mut runs {
            run.fit = Some(fit(&[("rss_ohm_cm2", known(2.0, 0.1))]));
        }
        let [a, b] = [0, 1].map(|k: usize| runs[k].path.clone());
        let mut group = finding("g", &[&a, &b], Verdict::Law, 0.001);
        group.shifts = vec![shift("rss_ohm_cm2", 2.0, 4.0)];
        group.effects = vec![ieap_domain::EffectFinding {
            effect: "follows:pre_charge_s".to_owned(),
            variant: None,
            parameters: Vec::new(),
            p: 0.001,
            q: None,
            twins: Vec::new(),
        }];
        let groups = [group];
        let alone = [finding(&a, &[&a], Verdict::Right, 0.9)];
        let findings = Findings {
            groups: &groups,
            runs: &alone,
        };
        let doubts = Doubts::new(findings, &runs);
        assert_eq!(doubts.shift(&a, "rss_ohm_cm2", true), Some(0.0));
        assert!(doubts.leaves_out(&b));
    }

    #[test]
    fn what_is_not_claimed_raises_no_doubt() {
        let mut one = run("a", "CNaf-01", "air", Some(34.0), 2.0);
        one.fit = Some(fit(&[("rss_ohm_cm2", known(2.0, 0.1))]));
        for found in [
            finding("g", &[&one.path], Verdict::Unexplained, 0.2),
            finding("g", &[&one.path], Verdict::Right, 0.001),
        ] {
            let groups = [found];
            let findings = Findings {
                groups: &groups,
                runs: &[],
            };
            assert!(!Doubts::new(findings, std::slice::from_ref(&one)).leaves_out(&one.path));
        }
    }
}
