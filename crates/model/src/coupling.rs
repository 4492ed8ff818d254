//! Charge-to-curvature coupling per total, areal and line charge: three quantities with three units.
//!
//! Correction to the thesis: it prints alpha in 1/(C cm), which multiplies the charge of the whole sample, beside
//! capacitances per cm2, and calls the distributed coupling (26) mu where the lumped one (16) is alpha.

use super::geometry::CrossSection;

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
    /// Bending moment per charge, mu of (15), mN mm per C: what blocks the strip's motion, independent of how stiff
    /// it is.
    pub fn moment_per_charge_mn_mm_per_c(self, modulus_mpa: f64, section: &CrossSection) -> f64 {
        section.bending_moment_mn_mm(modulus_mpa, self.0)
    }

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
    fn a_softer_strip_bends_further_under_the_same_moment() {
        let section = CrossSection::symmetrical(5.0, 0.22);
        let dry = CurvaturePerTotalCharge(2.1);
        let moment = dry.moment_per_charge_mn_mm_per_c(70.0, &section);
        let humid = CurvaturePerTotalCharge(section.curvature_from_moment(55.0, moment));
        assert!((humid.0 / dry.0 - 70.0 / 55.0).abs() < 1e-14);
        // E I kappa per coulomb by hand: 70 N/mm2, 5 * 0.22^3 / 12 mm4, 0.21 per mm.
        assert!((moment - 1e3 * 70.0 * (5.0 * 0.010_648 / 12.0) * 0.21).abs() < 1e-10);
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
