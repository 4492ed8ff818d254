//! The thesis's table 6: what happens in which environment at which voltage, in words that follow from numbers.
//!
//! A word is given where the whole 95 % interval lies in its class; an interval that reaches over a limit gives both
//! words. The limits are round numbers that put the thesis's own table 5 into the classes of its table 6 where one
//! rule can: docs/tables.md says where it cannot.

use super::TableInput;
use super::of_several::Runs;
use crate::conditions::{Conditions, DRY_UP_TO_PERCENT, Surroundings, conditions, volts};
use ieap_domain::ParameterInfo;
use ieap_domain::number::fixed;
use ieap_show::quantities::{ENVIRONMENT, HUMIDITY, MATERIAL, Quantity};
use ieap_show::{Column, Combined, Content, Sheet, Source, Table, Value};

/// Water is not split below this voltage, V.
pub const WATER_WINDOW_V: f64 = 1.23;
const ASPECT: Quantity = Quantity::plain("aspect", "Aspect", "what is judged");

/// Classes of a number: words, and the limits between them.
struct Classes {
    words: &'static [&'static str],
    limits: &'static [f64],
}

const RELAXATION: Classes = Classes {
    words: &["minor", "moderate", "intense"],
    limits: &[3e-4, 1e-3],
};
const ELECTROLYSIS: Classes = Classes {
    words: &["none", "present", "intensive"],
    limits: &[2.0, 20.0],
};
const TIME_CONSTANT: Classes = Classes {
    words: &["small", "medium", "large"],
    limits: &[50.0, 100.0],
};
const STEADY_CURRENT: Classes = Classes {
    words: &["low", "moderate", "high"],
    limits: &[5e-5, 5e-4],
};

/// The rules in words, with their numbers.
pub fn rules() -> Vec<String> {
    let [moderate, intense] = [RELAXATION.limits[0], RELAXATION.limits[1]];
    let half_life_min = |rate: f64| std::f64::consts::LN_2 / rate / 60.0;
    vec![
        format!(
            "Back-relaxation is minor for λ below {moderate} s⁻¹ (half of the bending is lost in more than {} min), intense from {intense} s⁻¹ (less than {} min), moderate between.",
            fixed(half_life_min(moderate), 0),
            fixed(half_life_min(intense), 0)
        ),
        format!(
            "Electrolysis of water is none up to {WATER_WINDOW_V} V (the window of water), without water (vacuum, inert gas, at most {DRY_UP_TO_PERCENT} % RH), and where Rₛₛ falls by less than a factor {} below that of the same material dry at the same voltage; it is intensive from a factor {}, present between.",
            ELECTROLYSIS.limits[0], ELECTROLYSIS.limits[1]
        ),
        format!(
            "The time constant (R₁ ∥ R₂)(C₁ + C₂) is small below {} s, large from {} s.",
            TIME_CONSTANT.limits[0], TIME_CONSTANT.limits[1]
        ),
        format!(
            "The steady-state current V₀/Rₛₛ is low below {} µA cm⁻², high from {} µA cm⁻².",
            fixed(1e6 * STEADY_CURRENT.limits[0], 0),
            fixed(1e6 * STEADY_CURRENT.limits[1], 0)
        ),
        "Two words mean that the 95 % interval reaches over the limit between them.".to_owned(),
    ]
}

/// A 95 % interval; open sides are infinite or zero.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Interval {
    low: f64,
    high: f64,
}

impl Interval {
    fn over(self, divisor: Interval) -> Interval {
        Interval {
            low: self.low / divisor.high,
            high: self.high / divisor.low,
        }
    }

    fn times(self, factor: Interval) -> Interval {
        Interval {
            low: self.low * factor.low,
            high: self.high * factor.high,
        }
    }
}

/// What a cell is judged by: the interval, or why there is none.
type Judged = (Result<Interval, String>, Vec<Source>);

/// One line of an environment: a name, and the word for a material at a voltage.
struct Aspect {
    name: &'static str,
    key: &'static str,
    classes: &'static Classes,
    judged: fn(&Place) -> Judged,
}

const ASPECTS: [Aspect; 4] = [
    Aspect {
        name: "electrolysis of water",
        key: "electrolysis",
        classes: &ELECTROLYSIS,
        judged: excess_conductance,
    },
    Aspect {
        name: "back-relaxation",
        key: "back_relaxation",
        classes: &RELAXATION,
        judged: |place| place.interval("lambda_per_s"),
    },
    Aspect {
        name: "time constant",
        key: "time_constant",
        classes: &TIME_CONSTANT,
        judged: time_constant,
    },
    Aspect {
        name: "steady-state current",
        key: "steady_state_current",
        classes: &STEADY_CURRENT,
        judged: steady_current,
    },
];

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    type Judging<'a> = (Place<'a>, &'static Aspect);
    let found = conditions(input.runs, input.campaign);
    let is_measured =
        |own: &Place| (0..found.voltages_v.len()).any(|voltage| !own.at(voltage).runs().is_empty());
    let mut rows = Vec::new();
    for surroundings in 0..found.surroundings.len() {
        for aspect in &ASPECTS {
            let places = (0..found.materials.len()).map(|material| Place {
                input,
                table: &found,
                material,
                surroundings,
                voltage: 0,
            });
            rows.extend(places.filter(is_measured).map(|place| (place, aspect)));
        }
    }
    let sheet = Sheet::<Judging>::new("table6", "Summary of the results in words", 4)
        .said(rules())
        .called(|(place, aspect)| {
            format!(
                "{}, {}, {}",
                place.surroundings().text(),
                aspect.key,
                place.material()
            )
        })
        .column(ENVIRONMENT, |(place, _)| {
            place.surroundings().environment.as_str()
        })
        .column(HUMIDITY, |(place, _)| place.surroundings().humidity_text())
        .column(ASPECT, |(_, aspect)| aspect.name)
        .column(MATERIAL, |(place, _)| place.material());
    let at_voltages = found.voltages_v.iter().enumerate();
    let sheet = at_voltages.fold(sheet, |sheet, (voltage, &voltage_v)| {
        let head = Column::plain(
            &format!("at_{voltage_v}_v"),
            &volts(voltage_v),
            "at this step voltage",
        );
        sheet.column_under(head, move |(place, aspect)| aspect.word(&place.at(voltage)))
    });
    sheet.over(rows)
}

impl Aspect {
    fn word(&self, place: &Place) -> Value {
        if place.runs().is_empty() {
            return Value::Missing;
        }
        let (judged, sources) = (self.judged)(place);
        let (content, notes) = match judged {
            Ok(interval) => (Content::Text(self.classes.word(interval)), vec![]),
            Err(reason) => (Content::NotDetermined, vec![reason]),
        };
        Value::Combined(Combined {
            content,
            notes,
            sources,
        })
    }
}

impl Classes {
    fn class(&self, number: f64) -> usize {
        self.limits.iter().filter(|&&limit| number >= limit).count()
    }

    fn word(&self, interval: Interval) -> String {
        let (low, high) = (self.class(interval.low), self.class(interval.high));
        if low == high {
            self.words[low].to_owned()
        } else {
            format!("{} to {}", self.words[low], self.words[high])
        }
    }
}

/// A material in surroundings at a voltage.
#[derive(Clone, Copy)]
struct Place<'a> {
    input: &'a TableInput<'a>,
    table: &'a Conditions,
    material: usize,
    surroundings: usize,
    voltage: usize,
}

impl<'a> Place<'a> {
    fn at(self, voltage: usize) -> Place<'a> {
        Place { voltage, ..self }
    }

    fn surroundings(&self) -> &'a Surroundings {
        &self.table.surroundings[self.surroundings]
    }

    fn material(&self) -> &'a str {
        &self.table.materials[self.material]
    }

    fn runs(&self) -> &[usize] {
        let condition = self.table.at(self.material, self.surroundings, self.voltage);
        condition.map_or(&[], |condition| &condition.runs)
    }

    fn voltage_v(&self) -> f64 {
        self.table.voltages_v[self.voltage]
    }

    /// The 95 % interval of a parameter over the runs of this place.
    fn interval(&self, key: &str) -> Judged {
        let runs = Runs::new(self.input, self.runs());
        let own = runs.parameter(key);
        let interval = match own.content {
            Content::Measured(measured) => Some(Interval {
                low: measured.low_95.unwrap_or(measured.value).max(0.0),
                high: measured.high_95.unwrap_or(measured.value),
            }),
            Content::Bound { low, high } => Some(Interval {
                low: low.unwrap_or(0.0),
                high: high.unwrap_or(f64::INFINITY),
            }),
            _ => None,
        };
        let symbol = ParameterInfo::of(key).map_or(key, |info| info.symbol);
        let reason = || format!("{symbol}: {}", own.notes.join("; "));
        (interval.ok_or_else(reason), own.sources)
    }
}

/// By how much more the laminate conducts in the long run than the same material dry at the same voltage.
fn excess_conductance(place: &Place) -> Judged {
    const NONE: Interval = Interval { low: 1.0, high: 1.0 };
    if place.voltage_v().abs() <= WATER_WINDOW_V || place.surroundings().is_dry() {
        return (Ok(NONE), Runs::new(place.input, place.runs()).sources());
    }
    let (here, mut sources) = place.interval("rss_ohm_cm2");
    let dry_places = (0..place.table.surroundings.len())
        .filter(|&surroundings| place.table.surroundings[surroundings].is_dry())
        .map(|surroundings| Place {
            surroundings,
            ..*place
        })
        .filter(|dry| !dry.runs().is_empty());
    let mut reference: Option<Interval> = None;
    for dry in dry_places {
        let (interval, of_dry) = dry.interval("rss_ohm_cm2");
        sources.extend(of_dry);
        if let Ok(interval) = interval {
            reference = Some(reference.map_or(interval, |known| Interval {
                low: known.low.min(interval.low),
                high: known.high.max(interval.high),
            }));
        }
    }
    let reference = reference.ok_or_else(|| {
        "no dry run of this material at this voltage tells what Rₛₛ is without water".to_owned()
    });
    let excess = here.and_then(|here| Ok(reference?.over(here)));
    (excess, sources)
}

/// (R1 || R2)(C1 + C2), s; the two errors are taken to add up, which they do at worst.
fn time_constant(place: &Place) -> Judged {
    let (resistance, mut sources) = place.interval("r_parallel_ohm_cm2");
    let (capacitance, more) = place.interval("c_total_f_per_cm2");
    sources.extend(more);
    (resistance.and_then(|r| Ok(r.times(capacitance?))), sources)
}

/// V0 / R_ss, A cm-2.
fn steady_current(place: &Place) -> Judged {
    let (resistance, sources) = place.interval("rss_ohm_cm2");
    let volts = place.voltage_v().abs();
    let volts = Interval {
        low: volts,
        high: volts,
    };
    (resistance.map(|resistance| volts.over(resistance)), sources)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_given_where_the_interval_allows_one() {
        let word = |low, high| RELAXATION.word(Interval { low, high });
        assert_eq!(word(1e-4, 2.9e-4), "minor");
        assert_eq!(word(0.0, 4e-5), "minor");
        assert_eq!(word(3.1e-4, 9e-4), "moderate");
        assert_eq!(word(1.7e-3, f64::INFINITY), "intense");
        assert_eq!(word(2.5e-4, 3.5e-4), "minor to moderate");
        assert_eq!(word(0.0, f64::INFINITY), "minor to intense");
    }

    #[test]
    fn rules_state_their_numbers() {
        let text = rules().join(" ");
        for number in [
            "0.0003 s⁻¹",
            "39 min",
            "0.001 s⁻¹",
            "12 min",
            "1.23 V",
            "factor 20",
            "50 s",
            "50 µA",
        ] {
            assert!(text.contains(number), "{number}: {text}");
        }
    }
}
