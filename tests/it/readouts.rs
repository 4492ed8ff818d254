//! What a pointer reads off the lines of a page is what is stored: by node alone, and in a browser where there is one.

use std::process::Command;

use ieap::domain::tag::keys;
use ieap::domain::{CurveSource, Quantity, RunCurve};
use ieap::report::figures::response::{TimeView, response};
use ieap::report::kept::Earlier;
use ieap::report::{Site, render};
use serde_json::{Value, json};

use crate::needs_shared::skip;
use crate::report_fixture::{MadeUpCurves, input};

fn is_there(program: &str) -> bool {
    Command::new(program)
        .arg("--version")
        .output()
        .is_ok_and(|out| out.status.success())
}

/// Runs a script of `tests/` with node; none where node is absent.
fn with_node(script: &str, arguments: &[&std::ffi::OsStr]) -> Option<String> {
    if !is_there("node") {
        skip(&format!("there is no node to run {script}"));
        return None;
    }
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests")
        .join(script);
    let out = Command::new("node")
        .arg(path)
        .args(arguments)
        .output()
        .expect("node runs");
    let said = format!(
        "{}{}",
        String::from_utf8_lossy(&out.stdout),
        String::from_utf8_lossy(&out.stderr)
    );
    assert!(out.status.success(), "{said}");
    Some(said)
}

/// A charging current that bends most where a thinned line has fewest vertices.
fn curve() -> RunCurve {
    let time_s: Vec<f64> = (0..240).map(|k| 0.05 * (1.0457_f64.powi(k) - 1.0)).collect();
    let fitted: Vec<f64> = time_s
        .iter()
        .map(|t| 1e-3 * (0.6 * (-t / 4.0).exp() + 0.3 * (-t / 300.0).exp() + 0.06))
        .collect();
    RunCurve {
        quantity: Quantity::Current,
        measured: fitted.clone(),
        residual_sigma: vec![0.0; time_s.len()],
        readings: time_s.len(),
        time_s,
        fitted,
    }
}

#[test]
fn lines_are_read_between_their_vertices() {
    let curve = curve();
    let last_s = curve.time_s[curve.time_s.len() - 1];
    let views = [
        TimeView::Whole,
        TimeView::AboutStep {
            step_s: 0.0,
            first_s: curve.time_s[0],
            next_s: curve.time_s[1],
            last_s,
        },
        TimeView::SinceStep {
            step_s: 0.0,
            until_s: f64::INFINITY,
        },
    ];
    let figures: Vec<Value> = views
        .iter()
        .map(|view| {
            let svg = response(&curve, *view, "Current", false).unwrap().unwrap();
            json!({"svg": svg.svg, "time_s": &curve.time_s[1..], "fitted": &curve.fitted[1..]})
        })
        .collect();
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), serde_json::to_string(&figures).unwrap()).unwrap();
    if let Some(said) = with_node("check_readouts", &[file.path().as_os_str()]) {
        println!("{said}");
    }
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_browser_reads_what_is_stored() {
    let input = input(&["CNaf"], 1);
    let curves = MadeUpCurves::of(&input);
    let folder = tempfile::tempdir().unwrap();
    render(
        &input,
        &curves,
        &Earlier::none(),
        &folder.path().join("report"),
        &|_, _| {},
    )
    .expect("a site");
    let site = Site::new(&input);
    let with_fit = (0..input.runs.len())
        .filter(|&run| input.runs[run].fit.is_some())
        .take(3);
    let stored: Vec<Value> = with_fit
        .flat_map(|run| {
            let record = &input.runs[run];
            assert!(record.tag(keys::SAMPLE).is_some());
            let href = site.run_href(run);
            let curves = curves.curves(record.id).unwrap();
            let step_s = record
                .drive
                .as_ref()
                .map_or(0.0, |drive| drive.segments[0].start_s());
            curves.into_iter().map(move |curve| {
                json!({
                    "href": href, "quantity": curve.quantity.label(), "step_s": step_s,
                    "time_s": curve.time_s, "fitted": curve.fitted, "measured": curve.measured,
                })
            })
        })
        .collect();
    let file = folder.path().join("curves.json");
    std::fs::write(&file, serde_json::to_string(&stored).unwrap()).unwrap();
    let report = folder.path().join("report");
    let arguments = [
        report.as_os_str(),
        "--readouts-only".as_ref(),
        "--curves".as_ref(),
        file.as_os_str(),
    ];
    if let Some(said) = with_node("check_pages", &arguments) {
        println!("{said}");
    }
}
