//! `ieap table reductions`: where a simpler circuit would do.

use crate::campaign::{CampaignFolder, run_table};

#[test]
fn one_branch_is_enough_where_the_current_has_one_and_its_leak_is_not_passed_over() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.ieap(&["fit"]).expect(0);
    let table = folder
        .ieap(&["table", "reductions", "--format", "csv"])
        .expect(0)
        .stdout;
    let row = |circuit: &str| -> Vec<String> {
        let line = table.lines().find(|line| line.contains(circuit)).unwrap();
        // The circuit's name may hold a comma.
        let (_, rest) = line.split_once(circuit).unwrap();
        rest.trim_start_matches(|c: char| c != ',')
            .split(',')
            .skip(1)
            .map(str::to_owned)
            .collect()
    };
    let one = row("one branch (7G, 7F)\"");
    assert_eq!((one[0].as_str(), one[1].as_str()), ("yes", "2"), "{table}");
    assert!(one[2].parse::<f64>().unwrap() < 1.0, "{table}");
    let [ra, rb, c] = [6, 7, 8].map(|at: usize| one[at].parse::<f64>().unwrap());
    assert!(ra > 0.0 && rb > 10.0 * ra && c > 0.0, "{table}");
    let dry = row("one branch, no leak (7B)\"");
    assert_eq!(dry[0], "no", "{table}");
    assert_eq!(dry[5], "1.0e-9", "{table}");
}
