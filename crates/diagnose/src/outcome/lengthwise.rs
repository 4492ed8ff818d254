//! Electrodes that resist along the strip, told by readings at several places.
//!
//! In current and mean curvature the resistance looks like other causes. Places along the strip tell: they differ, and
//! some follow later, as no cause of the strip as a whole makes them.

use crate::extended::leftover::p_leftover;
use crate::levels::{RIGHT_FROM, TAKEN};
use crate::options::DiagnoseOptions;
use crate::outcome::policy::LEAST_CHANCE;
use crate::readings::group::RunInput;
use ieap_domain::finding_words::say;
use ieap_domain::number::{significant, upper_bound};
use ieap_domain::{EffectFinding, GroupDiagnosis, HeldOutError, MissingLaw, Parameter, Verdict};
use ieap_fit::distributed::{Decision, LumpedOrDistributed};
use ieap_model::effects::place_of;
use ieap_model::effects::{Site, effect, summary};

/// Id of the effect in the library.
const ID: &str = "lengthwise-resistance";

/// What a run of the group says of it: its name and the decision.
pub type PlacesOfRun<'a> = (&'a str, Decision);

/// The finding about a group with what places along the strip of its runs say. Runs without readings at two places say
/// nothing.
pub fn with_places(
    found: GroupDiagnosis,
    runs: &[PlacesOfRun],
    inputs: &[RunInput],
    options: &DiagnoseOptions,
) -> GroupDiagnosis {
    let mut found = joined(found, runs, |resistance_ohm_per_sq| {
        p_leftover(inputs, options, ID, &[resistance_ohm_per_sq])
    });
    say(&mut found, &summary);
    found
}

/// `leftover` gives the chance of what is left beside electrodes of that resistance, Ohm per square.
fn joined(
    mut found: GroupDiagnosis,
    runs: &[PlacesOfRun],
    leftover: impl FnOnce(f64) -> Option<f64>,
) -> GroupDiagnosis {
    let asked: Vec<(&PlacesOfRun, f64)> = runs
        .iter()
        .filter_map(|run| {
            let uneven = run.1.unevenness?;
            Some((run, uneven.p.max(uneven.p_later)))
        })
        .collect();
    let Some((clearest, p)) = asked.iter().min_by(|a, b| a.1.total_cmp(&b.1)).copied() else {
        return found;
    };
    let p = (p * asked.len() as f64).clamp(LEAST_CHANCE, 1.0);
    found
        .remarks
        .push(format!("{}: {}", clearest.0, clearest.1.issue().message));
    if found.verdict == Verdict::DataProblem {
        return found;
    }
    // Two questions were asked of the group: its course in time, and its places.
    found.p_misfit = found.p_misfit.map(|of_time| (2.0 * of_time.min(p)).min(1.0));
    if p < TAKEN {
        proved(found, clearest, p, leftover)
    } else {
        if found.verdict == Verdict::Right && found.p_misfit.is_some_and(|p| p < RIGHT_FROM) {
            found.verdict = Verdict::Undecided;
        }
        unseen(found, &asked)
    }
}

fn proved(
    mut found: GroupDiagnosis,
    clearest: &PlacesOfRun,
    p: f64,
    leftover: impl FnOnce(f64) -> Option<f64>,
) -> GroupDiagnosis {
    let resistance = &clearest.1.electrode_resistance_ohm_per_sq;
    let twins = effect(ID).map_or(&[][..], |effect| effect.about().twins);
    let is_it = |id: &str| id == ID || twins.contains(&id);
    let name = found.missing.iter().find_map(|law| law.name.as_deref());
    let others = found.verdict == Verdict::Law && name.is_some_and(|id| !is_it(id));
    if others {
        found.remarks.push(format!(
            "besides, places along the strip show {ID}, {}",
            chance(p)
        ));
        return found;
    }
    let fitted = found.effects.len() == 1 && found.effects[0].effect == ID;
    if fitted {
        found.effects[0].twins.clear();
        found.effects[0].p = p;
    } else {
        // What was said of another cause's gain and parameters is not said of this one.
        found.effects = vec![EffectFinding {
            effect: ID.to_owned(),
            variant: None,
            parameters: vec![Parameter {
                key: "electrode_resistance_ohm_per_sq".to_owned(),
                estimate: resistance.clone(),
            }],
            p,
            q: None,
            twins: Vec::new(),
        }];
        found.gain = None;
        found.shifts.clear();
        found.profiles.clear();
        found.p_leftover = None;
    }
    found.next_run = None;
    found.set = vec![ID.to_owned()];
    // A misfit in time that nothing explained may be that of the resistance.
    if found.verdict == Verdict::Unexplained && !fitted {
        found.p_leftover = resistance.value.and_then(leftover);
    }
    found.missing = vec![law(p)];
    found.verdict = Verdict::Law;
    let text = format!(
        "places along the strip tell it from every cause of the strip as a whole, {}",
        chance(p)
    );
    found.whereabouts.get_or_insert_default().text = text;
    found
}

/// The resistance of the electrodes as a missing law.
fn law(p: f64) -> MissingLaw {
    let place = place_of(ID);
    MissingLaw {
        place: Site::Current.name().to_owned(),
        law: place.map(|own| own.law.to_owned()),
        of: None,
        variable: place.map(|own| own.variable.to_owned()),
        words: "the electrodes resist along the strip".to_owned(),
        name: Some(ID.to_owned()),
        names: vec![ID.to_owned()],
        probability: 1.0 - p,
        curve: None,
        held_out: HeldOutError::default(),
    }
}

fn chance(p: f64) -> String {
    if p > LEAST_CHANCE {
        format!("p = {}", significant(p, 2))
    } else {
        format!("p {}", upper_bound(LEAST_CHANCE))
    }
}

/// Where places do not differ, a resistance beyond what they allow is no cause.
fn unseen(mut found: GroupDiagnosis, asked: &[(&PlacesOfRun, f64)]) -> GroupDiagnosis {
    let even = |(run, _): &(&PlacesOfRun, f64)| run.1.verdict() == LumpedOrDistributed::Even;
    let most = asked
        .iter()
        .filter_map(|(run, _)| run.1.electrode_resistance_ohm_per_sq.high_95)
        .fold(f64::INFINITY, f64::min);
    let of_it = found.effects.iter().find(|finding| finding.effect == ID);
    let needed = of_it
        .and_then(|finding| finding.parameters.first())
        .and_then(|parameter| parameter.estimate.low_95);
    let excluded = asked.iter().all(even) && needed.is_none_or(|needed| needed > most);
    if !excluded || found.set.len() < 2 || of_it.is_some() {
        return found;
    }
    found.set.retain(|id| id != ID);
    for finding in &mut found.effects {
        finding.twins.retain(|id| id != ID);
    }
    for law in &mut found.missing {
        law.names.retain(|id| id != ID);
        if let (None, [only]) = (&law.name, &law.names[..]) {
            law.name = Some(only.clone());
        }
    }
    found
        .remarks
        .push(format!("places along the strip do not differ: it is not {ID}"));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Estimate;
    use ieap_domain::testing::finding;
    use ieap_fit::distributed::Unevenness;

    fn group(verdict: Verdict, set: &[&str]) -> GroupDiagnosis {
        GroupDiagnosis {
            verdict,
            p_misfit: Some(0.001),
            set: set.iter().map(|id| (*id).to_owned()).collect(),
            ..finding()
        }
    }

    fn law_of(name: Option<&str>, names: &[&str]) -> GroupDiagnosis {
        let mut found = group(Verdict::Law, names);
        found.missing = vec![MissingLaw {
            name: name.map(str::to_owned),
            names: found.set.clone(),
            ..law(0.01)
        }];
        found
    }

    fn places(p: f64, p_later: f64) -> Decision {
        Decision {
            unevenness: Some(Unevenness {
                places: 8,
                gain: 1000.0,
                uneven: 1100.0,
                independent_readings: 900.0,
                p,
                p_later,
            }),
            lumped_error: None,
            electrode_resistance_ohm_per_sq: Estimate::determined(2.5, 0.1, 2.3, 2.7),
        }
    }

    fn unasked(_: f64) -> Option<f64> {
        panic!("what is left need not be asked")
    }

    #[test]
    fn a_misfit_without_a_name_is_asked_whether_the_resistance_leaves_it() {
        for left in [Some(0.4), Some(1e-4), None] {
            let found = joined(
                group(Verdict::Unexplained, &[]),
                &[("a", places(1e-9, 1e-8))],
                |resistance| {
                    assert_eq!(resistance, 2.5);
                    left
                },
            );
            assert_eq!((found.verdict, found.p_leftover), (Verdict::Law, left));
            assert_eq!(found.missing[0].name.as_deref(), Some(ID));
            assert!(found.whereabouts.unwrap().text.contains("tell it"));
        }
    }

    #[test]
    fn places_make_a_name_of_a_set() {
        let set = ["current-limit", ID];
        let found = joined(law_of(None, &set), &[("a", places(1e-9, 1e-8))], unasked);
        assert_eq!(
            (found.verdict, &found.set[..]),
            (Verdict::Law, &[ID.to_owned()][..])
        );
        assert_eq!(found.effects[0].parameters[0].estimate.value, Some(2.5));
    }

    #[test]
    fn even_places_and_a_fixed_pattern_name_nothing() {
        for (p, p_later) in [(0.4, 0.5), (1e-9, 0.3)] {
            let mut described = group(Verdict::Right, &[]);
            described.p_misfit = Some(0.6);
            let found = joined(described, &[("a", places(p, p_later))], unasked);
            assert_eq!((found.verdict, found.set.len()), (Verdict::Right, 0));
            assert_eq!(found.remarks.len(), 1);
        }
    }

    /// Of two questions the chance of the clearer counts twice: a group is right only where that is no less than 0.05.
    #[test]
    fn a_group_that_its_places_make_doubtful_is_not_called_right() {
        let mut described = group(Verdict::Right, &[]);
        described.p_misfit = Some(0.6);
        let found = joined(described, &[("a", places(0.015, 0.015))], unasked);
        assert_eq!((found.verdict, found.p_misfit), (Verdict::Undecided, Some(0.03)));
    }

    #[test]
    fn even_places_take_it_out_of_a_set_and_another_name_stands() {
        let found = joined(
            law_of(None, &["current-limit", ID]),
            &[("a", places(0.4, 0.5))],
            unasked,
        );
        assert_eq!(found.missing[0].name.as_deref(), Some("current-limit"));
        assert!(found.remarks[1].ends_with("it is not lengthwise-resistance"));
        let other = joined(
            law_of(Some("faradaic-leak"), &["faradaic-leak"]),
            &[("a", places(1e-9, 1e-9))],
            unasked,
        );
        assert_eq!(other.set, ["faradaic-leak"]);
        assert!(other.remarks.iter().any(|remark| remark.contains(ID)));
    }

    #[test]
    fn runs_without_places_change_nothing() {
        let mut none = places(1e-9, 1e-9);
        none.unevenness = None;
        let found = joined(law_of(None, &["current-limit", ID]), &[("a", none)], unasked);
        assert_eq!((found.set.len(), found.p_misfit), (2, Some(0.001)));
    }
}
