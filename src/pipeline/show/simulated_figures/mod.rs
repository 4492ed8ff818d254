//! Figures that need no campaign: the thesis's families of simulated curves, and the answer of every model to a step.

mod families;

use crate::pipeline::PipelineError;
use crate::report::print_figures::family::Family;
use crate::report::print_figures::{Print, family_print};
use families::{ALPHA, LAMBDA, distributed, figure13, figure16, figure18, lumped, rival};

/// A figure that no campaign is needed for.
pub struct SimulatedFigure {
    /// Its name.
    pub name: &'static str,
    /// The same by what it shows.
    pub alias: &'static str,
    /// What it shows, one sentence.
    pub about: &'static str,
    /// Width for which it is laid out, mm.
    pub width_mm: f64,
    family: fn() -> Family,
}

/// Every one, in the order in which they are listed.
pub const SIMULATED: [SimulatedFigure; 11] = [
    SimulatedFigure {
        name: "figure13",
        alias: "families",
        about: "Simulated curvature after a step: one and two R-C circuits, and several rates of relaxation",
        width_mm: 170.0,
        family: figure13,
    },
    SimulatedFigure {
        name: "figure16",
        alias: "voltages-simulated",
        about: "Simulated voltage along the strip after a step: sums of few and many terms, and its course in time",
        width_mm: 170.0,
        family: figure16,
    },
    SimulatedFigure {
        name: "figure18",
        alias: "curvatures-simulated",
        about: "Simulated curvature along the strip over time, for two rates of relaxation",
        width_mm: 170.0,
        family: figure18,
    },
    SimulatedFigure {
        name: "step-lumped-1",
        alias: "step-1",
        about: "Answer of lumped-1 to a step of the voltage",
        width_mm: 170.0,
        family: || lumped(1),
    },
    SimulatedFigure {
        name: "step-lumped-2",
        alias: "step-2",
        about: "Answer of lumped-2 (and of lumped-3 and -4, whose further branches are slower) to a step",
        width_mm: 170.0,
        family: || lumped(2),
    },
    SimulatedFigure {
        name: "step-distributed",
        alias: "step-along",
        about: "Answer of the distributed model to a step of the voltage",
        width_mm: 170.0,
        family: distributed,
    },
    SimulatedFigure {
        name: "step-yagasaki-tamagawa",
        alias: "step-modulus",
        about: "Answer of Yagasaki and Tamagawa's changing modulus to a step",
        width_mm: 85.0,
        family: || {
            rival(
                "yagasaki-tamagawa",
                &[
                    ("E1/E0 = 0.005 1/s", &[ALPHA], &[0.005, 0.3, 0.004]),
                    ("E1/E0 = 0.02 1/s", &[ALPHA], &[0.02, 0.3, 0.004]),
                    ("E1/E0 = 0.05 1/s", &[ALPHA], &[0.05, 0.3, 0.004]),
                ],
            )
        },
    },
    SimulatedFigure {
        name: "step-bao-two-way",
        alias: "step-transport",
        about: "Answer of Bao's two-way transport to a step",
        width_mm: 85.0,
        family: || {
            rival(
                "bao-two-way",
                &[
                    ("K2 = 0: the thesis", &[ALPHA, 0.0], &[LAMBDA]),
                    ("K2 = K1/3", &[ALPHA, ALPHA / 3.0], &[LAMBDA]),
                    ("K2 = 4/3 K1: creeps on", &[ALPHA, 4.0 * ALPHA / 3.0], &[LAMBDA]),
                ],
            )
        },
    },
    SimulatedFigure {
        name: "step-kelvin-voigt",
        alias: "step-voigt",
        about: "Answer of a Kelvin-Voigt solid to a step",
        width_mm: 85.0,
        family: || {
            rival(
                "kelvin-voigt",
                &[
                    ("eta/E = 100 s", &[ALPHA], &[1.0 / 100.0]),
                    ("eta/E = 400 s", &[ALPHA], &[1.0 / 400.0]),
                    ("eta/E = 1600 s", &[ALPHA], &[1.0 / 1600.0]),
                ],
            )
        },
    },
    SimulatedFigure {
        name: "step-maxwell",
        alias: "step-flow",
        about: "Answer of a Maxwell material to a step",
        width_mm: 85.0,
        family: || {
            rival(
                "maxwell",
                &[
                    ("E/eta = 0.0001 1/s", &[ALPHA], &[1e-4]),
                    ("E/eta = 0.0003 1/s", &[ALPHA], &[3e-4]),
                    ("E/eta = 0.001 1/s", &[ALPHA], &[1e-3]),
                ],
            )
        },
    },
    SimulatedFigure {
        name: "step-standard-linear-solid",
        alias: "step-solid",
        about: "Answer of a standard linear solid to a step",
        width_mm: 85.0,
        family: || {
            rival(
                "standard-linear-solid",
                &[
                    ("E2/E1 = 0.3", &[ALPHA], &[1.0 / 600.0, 0.3]),
                    ("E2/E1 = 1", &[ALPHA], &[1.0 / 600.0, 1.0]),
                    ("E2/E1 = 3", &[ALPHA], &[1.0 / 600.0, 3.0]),
                ],
            )
        },
    },
];

/// The simulated figure of that name or alias.
pub fn simulated_named(name: &str) -> Option<&'static SimulatedFigure> {
    SIMULATED
        .iter()
        .find(|figure| figure.name == name || figure.alias == name)
}

impl SimulatedFigure {
    /// The figure, `width_mm` wide.
    ///
    /// # Errors
    /// What the drawing library says.
    pub(crate) fn print(&'static self, width_mm: f64) -> Result<Print, PipelineError> {
        let print = family_print(&(self.family)(), self.about, width_mm);
        print.map_err(|reason| PipelineError::Figure {
            figure: self.name,
            reason,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_simulated_figure_has_lines_of_numbers() {
        for figure in &SIMULATED {
            let family = (figure.family)();
            assert!(!family.panels.is_empty());
            for panel in &family.panels {
                assert!(!panel.lines.is_empty(), "{}", figure.name);
                let points = panel.lines.iter().flat_map(|line| &line.points);
                assert!(points.clone().count() > 100, "{}", figure.name);
                assert!(
                    points
                        .clone()
                        .all(|point| point.0.is_finite() && point.1.is_finite())
                );
                assert!(points.clone().any(|point| point.1 != 0.0), "{}", figure.name);
            }
        }
        assert!(simulated_named("families").is_some() && simulated_named("figure26").is_none());
    }
}
