//! Runs that are read at several places along their strip: pages, figures, and the committed campaign that has them.

use std::path::{Path, PathBuf};

use ieap::domain::{
    AlongCurve, AlongStrip, ChannelNoise, CurveSource, EndsRatio, Estimate, PlaceSeries, Quantity, RunCurve,
    StripShape,
};
use ieap::report::figures::canvas::Shape;
use ieap::report::kept::Earlier;
use ieap::report::pages::{PAGES, strip_content};
use ieap::report::print_figures::{FIGURES, FigureInput, POINTS_PER_PIXEL, figure_format_named};
use ieap::report::{Input, Site, render};

use crate::campaign::CampaignFolder;
use crate::report_fixture::input;

use super::page_outline::outline;

const PLACES: usize = 6;
const FRAMES: usize = 40;
const LENGTH_MM: f64 = 30.0;

fn time_s(frame: usize) -> f64 {
    0.05 * 1.25f64.powi(frame as i32)
}

fn kappa(place: usize, frame: usize) -> f64 {
    0.4 * (-(place as f64) / 4.0).exp() * (1.0 - (-time_s(frame) / 3.0).exp())
}

/// Curvatures at six places, one reading of which is missing; fitted where asked.
fn curvature(fitted: bool) -> AlongCurve {
    let times: Vec<f64> = (0..FRAMES).map(time_s).collect();
    let model = |place: usize| -> Vec<f64> { (0..FRAMES).map(|frame| kappa(place, frame)).collect() };
    let rows: Vec<(Vec<f64>, Vec<f64>)> = (0..PLACES)
        .map(|place| {
            let model = model(place);
            let off = |frame: usize| 0.002 * (7.0 * frame as f64 + place as f64).sin();
            let read = (0..FRAMES).map(|frame| model[frame] + off(frame)).collect();
            (read, model)
        })
        .collect();
    let places: Vec<PlaceSeries> = rows
        .iter()
        .enumerate()
        .map(|(place, (read, model))| PlaceSeries {
            position_mm: 2.5 + 5.0 * place as f64,
            time_s: &times,
            measured: read,
            fitted: if fitted { model } else { &[] },
            noise: 0.0014,
        })
        .collect();
    let mut curve = AlongCurve::of(Quantity::Curvature, &places, &[0.0]).expect("a curve");
    curve.measured[2 * FRAMES + 20] = f64::NAN;
    curve
}

fn voltage() -> AlongCurve {
    let times: Vec<f64> = (0..FRAMES).map(time_s).collect();
    let rows: Vec<Vec<f64>> = (1..4)
        .map(|place| {
            times
                .iter()
                .map(|t| 1.5 - 0.2 * f64::from(place) / (1.0 + t))
                .collect()
        })
        .collect();
    let places: Vec<PlaceSeries> = rows
        .iter()
        .zip([5.0, 12.0, 25.0])
        .map(|(read, position_mm)| PlaceSeries {
            position_mm,
            time_s: &times,
            measured: read,
            fitted: read,
            noise: 0.002,
        })
        .collect();
    AlongCurve::of(Quantity::Voltage, &places, &[0.0]).expect("a curve")
}

/// A strip with everything that a page can show, or with readings of the curvature only.
fn strip(whole: bool) -> AlongStrip {
    let shape = |frame: usize| {
        let bent = |s: f64| (s, 0.02 * s * s * kappa(0, frame));
        let points: Vec<(f64, f64)> = (0..=PLACES).map(|k| bent(5.0 * k as f64)).collect();
        StripShape {
            frame,
            fitted_mm: if whole { points.clone() } else { Vec::new() },
            measured_mm: points,
        }
    };
    let ratio = |frame: usize, ratio: Estimate| EndsRatio {
        time_s: time_s(frame),
        ratio,
    };
    AlongStrip {
        length_mm: Some(LENGTH_MM),
        step_s: 0.0,
        changes_again: false,
        curvature: Some(curvature(whole)),
        voltage: whole.then(voltage),
        voltage_profile: None,
        voltage_frames: vec![0, 13, 26, 39],
        shapes: [0, 13, 26, 39].map(shape).to_vec(),
        film: (0..FRAMES).step_by(3).map(shape).collect(),
        ends_mm: Some([(2.5, 2.5), (27.5, 27.5)]),
        unevenness: vec![
            ratio(
                0,
                Estimate::above(3.42, "the bending near the tip cannot be told from none"),
            ),
            ratio(39, Estimate::determined(3.49, 0.017, 3.457, 3.523)),
        ],
    }
}

/// The made-up campaign whose first two runs are read along the strip, the second without a fit of it.
fn along_input() -> Input {
    let mut input = input(&["CNaf"], 1);
    for run in &mut input.runs[..2] {
        let whole = run.channels[1].clone();
        run.channels.extend((0..PLACES).map(|place| {
            let mut channel = whole.clone();
            channel.position_mm = Some(2.5 + 5.0 * place as f64);
            channel
        }));
    }
    let fit = input.runs[0].fit.as_mut().expect("fitted");
    fit.model = "distributed".to_owned();
    fit.noise = [(Quantity::Voltage, 0.0021), (Quantity::Curvature, 0.0014)]
        .map(|(quantity, residual_rms)| ChannelNoise {
            quantity,
            standard_deviation: 0.0014,
            residual_rms,
            ..fit.noise[0].clone()
        })
        .to_vec();
    input
}

/// Strips of the two runs.
struct Strips;

impl CurveSource for Strips {
    fn curves(&self, _run_id: i64) -> Result<Vec<RunCurve>, String> {
        Ok(Vec::new())
    }

    fn along(&self, run_id: i64) -> Result<Option<AlongStrip>, String> {
        Ok(Some(strip(run_id == 1)))
    }
}

#[test]
fn what_pages_along_the_strip_say() {
    let input = along_input();
    let site = Site::new(&input);
    let page = PAGES
        .iter()
        .find(|page| page.file == "along.html")
        .expect("a page");
    insta::assert_snapshot!("along", outline(&(page.content)(&site).expect("content").context));
    let both = [true, false]
        .map(|whole| strip_content(&site, usize::from(!whole), Some(&strip(whole))).expect("content"));
    insta::assert_snapshot!("strip_fitted", outline(&both[0].context));
    insta::assert_snapshot!("strip_measured_only", outline(&both[1].context));
    assert_eq!(
        both[0].figures.keys().collect::<Vec<_>>(),
        [
            "chart-5",
            "chart-6",
            "map-difference",
            "map-measured",
            "map-simulated",
            "shapes"
        ]
    );
    assert_eq!(
        both[1].figures.keys().collect::<Vec<_>>(),
        ["chart-3", "map-measured", "shapes"]
    );
    // One frame of the moving picture: its time, a measured and a simulated line.
    let drawing = &both[0].figures["shapes"];
    let film = drawing.split('"').nth(1).expect("frames");
    assert_eq!(film.split(';').count(), FRAMES.div_ceil(3));
    assert!(film.starts_with("0.05 s|M") && film.split(';').all(|frame| frame.matches('|').count() == 2));
}

#[test]
fn a_page_along_the_strip_stays_small_and_a_hole_stays_a_hole() {
    let input = along_input();
    let folder = tempfile::tempdir().expect("a folder");
    render(&input, &Strips, &Earlier::none(), folder.path(), &|_, _| {}).expect("a site");
    let pages: Vec<PathBuf> = std::fs::read_dir(folder.path().join("along"))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    assert_eq!(pages.len(), 2);
    for page in pages {
        let html = std::fs::read_to_string(&page).expect("a page");
        assert!(html.len() < 45_000, "{}: {} bytes", page.display(), html.len());
        assert!(!html.contains("NaN"), "{}", page.display());
    }
    // Every cell of the map is a pixel's colour; the one without a reading has none.
    let site = Site::new(&input);
    let print = FIGURES
        .iter()
        .find(|figure| figure.alias == "curvature-map")
        .expect("a figure")
        .print(&figure_input(&site, Some(1)), 85.0)
        .expect("drawn");
    let cells = print.drawing.shapes.iter().find_map(|shape| match shape {
        Shape::Cells(cells) => Some(cells),
        _ => None,
    });
    let colors = &cells.expect("cells").colors;
    assert_eq!(colors.len(), PLACES * FRAMES);
    let holes: Vec<usize> = (0..colors.len()).filter(|&k| colors[k].is_none()).collect();
    assert_eq!(
        holes,
        [(PLACES - 1 - 2) * FRAMES + 20],
        "rows are counted from the tip"
    );
}

fn figure_input<'a>(site: &'a Site, run: Option<usize>) -> FigureInput<'a> {
    FigureInput {
        parameter: None,
        site,
        curves: &Strips,
        run,
    }
}

#[test]
fn figures_of_strips_are_right_for_paper_at_any_width() {
    let input = along_input();
    let site = Site::new(&input);
    for figure in FIGURES.iter().filter(|figure| figure.of_strips) {
        for (width_mm, run) in [(85.0, None), (85.0, Some(0)), (170.0, None)] {
            let print = figure.print(&figure_input(&site, run), width_mm).expect("drawn");
            let points = |tenths: f64| tenths / 10.0 * POINTS_PER_PIXEL;
            let [mut right, mut below] = [0, 0];
            for shape in &print.drawing.shapes {
                match shape {
                    Shape::Text(label) => {
                        assert!((7.0..=9.0).contains(&points(label.size)), "{}", label.text)
                    }
                    Shape::Stroke {
                        width, points: line, ..
                    } => {
                        assert!(points(f64::from(*width)) >= 0.5, "{}: {width}", figure.name);
                        right = line.iter().map(|at| at.0).fold(right, i32::max);
                        below = line.iter().map(|at| at.1).fold(below, i32::max);
                    }
                    _ => {}
                }
            }
            let (width, height) = print.drawing.size;
            assert!(right <= width as i32 && below <= height as i32, "{}", figure.name);
            for format in ["svg", "png", "pdf"] {
                let format = figure_format_named(format).expect("a format");
                let bytes = (format.write)(&print, 150.0).expect("written");
                assert!(bytes.len() > 1_000, "{} {}", figure.name, format.name);
                assert!(format.name != "svg" || !String::from_utf8_lossy(&bytes).contains("NaN"));
            }
        }
    }
}

#[test]
fn figures_of_strips_say_what_is_missing() {
    let input = input(&["CNaf"], 1);
    let site = Site::new(&input);
    for figure in FIGURES.iter().filter(|figure| figure.of_strips) {
        let refused = figure
            .print(&figure_input(&site, None), 85.0)
            .map(|_| ())
            .expect_err("nothing to show");
        assert!(refused.contains("curvature_per_cm@5.0"), "{refused}");
    }
}

/// The committed campaign in a folder of its own.
fn committed() -> CampaignFolder {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("campaigns/strip");
    let folder = CampaignFolder::new();
    folder.write("runs/tags.toml", "environment = \"air\"\n");
    for name in ["campaign.toml", "simulation.toml"] {
        folder.write(name, std::fs::read_to_string(source.join(name)).expect(name));
    }
    for entry in std::fs::read_dir(source.join("runs")).expect("runs") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        folder.write(
            &format!("runs/{name}"),
            std::fs::read_to_string(&path).expect("a run"),
        );
    }
    folder
}

#[test]
fn the_committed_strips_are_what_their_spec_writes() {
    let folder = committed();
    folder.write(
        "again/simulation.toml",
        std::fs::read_to_string(folder.join("simulation.toml")).unwrap(),
    );
    folder.ieap(&["simulate", "again/simulation.toml"]).expect(0);
    for name in ["PtNaf_0.25V.csv", "CNaf_1.5V.csv"] {
        let [committed, written] = ["runs", "again/runs"]
            .map(|place| std::fs::read_to_string(folder.join(&format!("{place}/{name}"))).expect(name));
        assert!(committed == written, "{name} is not what simulation.toml writes");
        assert!(committed.starts_with("# SIMULATED"));
    }
    let truth = std::fs::read_to_string(folder.join("again/truth.json")).expect("the answer key");
    assert!(
        truth.contains("\"re_ohm_per_sq\": 4.5") && truth.contains("ladder of cells"),
        "{truth}"
    );
}

#[test]
fn a_campaign_of_strips_has_its_pages_and_figures() {
    let folder = committed();
    // A camera that lost sight of one joint for a while.
    let text = std::fs::read_to_string(folder.join("runs/CNaf_1.5V.csv")).expect("a run");
    let blanked: Vec<String> = text
        .lines()
        .enumerate()
        .map(|(at, line)| {
            if (24..28).contains(&at) {
                line.rsplit_once(',')
                    .map_or_else(String::new, |(rest, _)| format!("{rest},"))
            } else {
                line.to_owned()
            }
        })
        .collect();
    folder.write("runs/CNaf_1.5V.csv", blanked.join("\n") + "\n");
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let page = |name: &str| std::fs::read_to_string(folder.join(&format!("report/{name}"))).expect(name);
    let index = page("along.html");
    assert!(
        index.contains("2 runs are read at several places along the strip; 2 are fitted"),
        "{index}"
    );
    assert!(
        index.contains(">19</td>") && index.contains("distributed: 19 places"),
        "{index}"
    );
    assert!(page("parameters.html").contains("href=\"along.html\""));
    // Pages carry a hash of the run's path in their names.
    let named = |start: &str| {
        let files = std::fs::read_dir(folder.join("report/along")).expect("a folder");
        let mut names = files.map(|file| file.expect("a file").file_name().to_string_lossy().into_owned());
        names
            .find(|name| name.starts_with(start))
            .expect("a page of the run")
    };
    let cnaf = named("cnaf");
    let runs = std::fs::read_dir(folder.join("report/runs")).expect("pages of runs");
    let pages = runs.map(|entry| std::fs::read_to_string(entry.expect("a file").path()).expect("a page"));
    let leads = |html: &String| html.contains(&format!("href=\"../along/{cnaf}\""));
    assert_eq!(pages.filter(leads).count(), 1);
    for name in [named("ptnaf"), cnaf.clone()] {
        let html = page(&format!("along/{name}"));
        assert!(
            html.contains("as much near the clamp (") && html.contains("× the noise in the curvature and "),
            "{html}"
        );
        assert_eq!(
            html.matches("data:image/png;base64,").count(),
            6,
            "three maps with their bars"
        );
        assert!(html.contains("data-film=\"0."));
        assert!(html.len() < 60_000, "{name}: {} bytes", html.len());
    }
    for name in ["curvature-map", "shapes", "voltages", "places"] {
        for ending in ["svg", "png", "pdf"] {
            let file = format!("{name}.{ending}");
            folder
                .ieap(&[
                    "figure",
                    name,
                    "--width-mm",
                    "85",
                    "--run",
                    "runs/CNaf_1.5V.csv",
                    "-o",
                    &file,
                ])
                .expect(0);
            assert!(
                std::fs::metadata(folder.join(&file)).is_ok_and(|found| found.len() > 2_000),
                "{file}"
            );
        }
    }
    let refused = folder
        .ieap(&["figure", "shapes", "--run", "runs/none.csv"])
        .expect(2);
    assert!(refused.stderr.contains("--run"), "{refused:?}");
    // Without a distributed fit the readings stand alone.
    folder
        .ieap(&["run", "--no-diagnose", "--model", "lumped-2"])
        .expect(0);
    let html = page(&format!("along/{cnaf}"));
    assert!(
        html.contains("No distributed model is fitted to this run"),
        "{html}"
    );
    assert_eq!(html.matches("data:image/png;base64,").count(), 2);
    assert!(html.contains("as much near the clamp ("));
}
