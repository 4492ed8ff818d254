//! Charge-to-curvature coupling per total, areal and line charge: three quantities with three units.
//!
//! Correction to the thesis: it prints alpha in 1/(C cm), which multiplies the charge of the whole sample, beside
//! capacitances per cm2, and calls the distributed coupling (26) mu where the lumped one (16) is alpha.

/// Lengths of a strip that turn one charge into another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActiveArea {
    /// Free length L, cm.
    pub length_cm: f64,
    /// Width b, cm.
    pub width_cm: f64,
}

impl ActiveArea {
    /// Area L b, cm2.
    pub fn area_cm2(&self) -> f64 {
        self.length_cm * self.width_cm
    }
}

/// Curvature per total charge of the sample, 1/(C cm): alpha of (16) as the thesis prints it. It belongs to one
/// sample: half of the strip with half of the charge bends as much.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct CurvaturePerTotalCharge(pub f64);

/// Curvature per areal charge, cm/C. It belongs to the laminate, whatever the strip's length and width.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct CurvaturePerArealCharge(pub f64);

/// Curvature per charge of unit length, 1/C: mu of (26). It belongs to a strip of one width.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct CurvaturePerLineCharge(pub f64);

impl CurvaturePerTotalCharge {
    /// The laminate's coupling: `kappa = alpha (A q_areal)`.
    pub fn areal(self, of: &ActiveArea) -> CurvaturePerArealCharge {
        CurvaturePerArealCharge(self.0 * of.area_cm2())
    }

    /// The strip's coupling per line charge where the charge is uniform: `kappa = alpha (L q_line)`.
    pub fn line(self, of: &ActiveArea) -> CurvaturePerLineCharge {
        CurvaturePerLineCharge(self.0 * of.length_cm)
    }
}

impl CurvaturePerArealCharge {
    /// Coupling of one sample: `q_areal = Q / A`.
    pub fn total(self, of: &ActiveArea) -> CurvaturePerTotalCharge {
        CurvaturePerTotalCharge(self.0 / of.area_cm2())
    }

    /// Coupling of a strip of that width: `q_areal = q_line / b`.
    pub fn line(self, of: &ActiveArea) -> CurvaturePerLineCharge {
        CurvaturePerLineCharge(self.0 / of.width_cm)
    }
}

impl CurvaturePerLineCharge {
    /// The laminate's coupling: `q_line = b q_areal`.
    pub fn areal(self, of: &ActiveArea) -> CurvaturePerArealCharge {
        CurvaturePerArealCharge(self.0 * of.width_cm)
    }

    /// Coupling of one sample where the charge is uniform: `q_line = Q / L`.
    pub fn total(self, of: &ActiveArea) -> CurvaturePerTotalCharge {
        CurvaturePerTotalCharge(self.0 / of.length_cm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRIP: ActiveArea = ActiveArea {
        length_cm: 2.8,
        width_cm: 0.5,
    };

    #[test]
    fn the_same_charge_gives_the_same_curvature_in_every_measure() {
        let alpha = CurvaturePerTotalCharge(2.1);
        let total_c = 0.18;
        let curvature = alpha.0 * total_c;
        let areal = alpha.areal(&STRIP).0 * (total_c / STRIP.area_cm2());
        let line = alpha.line(&STRIP).0 * (total_c / STRIP.length_cm);
        assert!((areal / curvature - 1.0).abs() < 1e-15);
        assert!((line / curvature - 1.0).abs() < 1e-15);
    }

    #[test]
    fn every_way_round_comes_back() {
        let alpha = CurvaturePerTotalCharge(29.5);
        let round = alpha.areal(&STRIP).line(&STRIP).total(&STRIP);
        let other = alpha.line(&STRIP).areal(&STRIP).total(&STRIP);
        assert!((round.0 / alpha.0 - 1.0).abs() < 1e-15);
        assert!((other.0 / alpha.0 - 1.0).abs() < 1e-15);
    }
}
