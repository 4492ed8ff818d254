//! What was identified of a strip, before anything is said of it.

use super::contact_break::ContactBreak;
use super::described::{Described, model_of};
use super::input::DistributedInput;
use super::mechanical::Mechanical;
use super::readings::Readings;
use super::squares::Fitted;

/// R_e where only ratios to it can be found, Ohm per square: any would do.
pub(super) const RELATIVE_OHM_PER_SQ: f64 = 1.0;

/// Parameters that were found, with all that is said of them.
#[derive(Clone)]
pub(super) struct Identified<'a> {
    /// The run; where only ratios can be found, with R_e set to [`RELATIVE_OHM_PER_SQ`].
    pub(super) input: DistributedInput<'a>,
    pub(super) readings: Readings,
    /// Whether nothing sets the scale of resistances: neither a current nor R_e is given.
    pub(super) is_relative: bool,
    pub(super) electrical: Fitted,
    pub(super) mechanical: Option<Mechanical>,
    /// A break of the electrodes at a place.
    pub(super) contact_break: Option<ContactBreak>,
    pub(super) method: &'static str,
}

impl Identified<'_> {
    /// The strip as it was found.
    pub(super) fn described(&self) -> Described {
        let mechanical = self.mechanical.as_ref();
        let rate_per_s = mechanical.map_or(0.0, |m| m.rate_below_per_s.map_or(m.fitted.at[1].exp(), |_| 0.0));
        Described {
            model: model_of(&self.input.strip, &self.electrical.at, rate_per_s),
            mu_per_c: mechanical.map_or(0.0, |m| m.mu_per_c),
            contact_break: self.contact_break.as_ref().map(ContactBreak::of_model),
        }
    }
}
