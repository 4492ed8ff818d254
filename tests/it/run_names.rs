//! Every run that is read is in the list, whatever its file and its table are called.

use std::collections::BTreeSet;

use ieap::store::Store;

use crate::campaign::{CampaignFolder, run_table};
use crate::samples::xlsx;

const HEAD: &str =
    "EXPLAIN\r\nTAG\tCHRONOA\r\nVPRESTEP\tPOTEN\t0\tF\tPre-step\r\nVSTEP1\tPOTEN\t2\tF\tStep\r\n";

/// A chronoamperometry with two tables of one name.
fn two_curves() -> String {
    let curve = |scale: f64| {
        let mut text = String::from("CURVE\tTABLE\t30\r\n\tPt\tT\tVf\tIm\r\n\t#\ts\tV vs. Ref.\tA\r\n");
        for row in 0..30 {
            let time_s = f64::from(row);
            let current_a = scale * (1e-3 * (-time_s / 8.0).exp() + 1e-5);
            text += &format!("\t{row}\t{time_s:.5E}\t2.00000E+000\t{current_a:.5E}\r\n");
        }
        text
    };
    format!("{HEAD}{}{}", curve(1.0), curve(2.0))
}

fn current_runs(folder: &CampaignFolder) -> BTreeSet<String> {
    let store = Store::open_read_only(folder.path()).unwrap().unwrap();
    store.runs().unwrap().into_iter().map(|run| run.path).collect()
}

fn named(names: &[&str]) -> BTreeSet<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

#[test]
fn two_tables_of_one_name_are_two_runs() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.DTA", two_curves());
    let summary = folder.run_json();
    let both = ["runs/a.DTA#CURVE", "runs/a.DTA#CURVE (2)"];
    assert_eq!(summary["ingest"]["new"], serde_json::json!(both), "{summary:#}");
    assert_eq!(current_runs(&folder), named(&both));
    // The same bytes again are no news, and new ones are revisions of these two.
    folder.write("runs/a.DTA", two_curves());
    assert_eq!(folder.run_json()["ingest"]["revised"], serde_json::json!([]));
    folder.write("runs/a.DTA", two_curves().replace("Step\r", "Step again\r"));
    assert_eq!(folder.run_json()["ingest"]["revised"], serde_json::json!(both));
    assert_eq!(current_runs(&folder), named(&both));
}

#[test]
fn a_table_and_a_file_of_one_name_are_two_runs_in_any_order() {
    let sheet: &[&[&str]] = &[
        &["Time (s)", "Voltage (V)", "Current (mA)"],
        &["-0.5", "0", "0.0125"],
        &["0", "2.5", "12.75"],
        &["0.5", "2.5", "3.25"],
        &["1", "2.5", "1.125"],
    ];
    let book = xlsx(&[("Run", sheet), ("Other", sheet)]);
    for book_first in [true, false] {
        let folder = CampaignFolder::new();
        let write_book = || folder.write("runs/a.xlsx", &book);
        let write_file = || folder.write("runs/a.xlsx#Run", run_table(1));
        if book_first {
            write_book();
            folder.run_json();
            write_file();
        } else {
            write_file();
            folder.run_json();
            write_book();
        }
        folder.run_json();
        let names = ["runs/a.xlsx#Other", "runs/a.xlsx#Run", "runs/a.xlsx#Run (2)"];
        assert_eq!(current_runs(&folder), named(&names), "book first: {book_first}");
        // Later content goes to the run of its file.
        folder.write("runs/a.xlsx#Run", run_table(2));
        let own = if book_first { names[2] } else { names[1] };
        let summary = folder.run_json();
        assert_eq!(
            summary["ingest"]["replaced"],
            serde_json::json!([own]),
            "{summary:#}"
        );
        assert_eq!(current_runs(&folder), named(&names));
    }
}
