//! The verb `figure`: a named figure of the campaign for print.

use super::along::PageCurves;
use super::report::input;
use super::simulated_figures::{SIMULATED, simulated_named};
use crate::domain::ParameterInfo;
use crate::pipeline::findings::kept;
use crate::pipeline::{Context, PipelineError};
use crate::report::Site;
use crate::report::print_figures::{
    FIGURE_FORMATS, FIGURES, FigureFormat, FigureInput, figure_format_named, figure_named,
};

/// Narrowest and widest figure, mm: a column's quarter, and a poster.
const WIDTHS_MM: std::ops::RangeInclusive<f64> = 20.0..=1000.0;
/// Coarsest and finest resolution, dots per inch.
const RESOLUTIONS: std::ops::RangeInclusive<f64> = 30.0..=2400.0;

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct MakeFigure {
    /// Name or alias.
    pub name: String,
    /// `svg`, `png` or `pdf`.
    pub format: String,
    /// Width, mm; none: that for which the figure is laid out.
    pub width_mm: Option<f64>,
    /// Resolution of pixels, dots per inch.
    pub dots_per_inch: f64,
    /// Path of the only run that a figure of strips shows; none: all of them.
    pub run: Option<String>,
    /// Parameter that a figure of laws or lives shows alone, by its key, the beginning of it, or its symbol.
    pub parameter: Option<String>,
}

/// Name, alias, width in mm and description of every figure.
pub fn listed() -> impl Iterator<Item = (&'static str, &'static str, f64, &'static str)> {
    let of_campaigns = FIGURES
        .iter()
        .map(|own| (own.name, own.alias, own.width_mm, own.about));
    of_campaigns.chain(
        SIMULATED
            .iter()
            .map(|own| (own.name, own.alias, own.width_mm, own.about)),
    )
}

/// Whether the figure of that name is simulated and needs no campaign.
pub fn needs_no_campaign(name: &str) -> bool {
    simulated_named(name).is_some()
}

/// Names of the formats.
pub fn formats() -> Vec<&'static str> {
    FIGURE_FORMATS.iter().map(|format| format.name).collect()
}

impl MakeFigure {
    /// The bytes of a simulated figure, which needs no campaign.
    ///
    /// # Errors
    /// There is no such simulated figure or format, or the drawing library fails.
    pub fn simulated(&self) -> Result<Vec<u8>, PipelineError> {
        let figure = simulated_named(&self.name).ok_or_else(|| PipelineError::BadArgument {
            what: "figure",
            found: format!("{:?}", self.name),
            needed: "the name of a simulated figure".to_owned(),
        })?;
        let format = self.checked_format()?;
        for (what, asked) in [("--run", &self.run), ("--parameter", &self.parameter)] {
            if let Some(found) = asked {
                return Err(PipelineError::BadArgument {
                    what,
                    found: found.clone(),
                    needed: "neither a run nor a parameter: this figure is simulated".to_owned(),
                });
            }
        }
        let print = figure.print(self.width_mm.unwrap_or(figure.width_mm))?;
        (format.write)(&print, self.dots_per_inch).map_err(|reason| PipelineError::Figure {
            figure: figure.name,
            reason,
        })
    }

    /// The format, where width and resolution are within what is drawn.
    fn checked_format(&self) -> Result<&'static FigureFormat, PipelineError> {
        if let Some(width_mm) = self.width_mm {
            within("--width-mm", width_mm, &WIDTHS_MM)?;
        }
        within("--dpi", self.dots_per_inch, &RESOLUTIONS)?;
        figure_format_named(&self.format).ok_or_else(|| PipelineError::BadArgument {
            what: "--format",
            found: format!("{:?}", self.format),
            needed: format!("one of {}", formats().join(", ")),
        })
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// There is no such figure or format, the campaign lacks what it shows, or the database cannot be read.
    pub fn run(&self, context: &Context) -> Result<Vec<u8>, PipelineError> {
        let bad = |what: &'static str, found: String, needed: String| PipelineError::BadArgument {
            what,
            found,
            needed,
        };
        let names = || listed().map(|(name, ..)| name).collect::<Vec<_>>().join(", ");
        let figure = figure_named(&self.name).ok_or_else(|| {
            bad(
                "figure",
                format!("{:?}", self.name),
                format!("one of {}", names()),
            )
        })?;
        let format = self.checked_format()?;
        let width_mm = self.width_mm.unwrap_or(figure.width_mm);
        let (changes, changed_at) = context.store.changes()?;
        let input = input(context, changes, &changed_at, &kept::values(context))?;
        let site = Site::new(&input);
        if self.run.is_some() && !figure.of_strips && figure.name != "models" {
            let needed = "no run: this figure shows them all".to_owned();
            return Err(bad("--run", self.run.clone().unwrap_or_default(), needed));
        }
        if let Some(parameter) = self.parameter.as_ref().filter(|_| !figure.of_parameters) {
            let needed = "no parameter: only the figures laws and monitoring are of one".to_owned();
            return Err(bad("--parameter", parameter.clone(), needed));
        }
        if let Some(unknown) = self.parameter.as_ref().filter(|asked| !is_parameter(asked)) {
            let needed = "a parameter by its key or symbol, as `ieap list models` lists them".to_owned();
            return Err(bad("--parameter", format!("{unknown:?}"), needed));
        }
        let only = self.run.as_ref().map(|path| {
            let found = (0..input.runs.len())
                .find(|&run| input.runs[run].path == *path || site.run_name(run) == path);
            let needed = "the path of a run, as `ieap status` lists it".to_owned();
            found.ok_or_else(|| bad("--run", format!("{path:?}"), needed))
        });
        let only = only.transpose()?;
        let drawn = figure.print(
            &FigureInput {
                site: &site,
                curves: &PageCurves::new(context, &input.runs),
                run: only,
                parameter: self.parameter.as_deref(),
            },
            width_mm,
        );
        let written = drawn.and_then(|print| (format.write)(&print, self.dots_per_inch));
        written.map_err(|reason| PipelineError::Figure {
            figure: figure.name,
            reason,
        })
    }
}

/// Whether a parameter of a model is called so.
fn is_parameter(asked: &str) -> bool {
    ParameterInfo::all().any(|known| known.is_called(asked))
}

fn within(
    what: &'static str,
    found: f64,
    range: &std::ops::RangeInclusive<f64>,
) -> Result<(), PipelineError> {
    if range.contains(&found) {
        Ok(())
    } else {
        Err(PipelineError::BadArgument {
            what,
            found: found.to_string(),
            needed: format!("{} to {}", range.start(), range.end()),
        })
    }
}
