//! Names of columns in the languages that laboratories write: the one table of synonyms.
//!
//! In small letters, blanks for `_` and `-`. A name that is not here is a column of its own; a profile or `[names]` in
//! campaign.toml says what it is.

use ieap_domain::Quantity;

/// What PalmSens writes before the name of a negated column.
pub(super) const NEGATED: &str = "neg. ";

/// Names with the quantities that they may stand for, the likeliest first: English, German, French, Spanish, Italian,
/// Portuguese, Estonian, Russian, Japanese, Chinese.
const NAMES: [(&[Quantity], &[&str]); 24] = [
    (&[Quantity::Time, Quantity::Temperature], &["t"]),
    (
        &[Quantity::Time],
        &[
            "time",
            "test time",
            "elapsed time",
            "time elapsed",
            "corrected time",
            "total time",
            "run time",
            "epoch time",
            "elapsed",
            "zeit",
            "messzeit",
            "laufzeit",
            "versuchszeit",
            "temps",
            "temps \u{e9}coul\u{e9}",
            "tiempo",
            "tiempo transcurrido",
            "tempo",
            "tempo trascorso",
            "tempo decorrido",
            "aeg",
            "\u{432}\u{440}\u{435}\u{43c}\u{44f}",
            "\u{6642}\u{9593}",
            "\u{7d4c}\u{904e}\u{6642}\u{9593}",
            "\u{65f6}\u{95f4}",
            "x axis",
        ],
    ),
    (
        &[Quantity::Voltage],
        &[
            "voltage",
            "v",
            "u",
            "e",
            "potential",
            "we(1).potential",
            "cell voltage",
            "cell potential",
            "working electrode",
            "ewe",
            "ecell",
            "vf",
            "spannung",
            "zellspannung",
            "potenzial",
            "tension",
            "potentiel",
            "voltaje",
            "tensi\u{f3}n",
            "potencial",
            "tensione",
            "potenziale",
            "tens\u{e3}o",
            "pinge",
            "\u{43d}\u{430}\u{43f}\u{440}\u{44f}\u{436}\u{435}\u{43d}\u{438}\u{435}",
            "\u{96fb}\u{5727}",
            "\u{96fb}\u{4f4d}",
            "\u{7535}\u{538b}",
            "\u{7535}\u{4f4d}",
        ],
    ),
    (
        &[Quantity::Current, Quantity::CurrentDensity],
        &[
            "current",
            "i",
            "im",
            "we(1).current",
            "cell current",
            "strom",
            "stromst\u{e4}rke",
            "stromstaerke",
            "zellstrom",
            "courant",
            "intensit\u{e9}",
            "corriente",
            "intensidad",
            "corrente",
            "vool",
            "voolutugevus",
            "\u{442}\u{43e}\u{43a}",
            "\u{441}\u{438}\u{43b}\u{430} \u{442}\u{43e}\u{43a}\u{430}",
            "\u{96fb}\u{6d41}",
            "\u{7535}\u{6d41}",
        ],
    ),
    (
        &[Quantity::CurrentDensity],
        &["current density", "j", "stromdichte", "densit\u{e9} de courant"],
    ),
    (
        &[Quantity::Curvature],
        &[
            "curvature",
            "bending curvature",
            "kappa",
            "\u{3ba}",
            "kr\u{fc}mmung",
            "kruemmung",
            "courbure",
            "curvatura",
            "k\u{f5}verus",
            "\u{43a}\u{440}\u{438}\u{432}\u{438}\u{437}\u{43d}\u{430}",
            "\u{66f2}\u{7387}",
        ],
    ),
    (
        &[Quantity::TipDisplacement],
        &[
            "displacement",
            "tip displacement",
            "deflection",
            "tip deflection",
            "auslenkung",
            "durchbiegung",
            "verschiebung",
            "d\u{e9}placement",
            "fl\u{e8}che",
            "desplazamiento",
            "spostamento",
            "deslocamento",
            "siire",
            "\u{441}\u{43c}\u{435}\u{449}\u{435}\u{43d}\u{438}\u{435}",
            "\u{43f}\u{435}\u{440}\u{435}\u{43c}\u{435}\u{449}\u{435}\u{43d}\u{438}\u{435}",
            "\u{5909}\u{4f4d}",
            "\u{4f4d}\u{79fb}",
        ],
    ),
    (
        &[Quantity::BlockingForce],
        &[
            "blocking force",
            "force",
            "blocked force",
            "kraft",
            "blockierkraft",
        ],
    ),
    (&[Quantity::OpenCircuit], &["open circuit"]),
    (
        &[Quantity::Temperature],
        &[
            "temperature",
            "temp",
            "temp.",
            "ambient temperature",
            "air temperature",
            "temperatur",
            "lufttemperatur",
            "temp\u{e9}rature",
            "temperatura",
            "temperatuur",
            "\u{442}\u{435}\u{43c}\u{43f}\u{435}\u{440}\u{430}\u{442}\u{443}\u{440}\u{430}",
            "\u{6e29}\u{5ea6}",
        ],
    ),
    (
        &[Quantity::RelativeHumidity],
        &[
            "relative humidity",
            "rel. humidity",
            "humidity",
            "rh",
            "r.h.",
            "feuchte",
            "luftfeuchte",
            "luftfeuchtigkeit",
            "relative feuchte",
            "relative luftfeuchte",
            "rel. feuchte",
            "rel. luftfeuchte",
            "r.f.",
            "rf",
            "humidit\u{e9}",
            "humidite",
            "humidit\u{e9} relative",
            "hr",
            "humedad",
            "humedad relativa",
            "umidit\u{e0}",
            "umidit\u{e0} relativa",
            "ur",
            "umidade",
            "umidade relativa",
            "niiskus",
            "suhteline niiskus",
            "\u{f5}huniiskus",
            "\u{432}\u{43b}\u{430}\u{436}\u{43d}\u{43e}\u{441}\u{442}\u{44c}",
            "\u{43e}\u{442}\u{43d}\u{43e}\u{441}\u{438}\u{442}\u{435}\u{43b}\u{44c}\u{43d}\u{430}\u{44f} \u{432}\u{43b}\u{430}\u{436}\u{43d}\u{43e}\u{441}\u{442}\u{44c}",
            "\u{6e7f}\u{5ea6}",
            "\u{76f8}\u{5bfe}\u{6e7f}\u{5ea6}",
            "\u{76f8}\u{5bf9}\u{6e7f}\u{5ea6}",
        ],
    ),
    (
        &[Quantity::Pressure],
        &[
            "pressure",
            "p",
            "ambient pressure",
            "air pressure",
            "druck",
            "luftdruck",
            "pression",
            "presi\u{f3}n",
            "pressione",
            "press\u{e3}o",
            "r\u{f5}hk",
            "\u{f5}hur\u{f5}hk",
            "\u{434}\u{430}\u{432}\u{43b}\u{435}\u{43d}\u{438}\u{435}",
            "\u{6c17}\u{5727}",
            "\u{6c14}\u{538b}",
        ],
    ),
    (&[Quantity::Oxygen], &["oxygen", "o2"]),
    (&[Quantity::Water], &["water", "h2o", "moisture"]),
    (
        &[Quantity::StorageModulus],
        &["storage modulus", "e'", "e\u{2032}", "speichermodul"],
    ),
    (
        &[Quantity::LossModulus],
        &["loss modulus", "e''", "e\"", "e\u{2033}", "verlustmodul"],
    ),
    (&[Quantity::ComplexModulus], &["complex modulus", "|e*|", "e*"]),
    (
        &[Quantity::LossFactor],
        &[
            "loss factor",
            "tan delta",
            "tan(delta)",
            "tan \u{3b4}",
            "tan(\u{3b4})",
            "verlustfaktor",
        ],
    ),
    (&[Quantity::Frequency], &["frequency", "frequenz", "freq", "f"]),
    (
        &[Quantity::ImpedanceReal],
        &[
            "impedance real",
            "z'",
            "z\u{2032}",
            "re(z)",
            "zre",
            "zreal",
            "z real",
            "z re",
        ],
    ),
    (
        &[Quantity::ImpedanceImaginary],
        &[
            "impedance imaginary",
            "z''",
            "z\"",
            "z\u{2033}",
            "im(z)",
            "zim",
            "zimag",
            "z imag",
            "z im",
            "z imaginary",
        ],
    ),
    (
        &[Quantity::ImpedanceMagnitude],
        &["impedance magnitude", "|z|", "zmod", "z"],
    ),
    (
        &[Quantity::ImpedancePhase],
        &["impedance phase", "phase(z)", "zphz", "phase"],
    ),
    // What a source was told to apply.
    (
        &[Quantity::ControlVoltage],
        &[
            "control voltage",
            "control potential",
            "applied voltage",
            "applied potential",
            "potential applied",
            "e applied",
            "set voltage",
            "set potential",
            "voltage setpoint",
            "potential setpoint",
            "setpoint voltage",
            "command voltage",
            "commanded voltage",
        ],
    ),
];

/// Every known name of a column.
pub(super) fn known_names() -> impl Iterator<Item = &'static str> {
    NAMES.iter().flat_map(|(_, names)| names.iter().copied())
}

/// Names of one quantity.
pub fn names_of(quantity: Quantity) -> impl Iterator<Item = &'static str> {
    let of_quantity = move |(quantities, _): &&(&[Quantity], &[&str])| quantities[0] == quantity;
    NAMES
        .iter()
        .filter(of_quantity)
        .flat_map(|(_, names)| names.iter().copied())
}

/// `102 <current>` without the number of the input, as data loggers of Keysight name their columns.
fn without_channel(name: &str) -> &str {
    let label = name
        .trim()
        .trim_start_matches(|c: char| c.is_ascii_digit())
        .trim_start();
    if label.starts_with('<') && label.ends_with('>') {
        label
    } else {
        name.trim()
    }
}

/// Quantities that a name may stand for, the likeliest first; none for names that are not known.
pub(super) fn candidates(name: &str) -> &'static [Quantity] {
    let plain: String = without_channel(name)
        .trim_start_matches('<')
        .trim_end_matches('>')
        .chars()
        .map(|c| if matches!(c, '_' | '-') { ' ' } else { c })
        .flat_map(char::to_lowercase)
        .collect();
    // Quotes for primes, doubled where the cell was quoted.
    let plain = plain
        .replace("\"\"", "\"")
        .replace('\u{201d}', "\"")
        .replace('\u{2019}', "'")
        .replace('\u{2212}', "");
    let plain = plain.strip_prefix(NEGATED).unwrap_or(&plain);
    let words: Vec<&str> = plain.split_whitespace().collect();
    let name = words.join(" ");
    let known = NAMES.iter().find(|(_, names)| names.contains(&name.as_str()));
    known.map_or(&[], |(quantities, _)| quantities)
}
