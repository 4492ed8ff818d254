//! Header of an EC-Lab text file: where it ends, what it says, and what the columns mean.

use crate::formats::delimited::header_number;
use crate::text::Line;
use crate::text::header::{Header, Meaning};

/// Settings stand in columns of this width, one for each step of the technique.
const SETTING_WIDTH: usize = 20;
/// Columns with a meaning for a run or a spectrum; the others keep their names, for `P/W` or `E/V` of a log mean other things.
const KNOWN_COLUMNS: [&str; 14] = [
    "control voltage",
    "time",
    "Ewe",
    "<Ewe>",
    "Ecell",
    "<Ecell>",
    "I",
    "<I>",
    "Temperature",
    "freq",
    "Re(Z)",
    "-Im(Z)",
    "|Z|",
    "Phase(Z)",
];

/// Index of the line with the names of the columns: the last of the header lines declared, else the first line
/// that names columns, for exports are cut by hand.
pub fn names_at(lines: &[Line<'_>]) -> Option<usize> {
    let declared = lines.get(1).and_then(|line| {
        let count = line.text.strip_prefix("Nb header lines :")?;
        count.trim().parse::<usize>().ok()?.checked_sub(1)
    });
    let is_names = |line: &&Line<'_>| names_columns(line.text);
    match declared.filter(|at| lines.get(*at).as_ref().is_some_and(is_names)) {
        Some(at) => Some(at),
        None => lines.iter().position(|line| names_columns(line.text)),
    }
}

/// Whether a line names columns of EC-Lab.
pub fn names_columns(text: &str) -> bool {
    let mut cells = text.split('\t').map(str::trim);
    let has_several = text.contains('\t');
    has_several && cells.any(|cell| matches!(cell, "time/s" | "freq/Hz" | "Ewe/V" | "<Ewe>/V" | "Ecell/V"))
}

/// Columns named by a line, which may end in a tab.
pub fn headers(line: &str) -> Vec<Header> {
    let line = line.strip_suffix('\t').unwrap_or(line);
    line.split('\t').map(header).collect()
}

fn header(cell: &str) -> Header {
    let cell = cell.trim();
    // A degree sign that an editor has lost stands before C only.
    let mut spelled = cell.replace("\u{fffd}C", "°C");
    // Some versions put the unit of a mean inside its brackets: `<Ewe/V>`.
    if let Some((name, unit)) = spelled.strip_suffix('>').and_then(|inner| inner.rsplit_once('/')) {
        spelled = format!("{name}>/{unit}");
    }
    let (name, unit) = match spelled.as_str() {
        "ox/red" => ("ox/red", ""),
        _ => spelled.rsplit_once('/').unwrap_or((&spelled, "")),
    };
    // Of the control, `control/V` is a voltage; `control/mA` and `control/V/mA` are no drive of a strip, or not always.
    let meant = match (name, unit) {
        ("control", "V" | "mV") => "control voltage",
        _ => name,
    };
    let header = Header::with_unit(meant, unit);
    Header {
        raw_name: cell.to_owned(),
        meaning: if KNOWN_COLUMNS.contains(&meant) {
            header.meaning
        } else {
            Meaning::Other
        },
        ..header
    }
}

/// The settings before the names: `Key : value` and lines of the settings table.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Settings<'a> {
    /// Name of the technique.
    pub technique: Option<&'a str>,
    /// Keys and values in the file's order.
    pub pairs: Vec<(&'a str, &'a str)>,
}

impl<'a> Settings<'a> {
    /// Reads the lines of the header behind the magic and the number of lines.
    pub fn of(lines: &[Line<'a>]) -> Settings<'a> {
        let is_magic = |text: &str| text.ends_with("ASCII FILE") || text.starts_with("Nb header lines");
        let mut settings = Settings::default();
        for line in lines {
            let text = line.text.trim();
            if text.is_empty() || is_magic(text) {
                continue;
            }
            let pair = text.split_once(" : ").or(text.split_once(" :"));
            if pair.is_none() && settings.technique.is_none() && settings.pairs.is_empty() {
                settings.technique = Some(text);
                continue;
            }
            let (key, value) = pair.or_else(|| table_row(line.text)).unwrap_or((text, ""));
            settings.pairs.push((key.trim(), value.trim()));
        }
        settings
    }

    /// Value of a key.
    pub fn value(&self, key: &str) -> Option<&'a str> {
        self.pairs
            .iter()
            .find(|(name, _)| *name == key)
            .map(|(_, value)| *value)
    }

    /// Potentials of the steps, V, each with what it is relative to.
    pub fn potentials(&self) -> Vec<(f64, &'a str)> {
        let steps = |key| -> Vec<&'a str> { self.value(key).unwrap_or("").split_whitespace().collect() };
        let (levels, references) = (steps("Ei (V)"), steps("vs."));
        let levels = levels.iter().map_while(|level| header_number(level));
        levels.zip(references).collect()
    }
}

fn table_row(text: &str) -> Option<(&str, &str)> {
    (text.len() > SETTING_WIDTH && text.is_char_boundary(SETTING_WIDTH)).then(|| text.split_at(SETTING_WIDTH))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::Lines;
    use ieap_domain::Quantity;

    #[test]
    fn settings_of_a_chronoamperometry() {
        let text = "EC-Lab ASCII FILE\nNb header lines : 9\n\nChronoamperometry / Chronocoulometry\n\nDevice : SP-150 (SN 1)\n\
                    Ei (V)              1,500               -1,500              \n\
                    vs.                 Ref                 Emeas               \nmode\ttime/s\tEwe/V\t\n";
        let lines: Vec<_> = Lines::new(text).collect();
        assert_eq!(names_at(&lines), Some(8));
        let settings = Settings::of(&lines[..8]);
        assert_eq!(settings.technique, Some("Chronoamperometry / Chronocoulometry"));
        assert_eq!(settings.value("Device"), Some("SP-150 (SN 1)"));
        assert_eq!(settings.potentials(), [(1.5, "Ref"), (-1.5, "Emeas")]);
    }

    #[test]
    fn columns_keep_their_names_and_few_have_a_meaning() {
        let headers = headers(
            "mode\ttime/s\t<I/mA>\tcontrol/V\tcontrol/V/mA\tcontrol/mA\tP/W\tTemperature/\u{fffd}C\tQ charge/discharge/mA.h\t",
        );
        let shown: Vec<_> = headers
            .iter()
            .map(|h| (h.raw_unit.as_str(), h.meaning.quantity()))
            .collect();
        assert_eq!(
            shown,
            [
                ("", None),
                ("s", Some(Quantity::Time)),
                ("mA", Some(Quantity::Current)),
                ("V", Some(Quantity::ControlVoltage)),
                ("mA", None),
                ("mA", None),
                ("W", None),
                ("°C", Some(Quantity::Temperature)),
                ("mA.h", None)
            ]
        );
    }
}
