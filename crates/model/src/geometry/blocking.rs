//! The moment of a strip whose tip is held, from the force that holds it.
//!
//! A strip that is clamped at one end and would bend evenly by `kappa = M / (E I)` moves the place at distance `a` from
//! the clamp by `M a^2 / (2 E I)`; a force `F` there moves it back by `F a^3 / (3 E I)`. Held where it was:
//! `M = 2 F a / 3`, whatever the stiffness. It takes a moment that is even along the strip, a sensor that does not give
//! way, and a force across the strip; bending need not be small: see [`ieap_domain::blocked::LARGEST_BENDING_RAD`].

/// Moment, mN mm, of a strip that presses with `force_mn` on a sensor `force_at_mm` from its clamp.
pub fn blocked_moment_mn_mm(force_mn: f64, force_at_mm: f64) -> f64 {
    2.0 * force_mn * force_at_mm / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::CrossSection;
    use ieap_domain::blocked::LARGEST_BENDING_RAD;

    /// Height of the tip of a strip of length 1 that would bend by `free` per length, under a force of `load` E I: its
    /// exact form, `theta' = free - load (X - x)` with the tip at X.
    fn height(free: f64, load: f64) -> f64 {
        const STEPS: usize = 200;
        let step = 1.0 / STEPS as f64;
        let (mut tip, mut height) = (1.0, 0.0);
        for _ in 0..40 {
            let (mut x, mut y, mut angle) = (0.0, 0.0, 0.0_f64);
            for _ in 0..STEPS {
                let middle = angle + 0.5 * step * (free - load * (tip - x));
                let bent = free - load * (tip - x - 0.5 * step * angle.cos());
                (x, y, angle) = (
                    x + step * middle.cos(),
                    y + step * middle.sin(),
                    angle + step * bent,
                );
            }
            (tip, height) = (x, y);
        }
        height
    }

    /// Force over E I that brings the tip back.
    fn holding(free: f64) -> f64 {
        let (mut low, mut high) = (free, 3.0 * free);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if height(free, middle) > 0.0 {
                low = middle
            } else {
                high = middle
            }
        }
        0.5 * (low + high)
    }

    #[test]
    fn the_exact_form_of_the_held_strip_gives_the_same_moment() {
        // Length and E I are 1, so that the moment is the free curvature.
        for (free, within) in [(0.1, 1e-4), (1.0, 0.01), (LARGEST_BENDING_RAD, 0.022)] {
            let moment = blocked_moment_mn_mm(holding(free), 1.0);
            assert!((moment / free - 1.0).abs() < within, "{free}: {moment}");
        }
    }

    #[test]
    fn a_strip_of_known_stiffness_presses_as_beams_do() {
        let section = CrossSection::symmetrical(2.0, 0.22);
        let (modulus_mpa, length_mm, curvature_per_cm) = (100.0, 5.0, 0.5);
        let moment = section.bending_moment_mn_mm(modulus_mpa, curvature_per_cm);
        // F = 3 E I delta / L^3 with the free deflection delta = kappa L^2 / 2.
        let stiffness_mn_mm2 = 1000.0 * modulus_mpa * section.second_moment_mm4();
        let free_mm = curvature_per_cm / 10.0 * length_mm * length_mm / 2.0;
        let force_mn = 3.0 * stiffness_mn_mm2 * free_mm / length_mm.powi(3);
        assert!((blocked_moment_mn_mm(force_mn, length_mm) / moment - 1.0).abs() < 1e-12);
    }
}
