//! Units as laboratories write them.

use crate::truth::Meaning;

/// A unit: a number `w` of it is `(w - zero) * scale` in the canonical unit.
#[derive(Debug, Clone, Copy)]
pub struct Unit {
    /// How it is written.
    pub texts: &'static [&'static str],
    /// How it is written at the end of `name_unit`.
    pub snake: &'static str,
    /// How Russians write it.
    pub cyrillic: &'static str,
    /// Canonical units in it.
    pub scale: f64,
    /// Where the canonical zero stands.
    pub zero: f64,
}

const fn unit(
    texts: &'static [&'static str],
    snake: &'static str,
    cyrillic: &'static str,
    scale: f64,
) -> Unit {
    Unit {
        texts,
        snake,
        cyrillic,
        scale,
        zero: 0.0,
    }
}

const CELSIUS: Unit = unit(&["°C", "°C", "C", "degC", "℃", "*C"], "c", "°С", 1.0);
const FAHRENHEIT: Unit = Unit {
    texts: &["°F", "F", "degF"],
    snake: "f",
    cyrillic: "°F",
    scale: 1.0 / 1.8,
    zero: 32.0,
};
const KELVIN: Unit = Unit {
    texts: &["K"],
    snake: "k",
    cyrillic: "К",
    scale: 1.0,
    zero: 273.15,
};

/// Units of what a column holds, the common ones more often.
pub fn units(meaning: Meaning) -> &'static [(u32, Unit)] {
    match meaning {
        Meaning::Voltage => {
            const {
                &[
                    (3, unit(&["V"], "v", "В", 1.0)),
                    (1, unit(&["mV"], "mv", "мВ", 1e-3)),
                ]
            }
        }
        Meaning::Current => {
            const {
                &[
                    (3, unit(&["A"], "a", "А", 1.0)),
                    (3, unit(&["mA"], "ma", "мА", 1e-3)),
                    (3, unit(&["uA", "µA", "μA"], "ua", "мкА", 1e-6)),
                    (1, unit(&["nA"], "na", "нА", 1e-9)),
                ]
            }
        }
        Meaning::Curvature => {
            const {
                &[
                    (1, unit(&["1/cm", "cm^-1", "cm-1", "cm⁻¹"], "per_cm", "1/см", 1.0)),
                    (1, unit(&["1/m", "m^-1", "m-1", "m⁻¹"], "per_m", "1/м", 1e-2)),
                ]
            }
        }
        Meaning::TipDisplacement => {
            const {
                &[
                    (2, unit(&["mm"], "mm", "мм", 1.0)),
                    (1, unit(&["um", "µm", "μm"], "um", "мкм", 1e-3)),
                ]
            }
        }
        Meaning::Humidity => const { &[(1, unit(&["%", "%RH", "% RH", "%rh"], "percent", "%", 1.0))] },
        Meaning::Temperature | Meaning::DewPoint => const { &[(6, CELSIUS), (1, FAHRENHEIT), (1, KELVIN)] },
        Meaning::Pressure => {
            const {
                &[
                    (3, unit(&["hPa", "mbar"], "hpa", "гПа", 100.0)),
                    (1, unit(&["kPa"], "kpa", "кПа", 1000.0)),
                    (1, unit(&["Pa"], "pa", "Па", 1.0)),
                ]
            }
        }
        Meaning::Constant | Meaning::Remark => const { &[(1, unit(&[""], "", "", 1.0))] },
    }
}

/// Humidity as a fraction of one.
pub const FRACTION: Unit = unit(&[""], "", "", 100.0);

/// Units of elapsed time, in s.
pub const TIMES: [(u32, Unit); 5] = [
    (6, unit(&["s", "s", "sec"], "s", "с", 1.0)),
    (2, unit(&["ms"], "ms", "мс", 1e-3)),
    (1, unit(&["us", "µs", "μs"], "us", "мкс", 1e-6)),
    (1, unit(&["min"], "min", "мин", 60.0)),
    (1, unit(&["h"], "h", "ч", 3600.0)),
];
