//! A drive in words.

use ieap_domain::number::fixed;
use ieap_domain::number::seconds::seconds;
use ieap_domain::{Drive, Level};

/// A drive in words, for one who sets it: `hold 2.00 V for 600 s, then 0.00 V for 300 s`. The first word keeps
/// spreadsheets from taking a negative voltage for a formula.
pub fn drive(drive: &Drive, duration_s: f64) -> String {
    const SHOWN: usize = 4;
    if drive.moves() {
        let nominal_v = drive.nominal_step_v();
        return format!(
            "the moving voltage of up to {} V for {} s again",
            fixed(nominal_v, 2),
            seconds(duration_s)
        );
    }
    let starts = drive.segments.iter().map(|segment| segment.start_s());
    let ends = starts.skip(1).chain([duration_s]);
    let segments = drive.segments.iter().zip(ends).take(SHOWN);
    let parts: Vec<String> = segments
        .map(|(segment, end)| {
            let level = match segment.level {
                Level::Voltage(volts) => format!("{} V", fixed(volts, 2)),
                Level::OpenCircuit => "open circuit".to_owned(),
            };
            format!("{level} for {} s", seconds(end - segment.start_s()))
        })
        .collect();
    let more = if drive.segments.len() > SHOWN {
        format!(", and so on for {} s", seconds(duration_s))
    } else {
        String::new()
    };
    format!("hold {}{more}", parts.join(", then "))
}
