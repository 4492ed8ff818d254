//! A campaign of a chirp, a sine, a sine that is read too coarsely and a step: taken in, fitted, in table, figure and page.

use serde_json::Value;

use crate::campaign::CampaignFolder;

const CAMPAIGN: &str = "[campaign]\nid = \"waves\"\ntitle = \"Waves\"\n\n[[sample]]\nid = \"S1\"\nmaterial = \"M\"\nlength_mm = 10.0\nwidth_mm = 1.0\n";
const SPEC: &str = r#"[simulation]
seed = 7
folder = "runs"
statement = ["SIMULATED, not measured."]
baseline_s = 10.0
baseline_every_s = 0.5

[noise]
current_a = 2e-6
curvature_per_cm = 2e-3

[[sampling]]
until_s = 1800.0
every_s = 1.0
"#;
const R1_OHM_CM2: f64 = 521.4;

fn folder() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("campaign.toml", CAMPAIGN);
    let mut spec = SPEC.to_owned();
    for (name, drive) in [
        (
            "chirp",
            "wave = { amplitude_v = 2.0, frequency_hz = 5e-4, to_hz = 0.05, lasting_s = 1800.0 }",
        ),
        (
            "sine",
            "wave = { amplitude_v = 2.0, frequency_hz = 0.02, lasting_s = 1800.0 }",
        ),
        (
            "coarse",
            "wave = { amplitude_v = 2.0, frequency_hz = 0.11, lasting_s = 1800.0 }",
        ),
        ("step", "voltage_v = 2.0"),
    ] {
        spec += &format!(
            "\n[[run]]\nfile = \"{name}.csv\"\narea_cm2 = 0.1\n{drive}\nparameters = {{ r1_ohm_cm2 = {R1_OHM_CM2}, c1_f_per_cm2 = 0.098, \
             r2_ohm_cm2 = 2629.9, c2_f_per_cm2 = 0.13, rss_ohm_cm2 = 5660.0, alpha_per_c_cm = 13.88, lambda_per_s = 4e-3 }}\n\
             tags = {{ sample = \"S1\", environment = \"air\" }}\n"
        );
    }
    folder.write("simulation.toml", spec);
    let spec = folder.path().join("simulation.toml");
    folder.ieap(&["simulate", spec.to_str().unwrap()]).expect(0);
    folder
}

#[test]
fn a_chirp_and_a_sine_go_from_the_file_to_table_figure_and_page() {
    let folder = folder();
    folder.ieap(&["run"]).expect(0);
    let status = folder.ieap(&["status"]).expect(0).stdout;
    assert!(
        status.contains("runs/coarse.csv") && status.contains("or faster"),
        "{status}"
    );

    let table = folder
        .ieap(&["table", "frequency", "--format", "json"])
        .expect(0)
        .json();
    let rows = table["rows"].as_array().unwrap();
    let of = |run: &str| {
        rows.iter()
            .filter(|row| row["label"].as_str().unwrap().contains(run))
            .count()
    };
    assert_eq!((of("sine"), of("coarse"), of("step")), (1, 0, 0));
    assert!(of("chirp") > 4, "{table}");

    let page = folder.report("frequency.html");
    assert!(page.contains("2 runs under a sine or a chirp"), "{page}");
    let figure = folder.path().join("frequency.svg");
    folder
        .ieap(&["figure", "frequency", "-o", figure.to_str().unwrap()])
        .expect(0);

    // The step alone is a condition, for a wave has no voltage; all of them are diagnosed and compared.
    let fits = folder
        .ieap(&["table", "conditions", "--format", "json"])
        .expect(0)
        .json();
    assert_eq!(fits["rows"].as_array().map(Vec::len), Some(1));
    let found = folder.ieap(&["diagnose", "--json"]).expect(0).json();
    let group = &found["groups"][0];
    assert_eq!(
        (&group["verdict"], group["runs"].as_array().map(Vec::len)),
        (&"right".into(), Some(3)),
        "{group}"
    );
    assert!(folder.report("findings.html").contains("chirp"));
    let compared = folder.ieap(&["compare", "--json"]).expect(0).stdout;
    assert!(compared.contains("runs/chirp.csv"), "{compared}");
    let drawn = folder
        .ieap(&["table", "fits-wide", "--format", "json"])
        .expect(0)
        .json();
    assert!((r1(&drawn, "chirp") / R1_OHM_CM2 - 1.0).abs() < 0.02, "{drawn}");
}

fn r1(table: &Value, run: &str) -> f64 {
    let rows = table["rows"].as_array().unwrap();
    let row = rows
        .iter()
        .find(|row| row["label"].as_str().unwrap().contains(run));
    row.unwrap()["cells"]["r1_ohm_cm2"]["value"].as_f64().unwrap()
}
