//! The database as other programs read it: what docs/schema.md prints is run as it stands there.

use std::path::Path;
use std::process::{Command, Output};

use crate::campaign::{CampaignFolder, run_table};

/// The interpreter that tests use.
pub fn python() -> String {
    std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned())
}

/// Whether Python is there with these modules; says so where it is not.
pub fn has_python(modules: &str) -> bool {
    let tried = Command::new(python())
        .args(["-c", &format!("import {modules}")])
        .output();
    let is_there = tried.is_ok_and(|output| output.status.success());
    if !is_there {
        println!("not tried: {} with {modules} is not there", python());
    }
    is_there
}

/// Runs a script in a folder; gives what it printed.
pub fn run_python(folder: &Path, script: &str) -> String {
    let Output {
        status,
        stdout,
        stderr,
    } = Command::new(python())
        .args(["-c", script])
        .current_dir(folder)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&stderr);
    assert!(status.success(), "{script}\n{said}");
    String::from_utf8(stdout).unwrap()
}

/// The blocks of code of a page that hold `word`.
pub fn blocks_with(page: &str, word: &str) -> Vec<String> {
    let text =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(page)).unwrap();
    let mut blocks = vec![String::new()];
    for line in text.lines() {
        match line.strip_prefix("    ") {
            Some(code) => *blocks.last_mut().unwrap() += &format!("{code}\n"),
            None => blocks.push(String::new()),
        }
    }
    blocks.retain(|block| block.contains(word));
    blocks
}

/// A folder with `my-campaign` in it, which has a fitted run and one that was dropped.
fn world() -> (tempfile::TempDir, CampaignFolder) {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/b.csv", run_table(2));
    folder.run_json();
    folder
        .ieap(&["drop", "runs/b.csv", "--why", "clip slipped"])
        .expect(0);
    let above = tempfile::tempdir().unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink(folder.path(), above.path().join("my-campaign")).unwrap();
    (above, folder)
}

fn query(folder: &CampaignFolder, sql: &str) -> Vec<Vec<rusqlite::types::Value>> {
    let flags = rusqlite::OpenFlags::SQLITE_OPEN_READ_ONLY;
    let connection = rusqlite::Connection::open_with_flags(folder.join("campaign.db"), flags).unwrap();
    let mut statement = connection.prepare(sql).unwrap();
    let width = statement.column_count();
    let row = |row: &rusqlite::Row<'_>| (0..width).map(|column| row.get(column)).collect();
    let rows = statement.query_map([], row).unwrap();
    rows.map(Result::unwrap).collect()
}

#[test]
fn views_say_what_the_program_says() {
    let (_above, folder) = world();
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    let parameters = fits["fits"][0]["parameters"].as_object().unwrap();
    let rows = query(
        &folder,
        "SELECT parameter, value, unit FROM fits_view WHERE dropped_why IS NULL AND role = 'parameter' ORDER BY parameter",
    );
    assert_eq!(rows.len(), parameters.len());
    for row in rows {
        let [rusqlite::types::Value::Text(parameter), value, unit] = row.as_slice() else {
            panic!("{row:?}");
        };
        match value {
            rusqlite::types::Value::Real(value) => assert_eq!(parameters[parameter]["value"], *value),
            _ => assert!(parameters[parameter]["value"].is_null(), "{parameter}"),
        }
        assert_eq!(
            ieap::domain::unit_of_key(parameter).map(str::to_owned),
            match unit {
                rusqlite::types::Value::Text(unit) => Some(unit.clone()),
                _ => None,
            }
        );
    }
    let runs = query(
        &folder,
        "SELECT run, state, sample, voltage_v, dropped_why FROM runs_view ORDER BY run",
    );
    let text = |text: &str| rusqlite::types::Value::Text(text.to_owned());
    assert_eq!(runs[0][..3], [text("runs/a.csv"), text("fitted"), text("S1")]);
    assert_eq!(runs[0][3], rusqlite::types::Value::Real(2.0));
    assert_eq!(runs[1][4], text("clip slipped"));
    let tags = query(
        &folder,
        "SELECT count(*) FROM tags_view WHERE chosen = 1 AND key = 'sample'",
    );
    assert_eq!(tags, [[rusqlite::types::Value::Integer(2)]]);
    let id = query(&folder, "SELECT application_id FROM pragma_application_id");
    assert_eq!(id, [[rusqlite::types::Value::Integer(0x6965_6170)]]);
}

/// The questions of the page.
fn questions() -> Vec<String> {
    let blocks = blocks_with("schema.md", "FROM ").into_iter();
    blocks.filter(|block| block.starts_with("SELECT")).collect()
}

#[test]
fn the_questions_of_the_page_are_answered() {
    use rusqlite::types::Value::{Integer, Real, Text};
    let (_above, folder) = world();
    folder.write("runs/refused.csv", "nothing,that\na,reader knows\n");
    folder.run_json();
    let asked = questions();
    assert_eq!(asked.len(), 14);
    let answer = |about: &str| {
        query(
            &folder,
            asked.iter().find(|sql| sql.contains(about)).expect(about),
        )
    };
    let text = |text: &str| Text(text.to_owned());
    // What `ieap fit --json` says of the one run that speaks.
    let fits = folder.ieap(&["fit", "--json"]).json();
    let of_run = |parameter: &str| {
        fits["fits"][0]["parameters"][parameter]["value"]
            .as_f64()
            .unwrap()
    };
    let alpha = &answer("alpha_per_c_cm")[0];
    assert_eq!(
        (&alpha[0], &alpha[2], &alpha[3]),
        (&text("CNaf"), &Real(of_run("alpha_per_c_cm")), &Integer(1))
    );
    let compared = answer("r1_ohm_cm2");
    assert_eq!(compared.len(), 1);
    assert_eq!(compared[0][5], Real(of_run("r1_ohm_cm2")));
    let refused = answer("refused_view");
    assert_eq!(refused[0][0], text("runs/refused.csv"));
    assert!(
        refused[0]
            .iter()
            .all(|cell| matches!(cell, Text(said) if !said.is_empty())),
        "{refused:?}"
    );
    assert_eq!(
        answer("speaks = 0"),
        [[text("runs/b.csv"), text("dropped"), text("clip slipped")]]
    );
    let found = folder.ieap(&["diagnose", "--json"]).json();
    let right = answer("'right'");
    let groups = found["groups"].as_array().unwrap();
    let wanted: Vec<&serde_json::Value> = groups
        .iter()
        .filter(|group| group["verdict"] == "right")
        .collect();
    assert_eq!(right.len(), wanted.len());
    let is_law =
        |own: &&serde_json::Value| own["kind"].as_str().unwrap().contains("law") && !own["p"].is_null();
    let tests: Vec<&serde_json::Value> = (found["study"]["answers"].as_array().unwrap().iter())
        .filter(is_law)
        .collect();
    assert_eq!(
        query(&folder, "SELECT count(*) FROM laws_view"),
        [[Integer(tests.len() as i64)]]
    );
    for sql in &asked {
        query(&folder, sql);
    }
}

#[test]
fn a_run_has_its_material_and_speaks_before_any_report_and_after_an_old_one() {
    use rusqlite::types::Value::{Integer, Text};
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/b.csv", run_table(2));
    folder.ieap(&["ingest"]).expect(0);
    folder.ieap(&["fit"]).expect(0);
    let of_runs = "SELECT material, standing, speaks FROM runs_view ORDER BY run";
    let text = |text: &str| Text(text.to_owned());
    let known = vec![text("CNaf"), text("speaks"), Integer(1)];
    assert_eq!(query(&folder, of_runs), [known.clone(), known.clone()]);
    let of_fits =
        "SELECT count(*) FROM fits_view WHERE parameter = 'r1_ohm_cm2' AND material = 'CNaf' AND speaks = 1";
    assert_eq!(query(&folder, of_fits), [[Integer(2)]]);
    // A run that is newer than the report stands in averages like the others; a word against one holds at once.
    folder.ieap(&["report"]).expect(0);
    folder.write("runs/c.csv", run_table(3));
    folder.ieap(&["fit"]).expect(0);
    folder
        .ieap(&["drop", "runs/b.csv", "--why", "clip slipped"])
        .expect(0);
    let dropped = vec![text("CNaf"), text("dropped"), Integer(0)];
    assert_eq!(query(&folder, of_runs), [known.clone(), dropped, known]);
    assert_eq!(query(&folder, of_fits), [[Integer(2)]]);
}

#[test]
fn exports_of_findings_laws_and_monitoring_hold_what_the_views_show() {
    let (_above, folder) = world();
    folder.ieap(&["diagnose", "--draws", "99"]).expect(0);
    folder.ieap(&["report"]).expect(0);
    for (what, view) in [
        ("findings", "findings_view"),
        ("laws", "laws_view"),
        ("monitoring", "monitoring_view"),
    ] {
        let file = format!("{what}.json");
        folder.ieap(&["export", "--what", what, "-o", &file]).expect(0);
        let rows: Vec<serde_json::Value> =
            serde_json::from_str(&std::fs::read_to_string(folder.join(&file)).unwrap()).unwrap();
        let count = query(&folder, &format!("SELECT count(*) FROM {view}"));
        assert_eq!(
            count,
            [[rusqlite::types::Value::Integer(rows.len() as i64)]],
            "{what}"
        );
    }
    let findings = std::fs::read_to_string(folder.join("findings.json")).unwrap();
    let findings: Vec<serde_json::Value> = serde_json::from_str(&findings).unwrap();
    let sentences = query(&folder, "SELECT sentence FROM findings_view ORDER BY kind, name");
    let mut wanted: Vec<(String, String, String)> = findings
        .iter()
        .map(|row| {
            ["kind", "name", "sentence"]
                .map(|key| row[key].as_str().unwrap().to_owned())
                .into()
        })
        .collect();
    wanted.sort();
    let wanted: Vec<[rusqlite::types::Value; 1]> = wanted
        .into_iter()
        .map(|(_, _, sentence)| [rusqlite::types::Value::Text(sentence)])
        .collect();
    assert!(!wanted.is_empty());
    assert_eq!(sentences, wanted);
}

/// Of every table whose rows stand in no other view: as many rows, and cells that the program says too.
#[test]
fn every_table_is_a_view_with_the_units_of_its_columns() {
    use rusqlite::types::Value::{Integer, Text};
    let (_above, folder) = world();
    folder.run_json();
    let listed = folder.ieap(&["table", "--json"]).expect(0).json();
    let tables = listed["tables"].as_array().unwrap();
    let mut with_rows = 0;
    for name in tables.iter().map(|table| table["name"].as_str().unwrap()) {
        let has_view = [
            "runs",
            "tags",
            "fits",
            "findings",
            "laws",
            "monitoring",
            "refused",
        ]
        .contains(&name);
        if has_view || ["reductions", "step-and-spectrum"].contains(&name) {
            continue;
        }
        let document = folder.ieap(&["table", name, "--json"]).expect(0).json();
        let rows = document["rows"].as_array().unwrap();
        let sql = format!("SELECT count(*) FROM tables_view WHERE name = '{name}'");
        assert_eq!(query(&folder, &sql), [[Integer(rows.len() as i64)]], "{name}");
        let sql =
            format!("SELECT count(*) > 0 FROM columns_view WHERE name = '{name}' AND meaning IS NOT NULL");
        assert_eq!(query(&folder, &sql), [[Integer(1)]], "{name}");
        with_rows += usize::from(!rows.is_empty());
    }
    assert!(with_rows > 4, "{with_rows}");
    let peak = "SELECT cells ->> '$.run', unit FROM tables_view JOIN columns_view USING (name)
                  WHERE name = 'model-free' AND key = 'peak_curvature_per_cm'";
    let text = |text: &str| Text(text.to_owned());
    assert_eq!(query(&folder, peak), [[text("runs/a.csv"), text("cm⁻¹")]]);
}

/// Every unit of a parameter that the program prints is the one that its key ends in, which views and exports go by.
#[test]
fn keys_of_parameters_end_in_the_units_that_are_printed() {
    let folder = CampaignFolder::new();
    let (models, effects) = (
        folder.ieap(&["list", "models", "--json"]).json(),
        folder.ieap(&["list", "effects", "--json"]).json(),
    );
    let lists = [
        models["models"].as_array().unwrap(),
        effects["effects"].as_array().unwrap(),
    ];
    let mut counted = 0;
    for parameter in lists
        .into_iter()
        .flatten()
        .flat_map(|owner| owner["parameters"].as_array().unwrap())
    {
        let (key, unit) = (
            parameter["key"].as_str().unwrap(),
            parameter["unit"].as_str().unwrap(),
        );
        assert_eq!(ieap::domain::unit_of_key(key).unwrap_or(""), unit, "{key}");
        counted += 1;
    }
    assert!(counted > 100, "{counted}");
}

#[cfg(unix)]
#[test]
fn python_reads_the_views_as_the_page_says() {
    if !has_python("sqlite3") {
        return;
    }
    let (above, folder) = world();
    let script = blocks_with("schema.md", "FROM fits_view").remove(0);
    let said = run_python(above.path(), &script);
    assert_eq!(said.lines().count(), 1, "{said}");
    let fits = folder.ieap(&["fit", "--json"]).json();
    let value = fits["fits"][0]["parameters"]["lambda_per_s"]["value"]
        .as_f64()
        .unwrap();
    assert!(
        said.starts_with("('runs/a.csv', ") && said.contains("'1/s'"),
        "{said}"
    );
    let read: f64 = said.split(", ").nth(1).unwrap().parse().unwrap();
    assert_eq!(read, value);
}

#[cfg(unix)]
#[test]
fn ten_lines_of_python_read_the_readings() {
    if !has_python("sqlite3, zstandard") {
        return;
    }
    let (above, _folder) = world();
    let script = blocks_with("schema.md", "readings_view").pop().unwrap();
    assert_eq!(
        script
            .lines()
            .take_while(|line| !line.starts_with("for "))
            .count(),
        8,
        "short enough to be read"
    );
    let said = run_python(above.path(), &script);
    // The first row of run_table, of three channels and two runs.
    assert_eq!(said.lines().count(), 6, "{said}");
    assert!(
        said.lines()
            .any(|line| line.starts_with("runs/a.csv voltage V -20.0 0.0")),
        "{said}"
    );
    // Times that a channel shares with another one, and indices, which are of 32 bits.
    let whole = format!(
        "{script}\nprint(numbers(times)[1:3], numbers(db.execute(\"SELECT excluded_blob FROM readings_view\").fetchone()[0], 'I'))"
    );
    let said = run_python(above.path(), &whole);
    assert!(said.ends_with("(-19.0, -18.0) ()\n"), "{said}");
}

/// The block of a page that is fenced as this language and holds `word`.
#[cfg(unix)]
fn fenced(page: &str, language: &str, word: &str) -> String {
    let text =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(page)).unwrap();
    let open = format!("```{language}\n");
    let blocks = text.split(open.as_str()).skip(1);
    let mut code = blocks.map(|rest| rest.split("```").next().unwrap_or_default());
    code.find(|code| code.contains(word)).expect("a block").to_owned()
}

/// `.ci/run` says where there is no R.
#[cfg(unix)]
#[test]
fn r_reads_the_views_as_the_page_says() {
    let asked = "stopifnot(requireNamespace('DBI'), requireNamespace('RSQLite'))";
    let tried = Command::new("Rscript").args(["-e", asked]).output();
    if !tried.is_ok_and(|output| output.status.success()) {
        println!("not tried: Rscript with DBI and RSQLite is not there");
        return;
    }
    let (above, folder) = world();
    let script = fenced("publish.md", "r", "fits_view");
    assert!(script.lines().count() <= 10, "ten lines");
    std::fs::write(above.path().join("fits.R"), script).unwrap();
    let ended = Command::new("Rscript")
        .arg("fits.R")
        .current_dir(above.path())
        .output()
        .unwrap();
    assert!(
        ended.status.success(),
        "{}",
        String::from_utf8_lossy(&ended.stderr)
    );
    let said = String::from_utf8(ended.stdout).unwrap();
    let row: Vec<&str> = (said.lines().find(|line| line.contains("air")).expect("a row"))
        .split_whitespace()
        .collect();
    let fits = folder.ieap(&["fit", "--json"]).json();
    let value = fits["fits"][0]["parameters"]["lambda_per_s"]["value"]
        .as_f64()
        .unwrap();
    // Environment, voltage and the mean of the only run, in R's seven digits.
    let (voltage_v, mean): (f64, f64) = (row[2].parse().unwrap(), row[3].parse().unwrap());
    assert_eq!(voltage_v, 2.0);
    assert!((mean / value - 1.0).abs() < 1e-6, "{said} {value}");
}

#[cfg(unix)]
#[test]
fn python_writes_nexus_as_the_page_says() {
    if !has_python("h5py, pandas, pyarrow") {
        return;
    }
    let (_above, folder) = world();
    folder
        .ieap(&["export", "--what", "all", "-o", "export"])
        .expect(0);
    let script = fenced("export.md", "python", "NXdata");
    let look = "
file = h5py.File('campaign.nxs')
data = file['runs:a.csv/curvature']
assert file['runs:a.csv'].attrs['NX_class'] == 'NXentry' and data.attrs['NX_class'] == 'NXdata'
assert len(data[data.attrs['signal']]) == len(data[data.attrs['axes']]) > 10
print(list(file), data['value'].attrs['units'], data['time_s'].attrs['units'], data['time_s'][0])";
    let said = run_python(folder.path(), &(script + look));
    // The run that was dropped is not in it.
    assert_eq!(said, "['runs:a.csv'] 1/cm s -20.0\n");
}

#[cfg(unix)]
#[test]
fn duckdb_reads_the_views_and_the_parquet() {
    if !has_python("duckdb") {
        return;
    }
    let (above, folder) = world();
    folder
        .ieap(&["export", "--what", "all", "-o", "export"])
        .expect(0);
    let counted = "print(duckdb.sql(\"SELECT count(*) FROM 'my-campaign/export/runs.parquet'\").fetchall())";
    let said = run_python(above.path(), &format!("import duckdb\n{counted}"));
    assert_eq!(said, "[(2,)]\n");
    let block = blocks_with("schema.md", "ATTACH").remove(0);
    let mut statements = block.split(";\n");
    let (attach, select) = (statements.next().unwrap(), statements.next().unwrap());
    // The extension is fetched from the network where it is not there.
    let script = format!(
        "import duckdb\ndb = duckdb.connect()\ntry:\n    db.execute(\"LOAD sqlite\")\nexcept duckdb.Error as error:\n    \
         print('no extension')\nelse:\n    db.execute(\"{attach}\")\n    print(db.execute(\"{select}\").fetchall())\n"
    );
    let said = run_python(above.path(), &script);
    match said.trim() {
        "no extension" => println!("not tried: DuckDB has no extension for SQLite"),
        rows => assert_eq!(rows, "[('air', 2)]"),
    }
}
