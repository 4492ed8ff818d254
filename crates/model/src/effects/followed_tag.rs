//! A base parameter that follows a tag from run to run. Which tags there are a campaign says: such an effect stands in no
//! list, and is made of its id wherever that is met.

use std::collections::BTreeMap;
use std::sync::{Mutex, OnceLock, PoisonError};

use super::{About, Effect, EffectParameter, Limits, Scale, Search};
use crate::extended::{RunContext, System, TagAt};
use ieap_domain::diagnosis::{FOLLOWS, follows_a_tag};

/// See the module.
struct FollowedTag {
    about: &'static About,
}

/// Parameters that may follow it: the forms of the effect.
const FORMS: [&str; 5] = [
    "branch-resistances",
    "branch-capacitances",
    "r-ss",
    "alpha",
    "lambda",
];
/// The forms that only bending shows.
const OF_BENDING: usize = 3;
/// Relative changes over the span of the tag within which the strength is sought.
const CHANGE: (f64, f64) = (-0.9, 9.0);

static OF_NUMBERS: [EffectParameter; 1] = [EffectParameter {
    key: "relative_change",
    symbol: "e",
    unit: "",
    meaning: "relative change of the parameter from the lowest to the highest value of the tag in the group",
}];
static OF_A_WORD: [EffectParameter; 1] = [EffectParameter {
    key: "relative_change",
    symbol: "e",
    unit: "",
    meaning: "relative change of the parameter in the runs that have this value of the tag",
}];

/// Where the runs of a group lie among the values that they state of the tag `key`: nothing where all state the same.
/// Numbers are one question; of words each that some runs have and others have not is one, of two the second alone.
pub fn tag_places(key: &str, values: &[Option<&str>]) -> Vec<Vec<TagAt>> {
    let mut places = vec![Vec::new(); values.len()];
    let mut add = |id: &'static str, at: &dyn Fn(&str) -> f64| {
        for (places, value) in places.iter_mut().zip(values) {
            places.push(TagAt {
                id,
                at: value.map_or(0.0, at),
            });
        }
    };
    let number = |value: &str| value.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let stated: Vec<&str> = values.iter().copied().flatten().collect();
    let numbers: Vec<f64> = stated.iter().copied().filter_map(number).collect();
    if numbers.len() == stated.len() {
        let low = numbers.iter().copied().fold(f64::INFINITY, f64::min);
        let span = numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low;
        let mean = low + numbers.iter().map(|x| x - low).sum::<f64>() / numbers.len().max(1) as f64;
        if span > 0.0 && span.is_finite() {
            let id = followed_tag(&format!("{FOLLOWS}{key}")).about().id;
            add(id, &|value| number(value).map_or(0.0, |x| (x - mean) / span));
        }
        return places;
    }
    let mut words = stated;
    words.sort_unstable();
    words.dedup();
    // Of two words that all runs state one says the same as the other.
    let is_complement = words.len() == 2 && values.iter().all(Option::is_some);
    if words.len() > 1 {
        for word in words.into_iter().skip(usize::from(is_complement)) {
            // A model is written with its effects behind plus signs.
            let word_in_id = word.replace('%', "%25").replace('+', "%2B");
            let id = followed_tag(&format!("{FOLLOWS}{key}={word_in_id}")).about().id;
            add(id, &|value| f64::from(u8::from(value == word)));
        }
    }
    places
}

/// The effect of such an id; none of another id. What is made is kept for as long as the program runs: tags are few.
pub(super) fn of_id(id: &str) -> Option<&'static dyn Effect> {
    let tag = id.strip_prefix(FOLLOWS).filter(|tag| !tag.is_empty())?;
    let key = tag.split_once('=').map_or(tag, |(key, _)| key);
    (follows_a_tag(id) && !key.is_empty()).then(|| followed_tag(id))
}

fn followed_tag(id: &str) -> &'static dyn Effect {
    static KNOWN: OnceLock<Mutex<BTreeMap<String, &'static FollowedTag>>> = OnceLock::new();
    let mut known = KNOWN
        .get_or_init(Mutex::default)
        .lock()
        .unwrap_or_else(PoisonError::into_inner);
    *known.entry(id.to_owned()).or_insert_with(|| {
        Box::leak(Box::new(FollowedTag {
            about: Box::leak(Box::new(about(id))),
        }))
    })
}

fn about(id: &str) -> About {
    let kept = |text: String| -> &'static str { Box::leak(text.into_boxed_str()) };
    let tag = id.strip_prefix(FOLLOWS).unwrap_or(id);
    let word = tag.split_once('=').map(|(key, word)| (key, unescaped(word)));
    let (summary, of_runs) = match &word {
        None => (
            format!("a parameter that follows {tag} from run to run"),
            "x the distance of the run's value from the mean, in parts of the span",
        ),
        Some((key, word)) => (
            format!("a parameter that is another where {key} is {word}"),
            "x = 1 in the runs that have this value, 0 in the others",
        ),
    };
    About {
        id: kept(id.to_owned()),
        code: "R1",
        summary: kept(summary),
        equation: kept(format!("P -> P (1 + e)^x, {of_runs}")),
        variants: &FORMS,
        parameters: match word {
            None => &OF_NUMBERS,
            Some(_) => &OF_A_WORD,
        },
        vanishes: "e = 0",
        signature: "each run is described by itself, and its parameter goes with the tag",
        twins: &["contact-break", "residual-charge"],
        separated_by: "more runs in which the tag goes neither with the voltage nor with the order of the runs",
        sources: "the tags of the campaign",
    }
}

fn unescaped(word: &str) -> String {
    word.replace("%2B", "+").replace("%25", "%")
}

impl Effect for FollowedTag {
    fn about(&self) -> &'static About {
        self.about
    }

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        if variant >= OF_BENDING && scale.curvature_per_cm == 0.0 {
            return Search::none();
        }
        Search::over(0.02, vec![Limits::linear(CHANGE.0, CHANGE.1)], &[])
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        let own = run.tags.iter().find(|tag| tag.id == self.about.id);
        let factor = (1.0 + parameters[0]).powf(own.map_or(0.0, |tag| tag.at));
        let of_base = system
            .branches
            .iter_mut()
            .filter(|branch| branch.of_base.is_some());
        match variant {
            0 => of_base.for_each(|branch| branch.resistance_ohm_cm2 *= factor),
            1 => of_base.for_each(|branch| branch.capacitance_f_per_cm2 *= factor),
            2 => system.steady_s_per_cm2 /= factor,
            3 => system.charge_to_curvature_per_c_cm *= factor,
            _ => system
                .relaxation
                .iter_mut()
                .for_each(|mode| mode.rate_per_s *= factor),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Applied, effect};
    use super::*;
    use crate::extended::ExtendedModel;
    use crate::extended::tests::{base, context, drive};

    fn at(places: &[Vec<TagAt>], question: usize) -> Vec<f64> {
        places.iter().map(|run| run[question].at).collect()
    }

    #[test]
    fn numbers_are_one_question_and_words_as_many_as_differ() {
        let numbers = tag_places("pre_charge_s", &[Some("10"), Some("20"), None, Some("30")]);
        assert!(numbers.iter().all(|run| run.len() == 1));
        assert_eq!(at(&numbers, 0), [-0.5, 0.0, 0.0, 0.5]);
        assert_eq!(numbers[0][0].id, "follows:pre_charge_s");
        let two = tag_places("operator", &[Some("B"), Some("A"), Some("B")]);
        assert!(two.iter().all(|run| run.len() == 1));
        assert_eq!(
            (two[0][0].id, at(&two, 0)),
            ("follows:operator=B", vec![1.0, 0.0, 1.0])
        );
        let three = tag_places("operator", &[Some("A"), Some("B"), Some("C"), None]);
        assert!(three.iter().all(|run| run.len() == 3));
        assert_eq!(at(&three, 1), [0.0, 1.0, 0.0, 0.0]);
        for same in [["5", "5"], ["x", "x"]] {
            assert!(tag_places("k", &same.map(Some)).iter().all(Vec::is_empty));
        }
    }

    #[test]
    fn the_effect_is_known_by_its_id_and_a_plus_in_a_word_does_not_end_it() {
        let places = tag_places("batch", &[Some("A+B"), Some("A")]);
        let id = places[0][0].id;
        assert!(!id.contains('+'), "{id}");
        let known = effect(id).unwrap().about();
        assert_eq!(known.id, id);
        assert!(known.summary.ends_with("batch is A+B"), "{}", known.summary);
        assert!(effect("follows:").is_none() && effect("follows:=x").is_none());
    }

    #[test]
    fn a_run_has_the_parameter_that_its_tag_says() {
        let drive = drive(&[(0.0, Some(2.0))]);
        let times = [1.0, 50.0, 300.0];
        let tags = tag_places("pre_charge_s", &[Some("0"), Some("1")]);
        for (place, factor) in [(0, 1.44_f64.powf(-0.5)), (1, 1.44_f64.powf(0.5))] {
            let mut run = context(&drive);
            run.tags = &tags[place];
            let model = ExtendedModel {
                base: base(),
                effects: vec![Applied {
                    effect: effect("follows:pre_charge_s").unwrap(),
                    variant: 2,
                    parameters: vec![0.44],
                }],
            };
            let mut expected = base();
            expected.steady_state_resistance_ohm_cm2 *= factor;
            let found = model.responses(&run, &times, &times);
            for (a, b) in found
                .current_a
                .iter()
                .zip(expected.current_a(&drive, 0.1, &times))
            {
                assert!((a / b - 1.0).abs() < 1e-9);
            }
        }
    }
}
