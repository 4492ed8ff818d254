//! Each parameter over all conditions, with 95 % intervals.

use ieap_domain::words::counted;
use std::collections::BTreeMap;

use serde::Serialize;

use super::wording::{NOT_CONVERGED, humidity_label, voltage_labels};
use crate::aside::{Shown, beyond_words, marks};
use crate::blocks::Writer;
use crate::error::ReportError;
use crate::figures::aside::AsideMark;
use crate::figures::axis::Axis;
use crate::figures::comparison::{Group, Slot, comparison, small_comparison};
use crate::site::Site;
use ieap_analysis::conditions::Conditions;
use ieap_analysis::laws::words;
use ieap_analysis::parameters::{COMPARED, usable};
use ieap_domain::Estimate;
use ieap_domain::ParameterInfo;
use ieap_show::Block;

/// How far beyond the largest (or below the smallest positive) value an interval may stretch an axis.
const STRETCH: f64 = 2.0;

/// Every parameter in a part of its own.
///
/// # Errors
/// [`ReportError::Figure`] where a figure cannot be drawn.
pub fn parts(page: &mut Writer, site: &Site, shown: &mut Shown) -> Result<(), ReportError> {
    let mut parameters = COMPARED.iter().filter_map(|key| ParameterInfo::of(key));
    parameters.try_for_each(|parameter| {
        let title = format!("{} {}", parameter.symbol, parameter.name);
        page.anchored(parameter.key, &title, |part| {
            of_parameter(part, site, parameter, shown)
        })
    })
}

/// Fits that a finding doubts, and what is done with them.
pub fn doubts(site: &Site) -> Vec<String> {
    site.input.doubted.iter().map(words::doubted).collect()
}

/// A figure a material.
fn of_parameter(
    part: &mut Writer,
    site: &Site,
    parameter: &'static ParameterInfo,
    shown: &mut Shown,
) -> Result<(), ReportError> {
    let materials = &site.conditions.materials;
    let groups: Vec<Vec<Group>> = (0..materials.len())
        .map(|material| groups(site, material, parameter))
        .collect();
    let shared = parameter
        .spans_decades
        .then(|| axis(parameter, groups.iter().flatten()));
    for (material, groups) in groups.iter().enumerate() {
        let name = &materials[material];
        let note = Some(note(site, material, parameter)).filter(|note| !note.is_empty());
        let note = note.map_or_else(String::new, |note| format!("{name}: {note}"));
        let slots = groups.iter().flat_map(|group| &group.slots);
        if !slots.flat_map(|slot| &slot.estimates).any(says_something) {
            part.write([Block::say(note)])?;
            continue;
        }
        let axis = shared.clone().unwrap_or_else(|| axis(parameter, groups.iter()));
        let title = format!("{} of {name}", parameter.name);
        let desc = format!(
            "{} against step voltage in each environment, with 95 % intervals. The numbers stand in the table of parameters.",
            parameter.symbol
        );
        let drawn = comparison(groups, &axis, &title, &desc);
        let figure = format!("{}-{material}", parameter.key.replace('_', "-"));
        part.drawing(&figure, (name, &note), drawn)?;
        shown.note(aside_of(groups));
        part.beyond(beyond_words(
            aside_of(groups),
            (None, &axis),
            parameter.shown_unit(),
        ));
    }
    Ok(())
}

/// A small panel of the overview.
#[derive(Debug, Serialize)]
pub struct SmallPanel {
    /// Key of the parameter.
    #[serde(skip)]
    pub key: &'static str,
    title: String,
    figure: String,
    /// The section that shows it large.
    href: String,
}

/// Materials that the overview draws: those with most runs; the page of parameters has all.
const SMALL_MATERIALS: usize = 3;

/// Every parameter over all conditions, small.
pub fn small_panels(
    site: &Site,
    figures: &mut BTreeMap<String, String>,
) -> Result<Vec<SmallPanel>, ReportError> {
    let names = &site.conditions.materials;
    let runs_of = |material: usize| -> usize {
        let measured = site.conditions.measured.iter();
        measured
            .filter(|own| own.material == material)
            .map(|own| own.runs.len())
            .sum()
    };
    let mut materials: Vec<usize> = (0..names.len()).collect();
    materials.sort_by_key(|&material| std::cmp::Reverse(runs_of(material)));
    materials.truncate(SMALL_MATERIALS);
    materials.sort_unstable();
    let mut panels = Vec::new();
    for parameter in COMPARED.iter().filter_map(|key| ParameterInfo::of(key)) {
        let all: Vec<Vec<Group>> = materials.iter().map(|&m| groups(site, m, parameter)).collect();
        let shared = parameter
            .spans_decades
            .then(|| axis(parameter, all.iter().flatten()));
        for (&material, groups) in materials.iter().zip(&all) {
            let slots = groups.iter().flat_map(|group| &group.slots);
            if !slots.flat_map(|slot| &slot.estimates).any(says_something) {
                continue;
            }
            let figure = format!("{}-{material}", parameter.key.replace('_', "-"));
            let axis = shared.clone().unwrap_or_else(|| axis(parameter, groups.iter()));
            let title = format!("{} of {}", parameter.name, names[material]);
            let desc = format!(
                "{} against step voltage in each environment, with 95 % intervals.",
                parameter.symbol
            );
            let drawn = small_comparison(groups, &axis, &title, &desc);
            let drawn = drawn.map_err(ReportError::of_figure(&figure))?;
            figures.insert(figure.clone(), drawn);
            panels.push(SmallPanel {
                key: parameter.key,
                title: format!("{} of {}", parameter.symbol, names[material]),
                figure,
                href: format!("parameters.html#{}", parameter.key),
            });
        }
    }
    Ok(panels)
}

fn says_something(estimate: &Estimate) -> bool {
    estimate.value.or(estimate.low_95).or(estimate.high_95).is_some()
}

/// The runs of a panel that no result is made from.
pub fn aside_of(groups: &[Group]) -> impl Iterator<Item = &AsideMark> {
    let slots = groups.iter().flat_map(|group| &group.slots);
    slots.flat_map(|slot| &slot.aside)
}

/// Every surroundings with every voltage of the campaign, measured or not: panels of one row line up.
pub fn groups(site: &Site, material: usize, parameter: &ParameterInfo) -> Vec<Group> {
    let conditions = &site.conditions;
    let of_runs = |surroundings, voltage| match conditions.at(material, surroundings, voltage) {
        Some(condition) => estimates(site, &condition.runs, parameter),
        None => Default::default(),
    };
    let of_aside = |surroundings, voltage| {
        marks(site, parameter.key, |aside| {
            (aside.condition == Some((material, surroundings, voltage))).then_some(0.0)
        })
    };
    groups_of(conditions, of_runs, of_aside)
}

/// A group for every surroundings, with a slot for every voltage; both are asked for by their places.
pub fn groups_of(
    conditions: &Conditions,
    estimates: impl Fn(usize, usize) -> (Vec<usize>, Vec<Estimate>),
    aside: impl Fn(usize, usize) -> Vec<AsideMark>,
) -> Vec<Group> {
    let labels = voltage_labels(&conditions.voltages_v);
    let mut environments: Vec<&str> = Vec::new();
    let mut groups = Vec::new();
    for (index, surroundings) in conditions.surroundings.iter().enumerate() {
        if environments.last() != Some(&surroundings.environment.as_str()) {
            environments.push(&surroundings.environment);
        }
        let slot = |(voltage, label): (usize, &String)| {
            let (runs, estimates) = estimates(index, voltage);
            Slot {
                label: label.clone(),
                estimates,
                runs,
                aside: aside(index, voltage),
            }
        };
        groups.push(Group {
            label: surroundings.environment.clone(),
            humidity: humidity_label(surroundings),
            style: environments.len() - 1,
            slots: labels.iter().enumerate().map(slot).collect(),
        });
    }
    groups
}

/// The runs with a converged fit among `runs`, and their estimates in shown units.
fn estimates(site: &Site, runs: &[usize], parameter: &ParameterInfo) -> (Vec<usize>, Vec<Estimate>) {
    let finite = |number: &f64| number.is_finite();
    let shown = |number: Option<f64>| {
        number
            .filter(finite)
            .map(|number| number * parameter.shown_factor())
    };
    let of = |&run: &usize| {
        let record = &site.input.runs[run];
        let stated = usable(record, parameter.key)?;
        let estimate = site.input.doubts.stated(&record.path, parameter.key, stated);
        let estimate = Estimate {
            value: shown(estimate.value),
            standard_error: shown(estimate.standard_error),
            low_95: shown(estimate.low_95),
            high_95: shown(estimate.high_95),
            ..estimate.into_owned()
        };
        Some((run, estimate))
    };
    runs.iter().filter_map(of).unzip()
}

/// An axis that shows every value and bound, and intervals as far as `STRETCH` lets them reach.
pub fn axis<'a>(parameter: &ParameterInfo, groups: impl Iterator<Item = &'a Group>) -> Axis {
    let estimates: Vec<&Estimate> = groups
        .flat_map(|group| &group.slots)
        .flat_map(|slot| &slot.estimates)
        .collect();
    let core = |estimate: &&Estimate| match estimate.value {
        Some(value) => vec![value],
        None => [estimate.low_95, estimate.high_95]
            .into_iter()
            .flatten()
            .collect(),
    };
    let values: Vec<f64> = estimates.iter().flat_map(core).collect();
    let ends = estimates
        .iter()
        .flat_map(|estimate| [estimate.low_95, estimate.high_95])
        .flatten();
    let unit = parameter.shown_unit();
    if parameter.spans_decades {
        let positive = || values.iter().copied().filter(|value| *value > 0.0);
        let (low, high) = (
            positive().fold(f64::INFINITY, f64::min),
            positive().fold(0.0, f64::max),
        );
        let (low, high) = if high > 0.0 { (low, high) } else { (0.1, 1.0) };
        let reach = |(l, h): (f64, f64), end: f64| {
            if end > 0.0 {
                (l.min(end.max(low / STRETCH)), h.max(end.min(high * STRETCH)))
            } else {
                (l, h)
            }
        };
        let (low, high) = ends.fold((low, high), reach);
        // Room for the arrow below an upper bound: a seventh of the height.
        let decades = (high / low).log10().max(0.3);
        let bounded = |estimate: &&Estimate| estimate.value.is_none() && estimate.high_95.is_some();
        let room = if estimates.iter().any(bounded) {
            10f64.powf(decades / 6.0)
        } else {
            1.0
        };
        return Axis::log(low / room.max(1.5), high * 1.3, parameter.symbol, unit);
    }
    let largest = values.iter().fold(0.0, |far: f64, value| far.max(value.abs()));
    let limit = if largest > 0.0 { STRETCH * largest } else { 1.0 };
    let (low, high) = ends
        .chain(values.iter().copied())
        .fold((0.0, 0.0), |(l, h): (f64, f64), end| {
            (l.min(end.max(-limit)), h.max(end.min(limit)))
        });
    Axis::linear_rounded(low, high, parameter.symbol, unit, 5)
}

/// Which runs of a material do not determine the parameter, or only bound it, by reason.
fn note(site: &Site, material: usize, parameter: &ParameterInfo) -> String {
    let of_material = site
        .conditions
        .measured
        .iter()
        .filter(|condition| condition.material == material);
    let runs: Vec<usize> = of_material.flat_map(|condition| condition.runs.clone()).collect();
    let mut bounded: BTreeMap<String, usize> = BTreeMap::new();
    let mut missing: BTreeMap<String, usize> = BTreeMap::new();
    for &run in &runs {
        let record = &site.input.runs[run];
        let estimate = usable(record, parameter.key);
        let (reasons, reason) = match estimate {
            Some(estimate) if estimate.value.is_some() => continue,
            Some(estimate) => (
                if says_something(estimate) {
                    &mut bounded
                } else {
                    &mut missing
                },
                estimate.reason.as_deref().unwrap_or("no reason is stored"),
            ),
            None if record.fit.is_none() => (&mut missing, record.state.why_unfitted()),
            None if record.fit.as_ref().is_some_and(|fit| !fit.converged) => (&mut missing, NOT_CONVERGED),
            None => (&mut missing, "its model has no such parameter"),
        };
        *reasons.entry(reason.to_owned()).or_default() += 1;
    }
    let in_all = |reasons: &BTreeMap<String, usize>| reasons.values().sum::<usize>() == runs.len();
    let sentences = [
        reasons_sentence("Not determined", &missing, in_all(&missing)),
        reasons_sentence("Only bounded", &bounded, false),
    ];
    let sentences: Vec<String> = sentences.into_iter().flatten().collect();
    sentences.join(" ")
}

/// `Not determined in any run, because ...` or `Only bounded: 3 runs, because ...`; the most frequent first.
fn reasons_sentence(lead: &str, reasons: &BTreeMap<String, usize>, in_all: bool) -> Option<String> {
    let mut gathered: Vec<(&String, &usize)> = reasons.iter().collect();
    gathered.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
    if let ([(reason, _)], true) = (gathered.as_slice(), in_all) {
        return Some(format!("{lead} in any run, because {reason}."));
    }
    let part = |(reason, count): &(&String, &usize)| format!("{}, because {reason}", counted(**count, "run"));
    let parts: Vec<String> = gathered.iter().map(part).collect();
    let where_ = if in_all { " in any run" } else { "" };
    (!parts.is_empty()).then(|| format!("{lead}{where_}: {}.", parts.join("; ")))
}
