//! What follows from the masses of the hypotheses.

use ieap_domain::{Hypothesis, HypothesisKind, Verdict};

use super::policy::{LARGEST_SET, MOST, RESEMBLES, SURE};

/// How the id of a parameter that differs begins in a set.
const VARIES: &str = "varies:";

/// The verdict about a misfit that is no chance.
pub fn by_evidence(posterior: &[Hypothesis]) -> Verdict {
    let mass = |of: &dyn Fn(&Hypothesis) -> bool| -> f64 {
        posterior.iter().filter(|h| of(h)).map(|h| h.mass).sum()
    };
    let unknown = mass(&|h| {
        matches!(
            h.kind,
            HypothesisKind::Base | HypothesisKind::Unnamed | HypothesisKind::SlowNoise
        )
    });
    if unknown > MOST {
        return Verdict::Unknown;
    }
    if mass(&|h| h.kind == HypothesisKind::Varies) >= SURE {
        return Verdict::Varies;
    }
    let set = set_of(posterior);
    let Some(first) = set.first().filter(|_| set.len() <= LARGEST_SET) else {
        return Verdict::Unknown;
    };
    if set.iter().any(|id| inclusion(posterior, id) < SURE) {
        return Verdict::Set;
    }
    let holds = |h: &Hypothesis| h.effects.iter().any(|id| id == first);
    let whole = mass(&|h| holds(h));
    let with_unnamed = mass(&|h| holds(h) && h.with_unnamed);
    let stretched: f64 = posterior
        .iter()
        .filter(|h| holds(h) && !h.with_unnamed)
        .map(|h| h.mass * h.form_error.unwrap_or(0.0))
        .sum();
    match () {
        () if with_unnamed > MOST * whole => Verdict::Partial,
        () if stretched > RESEMBLES * whole => Verdict::Resembles,
        () => Verdict::Named,
    }
}

/// Whether it is the noise that leaves the misfit: slow noise, at rest as under voltage, is what is behind it.
pub(crate) fn is_slow_noise(posterior: &[Hypothesis]) -> bool {
    let slow = posterior.iter().filter(|h| h.kind == HypothesisKind::SlowNoise);
    slow.map(|h| h.mass).sum::<f64>() >= SURE
}

/// What becomes of one name that the rules give, asked of the probabilities, with the causes that stand beside it. The rules
/// ask whether held-out readings are predicted, the probabilities allow for equations that are not exact: a name is given
/// where both give it. Where the trace is stretched to fit, it resembles; where others are probable too, it is one of a set.
pub(crate) fn of_one_name(name: &str, posterior: &[Hypothesis]) -> (Verdict, Vec<String>) {
    let others = || {
        let set = set_of(posterior).into_iter();
        set.filter(|id| id != name && !id.starts_with(VARIES)).collect()
    };
    let is_first = set_of(posterior).first().is_some_and(|first| first == name);
    match by_evidence(posterior) {
        Verdict::Named | Verdict::Partial if is_first => (Verdict::Named, Vec::new()),
        Verdict::Resembles if is_first => (Verdict::Resembles, Vec::new()),
        Verdict::Unknown => (Verdict::Resembles, Vec::new()),
        Verdict::Named | Verdict::Set | Verdict::Partial | Verdict::Resembles => (Verdict::Set, others()),
        // Parameters that are free in every run explain more than any equation that is not exact, and predict no run that
        // they have not seen: a cause that does stands.
        _ => (Verdict::Named, Vec::new()),
    }
}

/// The effects and parameters that are sure, then the fewest others with which a sure mass is held, the most probable first.
pub fn set_of(posterior: &[Hypothesis]) -> Vec<String> {
    let mut ids: Vec<String> = Vec::new();
    for hypothesis in posterior {
        for id in names(hypothesis) {
            if !ids.contains(&id) {
                ids.push(id);
            }
        }
    }
    ids.sort_by(|a, b| inclusion(posterior, b).total_cmp(&inclusion(posterior, a)));
    let told: f64 = posterior
        .iter()
        .filter(|h| !names(h).is_empty())
        .map(|h| h.mass)
        .sum();
    let mut set: Vec<String> = Vec::new();
    for id in ids {
        let held: f64 = posterior
            .iter()
            .filter(|h| names(h).iter().any(|own| set.contains(own)))
            .map(|h| h.mass)
            .sum();
        if held >= SURE * told && inclusion(posterior, &id) < SURE {
            break;
        }
        set.push(id);
    }
    set
}

/// Mass of all hypotheses that hold it.
fn inclusion(posterior: &[Hypothesis], id: &str) -> f64 {
    let holds = |h: &&Hypothesis| names(h).iter().any(|own| own == id);
    posterior.iter().filter(holds).map(|h| h.mass).sum()
}

/// Ids of what a hypothesis says is the cause.
fn names(hypothesis: &Hypothesis) -> Vec<String> {
    match hypothesis.kind {
        HypothesisKind::Effect => hypothesis.effects.clone(),
        HypothesisKind::Varies => {
            let each = hypothesis.parameters_that_differ.iter();
            each.map(|key| format!("{VARIES}{key}")).collect()
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hypothesis(kind: HypothesisKind, id: &str, mass: f64) -> Hypothesis {
        Hypothesis {
            kind,
            effects: match kind {
                HypothesisKind::Effect => vec![id.to_owned()],
                _ => Vec::new(),
            },
            form: None,
            parameters_that_differ: match kind {
                HypothesisKind::Varies => vec![id.to_owned()],
                _ => Vec::new(),
            },
            with: None,
            with_unnamed: false,
            form_error: None,
            mass,
        }
    }

    #[test]
    fn the_verdict_follows_the_mass() {
        use HypothesisKind::{Base, Effect, Unnamed, Varies};
        let sure = [hypothesis(Effect, "warburg", 0.97), hypothesis(Unnamed, "", 0.03)];
        assert_eq!(by_evidence(&sure), Verdict::Named);
        let two = [
            hypothesis(Effect, "warburg", 0.6),
            hypothesis(Effect, "dispersion", 0.4),
        ];
        assert_eq!(by_evidence(&two), Verdict::Set);
        assert_eq!(set_of(&two), ["warburg", "dispersion"]);
        let none = [
            hypothesis(Effect, "warburg", 0.3),
            hypothesis(Unnamed, "", 0.5),
            hypothesis(Base, "", 0.2),
        ];
        assert_eq!(by_evidence(&none), Verdict::Unknown);
        let differs = [
            hypothesis(Varies, "rss_ohm_cm2", 0.5),
            hypothesis(Varies, "lambda_per_s", 0.47),
            hypothesis(Effect, "warburg", 0.03),
        ];
        assert_eq!(by_evidence(&differs), Verdict::Varies);
    }

    #[test]
    fn a_name_stands_where_both_give_it() {
        use HypothesisKind::{Effect, Unnamed};
        let sure = [hypothesis(Effect, "warburg", 0.97), hypothesis(Unnamed, "", 0.03)];
        assert_eq!(of_one_name("warburg", &sure), (Verdict::Named, vec![]));
        let beside = (Verdict::Set, vec!["warburg".to_owned()]);
        assert_eq!(of_one_name("dispersion", &sure), beside);
        let mut far = [hypothesis(Effect, "warburg", 1.0)];
        far[0].form_error = Some(0.95);
        assert_eq!(of_one_name("warburg", &far), (Verdict::Resembles, vec![]));
        let nameless = [hypothesis(Unnamed, "", 0.9), hypothesis(Effect, "warburg", 0.1)];
        assert_eq!(of_one_name("warburg", &nameless), (Verdict::Resembles, vec![]));
    }

    #[test]
    fn a_trace_of_another_form_only_resembles() {
        let mut own = hypothesis(HypothesisKind::Effect, "warburg", 1.0);
        own.form_error = Some(0.95);
        assert_eq!(by_evidence(std::slice::from_ref(&own)), Verdict::Resembles);
        let mut with = own.clone();
        (own.mass, with.mass, with.with_unnamed) = (0.3, 0.7, true);
        assert_eq!(by_evidence(&[with, own]), Verdict::Partial);
    }
}
