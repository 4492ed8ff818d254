//! One measure of bending into all others, thesis (3)-(10): displacement, angle, strain, moment, energy.

use thiserror::Error;

use super::CrossSection;
use super::arc::{curvature_from_displacement, displacement_from_curvature};
use super::strain::{
    bending_strain, curvature_from_bending_strain, curvature_from_strain_difference, strain_difference,
};

/// Turn of the tip at which the displacement of a tip is largest, rad: `u sin u = 1 - cos u`. A tip that goes on
/// turning comes back, and one displacement belongs to two curvatures.
pub const FURTHEST_TURN_RAD: f64 = 2.331_122_370_414_422_4;

/// What bending may be stated as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bending {
    /// Curvature, 1/cm.
    Curvature,
    /// Radius of the circle, mm.
    Radius,
    /// Sideways displacement at a point straight ahead of the clamp, as a fixed laser sees it, mm (3).
    Displacement,
    /// Sideways displacement of the tip itself, mm.
    TipDisplacement,
    /// Angle between the tip and the clamp, rad (11).
    TangentAngle,
    /// Strain of the outer layers, symmetrical bending, a share (5).
    BendingStrain,
    /// Difference of the strains of the two electrodes, a share (4).
    StrainDifference,
    /// Bending moment, mN mm (7).
    Moment,
    /// Strain energy, uJ (10).
    Energy,
}

impl Bending {
    /// All, in the order in which they are listed.
    pub const ALL: [Bending; 9] = [
        Bending::Curvature,
        Bending::Radius,
        Bending::Displacement,
        Bending::TipDisplacement,
        Bending::TangentAngle,
        Bending::StrainDifference,
        Bending::BendingStrain,
        Bending::Moment,
        Bending::Energy,
    ];
}

/// A strip as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownStrip {
    /// Free length L, mm.
    pub length_mm: Option<f64>,
    /// Distance straight ahead of the clamp at which a displacement is seen, mm; none: the free length.
    pub seen_at_mm: Option<f64>,
    /// Width b, mm.
    pub width_mm: Option<f64>,
    /// Thickness h, mm.
    pub thickness_mm: Option<f64>,
    /// Effective Young's modulus E, MPa.
    pub modulus_mpa: Option<f64>,
    /// Distance of the neutral layer from the centroid, mm.
    pub neutral_layer_shift_mm: f64,
    /// Mean elongation of the strip, a share: what the exact strain difference has beside the small one.
    pub mean_elongation: f64,
}

/// Why a measure cannot be converted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum ConversionError {
    /// A dimension is not known.
    #[error("needs {0}")]
    Needs(&'static str),
    /// The circle turns back before it reaches the place.
    #[error(
        "the circle turns back before it reaches the place of the displacement (curvature times distance above 1)"
    )]
    TurnsBack,
    /// The displacement is larger than such a strip can have.
    #[error(
        "no strip of this length bent to a circle has its tip so far aside: at most 0.725 times the length"
    )]
    TooFar,
    /// The displacement is larger than its distance.
    #[error(
        "the displacement is larger than its distance from the clamp: the circle has turned by more than a quarter, and the formula's curvature may belong to its other branch"
    )]
    PastQuarter,
    /// A negative or vanishing number stands where that has no meaning.
    #[error("needs {0}")]
    OutOfRange(&'static str),
}

impl KnownStrip {
    fn length(&self) -> Result<f64, ConversionError> {
        self.length_mm.ok_or(ConversionError::Needs("the length"))
    }

    fn seen_at(&self) -> Result<f64, ConversionError> {
        self.seen_at_mm.map_or_else(|| self.length(), Ok)
    }

    fn thickness(&self) -> Result<f64, ConversionError> {
        self.thickness_mm.ok_or(ConversionError::Needs("the thickness"))
    }

    fn section(&self) -> Result<(CrossSection, f64), ConversionError> {
        let section = CrossSection {
            width_mm: self.width_mm.ok_or(ConversionError::Needs("the width"))?,
            thickness_mm: self.thickness()?,
            neutral_layer_shift_mm: self.neutral_layer_shift_mm,
        };
        let modulus = self.modulus_mpa.ok_or(ConversionError::Needs("the modulus"))?;
        Ok((section, modulus))
    }

    /// The bending as `wanted`, from the curvature.
    ///
    /// # Errors
    /// A dimension is not known, or the circle turns back.
    pub fn from_curvature(&self, wanted: Bending, curvature_per_cm: f64) -> Result<f64, ConversionError> {
        Ok(match wanted {
            Bending::Curvature => curvature_per_cm,
            Bending::Radius => 10.0 / curvature_per_cm,
            Bending::Displacement => displacement_from_curvature(curvature_per_cm, self.seen_at()?)
                .ok_or(ConversionError::TurnsBack)?,
            Bending::TipDisplacement => tip_displacement_mm(curvature_per_cm, self.length()?),
            Bending::TangentAngle => curvature_per_cm / 10.0 * self.length()?,
            Bending::BendingStrain => bending_strain(self.thickness()?, curvature_per_cm),
            Bending::StrainDifference => {
                strain_difference(self.thickness()?, curvature_per_cm, self.mean_elongation)
            }
            Bending::Moment => {
                let (section, modulus) = self.section()?;
                section.bending_moment_mn_mm(modulus, curvature_per_cm)
            }
            Bending::Energy => {
                let (section, modulus) = self.section()?;
                section.strain_energy_uj(modulus, self.length()?, curvature_per_cm)
            }
        })
    }

    /// The curvature, 1/cm, from the bending as `given`; of an energy the positive one.
    ///
    /// # Errors
    /// A dimension is not known, or no circle has such a bending.
    pub fn to_curvature(&self, given: Bending, value: f64) -> Result<f64, ConversionError> {
        Ok(match given {
            Bending::Curvature => value,
            Bending::Radius if value == 0.0 => {
                return Err(ConversionError::OutOfRange("a radius that is not zero"));
            }
            Bending::Radius => 10.0 / value,
            Bending::Displacement => {
                let seen_at = self.seen_at()?;
                if value.abs() > seen_at {
                    return Err(ConversionError::PastQuarter);
                }
                curvature_from_displacement(value, seen_at)
            }
            Bending::TipDisplacement => {
                curvature_from_tip(value, self.length()?).ok_or(ConversionError::TooFar)?
            }
            Bending::TangentAngle => 10.0 * value / self.length()?,
            Bending::BendingStrain => curvature_from_bending_strain(value, self.thickness()?),
            Bending::StrainDifference => {
                curvature_from_strain_difference(value, self.thickness()?, self.mean_elongation)
            }
            Bending::Moment => {
                let (section, modulus) = self.section()?;
                section.curvature_from_moment(modulus, value)
            }
            Bending::Energy if value < 0.0 => {
                return Err(ConversionError::OutOfRange("an energy that is not negative"));
            }
            Bending::Energy => {
                let (section, modulus) = self.section()?;
                let of_unit_curvature = section.strain_energy_uj(modulus, self.length()?, 1.0);
                (value / of_unit_curvature).sqrt()
            }
        })
    }
}

/// Sideways displacement of the tip of a strip of that arc length bent to a circle, mm: `(1 - cos u)/kappa` with
/// `u = kappa L`, written `L sin^2(u/2)/(u/2)`.
pub fn tip_displacement_mm(curvature_per_cm: f64, length_mm: f64) -> f64 {
    let half = 0.5 * curvature_per_cm / 10.0 * length_mm;
    if half.abs() < 1e-150 {
        return length_mm * half;
    }
    length_mm * half.sin().powi(2) / half
}

/// Curvature, 1/cm, of the strip whose tip lies that far aside: the inverse up to the turn at which the tip is
/// farthest; none beyond. Newton's method from the straight strip, held between bounds.
pub fn curvature_from_tip(tip_displacement_mm: f64, length_mm: f64) -> Option<f64> {
    let share = (tip_displacement_mm / length_mm).abs();
    let far = |turn: f64| 2.0 * (0.5 * turn).sin().powi(2) / turn;
    if !share.is_finite() || share > far(FURTHEST_TURN_RAD) {
        return None;
    }
    let (mut low, mut high) = (0.0, FURTHEST_TURN_RAD);
    let mut turn = (2.0 * share).min(high);
    for _ in 0..80 {
        if turn == 0.0 {
            break;
        }
        let miss = far(turn) - share;
        if miss > 0.0 {
            high = turn
        } else {
            low = turn
        }
        let slope = (turn * turn.sin() - 1.0 + turn.cos()) / (turn * turn);
        let next = turn - miss / slope;
        let next = if next > low && next < high {
            next
        } else {
            0.5 * (low + high)
        };
        if (next - turn).abs() <= 1e-16 * turn {
            break;
        }
        turn = next;
    }
    Some((10.0 * turn / length_mm).copysign(tip_displacement_mm * length_mm))
}

#[cfg(test)]
mod tests {
    use super::super::Shape;
    use super::*;

    const STRIP: KnownStrip = KnownStrip {
        length_mm: Some(5.0),
        seen_at_mm: Some(4.0),
        width_mm: Some(2.0),
        thickness_mm: Some(0.22),
        modulus_mpa: Some(460.0),
        neutral_layer_shift_mm: 0.02,
        mean_elongation: 0.01,
    };

    #[test]
    fn every_measure_comes_back_to_the_curvature() {
        for curvature in [0.001, 0.3, 1.2, 2.4] {
            for measure in Bending::ALL {
                let value = STRIP.from_curvature(measure, curvature).unwrap();
                let back = STRIP.to_curvature(measure, value).unwrap();
                assert!(
                    (back / curvature - 1.0).abs() < 1e-7,
                    "{measure:?}: {value} {back}"
                );
                if measure != Bending::Energy {
                    let mirrored = STRIP.to_curvature(measure, -value).unwrap();
                    assert!((mirrored / curvature + 1.0).abs() < 1e-7, "{measure:?}");
                }
            }
        }
    }

    #[test]
    fn tip_is_that_of_the_shape_and_is_farthest_at_its_turn() {
        for curvature in [-3.0, 1e-9, 0.8, 4.0] {
            let shape = Shape::from_curvature(&[curvature], 0.5).tip_cm().1 * 10.0;
            assert!((tip_displacement_mm(curvature, 5.0) - shape).abs() < 1e-12);
        }
        let at = |turn: f64| tip_displacement_mm(turn * 2.0, 5.0);
        let far = at(FURTHEST_TURN_RAD);
        assert!(far > at(FURTHEST_TURN_RAD - 1e-3) && far > at(FURTHEST_TURN_RAD + 1e-3));
        assert!((far / 5.0 - 0.7246).abs() < 1e-4);
        assert_eq!(curvature_from_tip(3.7, 5.0), None);
        assert_eq!(curvature_from_tip(0.0, 5.0), Some(0.0));
    }

    #[test]
    fn what_is_missing_or_impossible_is_said() {
        let bare = KnownStrip {
            modulus_mpa: None,
            ..STRIP
        };
        let moment = bare.from_curvature(Bending::Moment, 1.0).unwrap_err();
        assert_eq!(moment.to_string(), "needs the modulus");
        let back = STRIP.from_curvature(Bending::Displacement, 2.6);
        assert_eq!(back, Err(ConversionError::TurnsBack));
        let past = STRIP.to_curvature(Bending::Displacement, 4.1);
        assert_eq!(past, Err(ConversionError::PastQuarter));
        assert!(STRIP.to_curvature(Bending::Energy, -1.0).is_err());
        assert!(STRIP.to_curvature(Bending::Radius, 0.0).is_err());
    }
}
