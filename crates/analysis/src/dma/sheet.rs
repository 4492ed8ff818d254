//! The tables of modulus logs.

use ieap_domain::modulus::step_keys;
use ieap_domain::number::{fixed, plain};
use ieap_domain::{Estimate, ModulusAnalysis, ModulusStep};
use ieap_show::quantities::{Quantity, SAMPLE};
use ieap_show::{Sheet, Table, Value};

/// Minutes of seconds.
pub const PER_MINUTE: f64 = 1.0 / 60.0;

const HUMIDITY: Quantity = Quantity::plain("humidity", "Humidity", "relative humidity before and after");
const WHEN: Quantity = Quantity::new("when", "When", "from the step to the next one", "min");
const RECOVERY: Quantity = Quantity::new(
    "recovery_percent",
    "Recovery",
    "part of the change that the way back has undone",
    "%",
);
const NUMBER: Quantity = Quantity::plain("number", "Number", "number of the log as a whole");
const PERCENT: Quantity = Quantity::new("value_percent", "Value", "value", "%");

/// The numbers of a humidity step.
pub const STEP: [Quantity; 9] = [
    Quantity::new(
        step_keys::HUMIDITY_BEFORE,
        "RH before",
        "relative humidity before the step",
        "%",
    ),
    Quantity::new(
        step_keys::HUMIDITY_AFTER,
        "RH after",
        "relative humidity after the step",
        "%",
    ),
    Quantity::new(
        step_keys::MODULUS_BEFORE,
        "|E*| before",
        "complex modulus when the step begins",
        "MPa",
    ),
    Quantity::new(
        step_keys::MODULUS_AFTER,
        "|E*| after",
        "complex modulus at the end of the stretch after the step",
        "MPa",
    ),
    Quantity::new(
        step_keys::RELATIVE_CHANGE,
        "Δ|E*|",
        "change relative to the value before, negative where it falls",
        "%",
    ),
    Quantity::new(
        step_keys::EQUILIBRIUM_TIME,
        "Equilibrium time",
        "time until the modulus stays within 5 % of its change from equilibrium",
        "s",
    )
    .shown_in("min", PER_MINUTE),
    Quantity::new(
        step_keys::MODULUS_EQUILIBRIUM,
        "|E*| in equilibrium",
        "complex modulus in equilibrium, from the fitted relaxation",
        "MPa",
    ),
    Quantity::plain(
        step_keys::LOSS_FACTOR_BEFORE,
        "tan δ before",
        "loss factor when the step begins",
    ),
    Quantity::plain(
        step_keys::LOSS_FACTOR_AFTER,
        "tan δ after",
        "loss factor at the end of the stretch after the step",
    ),
];

/// The first humidity step of each log.
pub fn first_steps<'a>(logs: impl Iterator<Item = (&'a str, &'a ModulusAnalysis)>) -> Table {
    type First<'a> = (&'a str, &'a ModulusAnalysis, &'a ModulusStep);
    let sheet = Sheet::<First>::new("first-steps", "The first humidity step of each log", 2)
        .remarks(
            "Equilibrium is reached within 5 % of the change. dma.csv of the report has every step.",
            "",
        )
        .column(SAMPLE, |(name, ..)| *name)
        .column(HUMIDITY, |(.., step)| humidity(step))
        .columns(&STEP[2..6], |(.., step), of| {
            step.estimate(of.key).map(Value::from)
        })
        .column(RECOVERY, |(_, found, _)| found.recovery().map(Value::from));
    sheet.over(logs.filter_map(|(name, found)| Some((name, found, found.steps.first()?))))
}

/// Every humidity step of a log.
pub fn steps(found: &ModulusAnalysis) -> Table {
    let minutes = |seconds: f64| plain((10.0 * seconds * PER_MINUTE).round() / 10.0);
    Sheet::<&ModulusStep>::new("steps", "Humidity steps", 1)
        .column(HUMIDITY, |step| humidity(step))
        .column(WHEN, |step| {
            format!("{} to {}", minutes(step.start_s), minutes(step.end_s))
        })
        .columns(&STEP[2..], |step, of| step.estimate(of.key).map(Value::from))
        .over(&found.steps)
}

/// What the way back says beside the way out; no row where the humidity did not turn back.
pub fn round_trip(found: &ModulusAnalysis) -> Table {
    let recovery = found.recovery().map(|own| {
        (
            "Recovery of the change at the end of the way back".to_owned(),
            own,
        )
    });
    let hysteresis = found.hysteresis().into_iter().map(|(humidity_percent, own)| {
        let at = humidity_percent.map(|percent| format!(" at {} %\u{a0}RH", fixed(percent, 0)));
        let name = "|E*| on the way back against the way out".to_owned() + &at.unwrap_or_default();
        (name, own)
    });
    Sheet::<(String, &Estimate)>::new("round-trip", "Way out and back", 1)
        .column(NUMBER, |(name, _)| name.clone())
        .column(PERCENT, |(_, own)| Value::from(*own))
        .over(recovery.into_iter().chain(hysteresis))
}

/// `0 to 40 % RH`
pub fn humidity(step: &ModulusStep) -> String {
    let percent = |key| {
        let value = step.estimate(key).and_then(|estimate| estimate.value);
        value.map_or("?".to_owned(), |value| fixed(value, 0))
    };
    format!(
        "{} to {}\u{a0}%\u{a0}RH",
        percent(step_keys::HUMIDITY_BEFORE),
        percent(step_keys::HUMIDITY_AFTER)
    )
}
