//! Size of a strip, with the errors of its dimensions.

use crate::coupling::ActiveArea;

/// A measured length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dimension {
    /// Length, mm; positive.
    pub value_mm: f64,
    /// Its standard error, mm; zero where it is taken as exact.
    pub standard_error_mm: f64,
}

impl Dimension {
    /// A length without an error.
    pub const fn exact(value_mm: f64) -> Dimension {
        Dimension {
            value_mm,
            standard_error_mm: 0.0,
        }
    }

    pub(super) fn relative(&self) -> f64 {
        self.standard_error_mm / self.value_mm
    }
}

/// Size of a strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripSize {
    /// Free length.
    pub length: Dimension,
    /// Width.
    pub width: Dimension,
    /// Thickness of the laminate, where it is known.
    pub thickness: Option<Dimension>,
}

/// A strip of 1 cm2, where only what belongs to the laminate counts.
pub(crate) const UNIT_SIZE: StripSize = StripSize {
    length: Dimension::exact(10.0),
    width: Dimension::exact(10.0),
    thickness: None,
};

impl StripSize {
    /// Length and width in cm.
    pub fn active_area(&self) -> ActiveArea {
        ActiveArea {
            length_cm: self.length.value_mm / 10.0,
            width_cm: self.width.value_mm / 10.0,
        }
    }

    /// Area, cm2.
    pub fn area_cm2(&self) -> f64 {
        self.active_area().area_cm2()
    }

    /// Relative standard error of the area.
    pub fn relative_area_error(&self) -> f64 {
        self.length.relative().hypot(self.width.relative())
    }
}
