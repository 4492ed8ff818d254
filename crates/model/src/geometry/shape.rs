//! The strip as a chain of short links: tangent angle, local curvature and shape, thesis (11).

/// Where a strip lies, seen from its side: joints of a chain of links, the clamp first.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Distance ahead of the clamp of each joint, cm.
    pub x_cm: Vec<f64>,
    /// Distance sideways of each joint, cm; positive where the curvature is.
    pub y_cm: Vec<f64>,
    /// Tangent angle at each joint, rad; zero at the clamp.
    pub angle_rad: Vec<f64>,
}

impl Shape {
    /// The shape of a strip clamped at the origin and pointing along x, whose links of `link_cm` each have the
    /// constant curvature `curvature_per_cm[k]` (1/cm). Every link is an arc, so a circle comes out exact.
    pub fn from_curvature(curvature_per_cm: &[f64], link_cm: f64) -> Shape {
        Shape::from_links(&Vec::from_iter(
            curvature_per_cm.iter().map(|&curvature| (curvature, link_cm)),
        ))
    }

    /// The same for links of any length: curvature (1/cm) and length (cm) of each.
    pub fn from_links(links: &[(f64, f64)]) -> Shape {
        let mut angle_rad = vec![0.0];
        angle_rad.extend(links.iter().scan(0.0, |angle, (curvature, link_cm)| {
            *angle += curvature * link_cm;
            Some(*angle)
        }));
        let mut shape = Shape {
            x_cm: vec![0.0],
            y_cm: vec![0.0],
            angle_rad: Vec::new(),
        };
        let (mut x, mut y) = (0.0, 0.0);
        for (ends, (_, link_cm)) in angle_rad.windows(2).zip(links) {
            let half_turn = 0.5 * (ends[1] - ends[0]);
            let chord_cm = link_cm * sine_quotient(half_turn);
            x += chord_cm * (ends[0] + half_turn).cos();
            y += chord_cm * (ends[0] + half_turn).sin();
            shape.x_cm.push(x);
            shape.y_cm.push(y);
        }
        shape.angle_rad = angle_rad;
        shape
    }

    /// Position of the tip, cm: ahead and sideways.
    pub fn tip_cm(&self) -> (f64, f64) {
        (last(&self.x_cm), last(&self.y_cm))
    }
}

fn last(values: &[f64]) -> f64 {
    values.last().copied().unwrap_or(0.0)
}

/// sin(x)/x.
fn sine_quotient(x: f64) -> f64 {
    if x.abs() < 1e-4 {
        1.0 - x * x / 6.0
    } else {
        x.sin() / x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::arc::curvature_from_displacement;
    use ieap_numerics::ode::integrate;

    /// Tip of a strip of `length_cm` with curvature `kappa(s)`: x' = cos phi, y' = sin phi, phi' = kappa.
    fn tip_by_integration(kappa: impl Fn(f64) -> f64, length_cm: f64) -> (f64, f64) {
        let mut state = [0.0; 3];
        let rate = |s: f64, y: &[f64], out: &mut [f64]| {
            out[0] = y[2].cos();
            out[1] = y[2].sin();
            out[2] = kappa(s);
        };
        integrate(rate, 0.0, length_cm, &mut state, 1e-12, 1e-14);
        (state[0], state[1])
    }

    #[test]
    fn constant_curvature_gives_a_circle_for_any_number_of_links() {
        for links in [1, 3, 50] {
            for curvature in [-2.0, 1e-9, 0.6, 3.0_f64] {
                let length = 1.4;
                let shape = Shape::from_curvature(&vec![curvature; links], length / links as f64);
                let (x, y) = shape.tip_cm();
                let turn = curvature * length;
                assert!((x - turn.sin() / curvature).abs() < 1e-14);
                let exact = 2.0 * (0.5 * turn).sin().powi(2) / curvature;
                assert!((y - exact).abs() < 1e-14 + 1e-13 * exact.abs(), "{y} {exact}");
                // (3) holds at every point of the circle up to the quarter turn.
                if turn.abs() < 1.5 {
                    assert!((curvature_from_displacement(10.0 * y, 10.0 * x) / curvature - 1.0).abs() < 1e-6);
                }
            }
        }
    }

    #[test]
    fn links_of_uneven_length_follow_their_arcs() {
        // A quarter of a circle of 2 cm radius, then straight on: up and to the side.
        let quarter = std::f64::consts::PI;
        let shape = Shape::from_links(&[(0.5, 0.25 * quarter), (0.5, 0.75 * quarter), (0.0, 3.0)]);
        let (x, y) = shape.tip_cm();
        assert!((x - 2.0).abs() < 1e-14 && (y - 5.0).abs() < 1e-14, "{x} {y}");
        assert!((shape.angle_rad[3] - 0.5 * std::f64::consts::PI).abs() < 1e-14);
    }

    #[test]
    fn links_come_to_the_continuous_strip_with_the_square_of_their_length() {
        let kappa = |s: f64| 1.5 * (-s).exp() - 0.3 * s;
        let (x, y) = tip_by_integration(kappa, 3.0);
        let miss = |links: usize| {
            let link = 3.0 / links as f64;
            let curvature: Vec<f64> = (0..links).map(|k| kappa((k as f64 + 0.5) * link)).collect();
            let tip = Shape::from_curvature(&curvature, link).tip_cm();
            (tip.0 - x).hypot(tip.1 - y)
        };
        let (coarse, fine) = (miss(200), miss(400));
        assert!(
            fine < 1e-4 && (3.5..4.5).contains(&(coarse / fine)),
            "{coarse} {fine}"
        );
    }
}
