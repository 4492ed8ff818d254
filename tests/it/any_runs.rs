//! Runs as nobody means them: short, flat, huge, tiny, all equal, out of order, barely tagged. From the file to the last
//! page, table, figure and export nothing panics, and every page is there. `IEAP_LONG=1` asks many.

use std::path::Path;

use ieap::domain::Fault;
use ieap::pipeline::documents::diagnosis::diagnosis_document;
use ieap::pipeline::documents::dma::dma;
use ieap::pipeline::documents::fits::fits_document;
use ieap::pipeline::findings::next_runs::{plan, write_sheet};
use ieap::pipeline::show::explain::explain;
use ieap::pipeline::show::export::{Export, written};
use ieap::pipeline::show::figures::{self, MakeFigure};
use ieap::pipeline::show::tables;
use ieap::pipeline::upkeep::status::status;
use ieap::pipeline::{
    AnalyseModulus, Context, DiagnoseChoice, DiagnoseRuns, FitRuns, Ingest, PipelineError, RaiseAlarms,
    RenderReport, Silent,
};
use ieap::report::tables::FORMATS;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner};

use crate::campaign::counted;

/// Draws of what chance does in a diagnosis: the fewest that the command line takes.
const DRAWS: usize = 99;

/// One cell: most of them ordinary, some at the ends of what a number can be, some no numbers.
fn cell() -> impl Strategy<Value = String> {
    let ends = vec![
        "0",
        "-0",
        "1e300",
        "-1e300",
        "1e-300",
        "5e-324",
        "1.7976931348623157e308",
        "",
        "nan",
        "inf",
        "1e12",
        "-1",
    ];
    prop_oneof![
        4 => (-3.0..3.0f64, -12..6i32).prop_map(|(number, power)| format!("{}", number * 10f64.powi(power))),
        2 => prop::sample::select(ends).prop_map(str::to_owned),
        1 => any::<f64>().prop_map(|number| format!("{number:e}")),
    ]
}

/// A size from atoms to power stations.
fn size() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => prop::sample::select(vec![1e-3, 1e-6, 1.0, 0.01]),
        1 => prop::sample::select(vec![1e-12, 1e6, 1e-300, 1e300]),
    ]
}

/// A column of `rows` cells.
fn column(rows: usize) -> impl Strategy<Value = Vec<String>> {
    let shaped = (0..8usize, size(), -1.0..1.0f64).prop_map(move |(shape, size, wiggle)| {
        let number = |k: usize| match shape {
            0 => 0.0,
            1 => size,
            2 => size * (-(k as f64) / 3.0).exp(),
            3 => -size * (-(k as f64) / 3.0).exp(),
            4 => size * k as f64,
            5 => size * if k.is_multiple_of(2) { 1.0 } else { -1.0 },
            6 => size * (1.0 + 1e-13 * wiggle * k as f64),
            _ => size * ((-(k as f64) / 4.0).exp() + 0.02 * (wiggle * 37.0 * k as f64).sin()),
        };
        (0..rows)
            .map(|k| format!("{:e}", number(k)))
            .collect::<Vec<String>>()
    });
    prop_oneof![5 => shaped, 1 => prop::collection::vec(cell(), rows)]
}

/// Times of `rows` readings, s: even, of any step, all equal, or anything.
fn times(rows: usize) -> impl Strategy<Value = Vec<String>> {
    let even = (
        0..3i32,
        prop::sample::select(vec![1e-9, 1e-3, 0.1, 1.0, 6.0, 1e5, 1e12]),
    )
        .prop_map(move |(before, step_s)| {
            let time = |k: usize| format!("{:e}", (k as i32 - before) as f64 * step_s);
            (0..rows).map(time).collect::<Vec<String>>()
        });
    let late: Vec<String> = (0..rows).map(|k| format!("{}", 1e9 + 1e-6 * k as f64)).collect();
    let late = Just(late);
    prop_oneof![8 => even, 1 => Just(vec!["0".to_owned(); rows]), 1 => late, 1 => prop::collection::vec(cell(), rows)]
}

/// The voltage: a step at any row (also the first), none, a train, or anything.
fn voltages(rows: usize) -> impl Strategy<Value = Vec<String>> {
    let step = (
        0..=rows,
        prop::sample::select(vec![2.0, -2.0, 1.0, 0.05, 1e-9, 1e9]),
    )
        .prop_map(move |(at, voltage)| {
            let level = |k: usize| if k < at { 0.0 } else { voltage };
            (0..rows)
                .map(|k| format!("{}", level(k)))
                .collect::<Vec<String>>()
        });
    let train: Vec<String> = (0..rows).map(|k| format!("{}", 2 * (k / 2 % 2))).collect();
    let train = Just(train);
    prop_oneof![6 => step, 1 => train, 1 => column(rows)]
}

/// The text of a run table.
fn table() -> impl Strategy<Value = String> {
    let rows = prop_oneof![4 => 1..6usize, 2 => 6..30usize, 1 => 30..90usize];
    rows.prop_flat_map(|rows| {
        let named = |name: &'static str, of: BoxedStrategy<Vec<String>>, share: f64| {
            prop::option::weighted(share, of.prop_map(move |cells| (name, cells)))
        };
        let bending = prop::sample::select(vec![
            "curvature_per_cm",
            "tip_displacement_mm",
            "blocking_force_mn",
            "curvature_per_cm@2",
        ]);
        let bending = (bending, column(rows));
        (
            times(rows),
            named("voltage_v", voltages(rows).boxed(), 0.9),
            named("current_a", column(rows).boxed(), 0.85),
            prop::option::weighted(0.5, bending),
            named("curvature_per_cm@8", column(rows).boxed(), 0.1),
            named("relative_humidity_percent", column(rows).boxed(), 0.15),
        )
            .prop_map(move |(times, a, b, c, d, e)| {
                let columns: Vec<_> = [Some(("time_s", times)), a, b, c, d, e]
                    .into_iter()
                    .flatten()
                    .collect();
                let line = |cells: Vec<&str>| cells.join(",") + "\n";
                let mut text = line(columns.iter().map(|(name, _)| *name).collect());
                for row in 0..rows {
                    text += &line(columns.iter().map(|(_, cells)| cells[row].as_str()).collect());
                }
                text
            })
    })
}

/// The tags beside a run: all, some, none.
fn tags() -> impl Strategy<Value = String> {
    let tag =
        |share: f64, lines: Vec<&'static str>| prop::option::weighted(share, prop::sample::select(lines));
    (
        tag(
            0.9,
            vec![
                "sample = \"S1\"",
                "sample = \"S1\"",
                "sample = \"S2\"",
                "sample = \"S3\"",
            ],
        ),
        tag(0.9, vec!["environment = \"air\"", "environment = \"vacuum\""]),
        tag(
            0.2,
            vec!["voltage_v = 2.0", "voltage_v = -1", "voltage_v = 1e300"],
        ),
        tag(
            0.6,
            vec![
                "relative_humidity_percent = 20",
                "relative_humidity_percent = 60",
                "relative_humidity_percent = 0",
            ],
        ),
        tag(0.4, vec!["cycle = 1", "cycle = 2", "cycle = 30"]),
        tag(
            0.4,
            vec![
                "started_at = \"2026-01-05T10:00:00Z\"",
                "started_at = \"2026-06-05T10:00:00Z\"",
            ],
        ),
        tag(0.2, vec!["temperature_c = 20", "temperature_c = -300"]),
    )
        .prop_map(|(a, b, c, d, e, f, g)| {
            let lines = [a, b, c, d, e, f, g].into_iter().flatten();
            lines.map(|line| format!("{line}\n")).collect::<String>()
        })
}

/// campaign.toml with samples of any size.
fn campaign() -> impl Strategy<Value = String> {
    let mm = || prop_oneof![4 => Just(5.0), 1 => prop::sample::select(vec![1e-6, 1e4, 1e-150, 1e150])];
    prop::collection::vec((mm(), mm(), mm()), 2).prop_map(|sizes| {
        let mut text = "[campaign]\nid = \"any\"\ntitle = \"Any\"\n".to_owned();
        for (k, (length, width, thickness)) in sizes.into_iter().enumerate() {
            let (id, material) = (k + 1, ["CNaf", "CPvf"][k]);
            text += &format!("[[sample]]\nid = \"S{id}\"\nmaterial = \"{material}\"\n");
            text += &format!("length_mm = {length:?}\nwidth_mm = {width:?}\nthickness_mm = {thickness:?}\n");
        }
        text
    })
}

/// A campaign: its campaign.toml, and runs with their tags.
type AnyCampaign = (String, Vec<(String, String)>);

fn any_campaign() -> impl Strategy<Value = AnyCampaign> {
    (campaign(), prop::collection::vec((table(), tags()), 1..6))
}

/// What went wrong where.
fn failed(step: &str, error: &PipelineError) -> TestCaseError {
    TestCaseError::fail(format!("{step}: {error}"))
}

fn no_faults(step: &str, faults: &[Fault]) -> Result<(), TestCaseError> {
    prop_assert!(faults.is_empty(), "{step}: {faults:#?}");
    Ok(())
}

/// A refusal is an answer, a fault of the program is none.
fn answered<T>(step: &str, made: Result<T, PipelineError>) -> Result<Option<T>, TestCaseError> {
    match made {
        Ok(made) => Ok(Some(made)),
        Err(error) if error.is_fault() || error.is_storage() => Err(failed(step, &error)),
        Err(_) => Ok(None),
    }
}

/// Everything from the files to the pages.
fn worked_through(folder: &Path) -> Result<Option<Context>, TestCaseError> {
    // Sizes that no sample can have are refused.
    let Some(mut context) = answered("opening", Context::open(folder, true))? else {
        return Ok(None);
    };
    let context_of = &mut context;
    let ingest = Ingest { ready: &mut |_| true }.run(context_of, &Silent);
    let ingest = ingest.map_err(|error| failed("ingest", &error))?;
    let fault = ingest
        .refused
        .iter()
        .find(|(_, issue)| issue.code == "reader-fault");
    prop_assert!(fault.is_none(), "{fault:?}");
    let fits = FitRuns::default()
        .run(context_of, &Silent)
        .map_err(|error| failed("fit", &error))?;
    prop_assert!(!fits.has_fault(), "{:?}", fits.failed);
    let choice = DiagnoseChoice {
        draws: Some(DRAWS),
        ..DiagnoseChoice::default()
    };
    let diagnose = DiagnoseRuns {
        choice: choice.clone(),
        ..DiagnoseRuns::default()
    };
    let found = diagnose
        .run(context_of, &Silent)
        .map_err(|error| failed("diagnose", &error))?;
    prop_assert!(!found.has_fault(), "{:?}", found.failed);
    let logs = AnalyseModulus::default().run(context_of, &Silent);
    prop_assert!(!logs.map_err(|error| failed("modulus", &error))?.has_fault());
    RaiseAlarms::default()
        .run(context_of, &Silent)
        .map_err(|error| failed("alarms", &error))?;
    let report = RenderReport::default().run(context_of, &Silent);
    no_faults(
        "report",
        &report.map_err(|error| failed("report", &error))?.faults,
    )?;
    no_faults(
        "status",
        &status(&context).map_err(|error| failed("status", &error))?.faults,
    )?;
    let document =
        diagnosis_document(&context, &choice, None).map_err(|error| failed("diagnose --json", &error))?;
    no_faults("diagnose --json", &document.faults)?;
    serde_json::to_string(&document).expect("JSON");
    serde_json::to_string(&fits_document(&context).map_err(|error| failed("fit --json", &error))?)
        .expect("JSON");
    serde_json::to_string(&dma(&context).map_err(|error| failed("dma --json", &error))?.0).expect("JSON");
    Ok(Some(context))
}

/// Every link of every page leads to a page that is there and whole.
fn every_page_is_there(report: &Path) -> Result<(), TestCaseError> {
    let mut open = vec!["index.html".to_owned()];
    let mut seen = std::collections::BTreeSet::new();
    while let Some(page) = open.pop() {
        if !seen.insert(page.clone()) {
            continue;
        }
        let html = std::fs::read_to_string(report.join(&page));
        prop_assert!(html.is_ok(), "{page} is not there");
        let html = html.unwrap_or_default();
        prop_assert!(html.contains("</footer>"), "{page} has no end");
        for word in ["NaN", ">inf<", "-inf"] {
            prop_assert!(!html.contains(word), "{page} prints {word}");
        }
        let base = Path::new(&page).parent().map(Path::to_owned).unwrap_or_default();
        for link in html.split("href=").skip(1) {
            let link = link.trim_start_matches('"');
            let link = link.split(['"', '>', ' ', '#']).next().unwrap_or_default();
            if link.ends_with(".html") {
                let path = base.join(link).to_string_lossy().replace("runs/../", "");
                open.push(path.replace("findings/../", "").replace("along/../", ""));
            }
        }
    }
    Ok(())
}

/// Tables in every format, figures, exports, what to measure next.
fn told_in_every_way(context: &Context) -> Result<(), TestCaseError> {
    for (name, _) in tables::listed() {
        let Some(table) = answered(name, tables::table(context, name))? else {
            continue;
        };
        for format in &FORMATS {
            (format.write)(&table);
        }
        if let (Some(row), Some(column)) = (table.rows.first(), table.columns.last()) {
            answered(name, explain(context, name, &row.label, &column.key))?;
        }
    }
    for (name, _, width_mm, _) in figures::listed() {
        let figure = MakeFigure {
            name: name.to_owned(),
            format: "svg".to_owned(),
            width_mm: Some(width_mm),
            dots_per_inch: 50.0,
            run: None,
            parameter: None,
        };
        answered(name, figure.run(context))?;
    }
    let out = tempfile::tempdir().expect("a folder");
    for (table, _) in written() {
        for ending in ["csv", "parquet", "json"] {
            let path = out.path().join(format!("{}.{ending}", table));
            let export = Export {
                table,
                format: None,
                path,
                overwrite: false,
            };
            answered(table, export.run(context))?;
        }
    }
    let plan = plan(context).map_err(|error| failed("next", &error))?;
    answered(
        "next --sheet",
        write_sheet(context, &plan, &out.path().join("next.csv")),
    )?;
    Ok(())
}

fn survives((campaign, runs): &AnyCampaign) -> Result<(), TestCaseError> {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("a file");
    std::fs::create_dir(folder.path().join("runs")).expect("a folder");
    write("campaign.toml", campaign);
    for (k, (table, tags)) in runs.iter().enumerate() {
        write(&format!("runs/r{k}.csv"), table);
        write(&format!("runs/r{k}.csv.toml"), tags);
    }
    let Some(context) = worked_through(folder.path())? else {
        return Ok(());
    };
    every_page_is_there(&folder.path().join("report"))?;
    told_in_every_way(&context)
}

#[test]
fn whatever_is_measured_there_is_a_report() {
    let config = Config {
        cases: counted(12, 1000) as u32,
        max_shrink_iters: 60,
        failure_persistence: None,
        ..Config::default()
    };
    let seed = [7; 32];
    let mut runner = TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &seed));
    runner
        .run(&any_campaign(), |campaign| survives(&campaign))
        .unwrap_or_else(|error| panic!("{error}"));
}

/// The tables that ended the program once.
#[test]
fn two_rows_that_start_at_the_step_have_a_report() {
    let tags = "sample = \"S1\"\nenvironment = \"air\"\n".to_owned();
    let campaign = "[campaign]\nid = \"a\"\ntitle = \"A\"\n[[sample]]\nid = \"S1\"\nmaterial = \"CNaf\"\n\
                    length_mm = 5.0\nwidth_mm = 2.0\nthickness_mm = 0.2\n";
    let two = "time_s,voltage_v,current_a\n0,2,0.1\n1,2,0.09\n".to_owned();
    let runs = vec![(two.clone() + "2,2,0.08\n", tags.clone()), (two, tags)];
    survives(&(campaign.to_owned(), runs)).unwrap();
}
