//! Curvature from the displacement of one point and back, for a strip bent to a circle: thesis (3).

/// Curvature of the circle that leaves the clamp straight ahead and passes `displacement_mm` beside the point
/// `distance_mm` ahead of the clamp, 1/cm: `kappa = 2 d / (L^2 + d^2)` (3).
///
/// L is the distance of the measured point along the undeflected strip, not the length of the arc. The distance
/// must be positive. A displacement d and its mirror image L^2/d lie on the same circle.
pub fn curvature_from_displacement(displacement_mm: f64, distance_mm: f64) -> f64 {
    10.0 * 2.0 * displacement_mm / (distance_mm * distance_mm + displacement_mm * displacement_mm)
}

/// Displacement at `distance_mm` ahead of the clamp of a strip bent to `curvature_per_cm`, mm: the inverse of (3)
/// on the first quarter of the circle, `d = kappa L^2 / (1 + sqrt(1 - kappa^2 L^2))`, without cancellation.
///
/// None where `|kappa| L > 1`: the circle turns back before it gets there, and nothing is to be seen.
pub fn displacement_from_curvature(curvature_per_cm: f64, distance_mm: f64) -> Option<f64> {
    let turn = curvature_per_cm / 10.0 * distance_mm;
    let rest = (1.0 - turn) * (1.0 + turn);
    (rest >= 0.0).then(|| turn * distance_mm / (1.0 + rest.sqrt()))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use ieap_numerics::ode::integrate;

    /// Where a strip of constant curvature passes the plane `distance_mm` ahead: x' = cos phi and y' = sin phi
    /// with the plane's distance as the variable, dy/dx = tan phi and d(sin phi)/dx = kappa.
    fn displacement_by_integration(curvature_per_cm: f64, distance_mm: f64) -> f64 {
        let mut state = [0.0, 0.0];
        let rate = |_: f64, y: &[f64], out: &mut [f64]| {
            out[0] = y[1] / (1.0 - y[1] * y[1]).sqrt();
            out[1] = curvature_per_cm / 10.0;
        };
        integrate(rate, 0.0, distance_mm, &mut state, 1e-12, 1e-14);
        state[0]
    }

    #[test]
    fn formula_is_the_path_of_a_strip_with_constant_curvature() {
        for curvature in [-1.9, -0.4, 1e-6, 0.3, 1.0, 1.95] {
            let found = displacement_from_curvature(curvature, 5.0).unwrap();
            let integrated = displacement_by_integration(curvature, 5.0);
            assert!(
                (found - integrated).abs() < 1e-9 * found.abs(),
                "{found} {integrated}"
            );
        }
    }

    #[test]
    fn a_quarter_circle_is_the_last_that_reaches_the_distance() {
        assert!((displacement_from_curvature(2.0, 5.0).unwrap() - 5.0).abs() < 1e-12);
        assert_eq!(displacement_from_curvature(2.0001, 5.0), None);
        assert!((curvature_from_displacement(5.0, 5.0) - 2.0).abs() < 1e-15);
    }

    proptest! {
        #[test]
        fn displacement_comes_back(share in -1.0..1.0_f64, distance_mm in 0.1..100.0_f64) {
            let displacement = share * distance_mm;
            let curvature = curvature_from_displacement(displacement, distance_mm);
            let back = displacement_from_curvature(curvature, distance_mm);
            // Near the quarter circle the curvature has its maximum: half of the digits of d are lost there.
            let allowed = 1e-15 * distance_mm / (1.0 - share * share).max(1e-8);
            prop_assert!(back.is_none_or(|b| (b - displacement).abs() < 10.0 * allowed));
            prop_assert!(back.is_some() || share.abs() > 1.0 - 1e-7);
        }
    }
}
