//! The thesis's figure 26: parameters over environment and voltage, one panel a parameter and material.

use std::collections::BTreeSet;

use super::FigureInput;
use super::grid::{Panel, grid};
use crate::aside::beyond_words;
use crate::figures::canvas::Drawing;
use crate::figures::comparison::comparison_on;
use crate::pages::comparison::{aside_of, axis, groups};
use ieap_domain::ParameterInfo;

/// What the thesis's figure shows, from top to bottom.
const SHOWN: [&str; 5] = [
    "c_total_f_per_cm2",
    "r_parallel_ohm_cm2",
    "rss_ohm_cm2",
    "alpha_per_c_cm",
    "lambda_per_s",
];
/// Height of a panel, px.
const HEIGHT: u32 = 190;

/// Draws it.
pub fn draw(input: &FigureInput, width: u32) -> Result<Drawing, String> {
    let materials = &input.site.conditions.materials;
    let (mut panels, mut aside, mut notes) = (Vec::new(), BTreeSet::new(), Vec::new());
    for parameter in SHOWN.iter().filter_map(|key| ParameterInfo::of(key)) {
        for (material, name) in materials.iter().enumerate() {
            let groups = groups(input.site, material, parameter);
            let known = groups
                .iter()
                .flat_map(|group| &group.slots)
                .flat_map(|slot| &slot.estimates);
            let is_known = |estimate: &ieap_domain::Estimate| {
                estimate.value.or(estimate.low_95).or(estimate.high_95).is_some()
            };
            if !known.into_iter().any(is_known) {
                continue;
            }
            let y = axis(parameter, groups.iter());
            aside.extend(aside_of(&groups).map(|mark| mark.run));
            let beyond = beyond_words(aside_of(&groups), (None, &y), parameter.shown_unit());
            if !beyond.is_empty() {
                notes.push(format!("{}, {name}: {beyond}", parameter.symbol));
            }
            panels.push(Panel {
                title: name.clone(),
                draw: Box::new(move |area| comparison_on(area, &groups, &y)),
            });
        }
    }
    let said = aside.into_iter().map(|run| {
        let (name, reason) = (
            input.site.run_name(run),
            input.site.input.record(run).standing.reason(),
        );
        format!("Crossed circle: set aside, in no result: {name} ({reason}).")
    });
    let notes: Vec<String> = said.chain(notes).collect();
    grid(width, materials.len().clamp(1, 3), HEIGHT, &[], &panels, &notes)
}
