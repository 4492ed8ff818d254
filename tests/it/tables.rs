//! Tables as their reader sees them, and the verbs `table` and `explain`.

use ieap::analysis::tables::{NamedTable, TABLES, Table, TableInput, named};
use ieap::domain::{Estimate, Parameter};
use ieap::report::Input;
use ieap::report::tables::{FORMATS, format_named};
use serde_json::Value;

use crate::campaign::{CampaignFolder, run_table};
use crate::findings_fixture::input_with_findings;
use crate::made_pages;
use crate::report_fixture::{input, run, troubled_input};

fn table(input: &Input, name: &str) -> Table {
    let doubts = Default::default();
    let input = TableInput {
        doubts: &doubts,
        origin: "ieap 0.1.0, change 412",
        ..input.of_tables()
    };
    named(name).expect("a known table").table(&input)
}

fn written(input: &Input, name: &str, format: &str) -> String {
    let format = format_named(format).expect("a known format");
    (format.write)(&table(input, name))
}

/// Two runs of each condition, and a third on another sample of CNaf.
fn repeated_input() -> Input {
    let mut input = input(&["CNaf", "CPvf"], 2);
    let mut other = input.campaign.samples[0].clone();
    other.id = "CNaf-02".to_owned();
    input.campaign.samples.push(other);
    for (surroundings, voltage_v) in [(2, 1.2), (2, 2.0), (2, 2.5)] {
        let mut third = run(100 + voltage_v as usize, "CNaf", surroundings, voltage_v, 3);
        third.tags[0].value = "CNaf-02".to_owned();
        for parameter in &mut third.fit.as_mut().expect("fitted").parameters {
            if let Some(value) = &mut parameter.estimate.value {
                *value *= 1.2;
            }
        }
        input.runs.push(third);
    }
    input
}

/// A sample fitted with the distributed model, its electrode resistance given and its R_ss only bounded.
fn distributed_input() -> Input {
    let mut input = input(&["CNaf"], 1);
    let fit = input.runs[0].fit.as_mut().expect("fitted");
    fit.model = "distributed".to_owned();
    let given = Estimate {
        value: Some(2.5),
        ..Estimate::not_determined("given with the sample, not fitted")
    };
    let parameters = [
        ("re_ohm_per_sq", given),
        ("rc_ohm_cm2", Estimate::determined(4.5, 0.11, 4.28, 4.72)),
        ("c_f_per_cm2", Estimate::determined(0.1312, 0.0021, 0.127, 0.135)),
        (
            "rss_ohm_cm2",
            Estimate::above(2272.0, "the steady current cannot be told from zero"),
        ),
        ("mu_per_c", Estimate::determined(5.88, 0.2, 5.5, 6.3)),
        ("alpha_per_c_cm", Estimate::determined(-2.1, 0.04, -2.18, -2.02)),
        (
            "lambda_per_s",
            Estimate::determined(2.9e-3, 1.2e-4, 2.66e-3, 3.14e-3),
        ),
    ];
    fit.parameters = parameters
        .into_iter()
        .map(|(key, estimate)| Parameter {
            key: key.to_owned(),
            estimate,
        })
        .collect();
    input.runs.truncate(1);
    input
}

#[test]
fn table5_of_a_troubled_campaign_in_every_notation() {
    let input = troubled_input();
    for format in ["text", "latex", "typst", "csv", "markdown"] {
        insta::assert_snapshot!(format!("table5_{format}"), written(&input, "table5", format));
    }
}

#[test]
fn repeats_are_pooled_and_their_spread_is_kept_apart() {
    let input = repeated_input();
    insta::assert_snapshot!("table5_repeated", written(&input, "table5", "text"));
    let document: Value = serde_json::from_str(&written(&input, "table5", "json")).expect("JSON");
    let air = &document["rows"][8];
    assert_eq!(air["label"], "CNaf, air, 2.5 V");
    insta::assert_json_snapshot!("table5_repeated_row", air);
    insta::assert_snapshot!("spread_repeated", written(&input, "spread", "text"));
}

#[test]
fn what_is_stated_for_every_run_gets_no_uncertainty_of_its_own() {
    let mut input = distributed_input();
    let mut again = input.runs[0].clone();
    again.id += 1;
    again.path = "runs/again.csv".to_owned();
    input.runs.push(again);
    let table = table(&input, "table3");
    let cell = &table.rows[0].cells[table.column_named("re_ohm_per_sq").expect("a column")];
    assert_eq!(ieap::report::tables::text_of(&cell.content), "2.50");
    let cell = &table.rows[0].cells[table.column_named("rc_ohm_cm2").expect("a column")];
    assert_eq!(
        ieap::report::tables::text_of(&cell.content),
        "4.50 ± 0.08",
        "two runs know it better than one"
    );
}

#[test]
fn words_of_table6() {
    insta::assert_snapshot!("table6_text", written(&repeated_input(), "table6", "text"));
    insta::assert_snapshot!("table6_latex", written(&repeated_input(), "table6", "latex"));
}

#[test]
fn the_other_tables() {
    insta::assert_snapshot!("table3_text", written(&distributed_input(), "table3", "text"));
    insta::assert_snapshot!("table3_latex", written(&distributed_input(), "table3", "latex"));
    insta::assert_snapshot!(
        "conditions_text",
        written(&repeated_input(), "conditions", "text")
    );
    insta::assert_snapshot!("runs_text", written(&troubled_input(), "runs", "text"));
    insta::assert_snapshot!("refused_html", written(&troubled_input(), "refused", "html"));
    insta::assert_snapshot!(
        "findings_text",
        written(&input_with_findings(), "findings", "text")
    );
}

#[test]
fn every_table_is_whole_in_every_format() {
    for input in [troubled_input(), repeated_input(), distributed_input()] {
        for NameAndTable { name, table } in all(&input) {
            let labels: std::collections::BTreeSet<&str> =
                table.rows.iter().map(|row| row.label.as_str()).collect();
            assert_eq!(labels.len(), table.rows.len(), "{name}: two rows have one label");
            assert!(table.stub <= table.columns.len());
            for row in &table.rows {
                assert_eq!(row.cells.len(), table.columns.len(), "{name}, {}", row.label);
                let notes = row.cells.iter().flat_map(|cell| &cell.notes);
                assert!(notes.into_iter().all(|&note| note < table.notes.len()), "{name}");
            }
            for format in &FORMATS {
                let text = (format.write)(&table);
                assert!(text.ends_with('\n'), "{name} as {}", format.name);
                // "Reinforcement" is a word of table 2.
                let mut words = text.split(|c: char| !c.is_alphanumeric());
                assert!(
                    !words.any(|word| ["NaN", "inf"].contains(&word)),
                    "{name} as {}",
                    format.name
                );
                assert!(
                    !text.contains('\u{1b}') && !text.contains('\u{202e}'),
                    "{name} as {}",
                    format.name
                );
            }
        }
    }
}

struct NameAndTable {
    name: &'static str,
    table: Table,
}

fn all(input: &Input) -> Vec<NameAndTable> {
    let make = |named: &NamedTable| NameAndTable {
        name: named.name,
        table: table(input, named.name),
    };
    TABLES.iter().map(make).collect()
}

#[test]
fn the_page_of_tables_lists_all() {
    let line = |named: &NamedTable| format!("- `{}`: {}\n", named.name, named.about);
    let made: String = TABLES.iter().map(line).collect();
    made_pages::hold("tables.md", "the_page_of_tables", &made);
}

#[test]
fn no_name_from_a_file_is_a_command() {
    let input = troubled_input();
    let html = written(&input, "refused", "html");
    assert!(
        !html.contains("<b>bad") && html.contains("&lt;b&gt;bad"),
        "{html}"
    );
    let csv = written(&input, "runs", "csv");
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    assert_eq!(reader.records().map(Result::unwrap).count(), input.runs.len());
}

/// Relative standard error given to the thesis's values, which it prints without one.
const RELATIVE_ERROR: f64 = 0.01;

/// One run per row of the thesis's table 5.
fn thesis_input(path: &std::path::Path) -> Input {
    let mut input = input(&["CNaf", "CPvf"], 1);
    let mut reader = csv::Reader::from_path(path).expect("the table");
    let rows = reader.records().map(|row| row.expect("a row"));
    input.runs = rows
        .enumerate()
        .map(|(index, row)| thesis_run(index, &row))
        .collect();
    input
}

fn thesis_run(index: usize, row: &csv::StringRecord) -> ieap::domain::RunRecord {
    let number = |column: usize| row[column].parse::<f64>().expect("a number");
    let mut made = run(index, &row[0], 0, number(2), 1);
    for tag in &mut made.tags {
        if tag.key == "environment" {
            row[1].clone_into(&mut tag.value);
        }
    }
    let (r1, c1, r2, c2) = (number(3), number(4), number(5), number(6));
    let values = [
        ("rss_ohm_cm2", 1e3 * number(7)),
        ("lambda_per_s", number(10)),
        ("c_total_f_per_cm2", c1 + c2),
        ("r_parallel_ohm_cm2", 1.0 / (1.0 / r1 + 1.0 / r2)),
    ];
    for (key, value) in values {
        let parameters = &mut made.fit.as_mut().expect("fitted").parameters;
        let parameter = parameters
            .iter_mut()
            .find(|p| p.key == key)
            .expect("the parameter");
        let error = RELATIVE_ERROR * value;
        parameter.estimate = if value > 0.0 {
            Estimate::determined(value, error, value - 1.96 * error, value + 1.96 * error)
        } else {
            Estimate::below(1e-6, "the thesis prints 0")
        };
    }
    made
}

/// Two runs, fitted.
fn fitted() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/b.csv", run_table(2));
    folder.run_json();
    folder
}

#[test]
fn tables_are_listed_printed_and_refused_by_name() {
    let folder = fitted();
    let listed = folder.ieap(&["table", "--json"]).expect(0).json();
    assert_eq!(listed["tables"].as_array().unwrap().len(), TABLES.len());
    let text = folder.ieap(&["table", "table5"]).expect(0).stdout;
    assert!(text.contains('±') && text.contains("CNaf"), "{text}");
    let refused = folder.ieap(&["table", "table7"]).expect(2);
    assert!(refused.stderr.contains("table5"), "{}", refused.stderr);
    let refused = folder.ieap(&["table", "table5", "--format", "word"]).expect(2);
    assert!(refused.stderr.contains("typst"), "{}", refused.stderr);
    folder.ieap(&["table", "table5", "-o", "t.tex"]).expect(0);
    let refused = folder.ieap(&["table", "table5", "-o", "t.tex"]).expect(2);
    assert!(refused.stderr.contains("--overwrite"), "{}", refused.stderr);
}

#[test]
fn a_cell_names_the_bytes_that_it_rests_on() {
    let folder = fitted();
    let found = folder
        .ieap(&["explain", "table5", "1", "alpha", "--json"])
        .expect(0)
        .json();
    let from = found["from"].as_array().unwrap();
    assert_eq!(from.len(), 2, "two runs of one condition: {found:#}");
    for (evidence, n) in from.iter().zip([1, 2]) {
        let bytes = run_table(n);
        assert_eq!(
            evidence["files"][0]["hash"],
            blake3::hash(bytes.as_ref()).to_hex().to_string()
        );
        assert_eq!(evidence["result"]["input_hash"].as_str().unwrap().len(), 64);
        assert!(
            evidence["result"]["model"]
                .as_str()
                .unwrap()
                .starts_with("lumped-2 v")
        );
    }
    assert!(found["how"].as_str().unwrap().contains("2 runs"));
    let refused = folder.ieap(&["explain", "table5", "1", "viscosity"]).expect(2);
    assert!(refused.stderr.contains("lambda_per_s"), "{}", refused.stderr);
    let listed = folder.ieap(&["explain", "table5"]).expect(0).stdout;
    assert!(
        listed.contains("CNaf, air, 2.0 V") && listed.contains("rss_ohm_cm2"),
        "{listed}"
    );
}

#[test]
fn a_refit_tells_which_cells_moved() {
    let folder = fitted();
    let still = folder
        .ieap(&["table", "fits-wide", "--moved", "--json"])
        .expect(0)
        .json();
    assert_eq!(still["cells"], serde_json::json!([]));
    folder.ieap(&["fit", "--again", "--model", "lumped-1"]).expect(0);
    let moved = folder
        .ieap(&["table", "fits-wide", "--moved", "--json"])
        .expect(0)
        .json();
    let cells = moved["cells"].as_array().unwrap();
    let of = |column: &str| cells.iter().find(|cell| cell["column"] == column);
    assert!(of("c1_f_per_cm2").is_some(), "{moved:#}");
    assert!(of("model").is_some_and(|cell| cell["before"].as_str().unwrap().starts_with("lumped-2")));
    let since = folder
        .ieap(&["table", "fits-wide", "--since", "2020-01-01", "--json"])
        .expect(0)
        .json();
    assert_eq!(since["rows_new"], serde_json::json!(["runs/a.csv", "runs/b.csv"]));
    let refused = folder
        .ieap(&["table", "fits-wide", "--since", "yesterday"])
        .expect(2);
    assert!(refused.stderr.contains("2026-11-20"), "{}", refused.stderr);
}

#[test]
fn everything_is_exported_in_every_format() {
    let folder = fitted();
    let rows = |format: &str| {
        let arguments = [
            "export", "--what", "all", "--format", format, "-o", "out", "--json",
        ];
        let files = folder.ieap(&arguments).expect(0).json()["files"].clone();
        let rows = |file: &Value| file["rows"].as_u64().unwrap();
        files.as_array().unwrap().iter().map(rows).collect::<Vec<_>>()
    };
    let parquet = rows("parquet");
    assert_eq!(parquet, rows("csv"));
    assert_eq!((parquet.len(), parquet[1]), (13, 2));
    let refused = folder.ieap(&["export", "--what", "all", "-o", "out"]).expect(2);
    assert!(refused.stderr.contains("--overwrite"), "{}", refused.stderr);
    folder
        .ieap(&["export", "--what", "fits", "-o", "fits.json"])
        .expect(0);
    let fits: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("fits.json")).unwrap()).unwrap();
    assert_eq!(fits.as_array().unwrap().len() as u64, parquet[3]);
    assert!(
        fits[0]["value"].is_number() && fits[0]["run"] == "runs/a.csv",
        "{}",
        fits[0]
    );
    let mut tags = csv::Reader::from_path(folder.join("out/tags.csv")).unwrap();
    let chosen = tags
        .records()
        .map(Result::unwrap)
        .filter(|row| &row[5] == "true")
        .count();
    assert!(
        chosen >= 6,
        "sample, environment and voltage of two runs: {chosen}"
    );
    let refused = folder
        .ieap(&["export", "--what", "traces", "-o", "traces.json"])
        .expect(2);
    assert!(refused.stderr.contains(".parquet"), "{}", refused.stderr);
    let leftovers = std::fs::read_dir(folder.path()).unwrap();
    assert!(
        leftovers
            .flatten()
            .all(|entry| !entry.file_name().to_string_lossy().ends_with(".part"))
    );
}

/// Against what lies beside the project.
mod needs_shared {
    use super::*;
    use crate::needs_shared::shared;

    #[test]
    fn the_words_of_the_thesis_follow_from_its_numbers() {
        let Some(path) = shared("reference/thesis_table5.csv") else {
            return;
        };
        let table = table(&thesis_input(&path), "table6");
        let words = |label: &str| -> Vec<String> {
            let row = &table.rows[table.row_named(label).expect("a row")];
            let word = |cell: &ieap::analysis::tables::Cell| ieap::report::tables::text_of(&cell.content);
            row.cells[table.stub..].iter().map(word).collect()
        };
        // The author's table 6, which names no material but for back-relaxation.
        assert_eq!(
            words("air, back_relaxation, CNaf"),
            ["minor", "moderate", "intense"]
        );
        assert_eq!(words("air, back_relaxation, CPvf"), ["minor"; 3]);
        assert_eq!(words("air, electrolysis, CNaf"), ["none", "present", "intensive"]);
        let time_constants = words("air, time_constant, CNaf");
        assert_eq!((&*time_constants[0], &*time_constants[2]), ("large", "small"));
        for dry in ["vacuum", "inert"] {
            for material in ["CNaf", "CPvf"] {
                let of = |aspect: &str| words(&format!("{dry}, {aspect}, {material}"));
                assert_eq!(of("back_relaxation"), ["minor"; 3], "{dry} {material}");
                assert_eq!(of("electrolysis"), ["none"; 3], "{dry} {material}");
                assert_eq!(of("time_constant"), ["small"; 3], "{dry} {material}");
            }
            assert_eq!(words(&format!("{dry}, steady_state_current, CNaf")), ["low"; 3]);
            // Where the rules differ from the author's words: docs/tables.md.
            let currents = words(&format!("{dry}, steady_state_current, CPvf"));
            assert!(currents.iter().all(|word| !word.contains("low")), "{currents:?}");
        }
        assert_eq!(words("air, electrolysis, CPvf"), ["none", "none", "present"]);
        assert_eq!(words("air, time_constant, CPvf"), ["small"; 3]);
    }
}
