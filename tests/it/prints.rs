//! Figures for print: what stands in the files, and that sizes are right for paper.

use ieap::report::figures::canvas::Shape;
use ieap::report::print_figures::{
    FIGURES, FigureInput, POINTS_PER_PIXEL, figure_format_named, figure_named,
};
use ieap::report::{Input, Site};

use crate::report_fixture::{MadeUpCurves, current_only_input, frequency_runs, input};

fn written(input: &Input, name: &str, width_mm: f64, format: &str) -> Result<Vec<u8>, String> {
    let site = Site::new(input);
    let curves = MadeUpCurves::of(input);
    let figure = figure_named(name).expect("a known figure");
    let print = figure.print(
        &FigureInput {
            parameter: None,
            site: &site,
            curves: &curves,
            run: None,
        },
        width_mm,
    )?;
    (figure_format_named(format).expect("a known format").write)(&print, 300.0)
}

#[test]
fn text_and_lines_are_right_for_paper_at_any_width() {
    let mut input = input(&["CNaf", "CPvf"], 1);
    input.frequency = frequency_runs(&input);
    let site = Site::new(&input);
    let curves = MadeUpCurves::of(&input);
    let figure_input = FigureInput {
        parameter: None,
        site: &site,
        curves: &curves,
        run: None,
    };
    for figure in FIGURES.iter().filter(|figure| {
        !["figure24", "models", "laws", "monitoring"].contains(&figure.name) && !figure.of_strips
    }) {
        for width_mm in [85.0, 120.0, 170.0] {
            let print = figure.print(&figure_input, width_mm).expect("drawn");
            let points = |tenths: f64| tenths / 10.0 * POINTS_PER_PIXEL;
            let wide = points(f64::from(print.drawing.size.0)) / 72.0 * 25.4;
            assert!((wide - width_mm).abs() < 0.2, "{}: {wide} mm", figure.name);
            for shape in &print.drawing.shapes {
                match shape {
                    Shape::Text(label) => {
                        assert!(
                            (7.0..=9.0).contains(&points(label.size)),
                            "{}: {}",
                            figure.name,
                            label.text
                        );
                    }
                    Shape::Stroke { width, .. } | Shape::Ring { width, .. } => {
                        assert!(points(f64::from(*width)) >= 0.5, "{}: {width}", figure.name);
                    }
                    Shape::Dot { .. }
                    | Shape::Fill { .. }
                    | Shape::Cells(_)
                    | Shape::Open(_)
                    | Shape::Close => {}
                }
            }
        }
    }
}

#[test]
fn svg_holds_its_size_and_no_text_that_needs_a_font() {
    let input = input(&["CNaf", "CPvf"], 1);
    let bytes = written(&input, "figure22", 85.0, "svg").unwrap();
    let text = String::from_utf8(bytes.clone()).unwrap();
    assert!(text.contains("width=\"85.00mm\"") && !text.contains("<text"));
    assert!(
        text.contains("Simulated, not measured."),
        "the notice goes with the figure"
    );
    assert!(!text.contains("NaN") && !text.contains("inf "));
    assert_eq!(
        written(&input, "currents", 85.0, "svg").unwrap(),
        bytes,
        "same input, same bytes"
    );
}

#[test]
fn png_says_how_large_it_is() {
    let bytes = written(&input(&["CNaf"], 1), "figure26", 170.0, "png").unwrap();
    assert_eq!(&bytes[1..4], b"PNG");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    // 170 mm at 300 dots per inch.
    assert_eq!(number(16), 2008);
    let chunk = bytes
        .windows(4)
        .position(|four| four == b"pHYs")
        .expect("a resolution");
    assert_eq!((number(chunk + 4), bytes[chunk + 12]), (11811, 1));
}

#[test]
fn pdf_has_one_page_of_the_asked_width() {
    let bytes = written(&input(&["CNaf"], 1), "figure23", 85.0, "pdf").unwrap();
    assert!(bytes.starts_with(b"%PDF-"));
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains("/MediaBox [0 0 240.9"), "85 mm are 240.94 points");
    assert!(!text.contains("/Font"));
}

#[test]
fn a_figure_without_data_says_what_is_missing() {
    let input = current_only_input();
    let refused = written(&input, "figure24", 85.0, "svg").unwrap_err();
    assert!(refused.contains("dma/"), "{refused}");
    let refused = written(&input, "bending", 85.0, "svg").unwrap_err();
    assert!(refused.contains("no run"), "{refused}");
    assert!(written(&input, "currents", 85.0, "svg").is_ok());
    let refused = written(&input, "currents", 85.0, "png").map(|_| ());
    assert!(refused.is_ok());
}
