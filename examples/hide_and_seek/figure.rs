//! The figure of the benchmark: right names against strength, a line for each method.

use std::fmt::Write;

use crate::methods::{METHODS, ORACLE, OURS};

const SIZE: (f64, f64) = (640.0, 400.0);
const LEFT: f64 = 60.0;
const RIGHT: f64 = 400.0;
const TOP: f64 = 20.0;
const BOTTOM: f64 = 350.0;
/// Okabe and Ito's colours, which the colour-blind can tell apart.
const COLOURS: [&str; 8] = [
    "#0072B2", "#56B4E9", "#E69F00", "#D55E00", "#CC79A7", "#009E73", "#999999", "#000000",
];

/// As SVG; `lines` holds for each method the share of right names at each strength.
pub fn svg(strengths: &[f64], lines: &[(&str, Vec<f64>)]) -> String {
    let x = |d: f64| {
        let ends = (strengths[0].ln(), strengths[strengths.len() - 1].ln());
        LEFT + (d.ln() - ends.0) / (ends.1 - ends.0) * (RIGHT - LEFT)
    };
    let y = |share: f64| BOTTOM - share * (BOTTOM - TOP);
    let mut out = String::new();
    let (width, height) = SIZE;
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\" role=\"img\">\n<title>Right names against strength</title>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>"
    );
    for tenth in [0, 2, 4, 6, 8, 10] {
        let at = y(f64::from(tenth) / 10.0);
        let _ = writeln!(
            out,
            "<path d=\"M{LEFT} {at:.1}H{RIGHT}\" stroke=\"#dddddd\"/><text x=\"{:.0}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            LEFT - 8.0,
            at + 4.0,
            10 * tenth
        );
    }
    for &d in strengths {
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.0}\" text-anchor=\"middle\">{d}</text>",
            x(d),
            BOTTOM + 18.0
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{:.0}\" y=\"{:.0}\" text-anchor=\"middle\">strength after refit, standard deviations</text>\n<text transform=\"translate(16 {:.0}) rotate(-90)\" text-anchor=\"middle\">one right name, % of groups</text>",
        (LEFT + RIGHT) / 2.0,
        BOTTOM + 40.0,
        (TOP + BOTTOM) / 2.0
    );
    let mut row = 0.0;
    for (k, (name, shares)) in lines.iter().enumerate() {
        // What gives no names has no line.
        if shares.iter().all(|share| *share == 0.0) {
            continue;
        }
        let points: Vec<String> = strengths
            .iter()
            .zip(shares)
            .map(|(d, share)| format!("{:.1} {:.1}", x(*d), y(*share)))
            .collect();
        let (dash, thick) = match k {
            ORACLE => (" stroke-dasharray=\"6 4\"", 1.5),
            OURS => ("", 3.0),
            _ => ("", 1.5),
        };
        let at = TOP + 14.0 + 22.0 * row;
        row += 1.0;
        let colour = COLOURS[k % COLOURS.len()];
        let _ = writeln!(
            out,
            "<path d=\"M{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{thick}\"{dash}/>\n<path d=\"M{:.0} {at:.0}h28\" stroke=\"{colour}\" stroke-width=\"{thick}\"{dash}/><text x=\"{:.0}\" y=\"{:.0}\">{name}</text>",
            points.join("L"),
            RIGHT + 16.0,
            RIGHT + 50.0,
            at + 4.0
        );
        debug_assert!(METHODS.contains(name));
    }
    out.push_str("</svg>\n");
    out
}
