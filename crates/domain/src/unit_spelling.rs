//! Spellings of units in instrument files.

use super::unit::{Conversion, Dimension};

/// One spelling for what files write in several: micro and degree signs, powers, bracketed stars, references.
pub(super) fn normalise(unit: &str) -> String {
    let half = |c: char| match c {
        '\u{ff01}'..='\u{ff5e}' => char::from_u32(c as u32 - 0xfee0).unwrap_or(c),
        c => c,
    };
    let mut text: String = unit.trim().chars().map(half).collect();
    for (from, to) in [
        ("\u{b5}", "u"),
        ("\u{3bc}", "u"),
        ("\u{b0}", "deg"),
        ("\u{ba}", "deg"),
        ("\u{2103}", "degC"),
        ("\u{2109}", "degF"),
        ("\u{207b}\u{b9}", "-1"),
        ("\u{207b}\u{b2}", "-2"),
        ("\u{2212}", "-"),
        ("^", ""),
        ("*", "deg"),
        ("deg ", "deg"),
        ("degrees ", "deg"),
        ("per ", "1/"),
        ("per_", "1/"),
    ] {
        if text.contains(from) {
            text = text.replace(from, to);
        }
    }
    let bare = text.trim_start_matches(['(', '[']).trim_end_matches([')', ']']);
    let bare = match bare.to_ascii_lowercase().find(" vs") {
        Some(reference) => &bare[..reference],
        None => bare,
    };
    let bare: String = bare.chars().filter(|c| !c.is_whitespace()).collect();
    of_word(&bare).map_or(bare, str::to_owned)
}

/// Words and letters for units in the languages of laboratories, in small letters after the signs above, with the spelling that
/// conversions know. One in capitals is meant so: milli and mega differ by it.
const WORDS: [(&str, &str); 28] = [
    (
        "s",
        "sec;secs;second;seconds;sekunde;sekunden;seconde;secondes;segundo;segundos;secondo;secondi;sekundy;sekund;sekundit;с;\
           сек;секунда;секунды;секунд;秒;초",
    ),
    ("ms", "msec;millisecond;milliseconds;millisekunden;мс;ミリ秒;毫秒"),
    ("us", "usec;microsecond;microseconds;мкс"),
    (
        "min",
        "minute;minutes;minuten;minutos;minuti;minuty;minutit;мин;минута;минуты;минут;分;分钟;분",
    ),
    (
        "h",
        "hr;hrs;hour;hours;stunde;stunden;heure;heures;hora;horas;ora;ore;godziny;tund;tundi;ч;час;часы;часов;時間;小时;小時;시간",
    ),
    ("d", "day;days;tag;tage;jour;jours;日;天"),
    ("V", "volt;volts;вольт;в;ボルト;伏;伏特;볼트"),
    ("mV", "millivolt;millivolts;милливольт;мв"),
    (
        "A",
        "amp;amps;ampere;amperes;ampère;ampères;ампер;а;アンペア;安;安培",
    ),
    (
        "mA",
        "milliamp;milliamps;milliampere;milliamperes;milliampère;milliampères;миллиампер;ма;ミリアンペア;毫安",
    ),
    (
        "uA",
        "microamp;microamps;microampere;microamperes;микроампер;мка;微安",
    ),
    ("nA", "nanoamp;nanoamps;nanoampere;nanoamperes;на"),
    (
        "mm",
        "millimeter;millimeters;millimetre;millimetres;миллиметр;мм;ミリメートル;毫米",
    ),
    ("um", "micrometer;micrometers;micrometre;micrometres;мкм;微米"),
    ("1/cm", "1/см"),
    ("1/m", "1/м"),
    (
        "degC",
        "celsius;deg.c;degcelsius;gradcelsius;grad;degs;degс;град;градус;градусы;摄氏度;度",
    ),
    ("K", "kelvin;degk;к"),
    ("degF", "fahrenheit;deg.f;degfahrenheit"),
    (
        "%",
        "percent;pct;prozent;pourcent;pourcentage;porcento;porciento;porcentaje;percento;protsent;procent;процент;проценты;\
           パーセント;百分比;%rh;rh%;%r.h.;%rf;rf%;%r.f.;%rel.f.;%hr;hr%;%h.r.;%ur",
    ),
    ("Pa", "pascal;па"),
    ("hPa", "гпа"),
    ("kPa", "кпа"),
    ("MPa", "МПа;megapascal"),
    ("Hz", "hertz;гц;ヘルツ;赫兹"),
    ("Ohm", "ом;オーム;欧姆"),
    ("mN", "millinewton;мн"),
    ("N", "newton"),
];
/// Fewest letters of a word in which a slip of one letter is seen. Chosen: shorter words are one letter from each other.
const FEWEST_LETTERS_OF_A_SLIP: usize = 6;

/// The spelling of a unit that a word is, where it is one, or one but for a letter.
fn of_word(bare: &str) -> Option<&'static str> {
    let lower = bare.to_lowercase();
    let find = |is: &dyn Fn(&str) -> bool| {
        let unit = WORDS.iter().find(|(_, words)| words.split(';').any(is));
        unit.map(|(unit, _)| *unit)
    };
    let is_long = |word: &str| word.is_ascii() && word.len() >= FEWEST_LETTERS_OF_A_SLIP;
    let is_word = bare.bytes().all(|byte| byte.is_ascii_alphabetic());
    find(&|word| word == bare || word == lower).or_else(|| {
        (is_word && is_long(&lower))
            .then(|| find(&|word| is_long(word) && is_one_letter_off(&lower, word)))?
    })
}

/// Whether one letter is another, more or less.
fn is_one_letter_off(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let same = a.iter().zip(b).take_while(|(x, y)| x == y).count();
    let (a, b) = (&a[same..], &b[same..]);
    match (a, b) {
        ([_, x @ ..], [_, y @ ..]) if x == y => true,
        ([_, x @ ..], y) if x == y => true,
        (x, [_, y @ ..]) => x == y,
        _ => false,
    }
}

/// Conversion of a normalised spelling, where it is a unit of that dimension.
pub(super) fn parse_as(spelled: &str, dimension: Dimension) -> Option<Conversion> {
    let word = spelled.to_ascii_lowercase();
    match dimension {
        Dimension::Time => time(spelled, &word),
        Dimension::Voltage => prefixed(spelled, "V").or_else(|| named(&word, &["vdc"])),
        Dimension::Current => prefixed(spelled, "A").or_else(|| named(&word, &["adc"])),
        Dimension::CurrentDensity => current_density(spelled),
        Dimension::Curvature => curvature(spelled),
        Dimension::Length => length(spelled),
        Dimension::Force => force(spelled),
        Dimension::Temperature => temperature(spelled, &word),
        Dimension::Ratio => named(spelled, &["%"]),
        Dimension::Pressure => pressure(spelled, &word),
        Dimension::GasFraction => match word.as_str() {
            "ppb" | "ppbv" => Some(Conversion::scale(1.0, 1000.0)),
            _ => named(&word, &["ppm", "ppmv", "vpm", "ppm(v)"]),
        },
        Dimension::Modulus => modulus(spelled),
        Dimension::Frequency => frequency(spelled),
        Dimension::Resistance => resistance(spelled, &word),
        Dimension::Angle => angle(&word),
        Dimension::Number => named(spelled, &["", "-", "1"]),
    }
}

fn named(word: &str, names: &[&str]) -> Option<Conversion> {
    names.contains(&word).then_some(Conversion::IDENTITY)
}

/// `symbol` behind an SI prefix that laboratory quantities carry; upper-case prefixes are left out on purpose,
/// for `MA` and `MV` are misspelt milli far more often than mega.
fn prefixed(spelled: &str, symbol: &str) -> Option<Conversion> {
    let denominator = match spelled.strip_suffix(symbol)? {
        "" => 1.0,
        "m" => 1e3,
        "u" => 1e6,
        "n" => 1e9,
        "p" => 1e12,
        "f" => 1e15,
        "k" => return Some(Conversion::scale(1e3, 1.0)),
        _ => return None,
    };
    Some(Conversion::scale(1.0, denominator))
}

/// A current in one of its units over an area: `mA/cm2`, `A/m²`, `uAcm-2`.
fn current_density(spelled: &str) -> Option<Conversion> {
    let plain = spelled.replace('\u{b2}', "2").replace(['\u{b7}', '.'], "");
    let areas = [("cm2", 1.0, 1.0), ("mm2", 100.0, 1.0), ("m2", 1.0, 1e4)];
    let of_area = |(area, numerator, denominator): (&str, f64, f64)| {
        let over = plain.strip_suffix(area).and_then(|rest| rest.strip_suffix('/'));
        let power = area.trim_end_matches('2');
        let times = || plain.strip_suffix("-2")?.strip_suffix(power);
        let per_ampere = match over.or_else(times)? {
            "A" => 1.0,
            "mA" => 1e3,
            "uA" => 1e6,
            "nA" => 1e9,
            _ => return None,
        };
        Some(Conversion::scale(numerator, denominator * per_ampere))
    };
    areas.into_iter().find_map(of_area)
}

fn time(spelled: &str, word: &str) -> Option<Conversion> {
    if let Some(conversion) = prefixed(spelled, "s").filter(|_| spelled != "ks" && spelled != "fs") {
        return Some(conversion);
    }
    Some(match word {
        "min" => Conversion::scale(60.0, 1.0),
        "h" => Conversion::scale(3600.0, 1.0),
        "d" => Conversion::scale(86_400.0, 1.0),
        _ => return None,
    })
}

/// Metres per unit as numerator over denominator.
fn metres(spelled: &str) -> Option<(f64, f64)> {
    Some(match spelled {
        "m" => (1.0, 1.0),
        "dm" => (1.0, 10.0),
        "cm" => (1.0, 1e2),
        "mm" => (1.0, 1e3),
        "um" | "micron" | "microns" => (1.0, 1e6),
        "nm" => (1.0, 1e9),
        _ => return None,
    })
}

fn length(spelled: &str) -> Option<Conversion> {
    let (_, per_metre) = metres(spelled)?;
    Some(if per_metre <= 1e3 {
        Conversion::scale(1e3 / per_metre, 1.0)
    } else {
        Conversion::scale(1.0, per_metre / 1e3)
    })
}

fn curvature(spelled: &str) -> Option<Conversion> {
    let unit = ["1/", "/"]
        .into_iter()
        .find_map(|start| spelled.strip_prefix(start))
        .or_else(|| spelled.strip_suffix("-1"))?;
    let (_, per_metre) = metres(unit)?;
    Some(if per_metre >= 1e2 {
        Conversion::scale(per_metre / 1e2, 1.0)
    } else {
        Conversion::scale(1.0, 1e2 / per_metre)
    })
}

fn force(spelled: &str) -> Option<Conversion> {
    Some(match spelled {
        "kN" => Conversion::scale(1e6, 1.0),
        "N" => Conversion::scale(1e3, 1.0),
        "mN" => Conversion::IDENTITY,
        "uN" => Conversion::scale(1.0, 1e3),
        "nN" => Conversion::scale(1.0, 1e6),
        _ => return None,
    })
}

fn temperature(spelled: &str, word: &str) -> Option<Conversion> {
    Some(match (spelled, word) {
        ("C", _) | (_, "degc") => Conversion::IDENTITY,
        ("K", _) => Conversion::IDENTITY.shifted(0.0, -273.15),
        ("F", _) | (_, "degf") => Conversion::scale(5.0, 9.0).shifted(-32.0, 0.0),
        _ => return None,
    })
}

fn pressure(spelled: &str, word: &str) -> Option<Conversion> {
    let pascals = match spelled {
        "Pa" => 1.0,
        "hPa" => 1e2,
        "kPa" => 1e3,
        "MPa" => 1e6,
        "mPa" => return Some(Conversion::scale(1.0, 1e3)),
        _ => match word {
            "bar" => 1e5,
            "mbar" => 1e2,
            "ubar" => return Some(Conversion::scale(1.0, 10.0)),
            "atm" => 101_325.0,
            "torr" | "mmhg" => return Some(Conversion::scale(101_325.0, 760.0)),
            "mtorr" => return Some(Conversion::scale(101_325.0, 760_000.0)),
            _ => return None,
        },
    };
    Some(Conversion::scale(pascals, 1.0))
}

/// `mPa` is left out: as a modulus it is a misspelt MPa.
fn modulus(spelled: &str) -> Option<Conversion> {
    Some(match spelled {
        "Pa" | "N/m2" | "N/m\u{b2}" => Conversion::scale(1.0, 1e6),
        "kPa" => Conversion::scale(1.0, 1e3),
        "MPa" | "N/mm2" | "N/mm\u{b2}" => Conversion::IDENTITY,
        "GPa" => Conversion::scale(1e3, 1.0),
        _ => return None,
    })
}

fn frequency(spelled: &str) -> Option<Conversion> {
    Some(match spelled {
        "Hz" | "1/s" => Conversion::IDENTITY,
        "mHz" => Conversion::scale(1.0, 1e3),
        "kHz" => Conversion::scale(1e3, 1.0),
        "rad/s" => Conversion::scale(1.0, std::f64::consts::TAU),
        _ => return None,
    })
}

/// `MOhm` is mega: a milliohm is written with a small letter, and no strip has one.
fn resistance(spelled: &str, word: &str) -> Option<Conversion> {
    let rest = ["ohms", "ohm", "\u{3a9}", "\u{2126}"]
        .into_iter()
        .find_map(|name| word.strip_suffix(name))?;
    match rest {
        "" => Some(Conversion::IDENTITY),
        "m" if spelled.starts_with('M') => Some(Conversion::scale(1e6, 1.0)),
        "m" => Some(Conversion::scale(1.0, 1e3)),
        "k" => Some(Conversion::scale(1e3, 1.0)),
        "u" => Some(Conversion::scale(1.0, 1e6)),
        _ => None,
    }
}

fn angle(word: &str) -> Option<Conversion> {
    match word {
        "deg" | "degree" | "degrees" => Some(Conversion::IDENTITY),
        "rad" => Some(Conversion::scale(180.0, std::f64::consts::PI)),
        _ => None,
    }
}

/// The spellings an error offers; every one is accepted (a test sees to it).
pub(super) fn known_units(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::Time => "s, ms, us, min, h, d",
        Dimension::Voltage => "V, mV, uV, kV",
        Dimension::Current => "A, mA, uA, nA, pA",
        Dimension::CurrentDensity => "A/cm2, mA/cm2, uA/cm2, A/m2, mA cm-2",
        Dimension::Curvature => "1/cm, 1/m, 1/mm, cm-1, m^-1, per cm",
        Dimension::Length => "mm, cm, m, um, nm",
        Dimension::Force => "mN, N, uN, nN, kN",
        Dimension::Temperature => "°C, degC, C, K, °F, degF",
        Dimension::Ratio => "%, percent, %RH",
        Dimension::Pressure => "Pa, hPa, kPa, MPa, mbar, bar, atm, Torr",
        Dimension::GasFraction => "ppm, ppmv, vpm, ppb",
        Dimension::Modulus => "MPa, GPa, kPa, Pa, N/mm2",
        Dimension::Frequency => "Hz, mHz, kHz, rad/s",
        Dimension::Resistance => "Ohm, kOhm, MOhm, mOhm, Ω",
        Dimension::Angle => "degree, deg, °, rad",
        Dimension::Number => "1, -",
    }
}
