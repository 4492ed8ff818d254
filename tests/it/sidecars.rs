//! Files that instrument software writes beside a run: they are no runs, and they are no refusals.

use crate::campaign::{CampaignFolder, run_table};

#[test]
fn sidecars_are_neither_runs_nor_refused() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write(
        "runs/step.imf",
        "Version= 15\r\nMethod=Transients\r\nTechnique=ChronoAmperometry\r\n",
    );
    folder.write("runs/step.mpl", "EC-Lab LOG FILE\r\n\r\nRun on channel : 1\r\n");
    folder.write("runs/step.mps", "EC-LAB SETTING FILE\r\n");
    folder.write("runs/step.tdms_index", b"TDSh\x0e\0\0\0");
    folder.ieap(&["run", "--no-diagnose"]).expect(0);
    let status = folder.ieap(&["status", "--json"]).expect(0).json();
    for state in ["refused", "pending"] {
        assert_eq!(status["status"][state], serde_json::json!([]), "{state}");
    }
    assert_eq!(status["status"]["runs"], 1);
    let shown = folder.ieap(&["inspect", "--json", "runs/step.mpl"]).json();
    assert_eq!(shown["status"], "sidecar", "{shown:#}");
    let again = folder.run_json();
    assert_eq!(again["ingest"]["new"], serde_json::json!([]));
}

#[test]
fn a_sidecar_that_becomes_a_run_is_taken() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", "EC-Lab LOG FILE\n");
    assert_eq!(folder.run_json()["ingest"]["new"], serde_json::json!([]));
    folder.write("runs/a.csv", run_table(1));
    assert_eq!(folder.run_json()["fit"]["fitted"], 1);
}

#[test]
fn an_ivium_file_is_a_run_with_the_tags_of_its_header() {
    let folder = CampaignFolder::new();
    let mut text = format!(
        "{}x\0\0\0\r\0Version=12\r\nQR=QR,2,7,,1,45579.5,45579.6,typed\r\n",
        "\0".repeat(16)
    );
    text += "Method=Transients\r\nTechnique=ChronoAmperometry\r\nTitle=a\r\nLevels.E[1]=1.5\r\nInterval time=0.5\r\n";
    text += "Report.Process data=endcondition: Scan completed\u{1c}\u{1e}\r\nprimary_data    \r\0";
    text += "3         \r\n40        \r\n";
    for row in 1..=40 {
        let time_s = 0.5 * f64::from(row);
        text += &format!(
            "{time_s:.5E} {:.5E} 1.50000E+00\r\n",
            1e-3 * (-time_s / 5.0).exp() + 1e-5
        );
    }
    folder.write("runs/a.idf", &text);
    let summary = folder.run_json();
    assert_eq!(
        summary["ingest"]["new"],
        serde_json::json!(["runs/a.idf"]),
        "{summary:#}"
    );
    assert_eq!(summary["ingest"]["refused"], serde_json::json!([]));
}
