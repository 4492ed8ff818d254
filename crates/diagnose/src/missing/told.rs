//! What the readings tell: the deepest of place, law and variable, name that is sure.

use ieap_domain::Hypothesis;
use ieap_model::effects::Site;
use ieap_model::effects::smooth_laws::{Place, SMOOTH_LAWS, WEIGHTS};
use ieap_model::law_of_parameter;

use super::policy::{INEXACT, SURE};
use super::weighed::{Says, Weighed, Weight};

/// What is told, with its probability.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Told {
    /// Where it acts.
    pub(crate) site: Option<Site>,
    /// Law and what it follows, where that is sure.
    pub(crate) place: Option<Place>,
    /// Equations of the library that lie under it, the most probable first.
    pub(crate) names: Vec<&'static str>,
    /// The one that is sure.
    pub(crate) name: Option<&'static str>,
    /// Probability of the deepest of these.
    pub(crate) probability: f64,
}

/// The deepest that is sure; nothing where no place is. `differing` are the runs that differ, with their masses.
pub(crate) fn told(weighed: &Weighed, masses: &[f64], differing: &[Hypothesis]) -> Told {
    let each = || weighed.all.iter().zip(masses);
    let followed: Vec<(Place, f64)> = (differing.iter())
        .filter_map(|own| Some((law_of(own)?, own.mass)))
        .collect();
    let sum = |is_of: &dyn Fn(&Place) -> bool| -> f64 {
        let placed = each().filter_map(|(own, mass)| Some((own.place.as_ref()?, mass)));
        let followed = followed.iter().map(|(place, mass)| (place, mass));
        let of = placed.chain(followed).filter(|(place, _)| is_of(place));
        of.map(|(_, mass)| mass).sum()
    };
    let mut told = Told::default();
    for site in [Site::Current, Site::Bending] {
        let mass = sum(&|place| place.site == site);
        if mass >= SURE {
            (told.site, told.probability) = (Some(site), mass);
        }
    }
    let Some(site) = told.site else { return told };
    let mut places: Vec<(Place, f64)> = Vec::new();
    for (own, _) in each() {
        let listed = own.place.filter(|_| own.says != Says::Unnamed);
        let Some(place) = listed.filter(|place| place.site == site) else {
            continue;
        };
        let key = Place { of: "", ..place };
        if places.iter().all(|(known, _)| *known != key) {
            places.push((key, sum(&|other| Place { of: "", ..*other } == key)));
        }
    }
    let best = places.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let Some((place, mass)) = best.filter(|(_, mass)| *mass >= SURE) else {
        return told;
    };
    (told.place, told.probability) = (Some(place), mass);
    let of_place = |own: &Weight| own.place.is_some_and(|of| Place { of: "", ..of } == place);
    let curve = each()
        .filter(|(own, _)| matches!(own.says, Says::Curve(_)) && of_place(own))
        .map(|(own, _)| own.fall)
        .fold(0.0, f64::max);
    let mut names: Vec<(&'static str, f64, f64)> = each()
        .filter_map(|(own, mass)| match own.says {
            Says::Equation(id) if of_place(own) => Some((id, *mass, own.fall)),
            _ => None,
        })
        .collect();
    names.sort_by(|a, b| b.1.total_cmp(&a.1));
    // Inside the band: what the curve explains beyond it is what its further weights take of noise.
    let inside = |fall: f64| fall > (1.0 - INEXACT) * curve - 0.5 * WEIGHTS as f64;
    let most = names.first().map_or(0.0, |(_, most, _)| *most);
    let within: Vec<(&'static str, f64)> = names
        .iter()
        .filter(|(_, own, fall)| inside(*fall) && *own > (1.0 - SURE) * most)
        .map(|(id, own, _)| (*id, *own))
        .collect();
    // A law of another shape may lie within the band as well: the name must be as sure as the law.
    told.name = match within[..] {
        [(only, mass)] if mass >= SURE => Some(only),
        _ => None,
    };
    let within = within.into_iter().map(|(id, _)| id).collect();
    told.names = within;
    told
}

/// The law that a parameter is which differs with the voltage: both say the same.
fn law_of(differs: &Hypothesis) -> Option<Place> {
    let [parameter] = &differs.parameters_that_differ[..] else {
        return None;
    };
    let law = law_of_parameter(parameter).filter(|_| differs.with.as_deref() == Some(VOLTAGE))?;
    let mut places = SMOOTH_LAWS.iter().map(|own| own.place);
    places.find(|place| (place.law, place.of, place.variable) == (law, "", VOLTAGE))
}

/// The variable that runs are mostly taken over.
const VOLTAGE: &str = "voltage_v";
