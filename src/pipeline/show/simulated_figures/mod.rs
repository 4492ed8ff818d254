//! Figures that need no campaign: the thesis's families of simulated curves.

mod families;

use crate::pipeline::PipelineError;
use crate::report::print_figures::{Print, charts_print};
use crate::show::Chart;
use families::{figure13, figure16, figure18};

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
    charts: fn() -> Vec<Chart>,
}

/// Every one, in the order in which they are listed.
pub const SIMULATED: [SimulatedFigure; 3] = [
    SimulatedFigure {
        name: "figure13",
        alias: "families",
        about: "Simulated curvature after a step: one and two R-C circuits, and several rates of relaxation",
        width_mm: 170.0,
        charts: figure13,
    },
    SimulatedFigure {
        name: "figure16",
        alias: "voltages-simulated",
        about: "Simulated voltage along the strip after a step: sums of few and many terms, and its course in time",
        width_mm: 170.0,
        charts: figure16,
    },
    SimulatedFigure {
        name: "figure18",
        alias: "curvatures-simulated",
        about: "Simulated curvature along the strip over time, for two rates of relaxation",
        width_mm: 170.0,
        charts: figure18,
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
        let charts = (self.charts)();
        let print = charts_print(&charts, charts.len(), self.about, width_mm);
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
            let charts = (figure.charts)();
            assert!(!charts.is_empty());
            for panel in charts.iter().flat_map(|chart| &chart.panels) {
                assert!(!panel.layers.is_empty(), "{}", figure.name);
                let points = panel.layers.iter().flat_map(|line| &line.points);
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
