//! Candidate effects: what the lumped model may be missing. One file each, one list.
//!
//! An effect says where it acts in a [`System`], within which limits its parameters are sought, and at which
//! shapes its signature is looked for. At strength 0 (the first parameter) it is absent.

mod about;
mod acting;
mod ambient_temperature;
mod asymmetric_capacitance;
mod bending_event;
mod camera_delay;
mod camera_zero;
mod clock_rate;
mod constant_phase;
mod contact_break;
mod counter_flow;
mod coupling_saturation;
mod creep;
mod current_event;
mod current_limit;
mod current_offset;
mod curvature_limit;
mod diffusion_limited_leak;
mod dispersion;
mod effect;
mod electrolytic_drying;
mod even_bending;
mod event;
mod exposure_smoothing;
mod faradaic_leak;
mod fast_branch;
mod followed_tag;
mod fractional_relaxation;
mod friction;
mod joule_heating;
mod leak_coupling;
mod lengthwise_resistance;
mod mechanical_lag;
mod modulus_drift;
mod moisture_bending;
mod noncircular_shape;
mod parameter_wander;
mod partial_relaxation;
mod piezoresistive_electrode;
mod polarity_coupling;
mod polarity_memory;
mod precurvature;
mod quadratic_coupling;
#[cfg(test)]
mod recovery_tests;
mod redox_peak;
mod residual_charge;
mod resistance_drift;
mod resonance;
mod search;
mod second_relaxation;
mod self_discharge;
mod sensing_feedback;
mod series_resistance;
mod slow_branch;
pub mod smooth_laws;
mod softening;
mod source_rise;
#[cfg(test)]
mod tests;
mod threshold_relaxation;
mod tip_formula;
mod tree;
mod unequal_coupling;
mod voltage_dependent_capacitance;
mod warburg;
mod water_exchange;
mod water_redistribution;

pub use about::{About, EffectParameter};
use effect::Equation;
pub use effect::{Applied, Effect};
pub use followed_tag::tag_places;
pub use search::{Limits, Scale, Search};
pub use tree::{Mechanism, Site};

pub use super::extended::TagAt;
use super::extended::{RunContext, System};

use std::sync::LazyLock;

use ieap_domain::diagnosis::follows_a_tag;
use smooth_laws::Shape::{Bell, Exponential, Power, Saturating, Threshold};
use smooth_laws::{Place, Textbook};
use tree::mechanism;

/// A row of the table of effects.
struct Row {
    effect: &'static dyn Effect,
    /// Id of the mechanism it is one of.
    mechanism: &'static str,
    /// The law that its equation is a curve of, what of several has it, and what it follows.
    law: &'static str,
    of: &'static str,
    variable: &'static str,
    /// Curves of textbooks that the equation is over its variable; none where it is of another kind.
    textbooks: &'static [Textbook],
}

const fn row(
    effect: &'static dyn Effect,
    mechanism: &'static str,
    [law, of, variable]: [&'static str; 3],
    textbooks: &'static [Textbook],
) -> Row {
    Row {
        effect,
        mechanism,
        law,
        of,
        variable,
        textbooks,
    }
}

/// Every effect, in the order of the catalogue: mechanism, law, what of several has it, variable, curves of textbooks.
#[rustfmt::skip]
static ROWS: &[Row] = &[
    row(&series_resistance::SeriesResistance, "source-or-contact", ["source", "", "current_a_per_cm2"], &[]),
    row(&slow_branch::SlowBranch, "current-time-scales", ["time-scales", "", "time_constant_s"], &[]),
    row(&fast_branch::FastBranch, "current-time-scales", ["time-scales", "", "time_constant_s"], &[]),
    row(&dispersion::Dispersion, "current-time-scales", ["time-scales", "", "time_constant_s"], &[]),
    row(&warburg::Warburg, "current-time-scales", ["time-scales", "", "time_constant_s"], &[]),
    row(&voltage_dependent_capacitance::VoltageDependentCapacitance, "capacitance-by-voltage", ["capacitance", "", "voltage_v"], &[Power.even()]),
    row(&asymmetric_capacitance::AsymmetricCapacitance, "capacitance-by-voltage", ["capacitance", "", "voltage_v"], &[Power.odd(), Saturating.odd()]),
    row(&faradaic_leak::FaradaicLeak, "leak", ["leak", "", "voltage_v"], &[Threshold.even(), Exponential.even(), Saturating.even()]),
    row(&diffusion_limited_leak::DiffusionLimitedLeak, "leak", ["leak", "", "time_since_edge_s"], &[]),
    row(&self_discharge::SelfDischarge, "leak", ["leak", "slow-branch", "voltage_v"], &[]),
    row(&resistance_drift::ResistanceDrift, "resistance-in-time", ["resistance", "", "time_s"], &[Power.even()]),
    row(&piezoresistive_electrode::PiezoresistiveElectrode, "resistance-by-state", ["resistance", "", "curvature_per_cm"], &[Power.odd(), Power.even()]),
    row(&current_limit::CurrentLimit, "source-or-contact", ["source", "", "current_a_per_cm2"], &[]),
    row(&source_rise::SourceRise, "source-or-contact", ["source", "", "time_since_edge_s"], &[]),
    row(&current_offset::CurrentOffset, "current-reading", ["current-reading", "", "time_s"], &[]),
    row(&residual_charge::ResidualCharge, "current-reading", ["first-charge", "", "time_s"], &[]),
    row(&redox_peak::RedoxPeak, "capacitance-by-voltage", ["capacitance", "", "voltage_v"], &[Bell.odd()]),
    row(&contact_break::ContactBreak, "resistance-in-time", ["resistance", "", "time_s"], &[]),
    row(&constant_phase::ConstantPhase, "current-time-scales", ["time-scales", "", "time_constant_s"], &[]),
    row(&polarity_memory::PolarityMemory, "capacitance-by-voltage", ["capacitance", "", "history"], &[]),
    row(&current_event::CurrentEvent, "current-reading", ["current-reading", "", "time_s"], &[]),
    row(&partial_relaxation::PartialRelaxation, "strain-relaxation", ["relaxation", "", "time_constant_s"], &[]),
    row(&second_relaxation::SecondRelaxation, "strain-relaxation", ["relaxation", "", "time_constant_s"], &[]),
    row(&fractional_relaxation::FractionalRelaxation, "strain-relaxation", ["relaxation", "", "time_constant_s"], &[]),
    row(&modulus_drift::ModulusDrift, "bending-by-itself", ["coupling", "", "time_s"], &[Saturating.even(), Exponential.even()]),
    row(&resonance::Resonance, "bending-late", ["delay", "", "time_constant_s"], &[]),
    row(&mechanical_lag::MechanicalLag, "bending-late", ["delay", "", "time_constant_s"], &[]),
    row(&softening::Softening, "bending-law", ["coupling", "", "curvature_per_cm"], &[Power.even()]),
    row(&friction::Friction, "bending-late", ["play", "", "curvature_per_cm"], &[]),
    row(&creep::Creep, "bending-by-itself", ["added-bending", "", "time_s"], &[Power.even()]),
    row(&precurvature::Precurvature, "bending-by-itself", ["added-bending", "", "time_s"], &[]),
    row(&unequal_coupling::UnequalCoupling, "strain-relaxation", ["coupling", "slow-branch", ""], &[]),
    row(&counter_flow::CounterFlow, "strain-relaxation", ["relaxation", "", "time_constant_s"], &[]),
    row(&quadratic_coupling::QuadraticCoupling, "bending-law", ["coupling", "", "charge_c_per_cm2"], &[Power.odd()]),
    row(&leak_coupling::LeakCoupling, "strain-relaxation", ["coupling", "leak", ""], &[]),
    row(&coupling_saturation::CouplingSaturation, "bending-law", ["coupling", "", "charge_c_per_cm2"], &[Saturating.even()]),
    row(&threshold_relaxation::ThresholdRelaxation, "strain-relaxation", ["relaxation", "", "voltage_v"], &[Threshold.even()]),
    row(&sensing_feedback::SensingFeedback, "bending-law", ["source", "", "curvature_per_cm"], &[]),
    row(&lengthwise_resistance::LengthwiseResistance, "source-or-contact", ["source", "", "current_a_per_cm2"], &[]),
    row(&polarity_coupling::PolarityCoupling, "bending-law", ["coupling", "", "voltage_v"], &[Saturating.odd()]),
    row(&even_bending::EvenBending, "bending-law", ["added-bending", "", "voltage_v"], &[]),
    row(&joule_heating::JouleHeating, "resistance-by-state", ["resistance", "", "heat"], &[]),
    row(&water_redistribution::WaterRedistribution, "resistance-by-state", ["resistance", "", "flow"], &[]),
    row(&water_exchange::WaterExchange, "resistance-in-time", ["resistance", "", "time_s"], &[Saturating.even(), Exponential.even()]),
    row(&moisture_bending::MoistureBending, "bending-by-itself", ["added-bending", "", "time_s"], &[Saturating.even(), Exponential.even()]),
    row(&electrolytic_drying::ElectrolyticDrying, "resistance-in-time", ["resistance", "", "heat"], &[]),
    row(&ambient_temperature::AmbientTemperature, "resistance-in-time", ["resistance", "", "time_s"], &[Saturating.even(), Exponential.even()]),
    row(&parameter_wander::ParameterWander, "resistance-in-time", ["resistance", "", "time_s"], &[]),
    row(&camera_zero::CameraZero, "bending-by-itself", ["added-bending", "", "time_s"], &[]),
    row(&camera_delay::CameraDelay, "bending-late", ["delay", "", "time_constant_s"], &[]),
    row(&clock_rate::ClockRate, "bending-late", ["delay", "", "time_s"], &[]),
    row(&tip_formula::TipFormula, "bending-law", ["coupling", "", "curvature_per_cm"], &[Power.even()]),
    row(&exposure_smoothing::ExposureSmoothing, "bending-late", ["delay", "", "time_constant_s"], &[]),
    row(&noncircular_shape::NoncircularShape, "bending-law", ["coupling", "", "curvature_per_cm"], &[Power.odd(), Power.even()]),
    row(&curvature_limit::CurvatureLimit, "bending-law", ["coupling", "", "curvature_per_cm"], &[Saturating.even()]),
    row(&bending_event::BendingEvent, "bending-by-itself", ["added-bending", "", "time_s"], &[]),
];

/// Every effect that can be simulated and fitted, in the order of the catalogue. What follows a tag from run to run is not
/// among them: which tags there are a campaign says ([`tag_places`]).
pub static ALL: LazyLock<Vec<&'static dyn Effect>> =
    LazyLock::new(|| ROWS.iter().map(|row| row.effect).collect());

fn row_of(effect: &str) -> Option<&'static Row> {
    ROWS.iter().find(|row| row.effect.about().id == effect)
}

/// The mechanism that an effect is one of; none of an unknown id.
pub fn mechanism_of(effect: &str) -> Option<&'static Mechanism> {
    if follows_a_tag(effect) {
        mechanism("from-run-to-run")
    } else {
        mechanism(row_of(effect)?.mechanism)
    }
}

impl<E: Equation> Effect for E {
    fn about(&self) -> &'static About {
        E::ABOUT
    }

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let site = mechanism_of(E::ABOUT.id).map(|own| own.site);
        if site == Some(Site::Bending) && scale.curvature_per_cm == 0.0 {
            return Search::none();
        }
        Equation::search(self, variant, scale)
    }

    fn acts_in(&self, parameters: &[f64], run: usize) -> bool {
        Equation::acts_in(self, parameters, run)
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        Equation::apply(self, variant, parameters, run, system);
    }
}

/// Forms that act elsewhere than the first form of their effect: id, form, where, law and variable.
#[rustfmt::skip]
static ELSEWHERE: &[(&str, &str, Site, [&str; 2])] = &[
    ("constant-phase", "lost", Site::Current, ["leak", "time_since_edge_s"]),
    ("contact-break", "capacitance", Site::Current, ["capacitance", "time_s"]),
    ("contact-break", "coupling", Site::Bending, ["coupling", "time_s"]),
    ("current-limit", "meter", Site::Current, ["current-reading", "current_a_per_cm2"]),
    ("parameter-wander", "capacitances", Site::Current, ["capacitance", "time_s"]),
    ("parameter-wander", "r-ss", Site::Current, ["leak", "time_s"]),
    ("parameter-wander", "coupling", Site::Bending, ["coupling", "time_s"]),
    ("polarity-memory", "resistance", Site::Current, ["resistance", "history"]),
    ("polarity-memory", "relaxation", Site::Bending, ["relaxation", "history"]),
    ("water-redistribution", "relaxation", Site::Bending, ["relaxation", "flow"]),
];

/// The place of an effect of the library in that form: the law that its equation is a curve of.
pub fn place_of_form(effect: &str, variant: usize) -> Option<Place> {
    let row = row_of(effect)?;
    let form = row.effect.about().variants.get(variant);
    let elsewhere = ELSEWHERE
        .iter()
        .find(|own| own.0 == effect && Some(&own.1) == form);
    match elsewhere {
        Some(&(_, _, site, [law, variable])) => Some(Place {
            site,
            law,
            of: "",
            variable,
        }),
        None => place_of(effect),
    }
}

/// The place of an effect of the library in its first form.
pub fn place_of(effect: &str) -> Option<Place> {
    let row = row_of(effect)?;
    Some(Place {
        site: mechanism(row.mechanism)?.site,
        law: row.law,
        of: row.of,
        variable: row.variable,
    })
}

/// Curves of textbooks that an equation of the library is over its variable.
pub fn textbooks_of(effect: &str) -> &'static [Textbook] {
    row_of(effect).map_or(&[], |row| row.textbooks)
}

/// The effect of that id: one of the list, or one that follows a tag.
pub fn effect(id: &str) -> Option<&'static dyn Effect> {
    let listed = row_of(id).map(|row| row.effect);
    let smooth = || smooth_laws::smooth_law(id).map(|law| law as &'static dyn Effect);
    listed.or_else(|| followed_tag::of_id(id)).or_else(smooth)
}

/// What the effect of that id is, in a line.
pub fn summary(id: &str) -> Option<&'static str> {
    effect(id).map(|known| known.about().summary)
}
