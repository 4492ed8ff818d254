//! Candidate effects: what the lumped model may be missing. One file each, one list.
//!
//! An effect says where it acts in a [`System`](crate::extended::System), within which limits its parameters are sought, and at which
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
pub use effect::{Applied, Effect};
pub use followed_tag::tag_places;
pub use search::{Limits, Scale, Search};
pub use tree::{MECHANISMS, Mechanism, Site, mechanism, mechanism_of};

pub use super::extended::TagAt;

/// Every effect that can be simulated and fitted, in the order of the catalogue. What follows a tag from run to run is not
/// among them: which tags there are a campaign says ([`tag_places`]).
pub static ALL: &[&dyn Effect] = &[
    &series_resistance::SeriesResistance,
    &slow_branch::SlowBranch,
    &fast_branch::FastBranch,
    &dispersion::Dispersion,
    &warburg::Warburg,
    &voltage_dependent_capacitance::VoltageDependentCapacitance,
    &asymmetric_capacitance::AsymmetricCapacitance,
    &faradaic_leak::FaradaicLeak,
    &diffusion_limited_leak::DiffusionLimitedLeak,
    &self_discharge::SelfDischarge,
    &resistance_drift::ResistanceDrift,
    &piezoresistive_electrode::PiezoresistiveElectrode,
    &current_limit::CurrentLimit,
    &source_rise::SourceRise,
    &current_offset::CurrentOffset,
    &residual_charge::ResidualCharge,
    &redox_peak::RedoxPeak,
    &contact_break::ContactBreak,
    &constant_phase::ConstantPhase,
    &polarity_memory::PolarityMemory,
    &current_event::CurrentEvent,
    &partial_relaxation::PartialRelaxation,
    &second_relaxation::SecondRelaxation,
    &fractional_relaxation::FractionalRelaxation,
    &modulus_drift::ModulusDrift,
    &resonance::Resonance,
    &mechanical_lag::MechanicalLag,
    &softening::Softening,
    &friction::Friction,
    &creep::Creep,
    &precurvature::Precurvature,
    &unequal_coupling::UnequalCoupling,
    &counter_flow::CounterFlow,
    &quadratic_coupling::QuadraticCoupling,
    &leak_coupling::LeakCoupling,
    &coupling_saturation::CouplingSaturation,
    &threshold_relaxation::ThresholdRelaxation,
    &sensing_feedback::SensingFeedback,
    &lengthwise_resistance::LengthwiseResistance,
    &polarity_coupling::PolarityCoupling,
    &even_bending::EvenBending,
    &joule_heating::JouleHeating,
    &water_redistribution::WaterRedistribution,
    &water_exchange::WaterExchange,
    &moisture_bending::MoistureBending,
    &electrolytic_drying::ElectrolyticDrying,
    &ambient_temperature::AmbientTemperature,
    &parameter_wander::ParameterWander,
    &camera_zero::CameraZero,
    &camera_delay::CameraDelay,
    &clock_rate::ClockRate,
    &tip_formula::TipFormula,
    &exposure_smoothing::ExposureSmoothing,
    &noncircular_shape::NoncircularShape,
    &curvature_limit::CurvatureLimit,
    &bending_event::BendingEvent,
];

/// The effect of that id: one of the list, or one that follows a tag.
pub fn effect(id: &str) -> Option<&'static dyn Effect> {
    let listed = ALL.iter().copied().find(|effect| effect.about().id == id);
    let smooth = || smooth_laws::smooth_law(id).map(|law| law as &'static dyn Effect);
    listed.or_else(|| followed_tag::of_id(id)).or_else(smooth)
}

/// What the effect of that id is, in a line.
pub fn summary(id: &str) -> Option<&'static str> {
    effect(id).map(|known| known.about().summary)
}
