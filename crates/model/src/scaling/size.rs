//! Size of a strip, with the errors of its dimensions.

use crate::coupling::ActiveArea;
use ieap_domain::typed_value::Measured;

/// Size of a strip; its lengths are positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripSize {
    /// Free length, mm.
    pub length_mm: Measured,
    /// Width, mm.
    pub width_mm: Measured,
    /// Thickness of the laminate, mm, where it is known.
    pub thickness_mm: Option<Measured>,
}

/// A strip of 1 cm2, where only what belongs to the laminate counts.
pub(crate) const UNIT_SIZE: StripSize = StripSize {
    length_mm: Measured::exact(10.0),
    width_mm: Measured::exact(10.0),
    thickness_mm: None,
};

impl StripSize {
    /// Length and width in cm.
    pub fn active_area(&self) -> ActiveArea {
        ActiveArea {
            length_cm: self.length_mm.value / 10.0,
            width_cm: self.width_mm.value / 10.0,
        }
    }

    /// Area, cm2.
    pub fn area_cm2(&self) -> f64 {
        self.active_area().area_cm2()
    }

    /// Relative standard error of the area.
    pub fn relative_area_error(&self) -> f64 {
        (self.length_mm.relative_error()).hypot(self.width_mm.relative_error())
    }
}
