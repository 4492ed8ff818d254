//! The run table and the table of standard errors, as text.

use std::fmt::Write;

use super::{RefusedFrame, ViewSummary};
use crate::domain::number::digits;
use crate::domain::safe_text::one_line;
use crate::domain::words::counted;
use crate::strip::{Bending, Initial};

/// What a frame adds to the tables.
pub struct Row {
    /// The frame's name.
    pub frame: String,
    /// BLAKE3 of its file, hexadecimal.
    pub hash: String,
    /// When it was taken, s.
    pub time_s: f64,
    /// Noise of the edges, pixels.
    pub edge_noise_px: f64,
    /// Bending since the initial shape.
    pub bending: Bending,
}

/// Tables under way.
pub struct Tables {
    statement: String,
    header: String,
    rows: String,
    errors: String,
    hashes: String,
}

impl Tables {
    /// Empty tables for frames of that view.
    pub fn new(initial: &Initial, view: &ViewSummary, frames: usize) -> Tables {
        let mut statement = String::new();
        let lines = [
            format!("traced from {} by ieap {}", counted(frames, "frame"), env!("CARGO_PKG_VERSION")),
            format!("{} strip, clamp at the {}", view.strip, view.clamp),
            format!(
                "scale {} px/mm ({}), free length {} mm",
                digits(view.px_per_mm, 4),
                view.scale_from,
                digits(view.length_mm, 3)
            ),
            format!("bending is counted from {}; positive is {} from the clamp to the tip", view.initial, view.positive),
            "curvature_per_cm is the mean over the length; curvature_per_cm@<mm> is at that distance from the clamp"
                .to_owned(),
            "arc_deviation_mm is the distance (root mean square) of the shape from the nearest arc of a circle".to_owned(),
        ];
        for line in lines {
            let _ = writeln!(statement, "# {line}");
        }
        let at = |name: &str| -> String {
            initial
                .joints_mm
                .iter()
                .map(|mm| format!(",{name}@{}", digits(*mm, 3)))
                .collect()
        };
        Tables {
            statement,
            header: format!(
                "time_s,curvature_per_cm,tip_displacement_mm{},curvature_standard_error_per_cm,tip_displacement_standard_error_mm,arc_deviation_mm,edge_noise_px,bandwidth_mm\n",
                at("curvature_per_cm")
            ),
            rows: String::new(),
            errors: format!("time_s{}\n", at("curvature_standard_error_per_cm")),
            hashes: String::new(),
        }
    }

    /// One more row.
    pub fn add(&mut self, row: &Row) {
        let bending = &row.bending;
        let (mean, tip) = (&bending.mean_per_cm, &bending.tip_displacement_mm);
        let _ = write!(
            self.rows,
            "{},{},{}",
            row.time_s,
            digits(mean.value, 6),
            digits(tip.value, 5)
        );
        let _ = write!(self.errors, "{}", row.time_s);
        for reading in &bending.curvature_per_cm {
            let _ = write!(self.rows, ",{}", digits(reading.value, 6));
            let _ = write!(self.errors, ",{}", digits(reading.standard_error, 6));
        }
        let _ = writeln!(
            self.rows,
            ",{},{},{},{},{}",
            digits(mean.standard_error, 6),
            digits(tip.standard_error, 5),
            digits(bending.arc_deviation_mm, 5),
            digits(row.edge_noise_px, 4),
            digits(bending.bandwidth_mm, 3)
        );
        self.errors.push('\n');
        let _ = writeln!(
            self.hashes,
            "# frame {} blake3 {}",
            one_line(&row.frame),
            row.hash
        );
    }

    /// Both tables; the frames that were refused and the hashes of the others stand as comments behind the rows, for
    /// they may be thousands, and a reader looks for the header near the top.
    pub fn finished(self, refused: &[RefusedFrame]) -> (String, String) {
        let mut table = self.statement.clone();
        table += &self.header;
        table += &self.rows;
        for frame in refused {
            let _ = writeln!(
                table,
                "# refused frame {}, {}",
                one_line(&frame.frame),
                one_line(&frame.reason)
            );
        }
        table += &self.hashes;
        (table, self.statement + &self.errors)
    }
}
