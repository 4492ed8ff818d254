//! Noise that is the instrument's: other runs tell of it, and which of them decides alone which fits are made anew.

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, run_table};

/// One of one branch, as the runs are: a second one might hide before the first reading, and then nothing is told.
fn campaign() -> CampaignFolder {
    let folder = CampaignFolder::new();
    let stated = CAMPAIGN_TOML.replace("[campaign]", "[campaign]\nmodel = \"lumped-1\"");
    folder.write("campaign.toml", stated);
    folder
}

fn fitted(folder: &CampaignFolder) -> String {
    folder.ieap(&["ingest"]).expect(0);
    folder.ieap(&["fit"]).expect(0).stderr
}

#[test]
fn earlier_fits_change_only_where_the_number_of_runs_doubles() {
    let folder = campaign();
    let mut said = Vec::new();
    for seed in 1..=5 {
        folder.write(&format!("runs/{seed}.csv"), run_table(seed));
        let stderr = fitted(&folder);
        let line = stderr.lines().find(|line| line.contains(" fitted, ")).unwrap();
        said.push(line.split(',').next().unwrap().trim().to_owned());
    }
    assert_eq!(said, ["1 fitted", "2 fitted", "1 fitted", "4 fitted", "1 fitted"]);
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    let told = |run: usize| fits["fits"][run]["noise"][0]["character"]["runs_of_instrument"].clone();
    assert_eq!((told(0), told(4)), (3.into(), 4.into()), "{fits}");
}

/// Runs are numbered by seed: those of an instrument of their own hear of each other and of no others.
#[test]
fn runs_of_another_instrument_tell_nothing() {
    let folder = campaign();
    for seed in 1..=4 {
        folder.write(&format!("runs/{seed}.csv"), run_table(seed));
    }
    fitted(&folder);
    folder
        .ieap(&["tag", "runs/4.csv", "instrument=another"])
        .expect(0);
    folder.ieap(&["fit"]).expect(0);
    let fits = folder.ieap(&["fit", "--json"]).expect(0).json();
    let told = |run: usize| fits["fits"][run]["noise"][0]["character"].clone();
    assert_eq!(told(0)["runs_of_instrument"], 1, "{fits}");
    assert!(told(3).get("runs_of_instrument").is_none(), "{fits}");
}
