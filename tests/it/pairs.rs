//! Runs in two files through files: in either order, tagged by either half, taken back, rebuilt; and what intake says of
//! halves, voltages in another unit, sensors without a log.

use ieap::store::Store;
use serde_json::Value;

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, run_table};

/// The columns of a run table, by their places.
fn columns(seed: u32, wanted: &[usize], names: &str) -> String {
    let table = run_table(seed);
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        wanted.iter().map(|at| cells[*at]).collect::<Vec<_>>().join("\t") + "\n"
    };
    format!("{names}\n{}", table.lines().skip(1).map(row).collect::<String>())
}

fn current(seed: u32) -> String {
    columns(seed, &[0, 1, 2], "time_s\tvoltage_v\tcurrent_a")
}

fn bending(seed: u32) -> String {
    columns(seed, &[0, 3], "time_s\tcurvature_per_cm")
}

/// Names of current runs with the paths of their files.
fn runs(folder: &CampaignFolder) -> Vec<(String, Vec<String>)> {
    let store = Store::open_read_only(folder.path()).unwrap().unwrap();
    let runs = store.runs().unwrap().into_iter();
    runs.map(|run| (run.path, run.files.into_iter().map(|file| file.path).collect()))
        .collect()
}

fn pair(run: &str, bending: &str) -> (String, Vec<String>) {
    (run.to_owned(), vec![run.to_owned(), bending.to_owned()])
}

fn alone(run: &str) -> (String, Vec<String>) {
    (run.to_owned(), vec![run.to_owned()])
}

fn ingest(folder: &CampaignFolder) -> Value {
    folder.ieap(&["ingest", "--json"]).expect(0).json()["ingest"].clone()
}

#[test]
fn halves_join_in_either_order_and_are_parted_when_campaign_toml_says_so() {
    let (a, b) = ("runs/pot/S1_2V_1.txt", "runs/laser/S1_p2V_1.csv");
    for first in [true, false] {
        let folder = CampaignFolder::new();
        let halves = [(a, current(1)), (b, bending(1))];
        let order = if first { [0, 1] } else { [1, 0] };
        folder.write(halves[order[0]].0, &halves[order[0]].1);
        ingest(&folder);
        // A tag of the half is one of the run.
        folder
            .ieap(&["tag", halves[order[0]].0, "operator=ann"])
            .expect(0);
        folder.write(halves[order[1]].0, &halves[order[1]].1);
        let found = ingest(&folder);
        assert_eq!(found["paired"].as_array().unwrap().len(), 1, "{found:#}");
        assert_eq!(found["lone_halves"], serde_json::json!([]));
        assert_eq!(runs(&folder), [pair(a, b)]);
        let told = folder.ieap(&["tag", a, "note=seen", "--json"]).expect(0).json();
        assert!(told["tag"]["tags"].to_string().contains("\"ann\""), "{told:#}");
        // Nothing is done twice, a half that changes makes a new revision of the run.
        assert_eq!(ingest(&folder)["paired"], serde_json::json!([]));
        folder.write(b, bending(2));
        assert_eq!(ingest(&folder)["revised"], serde_json::json!([a]));
        assert_eq!(runs(&folder), [pair(a, b)]);
        folder.ieap(&["rebuild"]).expect(0);
        assert_eq!(runs(&folder), [pair(a, b)]);
        let parted = format!("{CAMPAIGN_TOML}\n[runs]\npair_by = []\n");
        folder.write("campaign.toml", &parted);
        ingest(&folder);
        assert_eq!(runs(&folder), [alone(b), alone(a)]);
        let ruled = format!(
            "{parted}\n[[pair]]\ncurrent = \"pot/{{sample}}_2V_{{k}}.txt\"\nbending = \"laser/{{sample}}_p2V_{{k}}.csv\"\n"
        );
        folder.write("campaign.toml", ruled);
        ingest(&folder);
        assert_eq!(runs(&folder), [pair(a, b)]);
        let status = folder.ieap(&["status", "--json"]).json();
        assert_eq!(status["status"]["pairs"][0]["by"], "rule");
    }
}

#[test]
fn a_half_says_whom_it_waits_for_and_parts_of_one_name_stay_what_they_were() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.current.csv", current(1).replace('\t', ","));
    folder.write("runs/a.curvature.csv", bending(1).replace('\t', ","));
    folder.write("runs/b.current.txt", current(2));
    folder.write("runs/b.displacement.csv", bending(2));
    folder.write("runs/S1_air_2V_1.txt", current(3));
    folder.write("runs/S1_air_2V_1_laser.csv", bending(3));
    folder.write("runs/S1_air_2V_2.txt", current(4));
    let found = ingest(&folder);
    let waits: Vec<&str> = found["lone_halves"]
        .as_array()
        .unwrap()
        .iter()
        .map(|half| half["waits_for"].as_str().unwrap())
        .collect();
    assert_eq!(waits, ["runs/S1_air_2V_2_laser.csv with the bending"]);
    let names: Vec<String> = runs(&folder).into_iter().map(|(name, _)| name).collect();
    assert_eq!(
        names,
        [
            "runs/S1_air_2V_1.txt",
            "runs/S1_air_2V_2.txt",
            "runs/a.csv",
            "runs/b.current.txt"
        ]
    );
    let files = folder.ieap(&["status", "--files", "--json"]).expect(0).json();
    let half = files["files"]
        .as_array()
        .unwrap()
        .iter()
        .find(|file| file["path"] == "runs/S1_air_2V_2.txt");
    assert_eq!(half.unwrap()["why"][0]["code"], "half-of-a-run");
    let text = folder.ieap(&["status"]).expect(0).stdout;
    assert!(text.contains("waits for runs/S1_air_2V_2_laser.csv"), "{text}");
}

#[test]
fn a_voltage_in_another_unit_than_that_of_the_readings_is_refused_unless_it_is_meant() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["ingest"]).expect(0);
    let refused = folder.ieap(&["tag", "runs/a.csv", "voltage_v=2500"]).expect(2);
    assert!(
        refused.stderr.contains("say 2 V") && refused.stderr.contains("--even-so"),
        "{}",
        refused.stderr
    );
    folder.ieap(&["tag", "runs/a.csv", "voltage_v=2.5"]).expect(0);
    folder
        .ieap(&["tag", "runs/a.csv", "voltage_v=2500", "--even-so"])
        .expect(0);
}

#[test]
fn what_an_environment_states_counts_more_than_the_room_and_a_sensor_without_a_log_is_said() {
    let folder = CampaignFolder::new();
    folder.write(
        "campaign.toml",
        format!(
            "{CAMPAIGN_TOML}\n[[environment]]\nid = \"dry-box\"\nrelative_humidity_percent = 5.0\n\n[[sensor]]\nid = \"bench-7\"\n"
        ),
    );
    let rows: String = (0..60)
        .map(|k| format!("2026-01-10 {:02}:{:02}:00,21,40\n", 9 + k / 60, k % 60))
        .collect();
    folder.write(
        "ambient/room.csv",
        format!("Time,Temperature (°C),Relative Humidity (%)\n{rows}"),
    );
    folder.write(
        "runs/box/tags.toml",
        "environment = \"dry-box\"\nstarted_at = \"2026-01-10T09:10:00\"\n",
    );
    folder.write("runs/box/a.csv", run_table(1));
    folder.write(
        "runs/room/tags.toml",
        "environment = \"Luft\"\nstarted_at = \"2026-01-10T09:10:00\"\n",
    );
    folder.write("runs/room/b.csv", run_table(2));
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    let of = |run: &str| {
        let fits = fits["fits"].as_array().unwrap();
        let fit = fits.iter().find(|fit| fit["run"] == run).unwrap();
        (
            fit["environment"].as_str().unwrap().to_owned(),
            fit["relative_humidity_percent"].as_f64(),
        )
    };
    assert_eq!(of("runs/box/a.csv"), ("dry-box".to_owned(), Some(5.0)));
    assert_eq!(of("runs/room/b.csv"), ("air".to_owned(), Some(40.0)));
    let store = Store::open_read_only(folder.path()).unwrap().unwrap();
    let run = store
        .runs()
        .unwrap()
        .into_iter()
        .find(|run| run.path == "runs/box/a.csv")
        .unwrap();
    let asked = run
        .issues
        .iter()
        .find(|issue| issue.code == "climate-environment-stated")
        .unwrap();
    assert!(asked.mend.contains("environments = [\"dry-box\"]"), "{asked:?}");
    let status = folder.ieap(&["status", "--json"]).json();
    let issues = status["status"]["climate"]["assessment"]["issues"].to_string();
    assert!(
        issues.contains("sensor-without-log") && issues.contains("bench-7"),
        "{issues}"
    );
}
