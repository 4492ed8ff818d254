//! Axes: which range is shown, where ticks stand and what they say.

use ieap_domain::number::{Prefix, decimal_exponent, fixed, si_prefix, significant, superscript};
use ieap_domain::range_of;

/// How numbers become positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// Proportional.
    Linear,
    /// Proportional to the logarithm; numbers must be positive.
    Log,
    /// Proportional, of seconds since 1970 UTC.
    Calendar,
    /// Places of names: a position is no number.
    Names,
    /// Time about a step, which is at 0: see [`Axis::about_step`].
    AboutStep {
        /// Time after the step from which on the scale is logarithmic, s.
        unit_s: f64,
        /// Positions per second before the step.
        before: f64,
    },
}

impl Scale {
    /// Position of a number.
    fn position(self, number: f64) -> f64 {
        match self {
            Scale::Linear | Scale::Calendar | Scale::Names => number,
            Scale::Log => number.log10(),
            Scale::AboutStep { before, .. } if number < 0.0 => before * number,
            Scale::AboutStep { unit_s, .. } => (number / unit_s).ln_1p() / std::f64::consts::LN_10,
        }
    }
}

/// Shortest time that an axis about a step resolves, as a part of the longest: a number of 64 bits tells no more apart.
const SHORTEST_UNIT: f64 = 1e-15;

/// Room of what precedes a step, as a share of the room after it.
const STRIP_BEFORE: f64 = 0.07;

/// A mark on an axis: its position on the scale and its text (empty for a minor tick).
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Position on the scale (the logarithm on a log axis).
    pub at: f64,
    /// Text beside it.
    pub label: String,
}

/// One axis of a panel. Positions are on the scale: logarithms on a log axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// How numbers become positions.
    pub scale: Scale,
    /// Smallest position shown.
    pub low: f64,
    /// Largest position shown.
    pub high: f64,
    /// Ticks, rising.
    pub ticks: Vec<Tick>,
    /// Quantity with its unit.
    pub title: String,
    /// Number as the title's unit shows it, over the number of a position; on a log axis both are the same.
    pub shown_factor: f64,
}

impl Axis {
    /// A linear axis over `low..=high`, with an SI prefix before `unit` where that takes one, else a power of ten where ticks
    /// would be rows of zeros.
    pub fn linear(low: f64, high: f64, quantity: &str, unit: &str, wanted_ticks: usize) -> Axis {
        let (low, high) = widened(low, high);
        let (base, per_base) = unprefixed(unit);
        let largest = low.abs().max(high.abs());
        let (prefix, unit) = match base {
            "" => (si_prefix(1.0), String::new()),
            "s" if largest < 10_000.0 => (si_prefix(1.0), base.to_owned()),
            base if takes_prefix(base) => {
                let prefix = si_prefix(largest * per_base);
                let factor = prefix.factor * per_base;
                (Prefix { factor, ..prefix }, format!("{}{base}", prefix.symbol))
            }
            base => {
                let (factor, unit) = scaled_unit(largest, base);
                (Prefix { factor, symbol: "" }, unit)
            }
        };
        let step = tick_step((high - low) * prefix.factor, wanted_ticks);
        Axis {
            scale: Scale::Linear,
            low,
            high,
            ticks: linear_ticks(low, high, step, prefix),
            title: titled(quantity, &unit),
            shown_factor: prefix.factor,
        }
    }

    /// A linear axis whose ends are ticks; it includes `low..=high`. The unit is printed as it is, unless the numbers are so
    /// small or so large that ticks would be rows of zeros: then it takes a prefix or a power of ten.
    pub fn linear_rounded(low: f64, high: f64, quantity: &str, unit: &str, wanted_ticks: usize) -> Axis {
        let (low, high) = widened(low, high);
        let step = tick_step(high - low, wanted_ticks);
        let (low, high) = ((low / step).floor() * step, (high / step).ceil() * step);
        let (factor, unit) = scaled_unit(low.abs().max(high.abs()), unit);
        let shown = Prefix { factor, symbol: "" };
        Axis {
            scale: Scale::Linear,
            low,
            high,
            ticks: linear_ticks(low, high, step * factor, shown),
            title: titled(quantity, &unit),
            shown_factor: factor,
        }
    }

    /// A logarithmic axis over the positive numbers `low..=high`; where an end is not one, the other tells it.
    pub fn log(low: f64, high: f64, quantity: &str, unit: &str) -> Axis {
        let (low, high) = positive(low, high);
        let (low, high) = (low.log10(), high.log10().max(low.log10() + 0.1));
        Axis {
            scale: Scale::Log,
            low,
            high,
            ticks: log_ticks(low, high),
            title: titled(quantity, shown_unit(unit)),
            shown_factor: 1.0,
        }
    }

    /// Names at 0, 1 and so on, the first one lowest or leftmost.
    pub fn names(names: &[String]) -> Axis {
        let tick = |(at, label): (usize, &String)| Tick {
            at: at as f64,
            label: label.clone(),
        };
        Axis {
            scale: Scale::Names,
            low: -0.5,
            high: names.len() as f64 - 0.5,
            ticks: names.iter().enumerate().map(tick).collect(),
            title: String::new(),
            shown_factor: 1.0,
        }
    }

    /// Linear time of a whole run, s, with a little room at its ends.
    pub fn whole(first_s: f64, last_s: f64) -> Axis {
        let margin = 0.015 * (last_s - first_s);
        Axis::linear(first_s - margin, last_s + margin, "Time", "s", 6)
    }

    /// Times about a step at 0, s: up to `unit_s` the scale is nearly linear, then it becomes logarithmic
    /// (log10(1 + t / unit)), so that seconds and hours have equal room; what precedes the step stands linear in a narrow
    /// strip. `first_s` is not after the step, `last_s` after it.
    pub fn about_step(first_s: f64, unit_s: f64, last_s: f64, title: &str) -> Axis {
        let (unit_s, last_s) = positive(unit_s, last_s);
        let unit_s = unit_s.max(SHORTEST_UNIT * last_s);
        // What is shorter than the axis resolves is no time before the step.
        let is_seen = first_s.is_finite() && first_s.abs() >= SHORTEST_UNIT * last_s;
        let first_s = if is_seen { first_s } else { 0.0 };
        let after = Scale::AboutStep { unit_s, before: 0.0 }.position(last_s);
        let before = if first_s < 0.0 {
            STRIP_BEFORE * after / -first_s
        } else {
            0.0
        };
        let scale = Scale::AboutStep { unit_s, before };
        let zero = Tick {
            at: 0.0,
            label: "0".to_owned(),
        };
        // A decade's tick stands clear of the one of the step.
        let lowest = (2.0 * unit_s).log10();
        let later = log_ticks(lowest, last_s.log10().max(lowest)).into_iter();
        let margin = 0.012 * after;
        Axis {
            scale,
            low: scale.position(first_s) - margin,
            high: after + margin,
            ticks: [zero]
                .into_iter()
                .chain(later.map(|tick| Tick {
                    at: scale.position(10f64.powf(tick.at)),
                    ..tick
                }))
                .collect(),
            title: titled(title, "s"),
            shown_factor: 1.0,
        }
    }

    /// Position of a number on the scale.
    pub fn position(&self, number: f64) -> f64 {
        self.scale.position(number)
    }

    /// Whether a number can be shown: finite, positive on a log axis, within the range.
    pub fn shows(&self, number: f64) -> bool {
        let margin = 1e-9 * (self.high - self.low);
        (self.low - margin..=self.high + margin).contains(&self.position(number))
    }

    /// On which side of it a number lies: -1 below, 1 above. What has no place on a logarithmic axis lies below.
    pub fn way(&self, number: f64) -> i32 {
        match self.shows(number) {
            true => 0,
            false if self.position(number) > self.high => 1,
            false => -1,
        }
    }

    /// Position of a number, brought to the ends of the axis.
    pub fn inside(&self, number: f64) -> f64 {
        match self.way(number) {
            0 => self.position(number),
            1 => self.high,
            _ => self.low,
        }
    }
}

/// Units with a prefix of their own, with the unit below it and how much of that each is.
const PREFIXED: [(&str, &str, f64); 3] = [("mm", "m", 1e-3), ("mN", "N", 1e-3), ("MPa", "Pa", 1e6)];

/// The unit without its prefix, and how much of that it is: a second prefix before the first would be no unit.
fn unprefixed(unit: &str) -> (&str, f64) {
    let known = PREFIXED.iter().find(|(prefixed, ..)| *prefixed == unit);
    known.map_or((unit, 1.0), |&(_, base, factor)| (base, factor))
}

/// Whether a unit takes a prefix: no percent does, nor a degree.
fn takes_prefix(base: &str) -> bool {
    let first = base.split([' ', '/']).next().unwrap_or_default();
    matches!(
        first,
        "A" | "V" | "F" | "Ω" | "Ohm" | "Hz" | "s" | "m" | "N" | "Pa" | "C"
    )
}

fn titled(quantity: &str, unit: &str) -> String {
    if unit.is_empty() {
        quantity.to_owned()
    } else {
        format!("{quantity} ({unit})")
    }
}

fn shown_unit(unit: &str) -> &str {
    match unit {
        "1/cm" => "cm⁻¹",
        unit => unit,
    }
}

/// Magnitudes whose ticks are short as they are.
const PLAIN: std::ops::Range<f64> = 1e-3..1e5;

/// The factor with which numbers up to `largest` are shown, and the unit then: a prefix where the unit takes one, else a
/// power of ten before it.
fn scaled_unit(largest: f64, unit: &str) -> (f64, String) {
    if largest == 0.0 || PLAIN.contains(&largest) || !(SMALLEST..=LARGEST).contains(&largest) {
        return (1.0, shown_unit(unit).to_owned());
    }
    let base = unit.split(' ').next().unwrap_or_default();
    let prefix = si_prefix(largest);
    if matches!(base, "F" | "Ω" | "A" | "V" | "Hz") && (1.0..1e4).contains(&(largest * prefix.factor)) {
        return (prefix.factor, format!("{}{unit}", prefix.symbol));
    }
    let exponent = decimal_exponent(largest);
    let power = format!("·10{} {}", superscript(exponent), shown_unit(unit));
    (10f64.powi(-exponent), power.trim_end().to_owned())
}

/// Largest magnitude that an axis shows, and the smallest positive number: the ends of what a number of 64 bits can hold,
/// with room for margins, powers of ten and prefixes.
const LARGEST: f64 = 1e290;
const SMALLEST: f64 = 1e-290;
/// A range below this part of its magnitude is a point: ticks in it would need more than nine decimals.
const NARROWEST: f64 = 1e-9;

/// A range that is not empty and in which numbers can be told apart.
fn widened(low: f64, high: f64) -> (f64, f64) {
    if !(low.is_finite() && high.is_finite()) {
        return (0.0, 1.0);
    }
    let (low, high) = (low.min(high), high.max(low));
    let (low, high) = (low.clamp(-LARGEST, LARGEST), high.clamp(-LARGEST, LARGEST));
    let magnitude = low.abs().max(high.abs());
    if high - low > (NARROWEST * magnitude).max(SMALLEST) {
        (low, high)
    } else {
        let half = if magnitude <= SMALLEST {
            1.0
        } else {
            0.1 * magnitude
        };
        (low - half, high + half)
    }
}

/// The ends of a logarithmic range: positive, the first not above the last.
fn positive(low: f64, high: f64) -> (f64, f64) {
    let is_positive = |number: f64| number.is_finite() && number > 0.0;
    let (low, high) = match (is_positive(low), is_positive(high)) {
        (true, true) => (low.min(high), high),
        (true, false) => (low, 10.0 * low),
        (false, true) => (0.1 * high, high),
        (false, false) => (0.1, 1.0),
    };
    (low.clamp(SMALLEST, LARGEST), high.clamp(SMALLEST, LARGEST))
}

/// The step of 1, 2 or 5 times a power of ten that gives at most `wanted` steps.
fn tick_step(span: f64, wanted: usize) -> f64 {
    let rough = span / wanted.max(1) as f64;
    let power = 10f64.powf(rough.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|factor| factor * power >= rough * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// Ticks at multiples of `step` (in the prefixed unit), labelled with the decimals the step needs.
fn linear_ticks(low: f64, high: f64, step: f64, prefix: Prefix) -> Vec<Tick> {
    let label = |number: f64| tick_label(number, step, low.abs().max(high.abs()) * prefix.factor);
    let first = (low * prefix.factor / step - 1e-6).ceil() as i64;
    let last = (high * prefix.factor / step + 1e-6).floor() as i64;
    (first..=last.min(first + 100))
        .map(|multiple| Tick {
            at: multiple as f64 * step / prefix.factor,
            label: label(multiple as f64 * step),
        })
        .collect()
}

/// Decimals from which on, and the number from which on, ticks are written with a power of ten.
const MOST_DECIMALS: i32 = 9;
const LONGEST: f64 = 1e8;

/// The label of a tick of an axis that reaches to `largest`: as many decimals as `step` needs.
fn tick_label(number: f64, step: f64, largest: f64) -> String {
    let place = decimal_exponent(step);
    if number != 0.0 && (place < -MOST_DECIMALS || largest >= LONGEST) {
        return significant(number, decimal_exponent(number.abs()) - place + 1);
    }
    fixed(number, (-place).clamp(0, MOST_DECIMALS) as usize)
}

/// Decades below which evenly spaced numbers look evenly spaced on a log axis.
const NARROW: f64 = 0.6;

/// Decades whose ticks can still be told apart on a panel of some hundred pixels.
const MOST_DECADES: f64 = 100.0;

/// Ticks at powers of ten; within less than two decades also between them.
fn log_ticks(low: f64, high: f64) -> Vec<Tick> {
    let every = (((high - low) / 7.0).ceil() as i32).max(1);
    let decades = high.floor() - low.ceil();
    let factors: &[f64] = match high - low {
        span if span < NARROW => &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
        // Less than two decades may hold one power of ten, which says no scale.
        span if span < 1.7 || decades < 1.0 => &[1.0, 2.0, 5.0],
        _ => &[1.0],
    };
    // One way of writing for the whole axis: plain numbers only where all of them are short.
    let plain = low.floor() >= -3.0 && high <= 4.0;
    let mut ticks = Vec::new();
    // A tick a decade, unless they would blur: then those with a number.
    let has_ticks = |decade: &i32| high - low < MOST_DECADES || decade.rem_euclid(every) == 0;
    for decade in (low.floor() as i32..=high.ceil() as i32).filter(has_ticks) {
        for &factor in factors {
            let at = f64::from(decade) + factor.log10();
            if at >= low - 1e-9 && at <= high + 1e-9 {
                let label = if decade.rem_euclid(every) == 0 {
                    log_label(decade, factor, plain)
                } else {
                    String::new()
                };
                ticks.push(Tick { at, label });
            }
        }
    }
    if ticks.len() < 3 && (NARROWEST..NARROW).contains(&(high - low)) {
        narrow_log_ticks(low, high, plain)
    } else {
        ticks
    }
}

/// Ticks of a log axis that spans too little for whole digits: evenly spaced numbers at their logarithms.
fn narrow_log_ticks(low: f64, high: f64, plain: bool) -> Vec<Tick> {
    let (first, last) = (10f64.powf(low), 10f64.powf(high));
    let step = tick_step(last - first, 4);
    let decade = if plain { 0 } else { low.floor() as i32 };
    let digits = (f64::from(decade) - step.log10()).ceil().max(0.0) as usize;
    let ending = match decade {
        0 => String::new(),
        _ => format!("·10{}", superscript(decade)),
    };
    let tick = |k: i64| {
        let number = k as f64 * step;
        Tick {
            at: number.log10(),
            label: format!("{}{ending}", fixed(number / 10f64.powi(decade), digits)),
        }
    };
    ((first / step).ceil() as i64..=(last / step).floor() as i64)
        .map(tick)
        .collect()
}

fn log_label(decade: i32, factor: f64, plain: bool) -> String {
    match decade {
        _ if plain => fixed(factor * 10f64.powi(decade), (-decade).max(0) as usize),
        0 => fixed(factor, 0),
        _ if factor == 1.0 => format!("10{}", superscript(decade)),
        _ => format!("{}·10{}", fixed(factor, 0), superscript(decade)),
    }
}

/// The least and the greatest of the finite values.
pub fn finite_range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    range_of(values.filter(|value| value.is_finite()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|tick| tick.label.as_str()).collect()
    }

    #[test]
    fn a_log_axis_over_a_fraction_of_a_decade_has_ticks_too() {
        let axis = Axis::log(114.0, 271.0, "R₁", "Ω cm²");
        assert_eq!(labels(&axis), ["150", "200", "250"]);
        let axis = Axis::log(1.21e-4, 1.34e-4, "λ", "s⁻¹");
        assert_eq!(labels(&axis), ["1.3·10⁻⁴", "1.4·10⁻⁴", "1.5·10⁻⁴"]);
        assert!(
            axis.ticks
                .iter()
                .all(|tick| (axis.low..=axis.high).contains(&tick.at))
        );
        assert_eq!(labels(&Axis::log(1.0, 100.0, "a", "")), ["1", "10", "100"]);
        assert_eq!(labels(&Axis::log(1.2, 900.0, "a", "")), ["10", "100"]);
        let axis = Axis::log(1.15e-3, 0.075, "Frequency", "Hz");
        assert_eq!(labels(&axis), ["0.002", "0.005", "0.01", "0.02", "0.05"]);
    }

    #[test]
    fn linear_axis_takes_a_prefix() {
        let axis = Axis::linear(-0.4e-3, 2.1e-3, "Current", "A", 5);
        assert_eq!(axis.title, "Current (mA)");
        assert_eq!(labels(&axis), ["0.0", "0.5", "1.0", "1.5", "2.0"]);
        assert_eq!(Axis::linear(0.0, 40_000.0, "Time", "s", 5).title, "Time (ks)");
        assert_eq!(Axis::linear(0.0, 3600.0, "Time", "s", 5).title, "Time (s)");
    }

    #[test]
    fn a_unit_has_one_prefix() {
        for (largest, unit, title, tick) in [
            (5e-3, "mm", "q (µm)", "5"),
            (2.0, "mm", "q (mm)", "2.0"),
            (3e3, "MPa", "q (GPa)", "3"),
            (0.05, "%", "q (%)", "0.05"),
            (4e-4, "A/cm2", "q (µA/cm2)", "400"),
        ] {
            let axis = Axis::linear(0.0, largest, "q", unit, 5);
            assert_eq!(axis.title, title);
            assert_eq!(
                labels(&axis).last().unwrap().trim_end_matches(".0"),
                tick.trim_end_matches(".0"),
                "{axis:?}"
            );
        }
    }

    #[test]
    fn small_numbers_have_short_ticks() {
        let axis = Axis::linear_rounded(0.0, 1.1e-4, "C₁", "F cm⁻²", 5);
        assert_eq!(axis.title, "C₁ (µF cm⁻²)");
        assert_eq!(labels(&axis), ["0", "50", "100", "150"]);
        assert_eq!(axis.ticks[1].at, 5e-5);
        let axis = Axis::linear_rounded(1.2e-5, 2.8e-5, "λ", "s⁻¹", 4);
        assert_eq!(axis.title, "λ (·10⁻⁵ s⁻¹)");
        assert_eq!(labels(&axis), ["1.0", "1.5", "2.0", "2.5", "3.0"]);
        assert_eq!(
            Axis::linear_rounded(0.0, 0.2, "C₁", "F cm⁻²", 5).title,
            "C₁ (F cm⁻²)"
        );
    }

    #[test]
    fn log_axis_labels_decades() {
        assert_eq!(
            labels(&Axis::log(0.1, 1000.0, "Time", "s")),
            ["0.1", "1", "10", "100", "1000"]
        );
        assert_eq!(
            labels(&Axis::log(45.0, 101.0, "R", "")),
            ["50", "60", "70", "80", "90", "100"]
        );
        assert_eq!(
            labels(&Axis::log(4e-5, 2e-3, "λ", "s⁻¹")),
            ["5·10⁻⁵", "10⁻⁴", "2·10⁻⁴", "5·10⁻⁴", "10⁻³", "2·10⁻³"]
        );
        assert!(
            labels(&Axis::log(1e-9, 1e9, "x", ""))
                .iter()
                .filter(|label| !label.is_empty())
                .count()
                <= 8
        );
    }

    /// Any number of 64 bits, those that are no numbers too.
    fn any_number() -> impl Strategy<Value = f64> {
        prop_oneof![
            any::<f64>(),
            prop::sample::select(vec![
                0.0,
                1e308,
                -1e308,
                5e-324,
                f64::MAX,
                f64::INFINITY,
                f64::NAN
            ])
        ]
    }

    proptest! {
        #[test]
        fn any_two_numbers_make_an_axis(low in any_number(), high in any_number(), unit_s in any_number()) {
            let axes = [
                Axis::linear(low, high, "q", "A", 5),
                Axis::linear(low, high, "q", "", 5),
                Axis::linear_rounded(low, high, "q", "", 5),
                Axis::log(low, high, "q", ""),
                Axis::whole(low, high),
                Axis::about_step(low.min(0.0), unit_s, high, "t"),
            ];
            for axis in axes {
                prop_assert!(axis.low.is_finite() && axis.high.is_finite(), "{axis:?}");
                prop_assert!(axis.ticks.len() <= 110, "{axis:?}");
                prop_assert!(axis.ticks.iter().all(|tick| tick.label.chars().count() < 40), "{axis:?}");
            }
        }

        #[test]
        fn numbers_that_nearly_agree_make_an_axis(number in any_number(), bits in 0u64..3) {
            let next = f64::from_bits(number.to_bits().saturating_add(bits));
            for axis in [Axis::linear(number, next, "q", "A", 5), Axis::log(number, next, "q", "")] {
                prop_assert!(axis.low < axis.high, "{axis:?}");
            }
        }

        #[test]
        fn any_range_gets_a_few_rising_ticks(low in -1e9..1e9f64, span in 1e-9..1e9f64, wanted in 2usize..9) {
            let axis = Axis::linear(low, low + span, "q", "A", wanted);
            prop_assert!(axis.ticks.len() <= wanted + 2);
            prop_assert!(axis.ticks.windows(2).all(|pair| pair[0].at < pair[1].at));
        }
    }
}
