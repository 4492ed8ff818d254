//! A picture as a value: panels below each other, each of layers over two axes. Page, print and terminal draw it alike.

use std::borrow::Cow;

/// A picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// What it shows, a few words.
    pub title: String,
    /// What a reader needs beside its legend, a sentence; empty where nothing.
    pub caption: String,
    /// Panels from top to bottom; the lowest one has the labels of the horizontal axis.
    pub panels: Vec<Panel>,
    /// Its form.
    pub form: Form,
}

/// The form of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Form {
    /// As wide as a column of a page.
    #[default]
    Plain,
    /// As wide as a page: for long times.
    Wide,
    /// Square, and a length means the same on both axes, as in a Nyquist plot.
    EqualScales,
}

/// A panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Horizontal axis.
    pub x: Range,
    /// Vertical axis.
    pub y: Range,
    /// Layers from back to front.
    pub layers: Vec<Layer>,
}

/// What an axis shows: the finite numbers of the layers that lie in a panel, and what else must be seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Range {
    /// Quantity.
    pub quantity: Cow<'static, str>,
    /// Unit.
    pub unit: Cow<'static, str>,
    /// How numbers become positions.
    pub scale: Scale,
    /// Numbers that are seen in any case.
    pub always: Vec<f64>,
    /// Names at 0, 1 and so on, of an axis of names.
    pub names: Vec<String>,
}

/// How numbers become positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// Proportional.
    Linear,
    /// Proportional to the logarithm; what is not positive is left out.
    Log,
    /// Of times since a step, s: nearly proportional up to `unit_s`, then to the logarithm, so that seconds and hours have
    /// equal room; what precedes the step stands in a narrow strip.
    SinceStep {
        /// Where it turns, s.
        unit_s: f64,
    },
    /// Places of names.
    Names,
    /// Dates by the clock of the campaign, of seconds since 1970 UTC.
    Calendar,
}

/// One series of a panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// What readouts and the legend call it; empty for what has no name.
    pub name: String,
    /// What stands at its points.
    pub mark: Mark,
    /// Its colour.
    pub ink: Ink,
    /// Its points; one that is no number interrupts a line.
    pub points: Vec<(f64, f64)>,
    /// Lower and upper end of the interval of each point; empty where there are none.
    pub bars: Vec<(f64, f64)>,
    /// The same along the horizontal axis.
    pub bars_across: Vec<(f64, f64)>,
    /// Paths of the runs that its points stand for; empty where they stand for none.
    pub runs: Vec<String>,
    /// Whether it is of a run that no result is made from, and that it is named after: marks are crossed, dots open, lines
    /// pale and dashed. Axes take no notice of it: what lies beyond them is said in words.
    pub is_aside: bool,
}

/// What stands at the points of a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Readings: open circles, or dots where they are many.
    Readings,
    /// Marks that are told apart without colour, with their bars.
    Marks,
    /// A line through them, as far as the axes show it: it does not widen them. Its bars are a band about it.
    Line,
    /// A line through them that the axes make room for, and a small dot at each.
    DottedLine,
    /// A line that the axes make room for, with a few marks on it by which it is told apart without colour.
    MarkedLine,
    /// An upright dashed line at each.
    Upright,
    /// A level line at each.
    Level,
    /// What lies between its bars along the horizontal axis is shaded.
    Span,
}

/// Colours by what they stand for; a writer has them such that the colour-blind tell them apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// Readings.
    Readings,
    /// The first model or series, the second, and so on.
    Series(usize),
    /// Which one of how many in an order, as times and places: all that is drawn of it shares a key.
    Ordered(usize, usize),
    /// Guides, and what is beside the matter.
    Guide,
    /// Limits, and what lies beyond them.
    Limit,
}

impl Range {
    /// A linear axis.
    pub fn linear(quantity: impl Into<Cow<'static, str>>, unit: impl Into<Cow<'static, str>>) -> Range {
        Range {
            quantity: quantity.into(),
            unit: unit.into(),
            scale: Scale::Linear,
            always: Vec::new(),
            names: Vec::new(),
        }
    }

    /// An axis of names, at 0, 1 and so on.
    pub fn names(names: Vec<String>) -> Range {
        Range {
            scale: Scale::Names,
            names,
            ..Range::linear("", "")
        }
    }

    /// A logarithmic axis.
    pub fn log(quantity: impl Into<Cow<'static, str>>, unit: impl Into<Cow<'static, str>>) -> Range {
        Range {
            scale: Scale::Log,
            ..Range::linear(quantity, unit)
        }
    }

    /// Time since a step at 0, of which `times_s` are shown: it turns at the first of them after it, at `shortest` of the last
    /// at the soonest.
    pub fn since_step(times_s: impl Iterator<Item = f64>, shortest: f64) -> Range {
        let after = times_s.filter(|time_s| *time_s > 0.0);
        let (next_s, last_s) = after.fold((f64::INFINITY, 0.0), |(next, last), time_s| {
            (time_s.min(next), time_s.max(last))
        });
        Range {
            scale: Scale::SinceStep {
                unit_s: next_s.max(shortest * last_s),
            },
            ..Range::linear("Time since the step", "s")
        }
    }

    /// Time, of seconds since 1970 UTC.
    pub fn calendar() -> Range {
        Range {
            scale: Scale::Calendar,
            ..Range::linear("Time", "")
        }
    }

    /// The same, on which that number is seen.
    pub fn with(mut self, number: f64) -> Range {
        self.always.push(number);
        self
    }
}

impl Ink {
    /// Series that have a colour of their own; further ones take them anew.
    pub const COLOURS: usize = 6;
    /// The first series.
    pub const FIRST: Ink = Ink::Series(0);
    /// The second.
    pub const SECOND: Ink = Ink::Series(1);
    /// The third.
    pub const THIRD: Ink = Ink::Series(2);
}

impl Chart {
    /// A picture of these panels.
    pub fn new(title: impl Into<String>, panels: Vec<Panel>) -> Chart {
        Chart {
            title: title.into(),
            caption: String::new(),
            panels,
            form: Form::Plain,
        }
    }

    /// The same with a sentence beside its legend.
    pub fn told(self, caption: impl Into<String>) -> Chart {
        Chart {
            caption: caption.into(),
            ..self
        }
    }

    /// The same in that form.
    pub fn formed(self, form: Form) -> Chart {
        Chart { form, ..self }
    }
}

impl Layer {
    /// A layer of these points.
    pub fn new(
        name: impl Into<String>,
        mark: Mark,
        ink: Ink,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Layer {
        Layer {
            name: name.into(),
            mark,
            ink,
            points: points.into_iter().collect(),
            bars: Vec::new(),
            bars_across: Vec::new(),
            runs: Vec::new(),
            is_aside: false,
        }
    }

    /// The same as of a run that no result is made from.
    pub fn aside(self) -> Layer {
        Layer {
            is_aside: true,
            ..self
        }
    }

    /// The same with the ends of an interval at each point.
    pub fn with_bars(self, bars: Vec<(f64, f64)>) -> Layer {
        Layer { bars, ..self }
    }

    /// The same with the ends of an interval along the horizontal axis.
    pub fn with_bars_across(self, bars_across: Vec<(f64, f64)>) -> Layer {
        Layer { bars_across, ..self }
    }

    /// The same with the paths of the runs that its points stand for.
    pub fn of_runs(self, runs: Vec<String>) -> Layer {
        Layer { runs, ..self }
    }

    /// Guides, upright or level, at these numbers.
    pub fn guides(mark: Mark, at: impl IntoIterator<Item = f64>) -> Layer {
        Layer::new("", mark, Ink::Guide, at.into_iter().map(|at| (at, at)))
    }

    /// A layer of the numbers `y` over `x`.
    pub fn over(name: impl Into<String>, mark: Mark, ink: Ink, x: &[f64], y: &[f64]) -> Layer {
        Layer::new(name, mark, ink, x.iter().copied().zip(y.iter().copied()))
    }
}
