//! What may be behind a misfit, as it is stored and told.

use ieap_domain::{Hypothesis, HypothesisKind};
use ieap_model::effects::Effect;

use super::columns::LawColumns;
use super::policy::LEAST_PROBABILITY;
use super::weighed::{Says, Weighed};
use crate::cause::evidence::log_sum;
use crate::fitting::fitted::Fitted;

/// Every hypothesis that is told, the most probable first.
pub(super) fn posterior(
    weighed: &Weighed,
    masses: &[f64],
    laws: &[LawColumns],
    base: &Fitted,
) -> Vec<Hypothesis> {
    let mut found: Vec<Hypothesis> = Vec::new();
    for (own, &mass) in weighed.all.iter().zip(masses) {
        let plain = |kind, effect: Option<&str>| Hypothesis {
            kind,
            effect: effect.map(str::to_owned),
            parameters_that_differ: Vec::new(),
            with: None,
            mass,
        };
        match own.says {
            Says::Curve(k) | Says::Textbook(k) => {
                let id = laws[k].law.about().id;
                match found.iter_mut().find(|known| known.effect.as_deref() == Some(id)) {
                    Some(known) => known.mass += mass,
                    None => found.push(plain(HypothesisKind::Law, Some(id))),
                }
            }
            Says::Equation(id) => found.push(plain(HypothesisKind::Effect, Some(id))),
            Says::Unnamed => found.push(Hypothesis {
                with: own.place.map(|place| place.site.name().to_owned()),
                ..plain(HypothesisKind::Unnamed, None)
            }),
            Says::Differ => found.extend(differing(weighed, mass, base)),
        }
    }
    found.sort_by(|a, b| b.mass.total_cmp(&a.mass));
    let leads = |k: usize| found[..k].iter().all(|before| before.kind != found[k].kind);
    let kept: Vec<bool> = (0..found.len())
        .map(|k| found[k].mass >= LEAST_PROBABILITY || leads(k))
        .collect();
    // What is not told by itself counts with the leading one of its kind: all sum to one.
    for k in (0..found.len()).filter(|&k| !kept[k]) {
        let (kind, mass) = (found[k].kind, found[k].mass);
        if let Some(leading) = found.iter_mut().find(|own| own.kind == kind) {
            leading.mass += mass;
        }
    }
    let mut kept = kept.into_iter();
    found.retain(|_| kept.next().unwrap_or(false));
    found
}

/// The subsets of parameters that differ, which share that probability.
pub(super) fn differing(weighed: &Weighed, mass: f64, base: &Fitted) -> Vec<Hypothesis> {
    let each: Vec<(Hypothesis, f64)> = (weighed.varying.iter())
        .flat_map(|varying| varying.weighed(base))
        .collect();
    let whole = log_sum(&each.iter().map(|(_, log)| *log).collect::<Vec<_>>());
    let shared = each.into_iter().map(|(own, log)| Hypothesis {
        mass: mass * (log - whole).exp(),
        ..own
    });
    shared.collect()
}
