//! A parameter that takes a smooth course of its own over the run.

use super::acting::{LEAST, instant, scale_resistances};
use super::{About, EffectParameter, Equation, Limits, Scale, Search};
use crate::extended::{RunContext, System};

/// See the module.
pub(super) struct ParameterWander;

static ABOUT: About = About {
    id: "parameter-wander",
    code: "N7",
    summary: "a parameter takes a smooth course of its own over the run",
    equation: "X -> X (1 + e g(t/T)), g(x) = cos(phi) sin(pi x/2) + sin(phi) sin(3 pi x/2), T the time of the last reading; X all resistances of branches, all capacitances, R_ss, or alpha",
    variants: &["resistances", "capacitances", "r-ss", "coupling"],
    parameters: &[
        EffectParameter {
            key: "relative_change",
            symbol: "e",
            unit: "",
            meaning: "size of the course in terms of the parameter",
        },
        EffectParameter {
            key: "shape_rad",
            symbol: "phi",
            unit: "rad",
            meaning: "shape of the course: 0 goes one way, pi/2 goes there, back and beyond",
        },
    ],
    vanishes: "e = 0",
    signature: "what is left follows the clock, whatever the drive does, and turns back",
    twins: &[
        "resistance-drift",
        "water-exchange",
        "modulus-drift",
        "ambient-temperature",
    ],
    separated_by: "pulses all through the run; a thermometer and a hygrometer; the same run again: a course of its own is another one then",
    sources: "first two terms of the Karhunen-Loeve series of a random walk",
};

/// The course at a part of the run.
fn course(shape_rad: f64, x: f64) -> f64 {
    let quarter = std::f64::consts::FRAC_PI_2 * x;
    shape_rad.cos() * quarter.sin() + shape_rad.sin() * (3.0 * quarter).sin()
}

impl Equation for ParameterWander {
    const ABOUT: &'static About = &ABOUT;

    fn search(&self, variant: usize, scale: &Scale) -> Search {
        let leaks = scale.base.steady_state_resistance_ohm_cm2.is_finite();
        if variant == 2 && !leaks || variant == 3 && scale.curvature_per_cm == 0.0 {
            return Search::none();
        }
        // One-way courses of resistances and of the coupling are those of other effects.
        let shapes: &[f64] = match variant {
            0 | 3 => &[1.2],
            _ => &[0.0, 1.2],
        };
        let limits = vec![Limits::linear(-0.7, 1.5), Limits::linear(-2.0, 2.0)];
        Search::over(0.03, limits, &[shapes.to_vec()])
    }

    fn apply(&self, variant: usize, parameters: &[f64], run: &RunContext, system: &mut System) {
        let [change, shape_rad] = [parameters[0], parameters[1]];
        let end_s = (run.duration_s - run.start_s()).max(f64::MIN_POSITIVE);
        system.laws.push(instant(move |now, c| {
            let x = (now.clock_s / end_s).clamp(0.0, 1.0);
            let factor = (1.0 + change * course(shape_rad, x)).max(LEAST);
            match variant {
                0 => scale_resistances(c, factor),
                1 => c.capacitance_f_per_cm2.iter_mut().for_each(|c| *c *= factor),
                2 => c.steady_s_per_cm2 /= factor,
                _ => c.coupling_factor *= factor,
            }
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::respond;
    use super::course;

    #[test]
    fn a_course_begins_at_nothing_and_turns_back_by_its_shape() {
        assert_eq!(course(0.7, 0.0), 0.0);
        assert!((course(0.0, 1.0) - 1.0).abs() < 1e-12);
        assert!((course(std::f64::consts::FRAC_PI_2, 1.0 / 3.0) - 1.0).abs() < 1e-12);
        assert!((course(std::f64::consts::FRAC_PI_2, 1.0) + 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_late_step_meets_the_parameter_of_its_time() {
        let late = [(0.0, Some(0.0)), (150.0, Some(2.0))];
        let factor = 1.0 + 0.4 * course(0.5, 0.5);
        let of = |variant| {
            let effect = ("parameter-wander", variant, [0.4, 0.5].as_slice());
            respond(&[effect], &late, &[150.0], &[200.0])
        };
        let conductance = 1.0 / 3.0 + 1.0 / 15.0;
        let expected = 0.1 * 2.0 * (conductance / factor + 1.0 / 300.0);
        assert!((of(0).current_a[0] / expected - 1.0).abs() < 1e-12);
        let expected = 0.1 * 2.0 * (conductance + 1.0 / (300.0 * factor));
        assert!((of(2).current_a[0] / expected - 1.0).abs() < 1e-12);
        let bent = respond(&[], &late, &[], &[200.0]).curvature_per_cm[0];
        let expected = bent * (1.0 + 0.4 * course(0.5, 2.0 / 3.0));
        assert!((of(3).curvature_per_cm[0] / expected - 1.0).abs() < 1e-9);
    }

    /// With larger capacitances the same voltage step draws a current that falls more slowly.
    #[test]
    fn a_late_step_charges_the_capacitance_of_its_time() {
        let late = [(0.0, Some(0.0)), (150.0, Some(2.0))];
        let effect = ("parameter-wander", 1, [0.4, 0.0].as_slice());
        let found = respond(&[effect], &late, &[150.2], &[]);
        let factor = 1.0 + 0.4 * course(0.0, 0.5);
        let slower = |r: f64, c: f64| (-0.2 / (factor * r * c)).exp() / r;
        let expected = 0.1 * 2.0 * (slower(3.0, 0.1) + slower(15.0, 0.6) + 1.0 / 300.0);
        assert!((found.current_a[0] / expected - 1.0).abs() < 1e-3);
    }
}
