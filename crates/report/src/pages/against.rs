//! Every parameter against one covariate, run by run: small multiples, one a parameter and material.

use ieap_domain::range_of;
use ieap_domain::words::counted;

use crate::aside::{Shown, beyond_words, marks};
use crate::blocks::Writer;
use crate::error::ReportError;
use crate::figures::aside::AsideMark;
use crate::figures::axis::{Axis, Scale, Tick};
use crate::figures::calendar::calendar_axis;
use crate::figures::law::{Beside, Mark, SMALL, sized_panel};
use crate::site::Site;
use ieap_analysis::against::{Against, Places};
use ieap_analysis::conditions::compared_material;
use ieap_analysis::laws::facts::Known;
use ieap_analysis::parameters::usable;
use ieap_domain::parameters::{PARAMETERS, ParameterInfo};
use ieap_domain::tag::keys;

/// How far beyond the values an interval may stretch an axis, as a factor.
const STRETCH: f64 = 2.0;
/// Ticks of names that fit side by side, and characters of all of them together.
const MOST_NAMES: usize = 12;
const MOST_CHARACTERS: usize = 48;
/// Room that the marks of one name take, of the distance between two.
const SPREAD: f64 = 0.7;
/// Room beside them of runs that are set aside.
const ASIDE: f64 = 0.2;

/// Every parameter in a part of its own; gives by what its marks are told apart, none where runs do not differ in it.
///
/// # Errors
/// [`ReportError::Figure`] where a figure cannot be drawn.
pub fn parts(
    page: &mut Writer,
    site: &Site,
    against: Against,
    shown: &mut Shown,
) -> Result<Option<Groups>, ReportError> {
    let input = site.input;
    let Some(places) = against.places(&input.runs, &input.campaign, &site.facts) else {
        return Ok(None);
    };
    let groups = Groups::new(site, against);
    for info in &PARAMETERS {
        let own = Drawing {
            site,
            against,
            places: &places,
            groups: &groups,
            info,
        };
        let panels = own.panels();
        if !panels.is_empty() {
            let anchor = format!("{}-{}", name(against), info.key);
            let title = format!("{} {}", info.symbol, info.name);
            page.anchored(&anchor, &title, |part| {
                panels
                    .into_iter()
                    .try_for_each(|panel| own.draw(part, panel, shown))
            })?;
        }
    }
    Ok(Some(groups))
}

/// What the runs are shown against, in a word.
pub fn name(against: Against) -> &'static str {
    match against {
        Against::Humidity => "humidity",
        Against::Voltage => "voltage",
        Against::Environment => "environment",
        Against::Material => "material",
        Against::Sample => "sample",
        Against::Time => "time",
    }
}

/// By what marks are told apart.
pub struct Groups {
    /// Names, in the order of the markers.
    pub names: Vec<String>,
    of_run: Vec<Option<usize>>,
}

impl Groups {
    /// The environment, or the sample where the environment is what is shown against.
    fn new(site: &Site, against: Against) -> Groups {
        let (key, by) = match against {
            Against::Environment => (keys::SAMPLE, Against::Sample),
            _ => (keys::ENVIRONMENT, Against::Environment),
        };
        let (runs, campaign) = (&site.input.runs, &site.input.campaign);
        match by.places(runs, campaign, &site.facts) {
            Some(places) => Groups {
                names: places.names,
                of_run: places
                    .of_run
                    .iter()
                    .map(|place| Some(place.as_ref()?.value as usize))
                    .collect(),
            },
            None => Groups {
                names: runs
                    .iter()
                    .find_map(|run| run.tag(key))
                    .map(str::to_owned)
                    .into_iter()
                    .collect(),
                of_run: runs.iter().map(|run| run.tag(key).map(|_| 0)).collect(),
            },
        }
    }
}

/// One parameter.
struct Drawing<'a> {
    site: &'a Site<'a>,
    against: Against,
    places: &'a Places,
    groups: &'a Groups,
    info: &'static ParameterInfo,
}

/// The figure of a material.
struct Panel<'a> {
    /// Empty where all materials share it.
    material: &'a str,
    at: usize,
    marks: Vec<Mark>,
    /// Fitted runs that have no mark.
    left_out: usize,
}

impl<'a> Drawing<'a> {
    /// Every panel that has marks.
    fn panels(&self) -> Vec<Panel<'a>> {
        let materials = self.site.conditions.materials.iter().map(String::as_str);
        let names: Vec<&str> = match self.against {
            Against::Material => vec![""],
            _ => materials.collect(),
        };
        let panels = names.into_iter().enumerate().map(|(at, material)| {
            let (marks, left_out) = self.marks(material);
            Panel {
                material,
                at,
                marks,
                left_out,
            }
        });
        panels.filter(|panel| !panel.marks.is_empty()).collect()
    }

    fn draw(&self, part: &mut Writer, panel: Panel, shown: &mut Shown) -> Result<(), ReportError> {
        let (material, against) = (panel.material, name(self.against));
        let of = match material {
            "" => String::new(),
            material => format!(" of {material}"),
        };
        let title = format!("{}{of} against {against}", self.info.name);
        let desc = "One mark a run with its 95 % interval; the numbers stand in the table of parameters.";
        let (x, y) = (self.across(), vertical(self.info, &panel.marks));
        let beside = Beside {
            names: self.groups.names.clone(),
            aside: self.aside(material),
            ..Beside::default()
        };
        let note = match panel.left_out {
            0 => String::new(),
            some => format!(
                "{}{of} left out: a bound, or not determined.",
                counted(some, "run")
            ),
        };
        let drawn = sized_panel(SMALL, (&x, &y), (&panel.marks, &beside), (&title, desc));
        let figure = format!("{against}-{}-{}", self.info.key.replace('_', "-"), panel.at);
        part.drawing(&figure, (material, &note), drawn)?;
        shown.note(&beside.aside);
        part.beyond(beyond_words(
            &beside.aside,
            (Some(&x), &y),
            self.info.shown_unit(),
        ));
        Ok(())
    }

    /// Marks of a material (of all where the name is empty), and how many fitted runs have none.
    fn marks(&self, of: &str) -> (Vec<Mark>, usize) {
        let input = self.site.input;
        let (mut marks, mut left_out) = (Vec::new(), 0);
        for (run, record) in input.runs.iter().enumerate() {
            let (Some(place), Some(style)) = (self.places.of_run[run], self.groups.of_run[run]) else {
                continue;
            };
            if !of.is_empty() && compared_material(record, &input.campaign) != Some(of) {
                continue;
            }
            let Some(estimate) = usable(record, self.info.key) else {
                continue;
            };
            let Some(value) = estimate.value.filter(|value| value.is_finite()) else {
                left_out += 1;
                continue;
            };
            let shown = |number: Option<f64>| number.unwrap_or(value) * self.info.shown_factor();
            marks.push(Mark {
                x: place.value,
                x_error: place.standard_error.unwrap_or(0.0),
                y: value * self.info.shown_factor(),
                bar: (shown(estimate.low_95), shown(estimate.high_95)),
                style,
                run: Some(run),
            });
        }
        if !self.places.names.is_empty() {
            stand_side_by_side(&mut marks, self.places.names.len());
        }
        (marks, left_out)
    }

    /// Condemned runs of a material (of all where the name is empty).
    fn aside(&self, of: &str) -> Vec<AsideMark> {
        let campaign = &self.site.input.campaign;
        marks(self.site, self.info.key, |aside| {
            let record = self.site.input.record(aside.run);
            let facts = aside.facts.as_ref();
            let place = (self.against).place_of(record, campaign, facts, self.places)?;
            let is_of = of.is_empty() || compared_material(record, campaign) == Some(of);
            // Right of the runs of its name.
            let right = if self.places.names.is_empty() {
                0.0
            } else {
                0.5 * (SPREAD + ASIDE)
            };
            is_of.then_some(place.value + right)
        })
    }

    fn across(&self) -> Axis {
        let values = || self.places.of_run.iter().flatten();
        if !self.places.names.is_empty() {
            return names_axis(&self.places.names);
        }
        let reach = |known: &Known| known.standard_error.unwrap_or(0.0);
        let low = values()
            .map(|known| known.value - reach(known))
            .fold(f64::INFINITY, f64::min);
        let high = values()
            .map(|known| known.value + reach(known))
            .fold(f64::NEG_INFINITY, f64::max);
        let margin = 0.05 * (high - low);
        match self.against {
            Against::Time => calendar_axis(low - margin, high + margin, 4, &self.site.zone()),
            Against::Humidity => Axis::linear(low - margin, high + margin, "Relative humidity (%)", "", 6),
            _ => Axis::linear(low - margin, high + margin, "Step voltage (V)", "", 6),
        }
    }
}

/// Runs of one name stand beside each other in their order.
fn stand_side_by_side(marks: &mut [Mark], names: usize) {
    for name in 0..names {
        let own: Vec<usize> = (0..marks.len()).filter(|&k| marks[k].x == name as f64).collect();
        let count = own.len() as f64;
        for (at, &k) in own.iter().enumerate() {
            marks[k].x += SPREAD * ((at as f64 + 0.5) / count - 0.5);
        }
    }
}

/// Places of names; where they are many or long, only some are written.
fn names_axis(names: &[String]) -> Axis {
    let characters: usize = names.iter().map(|name| name.chars().count() + 2).sum();
    let every = names
        .len()
        .div_ceil(MOST_NAMES)
        .max(characters.div_ceil(MOST_CHARACTERS));
    let tick = |(at, name): (usize, &String)| Tick {
        at: at as f64,
        label: if at % every == 0 {
            name.clone()
        } else {
            String::new()
        },
    };
    Axis {
        scale: Scale::Names,
        low: -0.6,
        high: names.len() as f64 - 0.4,
        ticks: names.iter().enumerate().map(tick).collect(),
        title: String::new(),
        shown_factor: 1.0,
    }
}

/// An axis that shows every value, and intervals as far as `STRETCH` lets them reach.
fn vertical(info: &ParameterInfo, marks: &[Mark]) -> Axis {
    let ends = |(low, high): (f64, f64), y: f64| (low.min(y), high.max(y));
    let (low, high) = range_of(marks.iter().map(|mark| mark.y));
    let bars = || marks.iter().flat_map(|mark| [mark.bar.0, mark.bar.1]);
    if info.spans_decades && low > 0.0 {
        let reached = bars()
            .map(|end| end.clamp(low / STRETCH, high * STRETCH))
            .fold((low, high), ends);
        return Axis::log(reached.0 / 1.2, reached.1 * 1.2, info.symbol, info.shown_unit());
    }
    let room = (STRETCH - 1.0) * (high - low).max(0.2 * high.abs().max(low.abs()));
    let (low, high) = bars()
        .map(|end| end.clamp(low - room, high + room))
        .fold((low, high), ends);
    let margin = 0.06 * (high - low);
    let axis = Axis::linear(low - margin, high + margin, info.symbol, "", 5);
    Axis {
        title: format!("{} ({})", info.symbol, info.shown_unit()),
        ..axis
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_a_name_stand_beside_each_other_and_never_reach_the_next() {
        let mark = |x| Mark {
            x,
            x_error: 0.0,
            y: 1.0,
            bar: (1.0, 1.0),
            style: 0,
            run: None,
        };
        let mut marks: Vec<Mark> = (0..50).map(|k| mark(f64::from(k % 2))).collect();
        stand_side_by_side(&mut marks, 2);
        assert!(marks.iter().all(|mark| (mark.x - mark.x.round()).abs() < 0.36));
        let mut places: Vec<i64> = marks.iter().map(|mark| (1e6 * mark.x) as i64).collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), 50);
    }

    #[test]
    fn many_names_are_written_as_far_as_there_is_room() {
        let names: Vec<String> = (0..30).map(|k| format!("CNaf-{k:02}")).collect();
        let axis = names_axis(&names);
        let written = axis.ticks.iter().filter(|tick| !tick.label.is_empty()).count();
        assert!((3..=7).contains(&written), "{written}");
    }
}
