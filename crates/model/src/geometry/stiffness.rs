//! Second moment of area, bending moment and strain energy of a strip: thesis (7)-(10).

/// Cross-section of a strip with its neutral layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossSection {
    /// Width b, mm.
    pub width_mm: f64,
    /// Thickness h of the whole laminate, mm.
    pub thickness_mm: f64,
    /// Distance Delta of the neutral layer from the centroid, mm; zero where bending is symmetrical.
    pub neutral_layer_shift_mm: f64,
}

impl CrossSection {
    /// A section that bends symmetrically about its centroid.
    pub fn symmetrical(width_mm: f64, thickness_mm: f64) -> CrossSection {
        CrossSection {
            width_mm,
            thickness_mm,
            neutral_layer_shift_mm: 0.0,
        }
    }

    /// Second moment of area about the neutral layer, mm^4: `I = b h^3/12 + b h Delta^2` (8). With the neutral
    /// layer at the surface, Delta = h/2, it is four times that of symmetrical bending (9).
    pub fn second_moment_mm4(&self) -> f64 {
        let area_mm2 = self.width_mm * self.thickness_mm;
        area_mm2 * (self.thickness_mm.powi(2) / 12.0 + self.neutral_layer_shift_mm.powi(2))
    }

    /// Electrically induced bending moment `M = E I kappa` (7), mN mm, of a strip whose effective Young's modulus
    /// is `modulus_mpa`.
    pub fn bending_moment_mn_mm(&self, modulus_mpa: f64, curvature_per_cm: f64) -> f64 {
        1000.0 * modulus_mpa * self.second_moment_mm4() * (curvature_per_cm / 10.0)
    }

    /// Curvature that a bending moment gives, 1/cm: the inverse of (7).
    pub fn curvature_from_moment(&self, modulus_mpa: f64, moment_mn_mm: f64) -> f64 {
        10.0 * moment_mn_mm / (1000.0 * modulus_mpa * self.second_moment_mm4())
    }

    /// Work that bends the strip to a uniform curvature, `U = E I L kappa^2 / 2` (10), microjoule (mN mm).
    pub fn strain_energy_uj(&self, modulus_mpa: f64, length_mm: f64, curvature_per_cm: f64) -> f64 {
        0.5 * self.bending_moment_mn_mm(modulus_mpa, curvature_per_cm) * length_mm * (curvature_per_cm / 10.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECTION: CrossSection = CrossSection {
        width_mm: 2.0,
        thickness_mm: 0.22,
        neutral_layer_shift_mm: 0.05,
    };

    /// Sum over thin layers of `weight(distance from the neutral layer)` times the layer's area, mm2.
    fn over_layers(section: &CrossSection, weight: impl Fn(f64) -> f64) -> f64 {
        let layers = 20_000;
        let layer_mm = section.thickness_mm / layers as f64;
        let distance = |k: usize| {
            (k as f64 + 0.5) * layer_mm - section.thickness_mm / 2.0 + section.neutral_layer_shift_mm
        };
        (0..layers)
            .map(|k| weight(distance(k)) * section.width_mm * layer_mm)
            .sum()
    }

    #[test]
    fn second_moment_is_the_sum_over_layers() {
        let summed = over_layers(&SECTION, |z| z * z);
        assert!((SECTION.second_moment_mm4() / summed - 1.0).abs() < 1e-8);
    }

    #[test]
    fn a_neutral_layer_at_the_surface_makes_the_strip_four_times_as_stiff() {
        let symmetrical = CrossSection::symmetrical(2.0, 0.22);
        let shifted = CrossSection {
            neutral_layer_shift_mm: 0.11,
            ..symmetrical
        };
        let ratio = shifted.second_moment_mm4() / symmetrical.second_moment_mm4();
        assert!((ratio - 4.0).abs() < 1e-14, "{ratio}");
    }

    #[test]
    fn moment_and_energy_are_those_of_the_stressed_layers() {
        let (modulus_mpa, length_mm, curvature_per_cm) = (70.0, 5.0, 0.8);
        let per_mm = curvature_per_cm / 10.0;
        // Stress E z kappa (MPa = N/mm2) times lever z; energy density stress * strain / 2.
        let moment_n_mm = over_layers(&SECTION, |z| modulus_mpa * z * per_mm * z);
        let energy_mj = length_mm * over_layers(&SECTION, |z| 0.5 * modulus_mpa * (z * per_mm).powi(2));
        let moment = SECTION.bending_moment_mn_mm(modulus_mpa, curvature_per_cm);
        let energy = SECTION.strain_energy_uj(modulus_mpa, length_mm, curvature_per_cm);
        assert!((moment / (1e3 * moment_n_mm) - 1.0).abs() < 1e-8);
        assert!((energy / (1e3 * energy_mj) - 1.0).abs() < 1e-8);
        let back = SECTION.curvature_from_moment(modulus_mpa, moment);
        assert!((back / curvature_per_cm - 1.0).abs() < 1e-15);
    }
}
