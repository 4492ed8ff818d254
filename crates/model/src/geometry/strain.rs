//! Strains of a bent strip: difference between the electrodes (4), bending strain of the outer layers (5, 6).

/// Exact difference of strain between the electrodes (4): `eps_d = h kappa (1 + e)` with the mean elongation
/// `e = (dL1 + dL2) / (2 L)` of the strip, dimensionless. With `e = 0` it is the usual approximation
/// `2 h d / (L^2 + d^2)`, which is wrong by the share e and by nothing else.
pub fn strain_difference(thickness_mm: f64, curvature_per_cm: f64, mean_elongation: f64) -> f64 {
    thickness_mm * curvature_per_cm / 10.0 * (1.0 + mean_elongation)
}

/// Curvature that belongs to a difference of strain, 1/cm: the inverse of (4).
pub fn curvature_from_strain_difference(
    strain_difference: f64,
    thickness_mm: f64,
    mean_elongation: f64,
) -> f64 {
    10.0 * strain_difference / (thickness_mm * (1.0 + mean_elongation))
}

/// Bending strain of the outer layers where bending is symmetrical about the centroid, dimensionless:
/// `eps = h kappa / 2` (5), half of the strain difference (6).
///
/// Correction: (5) is printed `(h/2) R`, which has the unit of an area; it is `(h/2) / R`.
pub fn bending_strain(thickness_mm: f64, curvature_per_cm: f64) -> f64 {
    thickness_mm * curvature_per_cm / 20.0
}

/// Curvature that belongs to a symmetrical bending strain, 1/cm: the inverse of (5).
pub fn curvature_from_bending_strain(strain: f64, thickness_mm: f64) -> f64 {
    20.0 * strain / thickness_mm
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Length of the layer at `offset_mm` from the middle of a strip bent to a circle, by summing short chords.
    fn layer_length_mm(radius_mm: f64, offset_mm: f64, angle: f64) -> f64 {
        let links = 4000;
        let point = |k: usize| {
            let turn = angle * k as f64 / links as f64;
            (
                (radius_mm + offset_mm) * turn.sin(),
                (radius_mm + offset_mm) * turn.cos(),
            )
        };
        (0..links)
            .map(|k| {
                let ((x0, y0), (x1, y1)) = (point(k), point(k + 1));
                (x1 - x0).hypot(y1 - y0)
            })
            .sum()
    }

    #[test]
    fn difference_is_that_of_the_lengths_of_the_outer_layers() {
        let (length, thickness, curvature_per_cm) = (20.0, 0.22, 0.7);
        for elongation in [0.0, 0.03, -0.01] {
            let radius = 10.0 / curvature_per_cm;
            let angle = length * (1.0 + elongation) / radius;
            let outer = layer_length_mm(radius, thickness / 2.0, angle) - length;
            let inner = layer_length_mm(radius, -thickness / 2.0, angle) - length;
            assert!(((outer + inner) / (2.0 * length) - elongation).abs() < 1e-6);
            let measured = (outer - inner) / length;
            let formula = strain_difference(thickness, curvature_per_cm, elongation);
            assert!((measured / formula - 1.0).abs() < 1e-6, "{measured} {formula}");
            let small = strain_difference(thickness, curvature_per_cm, 0.0);
            assert!((formula / small - 1.0 - elongation).abs() < 1e-12);
            let back = curvature_from_strain_difference(formula, thickness, elongation);
            assert!((back / curvature_per_cm - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn symmetrical_strain_is_half_the_difference_and_falls_with_the_radius() {
        let strain = bending_strain(0.22, 0.7);
        assert!((strain / (0.5 * strain_difference(0.22, 0.7, 0.0)) - 1.0).abs() < 1e-15);
        assert!((curvature_from_bending_strain(strain, 0.22) / 0.7 - 1.0).abs() < 1e-15);
        // The outer layer of a strip of unchanged length at half the thickness from the middle.
        let (radius, length) = (10.0 / 0.7, 20.0);
        let outer = layer_length_mm(radius, 0.11, length / radius) / length - 1.0;
        assert!((outer / strain - 1.0).abs() < 1e-4);
        assert!(bending_strain(0.22, 0.35) < strain);
    }
}
