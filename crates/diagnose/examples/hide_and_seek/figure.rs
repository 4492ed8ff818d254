//! The figure of the benchmark: right and wrong names against strength, a line for each method.

use std::fmt::Write;

use crate::methods::{METHODS, ORACLE, OURS};

const SIZE: (f64, f64) = (900.0, 400.0);
const PANELS: [(f64, &str); 2] = [(60.0, "one right name, %"), (390.0, "one wrong name, %")];
const WIDTH: f64 = 260.0;
const TOP: f64 = 20.0;
const BOTTOM: f64 = 340.0;
const KEY: f64 = 676.0;
/// Okabe and Ito's colours, which the colour-blind can tell apart.
const COLOURS: [&str; 8] = [
    "#0072B2", "#56B4E9", "#E69F00", "#D55E00", "#CC79A7", "#009E73", "#999999", "#000000",
];

/// What a method named at each strength: strength, right and wrong names in percent.
pub type Line = Vec<(f64, [f64; 2])>;

/// As SVG, a line for each method in the order of the tables.
pub fn svg(lines: &[Line]) -> String {
    let mut out = String::new();
    let (width, height) = SIZE;
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\" role=\"img\">\n<title>Right and wrong names against strength</title>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>"
    );
    for (which, (left, title)) in PANELS.into_iter().enumerate() {
        panel(&mut out, lines, which, left, title);
    }
    let mut row = 0.0;
    for (k, name) in METHODS.iter().enumerate() {
        if !names(&lines[k]) {
            continue;
        }
        let at = TOP + 14.0 + 22.0 * row;
        row += 1.0;
        let _ = writeln!(
            out,
            "<path d=\"M{KEY} {at}h28\" {}/><text x=\"{}\" y=\"{}\">{name}</text>",
            stroke(k),
            KEY + 34.0,
            at + 4.0
        );
    }
    out.push_str("</svg>\n");
    out
}

/// What gives no names has no line.
fn names(line: &Line) -> bool {
    line.iter().any(|(_, [right, wrong])| right + wrong > 0.0)
}

fn stroke(method: usize) -> String {
    let (dash, thick) = match method {
        ORACLE => (" stroke-dasharray=\"6 4\"", 1.5),
        OURS => ("", 3.0),
        _ => ("", 1.5),
    };
    let colour = COLOURS[method % COLOURS.len()];
    format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"{thick}\"{dash}")
}

fn panel(out: &mut String, lines: &[Line], which: usize, left: f64, title: &str) {
    let strengths: Vec<f64> = lines[OURS].iter().map(|(d, _)| *d).collect();
    let (Some(first), Some(last)) = (strengths.first(), strengths.last()) else {
        return;
    };
    let x = |d: f64| left + (d.ln() - first.ln()) / (last.ln() - first.ln()) * WIDTH;
    let y = |percent: f64| BOTTOM - percent / 100.0 * (BOTTOM - TOP);
    for percent in [0.0, 20.0, 40.0, 60.0, 80.0, 100.0] {
        let at = y(percent);
        let _ = writeln!(
            out,
            "<path d=\"M{left} {at:.1}h{WIDTH}\" stroke=\"#dddddd\"/><text x=\"{:.0}\" y=\"{:.1}\" text-anchor=\"end\">{percent}</text>",
            left - 8.0,
            at + 4.0
        );
    }
    for &d in &strengths {
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.0}\" text-anchor=\"middle\">{d}</text>",
            x(d),
            BOTTOM + 18.0
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{:.0}\" y=\"{:.0}\" text-anchor=\"middle\">strength after refit, standard deviations</text>\n<text transform=\"translate({:.0} {:.0}) rotate(-90)\" text-anchor=\"middle\">{title}</text>",
        left + WIDTH / 2.0,
        BOTTOM + 40.0,
        left - 42.0,
        (TOP + BOTTOM) / 2.0
    );
    for (k, line) in lines.iter().enumerate().filter(|(_, line)| names(line)) {
        let points: Vec<String> = line
            .iter()
            .map(|(d, shares)| format!("{:.1} {:.1}", x(*d), y(shares[which])))
            .collect();
        let _ = writeln!(out, "<path d=\"M{}\" {}/>", points.join("L"), stroke(k));
    }
}

/// Lines of the rows that a printed table holds for the five drives.
pub fn of_table(text: &str) -> Vec<Line> {
    let mut lines = vec![Line::new(); METHODS.len()];
    for row in text.lines().filter(|row| row.starts_with("| five drives |")) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let Some(d) = cells.get(2).and_then(|d| d.parse().ok()) else {
            continue;
        };
        for (line, cell) in lines.iter_mut().zip(&cells[4..]) {
            let number = |text: &str| text.trim().parse().unwrap_or(0.0);
            let mut parts = cell.split(['/', '(']);
            let right = parts.next().map_or(0.0, number);
            let wrong = parts.next().map_or(0.0, number);
            line.push((d, [right, wrong]));
        }
    }
    lines
}
