//! What is said of a misfit: one table, decided here and nowhere else.
//!
//! | adequate | probability | predicts | said |
//! |---|---|---|---|
//! | yes | one cause (or each of several) is sure | clearly | `named` |
//! | yes | spread | clearly | `set`: the fewest that are sure together, under the deepest sure node of the tree of causes |
//! | each run by itself | parameters differ | - | `varies` |
//! | no | one cause is sure, and explains most | clearly | `partial` |
//! | as of one of these three | | not clearly | `unproved` |
//! | otherwise | | | `unknown` |
//!
//! Sure is [`SURE`]. The probabilities hold already what is adequate: what leaves a misfit stands there only with something
//! unnamed beside it.

use ieap_domain::diagnosis::follows_a_tag;
use ieap_domain::{CauseNode, Hypothesis, HypothesisKind, Verdict};
use ieap_model::effects::{Site, effect, mechanism_of};

use crate::cause::evidence::{LARGEST_SET, SURE};
use crate::levels::WRONG_BELOW;

/// How the id of a parameter that differs begins in a set.
const VARIES: &str = "varies:";
/// Mechanism of what differs from run to run.
const FROM_RUN_TO_RUN: &str = "from-run-to-run";

/// Depths of nodes. Of a cause that leaves a misfit the mechanism is told: its equation is not that of what is there.
const MECHANISM: usize = 2;
const EFFECT: usize = 3;

/// What the decision rests on.
pub(crate) struct Facts<'a> {
    /// What may be behind the misfit; the probabilities sum to one.
    pub(crate) posterior: &'a [Hypothesis],
    /// Ids of the effects that lead.
    pub(crate) lead: &'a [&'static str],
    /// Whether they leave no more than chance does.
    pub(crate) is_adequate: bool,
    /// Whether they explain most of what the base leaves beyond noise.
    pub(crate) explains_most: bool,
    /// Whether they predict readings that took no part in their fit.
    pub(crate) predicts: bool,
    /// Whether they clearly do.
    pub(crate) is_clear: bool,
}

/// What is said.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Decision {
    pub(crate) verdict: Verdict,
    /// Ids of effects, and of parameters that differ, the most probable first.
    pub(crate) set: Vec<String>,
    pub(crate) node: Option<CauseNode>,
}

/// Decides about a misfit that is no chance.
pub(crate) fn decide(facts: &Facts) -> Decision {
    let names = Names::of(facts.posterior);
    let said = |verdict, set: Vec<String>| Decision {
        verdict,
        node: names.node(&set, EFFECT),
        set,
    };
    let unknown = said(Verdict::Unknown, Vec::new());
    if differ(facts.posterior) >= SURE {
        let set = names.smallest_set(Names::held_in_part);
        let deepest = if set.len() == 1 { EFFECT } else { MECHANISM };
        return Decision {
            verdict: Verdict::Varies,
            node: names.node(&set, deepest),
            set,
        };
    }
    if !facts.predicts {
        return unknown;
    }
    let proved = |verdict| {
        if facts.is_clear {
            verdict
        } else {
            Verdict::Unproved
        }
    };
    let sure: Vec<String> = names.sure().map(str::to_owned).collect();
    let is_sure = |id: &&str| sure.iter().any(|own| own == id);
    if !facts.is_adequate {
        return if facts.explains_most && facts.lead.iter().any(is_sure) {
            Decision {
                verdict: proved(Verdict::Partial),
                node: names.node(&sure, MECHANISM.min(shared_depth(&sure))),
                set: sure,
            }
        } else {
            unknown
        };
    }
    if facts.lead.iter().all(is_sure) {
        let set: Vec<String> = facts.lead.iter().map(|id| (*id).to_owned()).collect();
        return Decision {
            verdict: proved(Verdict::Named),
            node: names.node(&set, shared_depth(&set)),
            set,
        };
    }
    let set = said(proved(Verdict::Set), names.smallest_set(Names::held_whole));
    if set.node.is_some() || (1..=LARGEST_SET).contains(&set.set.len()) {
        set
    } else {
        unknown
    }
}

/// What is said of one cause that is sure, by the chance of what it leaves.
pub(crate) fn of_one(p_leftover: Option<f64>) -> Verdict {
    match p_leftover {
        Some(p) if p < WRONG_BELOW => Verdict::Partial,
        _ => Verdict::Named,
    }
}

/// The leaf of an effect.
pub(crate) fn leaf(id: &str, probability: f64) -> CauseNode {
    let path = path_of(id);
    CauseNode {
        words: words(&path),
        depth: path.len(),
        path,
        probability,
    }
}

/// Probability that parameters differ between the runs, but for those that follow a tag: that has the name of the tag.
pub(crate) fn differ(posterior: &[Hypothesis]) -> f64 {
    let freely = posterior
        .iter()
        .filter(|own| own.kind == HypothesisKind::Varies && !own.with.as_deref().is_some_and(follows_a_tag));
    freely.map(|own| own.mass).sum()
}

/// Whether it is the noise that leaves the misfit: slow noise, at rest as under voltage, is what is behind it.
pub(crate) fn is_slow_noise(posterior: &[Hypothesis]) -> bool {
    let slow = posterior.iter().filter(|h| h.kind == HypothesisKind::SlowNoise);
    slow.map(|h| h.mass).sum::<f64>() >= SURE
}

/// Ids of what a hypothesis says is the cause.
fn names_of(hypothesis: &Hypothesis) -> Vec<String> {
    match (hypothesis.kind, hypothesis.with.as_deref()) {
        (HypothesisKind::Effect, _) => hypothesis.effects.clone(),
        (HypothesisKind::Varies, Some(tag)) if follows_a_tag(tag) => vec![tag.to_owned()],
        (HypothesisKind::Varies, _) => {
            let each = hypothesis.parameters_that_differ.iter();
            each.map(|key| format!("{VARIES}{key}")).collect()
        }
        _ => Vec::new(),
    }
}

/// What an id is called on the way from the root of the tree of causes.
fn path_of(id: &str) -> Vec<String> {
    let place = if id.starts_with(VARIES) {
        Some((Site::Runs, FROM_RUN_TO_RUN))
    } else {
        mechanism_of(id).map(|own| (own.site, own.id))
    };
    place.map_or_else(Vec::new, |(site, mechanism)| {
        vec![site.name().to_owned(), mechanism.to_owned(), id.to_owned()]
    })
}

/// Depth down to which the ways to all of them are one: what several causes that are there have in common.
fn shared_depth(ids: &[String]) -> usize {
    let paths: Vec<Vec<String>> = ids.iter().map(|id| path_of(id)).collect();
    let Some((first, others)) = paths.split_first() else {
        return 0;
    };
    let is_shared = |depth: &usize| others.iter().all(|other| other.starts_with(&first[..*depth]));
    (0..=first.len()).rev().find(is_shared).unwrap_or(0)
}

/// Hypotheses with the ids that they name.
struct Names<'a> {
    of: Vec<(Vec<String>, &'a Hypothesis)>,
    /// Every id with the probability that it is there, the most probable first.
    ranked: Vec<(String, f64)>,
}

impl<'a> Names<'a> {
    fn of(posterior: &'a [Hypothesis]) -> Names<'a> {
        let of: Vec<(Vec<String>, &Hypothesis)> = posterior.iter().map(|own| (names_of(own), own)).collect();
        let mut ranked: Vec<(String, f64)> = Vec::new();
        for (ids, own) in &of {
            for id in ids {
                match ranked.iter_mut().find(|(known, _)| known == id) {
                    Some((_, mass)) => *mass += own.mass,
                    None => ranked.push((id.clone(), own.mass)),
                }
            }
        }
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        Names { of, ranked }
    }

    /// Those that are sure by themselves.
    fn sure(&self) -> impl Iterator<Item = &str> {
        let sure = self.ranked.iter().filter(|(_, mass)| *mass >= SURE);
        sure.map(|(id, _)| id.as_str())
    }

    /// Probability of the hypotheses that name nothing but members of `set`.
    fn held_whole(&self, set: &[String]) -> f64 {
        self.held(&|ids| ids.iter().all(|id| set.contains(id)))
    }

    /// Probability of the hypotheses that name a member of `set`.
    fn held_in_part(&self, set: &[String]) -> f64 {
        self.held(&|ids| ids.iter().any(|id| set.contains(id)))
    }

    fn held(&self, holds: &dyn Fn(&[String]) -> bool) -> f64 {
        let held = self.of.iter().filter(|(ids, _)| !ids.is_empty() && holds(ids));
        held.map(|(_, own)| own.mass).sum()
    }

    /// Those that are sure, then the fewest others with which as much is held as is sure, the most probable first; nothing
    /// where all together hold less.
    fn smallest_set(&self, held: fn(&Self, &[String]) -> f64) -> Vec<String> {
        let mut set: Vec<String> = Vec::new();
        for (id, mass) in &self.ranked {
            if held(self, &set) >= SURE && *mass < SURE {
                return set;
            }
            set.push(id.clone());
        }
        if held(self, &set) >= SURE { set } else { Vec::new() }
    }

    /// The deepest sure node above the most probable of the set, no deeper than that.
    fn node(&self, set: &[String], deepest: usize) -> Option<CauseNode> {
        let first = path_of(set.first()?);
        (1..=first.len().min(deepest)).rev().find_map(|depth| {
            let path = &first[..depth];
            let under = |ids: &[String]| ids.iter().any(|id| path_of(id).starts_with(path));
            let probability = self.held(&under);
            (probability >= SURE).then(|| CauseNode {
                words: words(path),
                path: path.to_vec(),
                depth,
                probability: probability.min(1.0),
            })
        })
    }
}

/// What is so at a node, as a clause.
fn words(path: &[String]) -> String {
    match path {
        [.., mechanism, id] if path.len() == 3 => effect(id).map_or_else(
            || format!("{mechanism}: {}", id.trim_start_matches(VARIES)),
            |known| known.about().summary.to_owned(),
        ),
        [_, id] => ieap_model::effects::mechanism(id).map_or_else(|| id.clone(), |own| own.words.to_owned()),
        [site] if site == Site::Bending.name() => "the strip bends otherwise than simulated".to_owned(),
        [site] if site == Site::Current.name() => "the current is another than simulated".to_owned(),
        _ => "the runs differ".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use HypothesisKind::{Base, Effect, SlowNoise, Unnamed, Varies};

    fn hypothesis(kind: HypothesisKind, ids: &[&str], mass: f64) -> Hypothesis {
        let ids: Vec<String> = ids.iter().map(|id| (*id).to_owned()).collect();
        let (effects, parameters_that_differ) = match kind {
            Varies => (Vec::new(), ids),
            _ => (ids, Vec::new()),
        };
        Hypothesis {
            kind,
            effects,
            form: None,
            parameters_that_differ,
            with: None,
            with_unnamed: false,
            mass,
        }
    }

    fn decided(posterior: &[Hypothesis], is_adequate: bool, predicts: bool) -> Decision {
        decided_where(posterior, is_adequate, predicts, true)
    }

    fn decided_where(
        posterior: &[Hypothesis],
        is_adequate: bool,
        predicts: bool,
        is_clear: bool,
    ) -> Decision {
        let lead = posterior.iter().find(|own| own.kind == Effect);
        let ids = lead.map_or(&[][..], |own| &own.effects);
        let lead: Vec<&'static str> = ids.iter().filter_map(|id| Some(effect(id)?.about().id)).collect();
        decide(&Facts {
            posterior,
            lead: &lead,
            is_adequate,
            explains_most: true,
            predicts,
            is_clear,
        })
    }

    fn depth(decision: &Decision) -> usize {
        decision.node.as_ref().map_or(0, |node| node.depth)
    }

    #[test]
    fn one_cause_that_is_sure_is_named_where_it_is_adequate_and_predicts() {
        let sure = [
            hypothesis(Effect, &["warburg"], 0.97),
            hypothesis(Unnamed, &[], 0.03),
        ];
        let named = decided(&sure, true, true);
        assert_eq!((named.verdict, depth(&named)), (Verdict::Named, 3));
        assert_eq!(
            named.node.unwrap().path,
            ["current", "current-time-scales", "warburg"]
        );
        let partial = decided(&sure, false, true);
        assert_eq!((partial.verdict, depth(&partial)), (Verdict::Partial, 2));
        for is_adequate in [true, false] {
            let unknown = decided(&sure, is_adequate, false);
            assert_eq!((unknown.verdict, unknown.set.len()), (Verdict::Unknown, 0));
            let unproved = decided_where(&sure, is_adequate, true, false);
            assert_eq!((unproved.verdict, unproved.set.len()), (Verdict::Unproved, 1));
        }
    }

    #[test]
    fn a_spread_within_one_mechanism_is_that_mechanism() {
        let spread = [
            hypothesis(Effect, &["warburg"], 0.6),
            hypothesis(Effect, &["dispersion"], 0.38),
            hypothesis(Effect, &["creep"], 0.02),
        ];
        let set = decided(&spread, true, true);
        assert_eq!((set.verdict, depth(&set)), (Verdict::Set, 2));
        assert_eq!(set.set, ["warburg", "dispersion"]);
        assert!((set.node.unwrap().probability - 0.98).abs() < 1e-12);
        assert_eq!(decided(&spread, false, true).verdict, Verdict::Unknown);
    }

    #[test]
    fn a_spread_over_places_is_a_set_as_long_as_it_is_short() {
        let even = |ids: &[&str]| {
            let mass = 1.0 / ids.len() as f64;
            let all: Vec<Hypothesis> = ids.iter().map(|id| hypothesis(Effect, &[*id], mass)).collect();
            decided(&all, true, true)
        };
        let few = even(&["warburg", "creep"]);
        assert_eq!((few.verdict, depth(&few)), (Verdict::Set, 0));
        let many = even(&[
            "warburg",
            "creep",
            "faradaic-leak",
            "softening",
            "camera-delay",
            "friction",
        ]);
        assert_eq!(many.verdict, Verdict::Unknown);
        let of_bending = even(&[
            "creep",
            "softening",
            "camera-delay",
            "friction",
            "resonance",
            "camera-zero",
        ]);
        assert_eq!((of_bending.verdict, depth(&of_bending)), (Verdict::Set, 1));
    }

    #[test]
    fn both_of_a_pair_are_named_and_one_that_is_open_makes_a_set() {
        let pair = [hypothesis(Effect, &["warburg", "creep"], 0.99)];
        let named = decided(&pair, true, true);
        assert_eq!((named.verdict, named.set.len()), (Verdict::Named, 2));
        // One in the current, one in the bending: they have nothing in common.
        assert_eq!(
            (
                depth(&named),
                shared_depth(&["creep".to_owned(), "camera-zero".to_owned()])
            ),
            (0, 2)
        );
        let open = [
            hypothesis(Effect, &["warburg", "creep"], 0.5),
            hypothesis(Effect, &["warburg", "friction"], 0.5),
        ];
        let set = decided(&open, true, true);
        assert_eq!(set.verdict, Verdict::Set);
        assert_eq!(set.set[0], "warburg");
    }

    #[test]
    fn what_is_spread_over_nothing_known_is_unknown() {
        let none = [
            hypothesis(Effect, &["warburg"], 0.3),
            hypothesis(Unnamed, &[], 0.5),
            hypothesis(Base, &[], 0.2),
        ];
        assert_eq!(decided(&none, true, true).verdict, Verdict::Unknown);
        assert!(!is_slow_noise(&none));
        assert!(is_slow_noise(&[hypothesis(SlowNoise, &[], 0.96)]));
    }

    #[test]
    fn parameters_that_differ_are_told_and_those_that_follow_a_tag_have_its_name() {
        let differing = [
            hypothesis(Varies, &["rss_ohm_cm2"], 0.5),
            hypothesis(Varies, &["rss_ohm_cm2", "lambda_per_s"], 0.47),
            hypothesis(Effect, &["warburg"], 0.03),
        ];
        let found = decided(&differing, false, false);
        assert_eq!((found.verdict, depth(&found)), (Verdict::Varies, 3));
        assert_eq!(found.set, ["varies:rss_ohm_cm2"]);
        let two = [hypothesis(Varies, &["rss_ohm_cm2", "lambda_per_s"], 0.99)];
        let both = decided(&two, false, false);
        assert_eq!((both.set.len(), depth(&both)), (2, 2));
        let mut along = hypothesis(Varies, &["rss_ohm_cm2"], 0.8);
        along.with = Some("follows:batch".to_owned());
        let tag = [along, hypothesis(Effect, &["follows:batch"], 0.2)];
        let found = decided(&tag, true, true);
        assert_eq!(
            (found.verdict, found.set),
            (Verdict::Named, vec!["follows:batch".to_owned()])
        );
    }
}
